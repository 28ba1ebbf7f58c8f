//! The social feed, the player's posts, and the editor for the next post.

mod draft;
pub mod feed;
mod feed_pane;
mod own;
#[cfg(test)]
mod tests;
mod wall;

use std::sync::Arc;

use ratatui::layout::{Constraint, Layout, Rect};
use serde_json::{Value, json};
use strum::VariantArray;

use self::feed::{Filter, Post, PostKind};
use super::ScreenState;
use super::panes::{Pane, Paned, draw_pane};
use crate::action::Action;
use crate::context::{Figure, Look, ScreenId};
use crate::effect::Effect;
use novamind_base::notation::grouped;
use novamind_database::Rows;
use novamind_report::post_leads::leads_around;
use novamind_tools::ToolId;
use novamind_tui::canvas::{Canvas, fit};
use novamind_tui::theme::Role;
use novamind_tui::widgets::{Axis, Cell, Column, Editor, Field, Line, Side, Table, Unit, chart};
use novamind_worker::asking::Pending;
use novamind_worker::company::Company;
use novamind_worker::message::News;
use novamind_worker::posts::Posts;
use novamind_worker::questions::CallCheck;
use novamind_worker::readings::Reading;

/// Panes in tab order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, VariantArray)]
pub enum SocialPane {
    /// All posts.
    #[default]
    Feed,
    /// Editor for the next post.
    Draft,
    /// The player's posts.
    Own,
}

const POST: ToolId = ToolId::PostSocialMedia;

/// The social screen.
#[derive(Default)]
pub struct Social {
    focus: SocialPane,
    others: Posts,
    own: Vec<Arc<Post>>,
    /// All posts in feed order.
    all: Vec<Arc<Post>>,
    /// Indexes of the posts that pass the filter.
    shown: Vec<usize>,
    selected: usize,
    filter: Filter,
    typing: Option<Field>,
    table: Table,
    draft: Editor,
    editing: bool,
    answers: Option<u32>,
    /// Check of the tool call before the user confirms it.
    sending: Pending<CallCheck>,
    /// Newest post that was seen; `None` before the screen was shown.
    seen: Option<u32>,
    /// Last day that was seen before the run was opened.
    viewed: Option<u32>,
    day: u32,
}

impl Social {
    fn last_week(&self) -> u32 {
        self.day.div_ceil(7)
    }

    fn arrange(&mut self) {
        let kept = self.post().map(|post| (post.kind, post.number));
        self.all = feed::threads(&self.others, &self.own);
        self.show_filtered(kept);
        let row = |post: &Arc<Post>| {
            vec![
                Cell::number(f64::from(post.day), post.day.to_string()).role(Role::Dim),
                Cell::number(f64::from(post.views), grouped(f64::from(post.views), 0)),
                Cell::number(f64::from(post.comments), post.comments.to_string()),
                Cell::words(post.text.replace('\n', " ")),
            ]
        };
        let columns = ["day", "views", "comm."].map(Column::numbers);
        let columns = columns.into_iter().chain([Column::words("text").at_most(u16::MAX)]).collect();
        self.table.set(columns, self.own.iter().map(row).collect());
    }

    /// Applies the filter; the selection stays on its post if it is still shown.
    fn show_filtered(&mut self, kept: Option<(PostKind, u32)>) {
        self.shown = (0..self.all.len()).filter(|at| self.filter.takes(&self.all[*at])).collect();
        let is_kept = |at: &usize| Some((self.all[*at].kind, self.all[*at].number)) == kept;
        // If the newest post is selected, the selection follows the newest post.
        let place = self.shown.iter().position(is_kept).filter(|_| self.selected > 0);
        self.selected = place.unwrap_or(0);
    }

    fn refilter(&mut self) {
        let kept = self.post().map(|post| (post.kind, post.number));
        self.show_filtered(kept);
    }

    fn post(&self) -> Option<&Post> {
        self.shown.get(self.selected).and_then(|at| self.all.get(*at)).map(Arc::as_ref)
    }

    /// Shows a post with its details and comments.
    fn read(&self, post: &Post, company: &Company) -> Effect {
        let mut parts = vec![post.text.clone()];
        if post.kind == PostKind::Own {
            let of = |comment: &&Arc<Post>| {
                comment.kind == PostKind::Comments && comment.answers == Some(post.number)
            };
            parts.extend(leads_around(post.day, &company.group_weeks, &company.seen.known_groups));
            let comments = self.all.iter().filter(of);
            parts.extend(comments.map(|comment| format!("↳ {}\n  {}", comment.head(), comment.text)));
        } else if let Some(own) = self.own.iter().find(|own| post.answers == Some(own.number)) {
            parts.push(format!("On {}:\n  {}", own.head(), own.text));
        }
        Effect::ShowText(format!("day {} · {}", post.day, post.head()), parts.join("\n\n"))
    }

    /// Returns the selected post in the table of the player's posts.
    fn own_post(&self) -> Option<&Post> {
        self.table.selected().and_then(|row| self.own.get(row)).map(Arc::as_ref)
    }

