//! The social feed, the player's posts, and the editor for the next post.

mod draft;
pub mod feed;
mod feed_pane;
mod own_posts;
#[cfg(test)]
mod tests;
mod feed_rows;

use std::sync::Arc;

use ratatui::layout::{Constraint, Layout, Rect};
use serde_json::{Value, json};
use strum::VariantArray;

use self::feed::{PostFilter, Post, PostKind};
use super::ScreenState;
use super::panes::{Pane, PaneScreen, draw_pane};
use crate::action::Action;
use crate::context::{Figure, ScreenContext, ScreenId};
use crate::effect::Effect;
use novamind_base::formatting::grouped_number;
use novamind_database::{Interface, QueryResult};
use novamind_report::post_leads::lead_lines_around;
use novamind_tools::ToolId;
use novamind_tui::canvas::{Canvas, truncate_to_width};
use novamind_tui::theme::Role;
use novamind_tui::widgets::{XAxis, TableCell, TableColumn, TextEditor, TextField, Curve, YAxis, Table, AxisUnit, draw_chart};
use novamind_worker::question::Pending;
use novamind_worker::company::DisplayedCompany;
use novamind_worker::message::Response;
use novamind_worker::posts::Posts;
use novamind_worker::page_questions::PreviewCallQuestion;
use novamind_worker::screen_queries::Reading;

/// Panes of the social screen in tab order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, VariantArray)]
pub enum SocialPane {
    /// Feed of all posts.
    #[default]
    Feed,
    /// Editor for the next post.
    Draft,
    /// Table of the player's posts.
    OwnPosts,
}

const POST_TOOL: ToolId = ToolId::PostSocialMedia;

/// The social screen.
#[derive(Default)]
pub struct Social {
    focus: SocialPane,
    others: Posts,
    own_posts: Vec<Arc<Post>>,
    /// All posts in feed order.
    feed: Vec<Arc<Post>>,
    /// Indexes in `feed` of the posts that pass the filter.
    visible_posts: Vec<usize>,
    selected: usize,
    filter: PostFilter,
    filter_field: Option<TextField>,
    table: Table,
    draft: TextEditor,
    editing: bool,
    reply_to: Option<u32>,
    /// Check of the tool call before the user confirms the call.
    pending_call: Pending<PreviewCallQuestion>,
    /// Number of the newest post that was seen, or `None` until the screen is shown.
    newest_seen_post: Option<u32>,
    /// Day up to which posts were seen before the run was opened.
    last_viewed_day: Option<u32>,
    day: u32,
}

impl Social {
    fn last_week(&self) -> u32 {
        self.day.div_ceil(7)
    }

    fn rebuild_feed(&mut self) {
        let kept = self.selected_post().map(|post| (post.kind, post.number));
        self.feed = feed::posts_in_feed_order(&self.others, &self.own_posts);
        self.update_visible_posts(kept);
        let row = |post: &Arc<Post>| {
            vec![
                TableCell::from_number(f64::from(post.day), post.day.to_string()).with_role(Role::Dim),
                TableCell::from_number(f64::from(post.views), grouped_number(f64::from(post.views), 0)),
                TableCell::from_number(f64::from(post.comments), post.comments.to_string()),
                TableCell::from_text(post.text.replace('\n', " ")),
            ]
        };
        let columns = ["day", "views", "comm."].map(TableColumn::numeric);
        let columns = columns.into_iter().chain([TableColumn::text("text").with_max_width(u16::MAX)]).collect();
        self.table.set_columns_and_rows(columns, self.own_posts.iter().map(row).collect());
    }

    /// Applies the filter to the feed. The post `kept` is selected again if it passes the filter.
    fn update_visible_posts(&mut self, kept: Option<(PostKind, u32)>) {
        self.visible_posts = (0..self.feed.len()).filter(|at| self.filter.matches(&self.feed[*at])).collect();
        let is_kept = |at: &usize| Some((self.feed[*at].kind, self.feed[*at].number)) == kept;
        // If the first row is selected, the first row stays selected, so that the newest post is selected.
        let place = self.visible_posts.iter().position(is_kept).filter(|_| self.selected > 0);
        self.selected = place.unwrap_or(0);
    }

    fn apply_filter(&mut self) {
        let kept = self.selected_post().map(|post| (post.kind, post.number));
        self.update_visible_posts(kept);
    }

    fn selected_post(&self) -> Option<&Post> {
        self.visible_posts.get(self.selected).and_then(|at| self.feed.get(*at)).map(Arc::as_ref)
    }

