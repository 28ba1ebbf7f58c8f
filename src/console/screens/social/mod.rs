//! What people write, our posts, and the desk where the next one is written.

mod draw;
pub mod feed;
#[cfg(test)]
mod tests;
mod wall;

use std::sync::Arc;

use crossterm::event::{KeyCode, KeyEvent};
use ratatui::layout::Rect;
use serde_json::{Value, json};

use self::feed::{Filter, Kind, Post};
use super::{Figure, Look, Screen, ScreenState};
use crate::console::action::{Action, Scope};
use crate::console::canvas::{Canvas, fit};
use crate::console::effect::Effect;
use crate::console::message::News;
use crate::console::posts::Posts;
use crate::console::readings::Reading;
use crate::console::theme::Role;
use crate::console::widgets::{Cell, Column, Editor, Field, Table};
use crate::notation::grouped;
use crate::session::Rows;
use crate::tools::ToolId;

/// Panes.
const FEED: usize = 0;
const DESK: usize = 1;
const OWN: usize = 2;
const POST: ToolId = ToolId::PostSocialMedia;

/// The screen.
#[derive(Default)]
pub struct Social {
    focus: usize,
    others: Posts,
    own: Vec<Arc<Post>>,
    /// Everything in the order of the feed.
    all: Vec<Arc<Post>>,
    /// Places of the posts that the filter lets through.
    shown: Vec<usize>,
    selected: usize,
    filter: Filter,
    typing: Option<Field>,
    table: Table,
    draft: Editor,
    editing: bool,
    /// Post that the draft answers.
    answers: Option<u32>,
    /// Arguments of the call that is being looked at before the question.
    sending: Option<Value>,
    /// Newest post that was looked at; none before the screen was shown.
    seen: Option<u32>,
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

