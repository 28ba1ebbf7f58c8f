//! List of threads.

use ratatui::layout::Rect;

use super::model::{State, Thread};
use super::offer::in_words;
use super::{Inbox, InboxPane, InboxView, post};
use crate::action::{Action, Scope};
use crate::context::{Figure, Look};
use crate::effect::Effect;
use crate::screens::panes::{Border, Pane, Seat};
use novamind_base::notation::grouped;
use novamind_tui::canvas::{Canvas, rows_of};
use novamind_tui::text::{count, wrapped};
use novamind_tui::theme::Role;
use novamind_tui::widgets::{Cell, Column, Table};

/// Width of names in a narrow list; the number next to the name identifies the enterprise.
const NAME: u16 = 14;

pub struct ThreadListPane;

impl Pane<Inbox> for ThreadListPane {
    fn table<'a>(&self, inbox: &'a Inbox) -> Option<&'a Table> {
        Some(&inbox.table)
    }

    fn table_mut<'a>(&self, inbox: &'a mut Inbox) -> Option<&'a mut Table> {
        Some(&mut inbox.table)
    }

    fn scopes(&self, inbox: &Inbox) -> Vec<Scope> {
        match inbox.table.is_typing() {
            true => vec![Scope::Field, Scope::List],
            false => vec![Scope::Inbox, Scope::List],
        }
    }

    fn hints(&self, inbox: &Inbox) -> Vec<Action> {
        if inbox.table.is_typing() {
            return vec![Action::Commit, Action::Discard];
        }
        vec![
            Action::Open,
            Action::SendOffer,
            Action::TakeAsk,
            Action::Mark,
            Action::MarkAll,
            Action::RejectOffer,
            Action::InboxRules,
            Action::InboxOutcomes,
            Action::OtherThreads,
            Action::Filter,
            Action::Sort,
            Action::InboxGroup,
            Action::InboxSql,
        ]
    }

    fn figure(&self, inbox: &Inbox, _: &Look<'_>) -> Option<Figure> {
        let thread = inbox.here()?;
        Some(match inbox.table.selected_column() {
            5 => post::figure(thread, "seats of", "seats"),
            6 => post::figure(thread, "price asked by", "offer"),
            _ => post::figure(thread, "thread with", "thread"),
        })
    }

    fn act(&self, inbox: &mut Inbox, action: Action, look: &Look<'_>) -> Vec<Effect> {
        if action == Action::Open {
            inbox.focus = InboxPane::Offer;
        } else {
            inbox.scroll = 0;
            inbox.table.act(action, look.page);
        }
        Vec::new()
    }

    fn click(&self, inbox: &mut Inbox, row: usize, _: &Look<'_>) -> Vec<Effect> {
        inbox.table.select_place(row);
        inbox.scroll = 0;
        Vec::new()
    }

    fn border(&self, inbox: &Inbox, _: Rect, look: &Look<'_>) -> Border {
        let threads = inbox.rows.len();
        let (title, worth) = match inbox.view {
            InboxView::Waiting => (format!("{threads} waiting for you"), true),
            InboxView::Theirs => (format!("{threads} waiting for them"), true),
            InboxView::Over => (format!("{threads} ended"), false),
        };
        let all = inbox.rows.iter().filter_map(|at| inbox.letters.threads.get(*at));
        let seats: f64 = all.map(|thread| thread.seats).sum();
        let mut note = inbox.table.note();
        if note.is_empty() && worth && threads > 0 {
            note = count(seats, "seat");
        }
        if !inbox.marked.is_empty() {
            note = format!("{} marked · {note}", inbox.marked.len());
        }
        let keys = look.hints(&[Action::Mark, Action::MarkAll, Action::Filter, Action::OtherThreads]);
        Border { title, note, keys, ..Border::default() }
    }

    fn draw(&self, inbox: &Inbox, canvas: &mut Canvas<'_>, seat: Seat, look: &Look<'_>) {
        if inbox.rows.is_empty() {
            draw_nobody(inbox, canvas, seat.area, look);
        } else {
            inbox.table.draw(canvas, seat.area, seat.focused, seat.number);
        }
    }
}