    /// Returns the effect that shows a post with its details and comments.
    fn show_post(&self, post: &Post, company: &DisplayedCompany) -> Effect {
        let mut parts = vec![post.text.clone()];
        if post.kind == PostKind::Own {
            let of = |comment: &&Arc<Post>| {
                comment.kind == PostKind::Comments && comment.answered_post == Some(post.number)
            };
            parts.extend(lead_lines_around(post.day, &company.group_weeks, &company.observation.known_groups));
            let comments = self.feed.iter().filter(of);
            parts.extend(comments.map(|comment| format!("↳ {}\n  {}", comment.heading(), comment.text)));
        } else if let Some(answered) = self.own_posts.iter().find(|answered| post.answered_post == Some(answered.number)) {
            parts.push(format!("On {}:\n  {}", answered.heading(), answered.text));
        }
        Effect::ShowText(format!("day {} · {}", post.day, post.heading()), parts.join("\n\n"))
    }

    /// Returns the selected post in the table of the player's posts.
    fn selected_own_post(&self) -> Option<&Post> {
        self.table.selected().and_then(|row| self.own_posts.get(row)).map(Arc::as_ref)
    }

    /// Returns the number of the player's post to whose thread a post belongs. The thread consists of the player's
    /// post, the comments on this post, and the post that the player's post answers.
    fn thread_of_post(&self, post: &Post) -> Option<u32> {
        match post.kind {
            PostKind::Own => Some(post.number),
            PostKind::Comments => post.answered_post.filter(|number| self.own_posts.iter().any(|post| post.number == *number)),
            _ => self.own_posts.iter().find(|answer| answer.answered_post == Some(post.number)).map(|answer| answer.number),
        }
    }

    /// Filters the feed by the thread of a post. If a thread is already shown, shows the complete post.
    fn open_post(&mut self, post: Option<Post>, company: &DisplayedCompany) -> Vec<Effect> {
        let Some(post) = post else { return Vec::new() };
        match self.thread_of_post(&post).filter(|_| self.filter.thread.is_none()) {
            Some(number) => {
                let answered = self.own_posts.iter().find(|post| post.number == number).and_then(|post| post.answered_post);
                self.filter = PostFilter { thread: Some((number, answered)), ..PostFilter::default() };
                self.focus = SocialPane::Feed;
                self.apply_filter();
                Vec::new()
            }
            None => vec![self.show_post(&post, company)],
        }
    }

    fn start_draft(&mut self, answers: Option<u32>) {
        (self.focus, self.editing) = (SocialPane::Draft, true);
        if answers.is_some() {
            self.reply_to = answers;
        }
    }

    fn start_reply(&mut self) -> Vec<Effect> {
        let answerable = self.selected_post().filter(|post| post.kind != PostKind::Own).map(|post| post.number);
        match answerable.filter(|_| self.focus == SocialPane::Feed) {
            Some(number) => {
                self.start_draft(Some(number));
                Vec::new()
            }
            None => {
                vec![Effect::ShowError("Select another author's post in the feed to answer it".to_owned())]
            }
        }
    }

    fn draft_length(&self) -> usize {
        self.draft.text().chars().count()
    }

    /// Requests a check of the tool call, which is followed by the confirmation.
    fn check_post(&mut self, context: &ScreenContext<'_>) -> Vec<Effect> {
        let (length, most) = (self.draft_length(), context.company.tool_limits.post_characters);
        if self.draft.is_blank() {
            let key = context.keys.label(Action::Compose).unwrap_or_default();
            return vec![Effect::ShowError(format!("Nothing to publish. Write a post with {key}."))];
        }
        if length > most {
            return vec![Effect::ShowError(format!(
                "The post has {length} characters; the maximum is {most}. Shorten it by {}.",
                length - most
            ))];
        }
        let mut arguments = json!({ "content": self.draft.text() });
        if let Some(number) = self.reply_to {
            arguments["reply_to_post_id"] = number.into();
        }
        // The confirmation follows. If the user cancels, the next keys must not be typed into the post.
        self.editing = false;
        vec![Effect::Ask(self.pending_call.ask(PreviewCallQuestion { tool: POST_TOOL, arguments }))]
    }