    /// Shows what the filter lets through, staying at a post if it is still there.
    fn show_filtered(&mut self, kept: Option<(Kind, u32)>) {
        self.shown = (0..self.all.len()).filter(|at| self.filter.takes(&self.all[*at])).collect();
        let is_kept = |at: &usize| Some((self.all[*at].kind, self.all[*at].number)) == kept;
        // At the newest post one stays at the newest post.
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

    /// A post with all that is known of it, and the comments on it.
    fn read(&self, post: &Post) -> Effect {
        let mut parts = vec![post.text.clone()];
        if post.kind == Kind::Own {
            let of =
                |comment: &&Arc<Post>| comment.kind == Kind::Comments && comment.answers == Some(post.number);
            let comments = self.all.iter().filter(of);
            parts.extend(comments.map(|comment| format!("↳ {}\n  {}", comment.head(), comment.text)));
        } else if let Some(own) = self.own.iter().find(|own| post.answers == Some(own.number)) {
            parts.push(format!("On {}:\n  {}", own.head(), own.text));
        }
        Effect::ShowText(format!("day {} · {}", post.day, post.head()), parts.join("\n\n"))
    }

    /// Our post that is selected in their table.
    fn own_post(&self) -> Option<&Post> {
        self.table.selected().and_then(|row| self.own.get(row)).map(Arc::as_ref)
    }

    /// Our post in whose thread a post stands: itself, the one it comments, or the one that answers it.
    fn thread_of(&self, post: &Post) -> Option<u32> {
        match post.kind {
            Kind::Own => Some(post.number),
            Kind::Comments => post.answers.filter(|own| self.own.iter().any(|post| post.number == *own)),
            _ => self.own.iter().find(|own| own.answers == Some(post.number)).map(|own| own.number),
        }
    }

    /// Shows the thread of a post; within it, the whole post.
    fn open(&mut self) -> Vec<Effect> {
        let post = match self.focus {
            FEED => self.post(),
            OWN => self.own_post(),
            _ => {
                self.editing = true;
                None
            }
        };
        let Some(post) = post else { return Vec::new() };
        match self.thread_of(post).filter(|_| self.filter.thread.is_none()) {
            Some(own) => {
                let answered = self.own.iter().find(|post| post.number == own).and_then(|post| post.answers);
                self.filter = Filter { thread: Some((own, answered)), ..Filter::default() };
                self.focus = FEED;
                self.refilter();
                Vec::new()
            }
            None => vec![self.read(post)],
        }
    }

    fn write(&mut self, answers: Option<u32>) {
        (self.focus, self.editing) = (DESK, true);
        if answers.is_some() {
            self.answers = answers;
        }
    }

    fn reply(&mut self) -> Vec<Effect> {
        let answerable = self.post().filter(|post| post.kind != Kind::Own).map(|post| post.number);
        match answerable.filter(|_| self.focus == FEED) {
            Some(number) => {
                self.write(Some(number));
                Vec::new()
            }
            None => vec![Effect::Complain("select a post of others in the feed to answer it".to_owned())],
        }
    }

    fn length(&self) -> usize {
        self.draft.text().chars().count()
    }

    /// Asks what the call would do; the question to the person follows the answer.
    fn send(&mut self, look: &Look<'_>) -> Vec<Effect> {
        let (length, most) = (self.length(), look.company.terms.post_characters);
        if self.draft.is_blank() {
            let key = look.keys.label(Action::Compose).unwrap_or_default();
            return vec![Effect::Complain(format!("nothing to publish: {key} writes a post"))];
        }
        if length > most {
            return vec![Effect::Complain(format!(
                "the post has {length} characters, at most {most} are allowed; shorten it by {}",
                length - most
            ))];
        }
        let mut arguments = json!({ "content": self.draft.text() });
        if let Some(number) = self.answers {
            arguments["reply_to_post_id"] = number.into();
        }
        self.sending = Some(arguments.clone());
        vec![Effect::Check { tool: POST, arguments }]
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

    fn act_in_feed(&mut self, action: Action, page: u16) {
        let last = self.shown.len().saturating_sub(1);
        let page = usize::from(page.max(1));
        match action {
            Action::Up => self.selected = self.selected.saturating_sub(1),
            Action::Down => self.selected = (self.selected + 1).min(last),
            Action::PageUp => self.selected = self.selected.saturating_sub(page),
            Action::PageDown => self.selected = (self.selected + page).min(last),
            Action::First => self.selected = 0,
            Action::Last => self.selected = last,
            Action::Filter => self.typing = Some(Field::of(self.filter.text.clone())),
            Action::Discard => {
                self.typing = None;
                self.filter.text.clear();
                self.refilter();
            }
            Action::Commit | Action::CommitDown | Action::CommitNext | Action::CommitPrevious => {
                self.typing = None;
            }
            Action::Close => {
                self.filter = Filter::default();
                self.refilter();
            }
            _ => {}
        }
    }

    fn change_filter(&mut self, action: Action) {
        let last = self.last_week();
        self.focus = FEED;
        match action {
            Action::NextKind => self.filter.next_kind(),
            Action::EarlierWeek => self.filter.earlier_week(last),
            _ => self.filter.later_week(last),
        }
        self.refilter();
    }

    /// The field that is typed into, if any.
    fn typed_into(&mut self, work: impl FnOnce(&mut Field)) {
        if let Some(field) = &mut self.typing {
            work(field);
            self.filter.text = field.text().to_owned();
            self.refilter();
        } else {
            self.table.edit_filter(work);
        }
    }
}

impl ScreenState for Social {
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
        // Of a run that was just opened, what the last week brought is new.
        let is_new = |post: &&Arc<Post>| match self.seen {
            Some(seen) => post.number > seen,
            None => post.day + 7 > self.day,
        };
        self.others.iter().filter(is_new).count()
    }

    fn renew(&mut self, look: &Look<'_>) {
        self.day = look.company.seen.day;
        if !Arc::ptr_eq(&self.others, &look.company.posts) {
            self.others = look.company.posts.clone();
            self.arrange();
        }
    }

    fn hear(&mut self, news: &News, _: &Look<'_>) -> Vec<Effect> {
        match news {
            News::Checked(_, preview) => match (preview, self.sending.take()) {
                (Ok(preview), Some(arguments)) => vec![self.ask(arguments, preview.effect_day)],
                (Err(refusal), Some(_)) => vec![Effect::Complain(refusal.to_string())],
                _ => Vec::new(),
            },
            News::Called(POST, Ok(_), _) => {
                (self.draft, self.answers, self.editing) = (Editor::default(), None, false);
                self.focus = FEED;
                Vec::new()
            }
            _ => Vec::new(),
        }
    }

    fn holds_unsent_text(&self) -> bool {
        !self.draft.is_blank()
    }
}

impl Screen for Social {
    fn scopes(&self) -> Vec<Scope> {
        match self.focus {
            DESK if self.editing => vec![Scope::Editor, Scope::Social],
            FEED if self.typing.is_some() => vec![Scope::Field],
            OWN if self.table.is_typing() => vec![Scope::Field],
            _ => vec![Scope::Social, Scope::List],
        }
    }

