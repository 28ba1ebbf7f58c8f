//! Preview of a bulk offer: the offer to each marked thread.

use ratatui::layout::Rect;

use super::Inbox;
use super::offer::in_words;
use super::post::{Planned, monthly};
use crate::context::Look;
use crate::screens::panes::{Border, Seat};
use novamind_base::notation::{cents, dollars};
use novamind_tui::canvas::{Align, Canvas, rows_of};
use novamind_tui::theme::Role;

/// Column width of an enterprise with its name, and without.
const NAMED: u16 = 28;
const NUMBERED: u16 = 14;
const WORTH_A_NAME: u16 = 68;

pub fn border(inbox: &Inbox, look: &Look<'_>) -> Border {
    let title = format!("Preview for {}", inbox.planned(look.company).len());
    Border { title, note: "before → offer".to_owned(), ..Border::default() }
}

pub fn draw(inbox: &Inbox, canvas: &mut Canvas<'_>, seat: Seat, look: &Look<'_>) {
    let (inside, planned) = (seat.area, inbox.planned(look.company));
    if seat.focused {
        canvas.page = inside.height.max(1);
    }
    let from = (inbox.scroll as usize).min(planned.len().saturating_sub(inside.height as usize));
    for (row, one) in rows_of(inside).zip(planned.iter().skip(from)) {
        draw_planned(canvas, row, one);
    }
}

fn draw_planned(canvas: &mut Canvas<'_>, row: Rect, (thread, offers): &Planned<'_>) {
    // The number identifies the enterprise; the name needs room.
    let named = row.width >= WORTH_A_NAME;
    let head = if named { thread.company() } else { format!("#{} {}", thread.customer, thread.group) };
    let width = if named { NAMED } else { NUMBERED }.min(row.width);
    canvas.text(Rect { width: width.saturating_sub(1), ..row }, &head, Role::Text);
    let rest = Rect { x: row.x + width, width: row.width - width, ..row };
    let offers = match offers {
        Ok(offers) => offers,
        Err(why) => return canvas.text(rest, &format!("skipped: {why}"), Role::Warning),
    };
    let before = match (thread.offered(), thread.asked()) {
        ([], None) => thread.asked_plan().map_or("–".to_owned(), |plan| format!("plan {plan}?")),
        ([], Some((_, price))) => format!("asks {}", cents(price)),
        ([(_, price)], _) => cents(*price),
        (own, _) => format!("{} offers", own.len()),
    };
    let value = format!("{}/mo", dollars(monthly(thread, offers)));
    let room = rest.width.saturating_sub(value.len() as u16 + 1);
    let text = format!("{before} → {}", in_words(offers));
    // Drop the monthly amount before cutting the offer.
    if text.chars().count() as u16 <= room {
        canvas.aligned(rest, &value, Role::Strong, Align::Right);
    }
    canvas.text(rest_of(rest, &text, room), &text, Role::Text);
}

fn rest_of(rest: Rect, text: &str, room: u16) -> Rect {
    if text.chars().count() as u16 <= room { Rect { width: room, ..rest } } else { rest }
}
