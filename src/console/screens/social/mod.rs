//! What people write, our posts, and the desk where the next one is written.

pub mod feed;
#[cfg(test)]
mod tests;
mod wall;

use crossterm::event::{KeyCode, KeyEvent};
use ratatui::layout::{Constraint, Layout, Rect};
use serde_json::{Value, json};

use self::feed::{Filter, Kind, Post};
use super::{Look, Screen};
use crate::console::action::{Action, Scope};
use crate::console::canvas::{Canvas, Click, fit};
use crate::console::effect::Effect;
use crate::console::message::News;
use crate::console::readings::Reading;
use crate::console::theme::Role;
use crate::console::widgets::{Axis, Cell, Column, Editor, Field, Line, Table, chart};
use crate::notation::grouped;
use crate::session::Rows;

/// Panes.
const FEED: usize = 0;
const DESK: usize = 1;
const OWN: usize = 2;
const POST: &str = "post_social_media";

/// The screen.
#[derive(Default)]
pub struct Social {
    focus: usize,
    others: Vec<Post>,
    own: Vec<Post>,
    /// Everything in the order of the feed.
    all: Vec<Post>,
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
        let row = |post: &Post| {
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
        self.shown.get(self.selected).and_then(|at| self.all.get(*at))
    }

    /// A post with all that is known of it, and the comments on it.
    fn read(&self, post: &Post) -> Effect {
        let mut parts = vec![post.text.clone()];
        if post.kind == Kind::Own {
            let of = |comment: &&Post| comment.kind == Kind::Comments && comment.answers == Some(post.number);
            let comments = self.all.iter().filter(of);
            parts.extend(comments.map(|comment| format!("↳ {}\n  {}", comment.head(), comment.text)));
        } else if let Some(own) = self.own.iter().find(|own| post.answers == Some(own.number)) {
            parts.push(format!("On {}:\n  {}", own.head(), own.text));
        }
        Effect::ShowText(format!("day {} · {}", post.day, post.head()), parts.join("\n\n"))
    }

    fn open(&mut self) -> Vec<Effect> {
        let post = match self.focus {
            FEED => self.post(),
            OWN => self.table.selected().and_then(|row| self.own.get(row)),
            _ => {
                self.editing = true;
                None
            }
        };
        post.map(|post| self.read(post)).into_iter().collect()
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
            return vec![Effect::Complain(format!("nothing is written yet: {key} begins a post"))];
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
            "{kind} \"{text}\"?{read} It costs nothing, cannot be taken back, and is the only post of this week."
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
        let is_new = |post: &&Post| match self.seen {
            Some(seen) => post.number > seen,
            None => post.day + 7 > self.day,
        };
        self.others.iter().filter(is_new).count()
    }

    fn renew(&mut self, look: &Look<'_>) {
        self.day = look.company.seen.day;
        self.others = feed::posts_of(look.company);
        self.arrange();
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

    fn holds_unsent_text(&self) -> bool {
        !self.draft.is_blank()
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        if area.width >= 104 && area.height >= 20 {
            let right = (area.width / 3).clamp(40, 72);
            let [left, side] =
                Layout::horizontal([Constraint::Min(0), Constraint::Length(right)]).areas(area);
            let [feed, desk] = Layout::vertical([Constraint::Min(0), Constraint::Length(8)]).areas(left);
            let [own, weeks] = Layout::vertical([Constraint::Percentage(60), Constraint::Min(0)]).areas(side);
            self.draw_feed(canvas, feed, look);
            self.draw_desk(canvas, desk, look);
            self.draw_own(canvas, own, look);
            self.draw_weeks(canvas, weeks);
            return;
        }
        // One above the other; where even that is too much, the pane with the focus alone.
        let low = if area.height >= 14 { 7 } else { 0 };
        let low = if low == 0 && self.focus == DESK { area.height } else { low };
        let [upper, desk] = Layout::vertical([Constraint::Min(0), Constraint::Length(low)]).areas(area);
        match self.focus {
            OWN => {
                let [own, weeks] =
                    Layout::vertical([Constraint::Percentage(50), Constraint::Min(0)]).areas(upper);
                self.draw_own(canvas, own, look);
                self.draw_weeks(canvas, weeks);
            }
            _ => self.draw_feed(canvas, upper, look),
        }
        self.draw_desk(canvas, desk, look);
    }
}

impl Social {
    fn draw_feed(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        canvas.click(area, Click::Pane(FEED));
        let focused = self.focus == FEED;
        let filtered = self.filter.words();
        let note = match filtered.is_empty() {
            true => format!("{} posts", grouped(self.all.len() as f64, 0)),
            false => format!("{filtered}: {} of {}", self.shown.len(), self.all.len()),
        };
        let mut inside = canvas.pane(area, "Feed", &note, focused);
        if let Some(field) = self.typing.as_ref().filter(|_| inside.height > 1 && inside.width > 1) {
            let row = Rect { y: inside.bottom() - 1, height: 1, ..inside };
            canvas.text(row, "/", Role::Key);
            field.draw(canvas, Rect { x: row.x + 1, width: row.width - 1, ..row });
            inside.height -= 1;
        }
        if self.shown.is_empty() {
            let words = match self.all.is_empty() {
                true => "nobody has written anything yet: let a week pass (n)".to_owned(),
                false => format!("no post fits: {} shows all again", look.hint(Action::Close)),
            };
            canvas.text(inside, &words, Role::Dim);
        }
        let posts: Vec<&Post> = self.shown.iter().filter_map(|at| self.all.get(*at)).collect();
        wall::draw(canvas, inside, &posts, self.selected, focused, FEED);
        if focused {
            let keys = [Action::NextKind, Action::EarlierWeek, Action::LaterWeek, Action::Reply];
            canvas.pane_keys(area, &look.hints(&keys));
        }
    }

