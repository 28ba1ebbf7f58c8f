//! The panes: the feed, the desk, our posts, and how much is written by week.

use ratatui::layout::{Constraint, Layout, Rect};

use super::feed::{self, Kind, Post};
use super::{DESK, FEED, OWN, Social, wall};
use crate::console::action::Action;
use crate::console::canvas::{Canvas, Click};
use crate::console::screens::Look;
use crate::console::text::count;
use crate::console::theme::Role;
use crate::console::widgets::{Axis, Line, Side, Unit, chart};
use crate::notation::grouped;

/// Draws the screen.
pub(super) fn draw(social: &Social, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
    if canvas.zoomed {
        match social.focus {
            FEED => social.draw_feed(canvas, area, look),
            OWN => social.draw_own(canvas, area, look),
            _ => social.draw_desk(canvas, area, look),
        }
        return;
    }
    if area.width >= 104 && area.height >= 20 {
        let right = (area.width / 3).clamp(40, 72);
        let [left, side] = Layout::horizontal([Constraint::Min(0), Constraint::Length(right)]).areas(area);
        let [feed, desk] = Layout::vertical([Constraint::Min(0), Constraint::Length(8)]).areas(left);
        let [own, weeks] = Layout::vertical([Constraint::Percentage(60), Constraint::Min(0)]).areas(side);
        social.draw_feed(canvas, feed, look);
        social.draw_desk(canvas, desk, look);
        social.draw_own(canvas, own, look);
        social.draw_weeks(canvas, weeks);
        return;
    }
    // One above the other; where even that is too much, the pane with the focus alone.
    let low = if area.height >= 14 { 7 } else { 0 };
    let low = if low == 0 && social.focus == DESK { area.height } else { low };
    let [upper, desk] = Layout::vertical([Constraint::Min(0), Constraint::Length(low)]).areas(area);
    match social.focus {
        OWN => {
            let [own, weeks] =
                Layout::vertical([Constraint::Percentage(50), Constraint::Min(0)]).areas(upper);
            social.draw_own(canvas, own, look);
            social.draw_weeks(canvas, weeks);
        }
        _ => social.draw_feed(canvas, upper, look),
    }
    social.draw_desk(canvas, desk, look);
}

impl Social {
    fn draw_feed(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        canvas.click(area, Click::Pane(FEED));
        let focused = self.focus == FEED;
        let filtered = self.filter.words();
        let note = match filtered.is_empty() {
            true => count(self.all.len() as f64, "post"),
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
                true => "no posts yet: run a week (n)".to_owned(),
                false => format!("no matching posts: {} shows all", look.hint(Action::Close)),
            };
            canvas.text(inside, &words, Role::Text);
        }
        let posts: Vec<&Post> =
            self.shown.iter().filter_map(|at| self.all.get(*at)).map(AsRef::as_ref).collect();
        wall::draw(canvas, inside, &posts, self.selected, focused, FEED);
        if focused {
            let keys: &[Action] = match self.filter.thread {
                Some(_) => &[Action::Close, Action::Open, Action::Reply],
                None => &[Action::NextKind, Action::EarlierWeek, Action::LaterWeek, Action::Reply],
            };
            canvas.pane_keys(area, &look.hints(keys));
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
        let today = self.own.iter().any(|post| post.day == self.day);
        let title = match (self.answers, today) {
            (Some(post), _) => format!("Answer to #{post}"),
            (None, true) => "New post · 1 of 1 this week".to_owned(),
            (None, false) => "New post · 0 of 1 this week".to_owned(),
        };
        let inside = canvas.pane(area, &title, &note, self.focus == DESK);
        let key = look.keys.label(Action::Compose).unwrap_or_default();
        let hint = match today {
            true => "this week's post is published; the next one after this week".to_owned(),
            false => format!("{key} writes a post; one a week, read by every known group"),
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
            canvas.text(inside, &format!("none yet: {key} writes one"), Role::Dim);
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
        chart(canvas, inside, &lines, &x, &Side { unit: Unit::Number, holds: &[0.0] });
    }
}