fn draw_nobody(inbox: &Inbox, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
    let inside = Rect { x: area.x + 1, width: area.width.saturating_sub(2), ..area };
    let mut lines = wrapped(&nobody(inbox, look), inside.width as usize);
    if lines.len() > inside.height as usize {
        let zoom = look.keys.label(Action::Zoom).unwrap_or_default();
        lines.truncate((inside.height as usize).saturating_sub(1));
        lines.push(format!("… {zoom} shows more"));
    }
    for (row, line) in rows_of(inside).zip(lines) {
        canvas.text(row, &line, Role::Dim);
    }
}

fn nobody(inbox: &Inbox, look: &Look<'_>) -> String {
    let key = |action: Action| look.keys.label(action).unwrap_or_default();
    if !inbox.letters.threads.is_empty() {
        return format!("No threads here. {} shows others.", key(Action::OtherThreads));
    }
    let funnels: Vec<String> =
        look.company.funnels.iter().map(|own| format!("· {}", own.in_words())).collect();
    format!(
        "No enterprise has asked for an offer yet. Advertise to enterprise groups ({} set_targeted_ad_spend). A higher \
         model tier, development for their group and a quota for all seats make a plan more attractive.\n\n{}",
        key(Action::Tools),
        funnels.join("\n")
    )
}

pub(super) fn columns(view: InboxView) -> Vec<Column> {
    let day = if view == InboxView::Waiting { "left" } else { "since" };
    vec![
        Column::words("✓"),
        Column::numbers(day),
        Column::words("enterprise").at_least(NAME),
        Column::numbers("no."),
        Column::words("group"),
        Column::numbers("seats"),
        Column::numbers("their ask"),
        Column::words("kind"),
        Column::words(if view == InboxView::Over { "end" } else { "your offer" }).at_most(34),
        Column::numbers("offers"),
        Column::numbers("needs quota"),
    ]
}

fn figure(value: Option<f64>) -> Cell {
    match value {
        Some(value) => Cell::number(value, grouped(value, 0)),
        None => Cell::words("–").role(Role::Dim),
    }
}

pub(super) fn row_of(thread: &Thread, marked: bool) -> Vec<Cell> {
    let day = match (thread.state, thread.turns.last()) {
        (State::Waiting(left), _) => {
            let (mark, role) = match left {
                0..=2 => ("! ", Role::Bad),
                3..=5 => ("", Role::Warning),
                _ => ("", Role::Text),
            };
            Cell::number(f64::from(left), format!("{mark}{left} d")).role(role)
        }
        (_, Some(turn)) => Cell::number(f64::from(turn.day), format!("day {}", turn.day)).role(Role::Dim),
        (_, None) => Cell::words("–").role(Role::Dim),
    };
    let asked = match (thread.asked(), thread.asked_plan()) {
        (Some((_, price)), plan) => {
            let plan = plan.map_or(String::new(), |plan| format!("{plan} "));
            Cell::number(price, format!("{plan}${}", grouped(price, 2)))
        }
        (None, Some(plan)) => Cell::words(format!("plan {plan}")),
        (None, None) => Cell::words("–").role(Role::Dim),
    };
    let end = match thread.state {
        state if !state.is_open() => {
            let role = if state == State::Accepted { Role::Good } else { Role::Dim };
            Cell::words(state.words()).role(role)
        }
        _ if thread.offered().is_empty() => Cell::words("–").role(Role::Dim),
        _ => Cell::words(in_words(thread.offered())),
    };
    vec![
        Cell::words(if marked { "●" } else { "" }).role(Role::Changed),
        day,
        Cell::words(&thread.name),
        Cell::number(f64::from(thread.customer), format!("#{}", thread.customer)),
        Cell::words(&thread.group).role(Role::Strong),
        Cell::number(thread.seats, grouped(thread.seats, 0)),
        asked,
        Cell::words(thread.kind_in_words()),
        end,
        figure(thread.asking.as_ref().map(|own| f64::from(own.waiting.offers_so_far))),
        figure(thread.asking.as_ref().and_then(|own| own.needed_quota)),
    ]
}