    fn hints(&self) -> Vec<Action> {
        match self.focus {
            DESK if self.editing => vec![Action::SendPost, Action::LeaveEditor],
            DESK => vec![Action::Compose, Action::SendPost, Action::Unreply],
            FEED => vec![
                Action::Open,
                Action::Reply,
                Action::Compose,
                Action::Filter,
                Action::NextKind,
                Action::EarlierWeek,
            ],
            _ => vec![Action::Open, Action::Compose, Action::Sort, Action::Filter],
        }
    }

    fn panes(&self) -> usize {
        3
    }

    fn focus(&self) -> usize {
        self.focus
    }

    fn set_focus(&mut self, pane: usize) {
        self.focus = pane.min(OWN);
        self.editing = false;
        self.typing = None;
    }

    fn figure(&self, _: &Look<'_>) -> Option<Figure> {
        let post = match self.focus {
            FEED => self.post()?,
            OWN => self.own_post()?,
            _ => return Some(Figure { title: "a post of ours".to_owned(), term: POST.name(), sql: None }),
        };
        let number = post.number;
        let own = "SELECT agent_post_id, day, views, comment_post_ids, content FROM agent_social_media_posts";
        let (title, term, sql) = match (post.kind, self.focus, self.table.selected_column()) {
            (Kind::Own, OWN, 2) => (
                format!("comments on our post {number}"),
                "comment",
                format!(
                    "SELECT post_id, day, content FROM social_media_posts WHERE reply_to_agent_post_id = {number}"
                ),
            ),
            (Kind::Own, ..) => (
                format!("views of our post {number}"),
                "views",
                format!("{own} WHERE agent_post_id = {number}"),
            ),
            _ => (
                format!("post #{number}"),
                if post.kind == Kind::Press { "press" } else { "post" },
                format!("SELECT * FROM social_media_posts WHERE post_id = {number}"),
            ),
        };
        Some(Figure { title, term, sql: Some(sql) })
    }

    fn act(&mut self, action: Action, look: &Look<'_>) -> Vec<Effect> {
        match action {
            Action::Compose => self.write(None),
            Action::Reply => return self.reply(),
            Action::SendPost => return self.send(look),
            Action::Unreply => self.answers = None,
            Action::LeaveEditor => self.editing = false,
            Action::NextKind | Action::EarlierWeek | Action::LaterWeek => self.change_filter(action),
            Action::Open => return self.open(),
            Action::Close if self.focus == DESK => self.focus = FEED,
            Action::CommitNext | Action::CommitPrevious if self.focus == OWN => {
                self.table.act(Action::Commit, look.page);
            }
            action if self.focus == FEED => self.act_in_feed(action, look.page),
            action if self.focus == OWN => {
                self.table.act(action, look.page);
            }
            _ => {}
        }
        Vec::new()
    }

    fn key(&mut self, key: &KeyEvent, _: &Look<'_>) -> Vec<Effect> {
        match key.code {
            // A post has no columns: tab leads on.
            KeyCode::Tab if self.editing => return vec![Effect::Do(Action::FocusNext)],
            KeyCode::BackTab if self.editing => return vec![Effect::Do(Action::FocusPrevious)],
            _ if self.editing => self.draft.key(key),
            _ => self.typed_into(|field| {
                field.key(key);
            }),
        }
        Vec::new()
    }

    fn paste(&mut self, text: &str, _: &Look<'_>) -> Vec<Effect> {
        if self.editing {
            self.draft.insert(text);
        } else {
            self.typed_into(|field| field.insert(text));
        }
        Vec::new()
    }

    fn click(&mut self, pane: usize, row: usize, _: &Look<'_>) -> Vec<Effect> {
        let again = match pane {
            FEED => std::mem::replace(&mut self.selected, row.min(self.shown.len().saturating_sub(1))) == row,
            OWN => {
                let before = self.table.selected();
                self.table.select_place(row);
                before == self.table.selected()
            }
            _ => true,
        };
        if again { self.open() } else { Vec::new() }
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        draw::draw(self, canvas, area, look);
    }
}