    fn confirm_effect(&self, arguments: Value, effect_day: Option<u32>) -> Effect {
        let kind = self.reply_to.map_or("Publish".to_owned(), |post| format!("Answer #{post} with"));
        let read =
            effect_day.map_or(String::new(), |day| format!(" Every known group reads it on day {day}."));
        let text = truncate_to_width(&self.draft.text(), 300);
        let text = format!(
            "{kind} \"{text}\"?{read} It costs nothing, cannot be undone, and is this week's only post."
        );
        Effect::ConfirmCall { tool: POST_TOOL, arguments, text }
    }

    /// Returns the text of the unsent post and the number of the post that it answers.
    pub fn draft_text(&self) -> (String, Option<u32>) {
        (self.draft.text(), self.reply_to)
    }

    /// Restores an unsent post.
    pub fn restore_draft(&mut self, text: &str, answers: Option<u32>) {
        (self.draft, self.reply_to) = (TextEditor::with_text(text), answers);
    }

    fn change_filter(&mut self, action: Action, interface: Interface) {
        let last = self.last_week();
        self.focus = SocialPane::Feed;
        match action {
            Action::NextKind => self.filter.next_kind(interface),
            Action::EarlierWeek => self.filter.earlier_week(last),
            _ => self.filter.later_week(last),
        }
        self.apply_filter();
    }

    fn has_posted_this_week(&self) -> bool {
        self.own_posts.iter().any(|post| post.day == self.day)
    }
}

impl ScreenState for Social {
    fn screen_escape_depth(&self) -> usize {
        usize::from(self.focus == SocialPane::Draft || self.filter != PostFilter::default())
    }

    fn screen_queries(&self) -> &'static [Reading] {
        &[Reading::OwnPosts]
    }

    fn apply_rows(&mut self, _: Reading, rows: &QueryResult, _: &ScreenContext<'_>) {
        self.own_posts = feed::parse_own_posts(rows);
        self.rebuild_feed();
    }

    fn mark_seen(&mut self) {
        self.newest_seen_post = Some(self.others.iter().map(|post| post.number).max().unwrap_or(0));
    }

    fn unseen_count(&self) -> usize {
        // Counts the posts since the user left the screen, in this or an earlier session. If the user has never viewed the
        // screen, counts the posts of the last week.
        let is_new = |post: &&Arc<Post>| match (self.newest_seen_post, self.last_viewed_day) {
            (Some(seen), _) => post.number > seen,
            (None, Some(day)) => post.day > day,
            (None, None) => post.day + 7 > self.day,
        };
        self.others.iter().filter(is_new).count()
    }

    fn on_company_change(&mut self, context: &ScreenContext<'_>) {
        self.day = context.company.observation.day;
        self.last_viewed_day = context.company.last_viewed_days.get(ScreenId::Social.record_name()).copied();
        if !Arc::ptr_eq(&self.others, &context.company.posts) {
            self.others = context.company.posts.clone();
            self.rebuild_feed();
        }
    }

    fn take_answers(&mut self, _: &ScreenContext<'_>) -> Vec<Effect> {
        match self.pending_call.try_take() {
            Some((call, Ok(preview))) => vec![self.confirm_effect(call.arguments, preview.effect_day)],
            Some((_, Err(rejection))) => vec![Effect::ShowError(rejection.to_string())],
            None => Vec::new(),
        }
    }

    fn handle_response(&mut self, news: &Response, _: &ScreenContext<'_>) -> Vec<Effect> {
        if matches!(news, Response::ToolCalled(POST_TOOL, Ok(_), _)) {
            (self.draft, self.reply_to, self.editing) = (TextEditor::default(), None, false);
            self.focus = SocialPane::Feed;
        }
        Vec::new()
    }

    fn open_object(&self, _: &ScreenContext<'_>) -> Option<(&'static str, String)> {
        self.filter.thread.map(|(number, _)| ("post", number.to_string()))
    }

    fn edited_text(&self) -> Option<(String, String)> {
        self.editing.then(|| ("post".to_owned(), self.draft.text()))
    }

    fn has_unsent_text(&self) -> bool {
        !self.draft.is_blank()
    }
}

impl PaneScreen for Social {
    type PaneId = SocialPane;