    /// Returns the player's post that heads the thread of a post, which is the post itself, a comment on it,
    /// or the post it answers.
    fn thread_of(&self, post: &Post) -> Option<u32> {
        match post.kind {
            PostKind::Own => Some(post.number),
            PostKind::Comments => post.answers.filter(|own| self.own.iter().any(|post| post.number == *own)),
            _ => self.own.iter().find(|own| own.answers == Some(post.number)).map(|own| own.number),
        }
    }

    /// Shows the thread of a post; within the thread, the complete post.
    fn open(&mut self, post: Option<Post>, company: &Company) -> Vec<Effect> {
        let Some(post) = post else { return Vec::new() };
        match self.thread_of(&post).filter(|_| self.filter.thread.is_none()) {
            Some(own) => {
                let answered = self.own.iter().find(|post| post.number == own).and_then(|post| post.answers);
                self.filter = Filter { thread: Some((own, answered)), ..Filter::default() };
                self.focus = SocialPane::Feed;
                self.refilter();
                Vec::new()
            }
            None => vec![self.read(&post, company)],
        }
    }

    fn write(&mut self, answers: Option<u32>) {
        (self.focus, self.editing) = (SocialPane::Draft, true);
        if answers.is_some() {
            self.answers = answers;
        }
    }

    fn reply(&mut self) -> Vec<Effect> {
        let answerable = self.post().filter(|post| post.kind != PostKind::Own).map(|post| post.number);
        match answerable.filter(|_| self.focus == SocialPane::Feed) {
            Some(number) => {
                self.write(Some(number));
                Vec::new()
            }
            None => {
                vec![Effect::Complain("Select another author's post in the feed to answer it".to_owned())]
            }
        }
    }

    fn length(&self) -> usize {
        self.draft.text().chars().count()
    }

    /// Checks the tool call; the confirmation follows.
    fn send(&mut self, look: &Look<'_>) -> Vec<Effect> {
        let (length, most) = (self.length(), look.company.terms.post_characters);
        if self.draft.is_blank() {
            let key = look.keys.label(Action::Compose).unwrap_or_default();
            return vec![Effect::Complain(format!("Nothing to publish. Write a post with {key}."))];
        }
        if length > most {
            return vec![Effect::Complain(format!(
                "The post has {length} characters; the maximum is {most}. Shorten it by {}.",
                length - most
            ))];
        }
        let mut arguments = json!({ "content": self.draft.text() });
        if let Some(number) = self.answers {
            arguments["reply_to_post_id"] = number.into();
        }
        vec![Effect::Ask(self.sending.ask(CallCheck { tool: POST, arguments }))]
    }

    fn ask(&self, arguments: Value, effect_day: Option<u32>) -> Effect {
        let kind = self.answers.map_or("Publish".to_owned(), |post| format!("Answer #{post} with"));
        let read =
            effect_day.map_or(String::new(), |day| format!(" Every known group reads it on day {day}."));
        let text = fit(&self.draft.text(), 300);
        let text = format!(
            "{kind} \"{text}\"?{read} It costs nothing, cannot be undone, and is this week's only post."
        );
        Effect::ConfirmCall { tool: POST, arguments, text }
    }

    /// Returns the unsent post, and the post that it answers.
    pub fn unsent(&self) -> (String, Option<u32>) {
        (self.draft.text(), self.answers)
    }

    /// Restores an unsent post.
    pub fn restore(&mut self, text: &str, answers: Option<u32>) {
        (self.draft, self.answers) = (Editor::of(text), answers);
    }

    fn change_filter(&mut self, action: Action) {
        let last = self.last_week();
        self.focus = SocialPane::Feed;
        match action {
            Action::NextKind => self.filter.next_kind(),
            Action::EarlierWeek => self.filter.earlier_week(last),
            _ => self.filter.later_week(last),
        }
        self.refilter();
    }

    fn posted_this_week(&self) -> bool {
        self.own.iter().any(|post| post.day == self.day)
    }
}

impl ScreenState for Social {
    fn opened(&self) -> usize {
        usize::from(self.focus == SocialPane::Draft || self.filter != Filter::default())
    }

