//! The selected thread, or the preview of a bulk offer.

use ratatui::layout::Rect;

use super::model::{Thread, ThreadState};
use super::{Inbox, InboxPane, preview, sending};
use crate::action::{Action, Scope};
use crate::context::{Figure, ScreenContext};
use crate::effect::Effect;
use crate::screens::panes::{Pane, PaneBorder, PanePlacement, draw_framed};
use novamind_rules::{Turn, format_offer_lines};
use novamind_tui::canvas::{Canvas, row_rects};
use novamind_tui::text::{first_fitting, format_count, wrap};
use novamind_tui::theme::Role;

pub struct ThreadPane;

impl Pane<Inbox> for ThreadPane {
    fn scopes(&self, _: &Inbox) -> Vec<Scope> {
        vec![Scope::Inbox, Scope::List]
    }

    fn hints(&self, inbox: &Inbox) -> Vec<Action> {
        match inbox.rules_form {
            Some(_) => vec![Action::InboxRules, Action::SendOffer, Action::Close],
            None => super::OFFER_HINTS.to_vec(),
        }
    }

    fn figure(&self, inbox: &Inbox, _: &ScreenContext<'_>) -> Option<Figure> {
        inbox.selected_thread().map(|thread| sending::thread_figure(thread, "thread with", "thread"))
    }

    fn handle_action(&self, inbox: &mut Inbox, action: Action, context: &ScreenContext<'_>) -> Vec<Effect> {
        // A thread is shown from its end, a preview from its start.
        let back =
            if inbox.marked.is_empty() && inbox.rules_form.is_none() { Action::Up } else { Action::Down };
        inbox.scroll = match action {
            Action::Open => {
                inbox.focus = InboxPane::Offer;
                inbox.scroll
            }
            Action::Close => {
                inbox.focus = inbox.left_pane();
                inbox.scroll
            }
            Action::Up | Action::Down if action == back => inbox.scroll.saturating_add(1).min(500),
            Action::Up | Action::Down => inbox.scroll.saturating_sub(1),
            Action::PageUp | Action::PageDown if (action == Action::PageUp) == (back == Action::Up) => {
                inbox.scroll.saturating_add(context.page_rows).min(500)
            }
            Action::PageUp | Action::PageDown => inbox.scroll.saturating_sub(context.page_rows),
            Action::First | Action::Last => 0,
            _ => inbox.scroll,
        };
        Vec::new()
    }

    fn border(&self, inbox: &Inbox, area: Rect, context: &ScreenContext<'_>) -> PaneBorder {
        match (&inbox.rules_form, inbox.marked.is_empty()) {
            (Some(ruling), _) => inbox.rules_preview_border(ruling),
            (None, true) => MessagesPane.border(inbox, area, context),
            (None, false) => preview::preview_border(inbox, context),
        }
    }

    fn draw(
        &self,
        inbox: &Inbox,
        canvas: &mut Canvas<'_>,
        placement: PanePlacement,
        context: &ScreenContext<'_>,
    ) {
        match (&inbox.rules_form, inbox.marked.is_empty()) {
            (Some(ruling), _) => inbox.draw_rules_preview(ruling, canvas, placement, context),
            (None, true) => MessagesPane.draw(inbox, canvas, placement, context),
            (None, false) => preview::draw(inbox, canvas, placement, context),
        }
    }
}

/// Draws the selected thread next to the preview.
pub fn draw_side_thread(inbox: &Inbox, canvas: &mut Canvas<'_>, area: Rect, context: &ScreenContext<'_>) {
    draw_framed(&MessagesPane, inbox, canvas, PanePlacement { area, focused: false, index: 0 }, context);
}

struct MessagesPane;

impl Pane<Inbox> for MessagesPane {
    fn border(&self, inbox: &Inbox, area: Rect, _: &ScreenContext<'_>) -> PaneBorder {
        let Some(thread) = inbox.selected_thread() else {
            return PaneBorder { title: "Thread".to_owned(), ..PaneBorder::default() };
        };
        let state = match thread.state {
            ThreadState::WaitingForPlayer(1) => "1 day left".to_owned(),
            ThreadState::WaitingForPlayer(days) => format!("{days} days left"),
            state => state.label().to_owned(),
        };
        // Small windows show only the remaining days, because the list already shows the seats.
        let note = match area.width {
            ..72 => state,
            _ => format!("{} · {state}", format_count(thread.seats, "seat")),
        };
        let complete = format!("{} {} · {}", thread.customer_label(), thread.group, thread.kind_label());
        let number = format!("#{} · {}", thread.customer, thread.kind_label());
        // The list shows the name of the customer too.
        let title = first_fitting([complete, number], usize::from(area.width.saturating_sub(6)));
        PaneBorder { title, note, ..PaneBorder::default() }
    }

