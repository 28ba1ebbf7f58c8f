//! The selected thread, or the preview of a bulk offer.

use ratatui::layout::Rect;

use super::model::{State, Thread, Turn};
use super::offer::in_words;
use super::{Inbox, InboxPane, post, preview};
use crate::action::{Action, Scope};
use crate::context::{Figure, Look};
use crate::effect::Effect;
use crate::screens::panes::{Border, Pane, Seat, draw_framed};
use novamind_base::notation::cents;
use novamind_tui::canvas::{Canvas, rows_of};
use novamind_tui::text::{count, wrapped};
use novamind_tui::theme::Role;

pub struct ThreadPane;

impl Pane<Inbox> for ThreadPane {
    fn scopes(&self, _: &Inbox) -> Vec<Scope> {
        vec![Scope::Inbox, Scope::List]
    }

    fn hints(&self, inbox: &Inbox) -> Vec<Action> {
        match inbox.ruling {
            Some(_) => vec![Action::InboxRules, Action::SendOffer, Action::Close],
            None => super::OFFER_HINTS.to_vec(),
        }
    }

    fn figure(&self, inbox: &Inbox, _: &Look<'_>) -> Option<Figure> {
        inbox.here().map(|thread| post::figure(thread, "thread with", "thread"))
    }

    fn act(&self, inbox: &mut Inbox, action: Action, look: &Look<'_>) -> Vec<Effect> {
        // A thread opens at its end, a preview at its start.
        let back = if inbox.marked.is_empty() && inbox.ruling.is_none() { Action::Up } else { Action::Down };
        inbox.scroll = match action {
            Action::Open => {
                inbox.focus = InboxPane::Offer;
                inbox.scroll
            }
            Action::Close => {
                inbox.focus = inbox.first_pane();
                inbox.scroll
            }
            Action::Up | Action::Down if action == back => inbox.scroll.saturating_add(1).min(500),
            Action::Up | Action::Down => inbox.scroll.saturating_sub(1),
            Action::PageUp | Action::PageDown if (action == Action::PageUp) == (back == Action::Up) => {
                inbox.scroll.saturating_add(look.page).min(500)
            }
            Action::PageUp | Action::PageDown => inbox.scroll.saturating_sub(look.page),
            Action::First | Action::Last => 0,
            _ => inbox.scroll,
        };
        Vec::new()
    }

    fn border(&self, inbox: &Inbox, area: Rect, look: &Look<'_>) -> Border {
        match (&inbox.ruling, inbox.marked.is_empty()) {
            (Some(ruling), _) => inbox.rules_preview_border(ruling),
            (None, true) => Conversation.border(inbox, area, look),
            (None, false) => preview::border(inbox, look),
        }
    }

    fn draw(&self, inbox: &Inbox, canvas: &mut Canvas<'_>, seat: Seat, look: &Look<'_>) {
        match (&inbox.ruling, inbox.marked.is_empty()) {
            (Some(ruling), _) => inbox.draw_rules_preview(ruling, canvas, seat, look),
            (None, true) => Conversation.draw(inbox, canvas, seat, look),
            (None, false) => preview::draw(inbox, canvas, seat, look),
        }
    }
}

/// Draws the thread next to the preview.
pub fn draw_beside(inbox: &Inbox, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
    draw_framed(&Conversation, inbox, canvas, Seat { area, focused: false, number: 0 }, look);
}

struct Conversation;

impl Pane<Inbox> for Conversation {
    fn border(&self, inbox: &Inbox, area: Rect, _: &Look<'_>) -> Border {
        let Some(thread) = inbox.here() else {
            return Border { title: "Thread".to_owned(), ..Border::default() };
        };
        let state = match thread.state {
            State::Waiting(1) => "1 day left".to_owned(),
            State::Waiting(days) => format!("{days} days left"),
            state => state.words().to_owned(),
        };
        // In small windows the list shows the seats, and the remaining days matter most.
        let note = match area.width {
            ..72 => state,
            _ => format!("{} · {state}", count(thread.seats, "seat")),
        };
        let title = format!("{} {} · {}", thread.company(), thread.group, thread.kind_in_words());
        Border { title, note, ..Border::default() }
    }

    fn draw(&self, inbox: &Inbox, canvas: &mut Canvas<'_>, seat: Seat, _: &Look<'_>) {
        let Some(thread) = inbox.here() else { return };
        let inside = Rect { x: seat.area.x + 1, width: seat.area.width.saturating_sub(2), ..seat.area };
        if seat.focused {
            canvas.page = inside.height.max(1);
        }
        let lines = conversation(inbox, thread, inside.width as usize);
        // Show the newest message.
        let last = lines.len().saturating_sub(inside.height as usize);
        let back = if inbox.marked.is_empty() { inbox.scroll as usize } else { 0 };
        for (row, (line, role)) in rows_of(inside).zip(lines.iter().skip(last.saturating_sub(back))) {
            canvas.text(row, line, *role);
        }
    }
}

fn conversation(inbox: &Inbox, thread: &Thread, width: usize) -> Vec<(String, Role)> {
    let mut lines = Vec::new();
    if let Some(firm) = inbox.letters.firm(thread.customer) {
        let [culture, decision, concern] = &firm.manner;
        let facts: Vec<&str> =
            [firm.trade.as_str(), culture, decision].into_iter().filter(|fact| !fact.is_empty()).collect();
        let mut text = facts.join(" · ");
        if !concern.is_empty() {
            text += &format!(" · worries about {concern}");
        }
        let terms = match firm.status.as_str() {
            "subscribed" => format!("plan {} at {} since day {}", firm.plan, cents(firm.price), firm.since),
            "lead" => format!("not a customer; asked on day {}", firm.since),
            other => format!("{other}; came on day {}", firm.since),
        };
        lines.extend(wrapped(&text, width).into_iter().map(|line| (line, Role::Text)));
        lines.extend(wrapped(&terms, width).into_iter().map(|line| (line, Role::Strong)));
        lines.push((String::new(), Role::Text));
    }
    // Of long threads only the newest turns are read.
    if thread.turns.first().is_none_or(|turn| turn.number > 0) {
        lines.push(("earlier turns: see SQL".to_owned(), Role::Dim));
    }
    for turn in &thread.turns {
        let (who, role) = match turn.sender.as_str() {
            "agent" => ("you", Role::Changed),
            "customer" => ("they", Role::Text),
            _ => ("–", Role::Dim),
        };
        let head = format!("day {:>3} {who:<5}", turn.day);
        let indent = " ".repeat(2);
        let words = words_of(turn);
        let whole = format!("{head}{words}");
        let mut wrapped = wrapped(&whole, width).into_iter();
        lines.extend(wrapped.next().map(|line| (line, role)));
        let rest: String = wrapped.collect::<Vec<_>>().join(" ");
        let more = lines_of(&rest, width.saturating_sub(2));
        lines.extend(more.into_iter().map(|line| (format!("{indent}{line}"), role)));
    }
    if let Some(end) = thread.end_in_words() {
        lines.extend(wrapped(&end, width).into_iter().map(|line| (line, Role::Strong)));
    }
    lines
}

fn lines_of(text: &str, width: usize) -> Vec<String> {
    if text.is_empty() { Vec::new() } else { wrapped(text, width) }
}

fn words_of(turn: &Turn) -> String {
    match (turn.closes.as_str(), turn.sender.as_str()) {
        ("agent_rejected", _) => "ended the thread".to_owned(),
        (_, "agent") => format!("offered {}", in_words(&turn.offers)),
        _ if turn.text.is_empty() => "asks for an offer".to_owned(),
        _ => turn.text.clone(),
    }
}