    fn readings(&self) -> &'static [Reading] {
        &[Reading::OwnPosts]
    }

    fn take(&mut self, _: Reading, rows: &Rows, _: &Look<'_>) {
        self.own = feed::own_posts(rows);
        self.arrange();
    }

    fn looked_at(&mut self) {
        self.seen = Some(self.others.iter().map(|post| post.number).max().unwrap_or(0));
    }

    fn unseen(&self) -> usize {
        // After a run is opened, posts of the last week are unread unless they were seen before.
        let is_new = |post: &&Arc<Post>| match self.seen {
            Some(seen) => post.number > seen,
            None => post.day + 7 > self.day && self.viewed.is_none_or(|day| post.day > day),
        };
        self.others.iter().filter(is_new).count()
    }

    fn renew(&mut self, look: &Look<'_>) {
        self.day = look.company.seen.day;
        self.viewed = look.company.viewed.get(ScreenId::Social.id()).copied();
        if !Arc::ptr_eq(&self.others, &look.company.posts) {
            self.others = look.company.posts.clone();
            self.arrange();
        }
    }

    fn take_answers(&mut self, _: &Look<'_>) -> Vec<Effect> {
        match self.sending.try_take() {
            Some((call, Ok(preview))) => vec![self.ask(call.arguments, preview.effect_day)],
            Some((_, Err(refusal))) => vec![Effect::Complain(refusal.to_string())],
            None => Vec::new(),
        }
    }

    fn hear(&mut self, news: &News, _: &Look<'_>) -> Vec<Effect> {
        if matches!(news, News::Called(POST, Ok(_), _)) {
            (self.draft, self.answers, self.editing) = (Editor::default(), None, false);
            self.focus = SocialPane::Feed;
        }
        Vec::new()
    }

    fn open_object(&self, _: &Look<'_>) -> Option<(&'static str, String)> {
        self.filter.thread.map(|(own, _)| ("post", own.to_string()))
    }

    fn edited(&self) -> Option<(String, String)> {
        self.editing.then(|| ("post".to_owned(), self.draft.text()))
    }

    fn holds_unsent_text(&self) -> bool {
        !self.draft.is_blank()
    }
}

impl Paned for Social {
    type Name = SocialPane;

    fn panes(&self) -> &'static [SocialPane] {
        SocialPane::VARIANTS
    }

    fn pane(name: SocialPane) -> &'static dyn Pane<Social> {
        match name {
            SocialPane::Feed => &feed_pane::FeedPane,
            SocialPane::Draft => &draft::DraftPane,
            SocialPane::Own => &own::OwnPane,
        }
    }

    fn focused(&self) -> SocialPane {
        self.focus
    }

    fn focus_on(&mut self, name: SocialPane) {
        self.focus = name;
        self.editing = false;
        self.typing = None;
    }

    fn act_anywhere(&mut self, action: Action, look: &Look<'_>) -> Option<Vec<Effect>> {
        match action {
            Action::Compose => self.write(None),
            Action::Reply => return Some(self.reply()),
            Action::SendPost => return Some(self.send(look)),
            Action::Unreply => self.answers = None,
            Action::LeaveEditor => self.editing = false,
            Action::NextKind | Action::EarlierWeek | Action::LaterWeek => self.change_filter(action),
            _ => return None,
        }
        Some(Vec::new())
    }

    fn arrange(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        use SocialPane::{Draft, Feed, Own};
        if area.width >= 104 && area.height >= 20 {
            let right = (area.width / 3).clamp(40, 72);
            let [left, side] =
                Layout::horizontal([Constraint::Min(0), Constraint::Length(right)]).areas(area);
            let [feed, draft] = Layout::vertical([Constraint::Min(0), Constraint::Length(8)]).areas(left);
            let [own, weeks] = Layout::vertical([Constraint::Percentage(60), Constraint::Min(0)]).areas(side);
            draw_pane(self, Feed, canvas, feed, look);
            draw_pane(self, Draft, canvas, draft, look);
            draw_pane(self, Own, canvas, own, look);
            return self.draw_weeks(canvas, weeks);
        }
        // Panes stacked; if there are too few rows, only the focused one.
        let low = match self.focus {
            _ if area.height >= 14 => 7,
            Draft => area.height,
            _ => 0,
        };
        let [upper, draft] = Layout::vertical([Constraint::Min(0), Constraint::Length(low)]).areas(area);
        if self.focus == Own {
            let halves = [Constraint::Percentage(50), Constraint::Min(0)];
            let [own, weeks] = Layout::vertical(halves).areas(upper);
            draw_pane(self, Own, canvas, own, look);
            self.draw_weeks(canvas, weeks);
        } else {
            draw_pane(self, Feed, canvas, upper, look);
        }
        draw_pane(self, Draft, canvas, draft, look);
    }
}

impl Social {
    fn draw_weeks(&self, canvas: &mut Canvas<'_>, area: Rect) {
        let last = self.last_week();
        let people = feed::by_week(&self.others, last, |kind| kind == PostKind::Customers);
        let press = feed::by_week(&self.others, last, |kind| kind == PostKind::Press);
        let now = |points: &[(f64, f64)]| points.last().map_or(0.0, |point| point.1);
        let note = format!("customers {} · press {}", now(&people), now(&press));
        let inside = canvas.pane(area, "Posts by week", &note, false);
        let lines = [
            Line::through(people, Role::Series(0)),
            Line { scattered: true, ..Line::through(press, Role::Series(1)) },
        ];
        let x = Axis { write: &|week| format!("week {week:.0}"), holds: &[] };
        chart(canvas, inside, &lines, &x, &Side { unit: Unit::Number, holds: &[0.0] });
    }
}

fn figure_of(post: &Post) -> Figure {
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
    Figure { title, term, sql: Some(sql), why: None }
}