    fn draw(&self, inbox: &Inbox, canvas: &mut Canvas<'_>, placement: PanePlacement, _: &ScreenContext<'_>) {
        let Some(thread) = inbox.selected_thread() else { return };
        let inside =
            Rect { x: placement.area.x + 1, width: placement.area.width.saturating_sub(2), ..placement.area };
        if placement.focused {
            canvas.page_rows = inside.height.max(1);
        }
        let lines = message_lines(inbox, thread, inside.width as usize);
        // The newest message is at the end and must be visible.
        let last = lines.len().saturating_sub(inside.height as usize);
        let back = if inbox.marked.is_empty() { inbox.scroll as usize } else { 0 };
        for (row, (line, role)) in row_rects(inside).zip(lines.iter().skip(last.saturating_sub(back))) {
            canvas.draw_text(row, line, *role);
        }
    }
}

fn message_lines(inbox: &Inbox, thread: &Thread, width: usize) -> Vec<(String, Role)> {
    let mut lines = Vec::new();
    if let Some(firm) = inbox.threads.enterprise(thread.customer) {
        let [culture, decision, concern] = &firm.traits;
        let facts: Vec<&str> =
            [firm.industry.as_str(), culture, decision].into_iter().filter(|fact| !fact.is_empty()).collect();
        let mut text = facts.join(" · ");
        if !concern.is_empty() {
            text += &format!(" · main concern: {concern}");
        }
        let terms = match firm.status.as_str() {
            "subscribed" => firm.describe_terms(),
            "lead" => format!("not a customer; asked for an offer on day {}", firm.since_day),
            other => format!("{other}; arrived on day {}", firm.since_day),
        };
        lines.extend(wrap(&text, width).into_iter().map(|line| (line, Role::Text)));
        lines.extend(wrap(&terms, width).into_iter().map(|line| (line, Role::Strong)));
        lines.push((String::new(), Role::Text));
    }
    // Only the newest turns of a long thread are loaded.
    if thread.messages.first().is_none_or(|turn| turn.number > 0) {
        lines.push(("earlier turns: query in SQL".to_owned(), Role::Dim));
    }
    for turn in &thread.messages {
        let (who, role) = match turn.sender.as_str() {
            "agent" => ("you", Role::Changed),
            "customer" => ("they", Role::Text),
            _ => ("–", Role::Dim),
        };
        let head = format!("day {:>3} {who:<5}", turn.day);
        let indent = " ".repeat(2);
        let words = message_text(turn, thread);
        let whole = format!("{head}{words}");
        let mut wrapped = wrap(&whole, width).into_iter();
        lines.extend(wrapped.next().map(|line| (line, role)));
        let rest: String = wrapped.collect::<Vec<_>>().join(" ");
        let more = wrap_or_empty(&rest, width.saturating_sub(2));
        lines.extend(more.into_iter().map(|line| (format!("{indent}{line}"), role)));
    }
    lines.extend(loss_lines(thread, width));
    lines
}

/// Describes how a lost thread ended, and what the record shows about the reason.
fn loss_lines(thread: &Thread, width: usize) -> Vec<(String, Role)> {
    let Some(loss) = &thread.loss else { return Vec::new() };
    let end = wrap(&loss.describe(&thread.customer_label()), width);
    let mut lines: Vec<(String, Role)> = end.into_iter().map(|line| (line, Role::Strong)).collect();
    for fact in &loss.facts {
        for (at, line) in wrap(fact, width.saturating_sub(2)).into_iter().enumerate() {
            lines.push((format!("{} {line}", if at == 0 { "·" } else { " " }), Role::Text));
        }
    }
    lines
}

fn wrap_or_empty(text: &str, width: usize) -> Vec<String> {
    if text.is_empty() { Vec::new() } else { wrap(text, width) }
}

fn message_text(turn: &Turn, thread: &Thread) -> String {
    match (turn.closing_reason.as_str(), turn.sender.as_str()) {
        ("agent_rejected", _) => "ended the thread".to_owned(),
        (_, "agent") => format!("offered {}", format_offer_lines(&turn.offers)),
        _ if turn.text.is_empty() => match thread.kind.as_str() {
            "new_lead" => "asks for an offer".to_owned(),
            "churn_prevention" => "considers cancelling its subscription".to_owned(),
            _ => format!("opened the thread: {}", thread.kind_label()),
        },
        _ => turn.text.clone(),
    }
}