    fn panes(&self) -> &'static [SocialPane] {
        SocialPane::VARIANTS
    }

    fn pane(name: SocialPane) -> &'static dyn Pane<Social> {
        match name {
            SocialPane::Feed => &feed_pane::FeedPane,
            SocialPane::Draft => &draft::DraftPane,
            SocialPane::OwnPosts => &own_posts::OwnPostsPane,
        }
    }

    fn focused_pane(&self) -> SocialPane {
        self.focus
    }

    fn set_focused_pane(&mut self, name: SocialPane) {
        self.focus = name;
        self.editing = false;
        self.filter_field = None;
    }

    fn handle_screen_action(&mut self, action: Action, context: &ScreenContext<'_>) -> Option<Vec<Effect>> {
        match action {
            Action::Compose => self.start_draft(None),
            Action::Reply => return Some(self.start_reply()),
            Action::SendPost => return Some(self.check_post(context)),
            Action::ClearReply => self.reply_to = None,
            Action::LeaveEditor => self.editing = false,
            Action::NextKind | Action::EarlierWeek | Action::LaterWeek => {
                self.change_filter(action, context.company.numbers.interface());
            }
            _ => return None,
        }
        Some(Vec::new())
    }

    fn draw_panes(&self, canvas: &mut Canvas<'_>, area: Rect, context: &ScreenContext<'_>) {
        use SocialPane::{Draft, Feed, OwnPosts};
        if area.width >= 104 && area.height >= 20 {
            let right = (area.width / 3).clamp(40, 72);
            let [left, side] =
                Layout::horizontal([Constraint::Min(0), Constraint::Length(right)]).areas(area);
            let [feed, draft] = Layout::vertical([Constraint::Min(0), Constraint::Length(8)]).areas(left);
            let [own_posts_area, weeks] = Layout::vertical([Constraint::Percentage(60), Constraint::Min(0)]).areas(side);
            draw_pane(self, Feed, canvas, feed, context);
            draw_pane(self, Draft, canvas, draft, context);
            draw_pane(self, OwnPosts, canvas, own_posts_area, context);
            return self.draw_weekly_counts(canvas, weeks);
        }
        // The panes are drawn below each other. If there are too few rows, only the focused pane is drawn.
        let low = match self.focus {
            _ if area.height >= 14 => 7,
            Draft => area.height,
            _ => 0,
        };
        let [upper, draft] = Layout::vertical([Constraint::Min(0), Constraint::Length(low)]).areas(area);
        if self.focus == OwnPosts {
            let halves = [Constraint::Percentage(50), Constraint::Min(0)];
            let [own_posts_area, weeks] = Layout::vertical(halves).areas(upper);
            draw_pane(self, OwnPosts, canvas, own_posts_area, context);
            self.draw_weekly_counts(canvas, weeks);
        } else {
            draw_pane(self, Feed, canvas, upper, context);
        }
        draw_pane(self, Draft, canvas, draft, context);
    }
}

impl Social {
    fn draw_weekly_counts(&self, canvas: &mut Canvas<'_>, area: Rect) {
        let last = self.last_week();
        let is_of_people = |kind| matches!(kind, PostKind::Customers | PostKind::Public);
        let people = feed::posts_by_week(&self.others, last, is_of_people);
        let press = feed::posts_by_week(&self.others, last, |kind| kind == PostKind::Press);
        let now = |points: &[(f64, f64)]| points.last().map_or(0.0, |point| point.1);
        let authors_are_known = !self.others.iter().any(|post| post.kind == PostKind::Public);
        let note = match authors_are_known {
            true => format!("customers {} · press {}", now(&people), now(&press)),
            false => format!("posts {}", now(&people)),
        };
        let inside = canvas.draw_pane_frame(area, "Posts by week", &note, false);
        let mut lines = vec![Curve::from_points(people, Role::Series(0))];
        if authors_are_known {
            lines.push(Curve { is_scatter: true, ..Curve::from_points(press, Role::Series(1)) });
        }
        let x = XAxis { format: &|week| format!("week {week:.0}"), required_values: &[] };
        draw_chart(canvas, inside, &lines, &x, &YAxis { unit: AxisUnit::Number, required_values: &[0.0] });
    }
}

fn post_figure(post: &Post) -> Figure {
    let number = post.number;
    let (title, term, sql) = match post.kind {
        PostKind::Own => (
            format!("views of your post {number}"),
            "views",
            format!(
                "SELECT agent_post_id, day, views, comment_post_ids, content FROM agent_social_media_posts \
                 WHERE agent_post_id = {number}"
            ),
        ),
        kind => (
            format!("post #{number}"),
            if kind == PostKind::Press { "press" } else { "post" },
            format!("SELECT * FROM social_media_posts WHERE post_id = {number}"),
        ),
    };
    Figure { title, term, sql: Some(sql), week_quantity: None }
}