    fn draw_desk(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        if area.height < 3 {
            return;
        }
        canvas.click(area, Click::Pane(DESK));
        let (length, most) = (self.length(), look.company.terms.post_characters);
        let note = match length > most {
            true => format!("! {length} of {most} characters: {} too many", length - most),
            false => format!("{length} of {most} characters"),
        };
        let title = self.answers.map_or("New post".to_owned(), |post| format!("Answer to #{post}"));
        let inside = canvas.pane(area, &title, &note, self.focus == DESK);
        let today = self.own.iter().any(|post| post.day == self.day);
        let key = look.keys.label(Action::Compose).unwrap_or_default();
        let hint = match today {
            true => "published for this week; the next post can follow after it".to_owned(),
            false => format!("{key} begins a post; one a week, every known group reads it"),
        };
        self.draft.draw(canvas, inside, self.editing, &hint);
        if length > most && area.width > 8 {
            let width = (note.chars().count() as u16 + 1).min(area.width - 3);
            let row = Rect { x: area.right() - 2 - width, width, height: 1, ..area };
            canvas.buffer.set_style(row.intersection(canvas.area()), canvas.theme.style(Role::Bad));
        }
        let keys: &[Action] = match (self.focus, self.editing, self.answers) {
            (DESK, true, _) => &[Action::SendPost, Action::LeaveEditor],
            (DESK, false, Some(_)) => &[Action::Compose, Action::SendPost, Action::Unreply],
            (DESK, false, None) => &[Action::Compose, Action::SendPost],
            _ => &[Action::Compose],
        };
        canvas.pane_keys(area, &look.hints(keys));
    }

    fn draw_own(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        canvas.click(area, Click::Pane(OWN));
        let focused = self.focus == OWN;
        let views: u32 = self.own.iter().map(|post| post.views).sum();
        let note = match self.table.note() {
            note if !note.is_empty() => note,
            _ if self.own.is_empty() => String::new(),
            _ => format!("{} · {} views", self.own.len(), grouped(f64::from(views), 0)),
        };
        let inside = canvas.pane(area, "Our posts", &note, focused);
        if self.own.is_empty() {
            let key = look.keys.label(Action::Compose).unwrap_or_default();
            canvas.text(inside, &format!("none yet: {key} begins one"), Role::Dim);
            return;
        }
        self.table.draw(canvas, inside, focused, OWN);
        if focused {
            canvas.pane_keys(area, &look.hints(&[Action::Open, Action::Sort, Action::Filter]));
        }
    }

    fn draw_weeks(&self, canvas: &mut Canvas<'_>, area: Rect) {
        let last = self.last_week();
        let people = feed::by_week(&self.others, last, |kind| kind == Kind::Customers);
        let press = feed::by_week(&self.others, last, |kind| kind == Kind::Press);
        let now = |points: &[(f64, f64)]| points.last().map_or(0.0, |point| point.1);
        let note = format!("customers {} · press {}", now(&people), now(&press));
        let inside = canvas.pane(area, "Posts by week", &note, false);
        let lines = [
            Line::through(people, Role::Series(0)),
            Line { scattered: true, ..Line::through(press, Role::Series(1)) },
        ];
        let x = Axis { write: &|week| format!("week {week:.0}"), holds: &[] };
        chart(canvas, inside, &lines, &x, &Axis { write: &|count| grouped(count, 0), holds: &[0.0] });
    }
}
