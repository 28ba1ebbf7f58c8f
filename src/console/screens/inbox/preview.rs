//! Preview of a bulk offer: the offer to each marked thread.

use ratatui::layout::Rect;

use super::Inbox;
use super::sending::{PlannedOffer, max_monthly_revenue};
use crate::context::ScreenContext;
use crate::screens::panes::{PaneBorder, PanePlacement};
use novamind_base::formatting::{dollars, dollars_and_cents};
use novamind_rules::format_offer_lines;
use novamind_tui::canvas::{Align, Canvas, row_rects};
use novamind_tui::theme::Role;

/// Width of the enterprise column with names.
const NAMED_WIDTH: u16 = 28;
const NUMBERED_WIDTH: u16 = 14;
const MIN_WIDTH_FOR_NAMES: u16 = 68;

pub fn preview_border(inbox: &Inbox, context: &ScreenContext<'_>) -> PaneBorder {
    let title = format!("Preview for {}", inbox.planned_offers(context.company).len());
    PaneBorder { title, note: "before → offer".to_owned(), ..PaneBorder::default() }
}

pub fn draw(inbox: &Inbox, canvas: &mut Canvas<'_>, placement: PanePlacement, context: &ScreenContext<'_>) {
    let (inside, planned) = (placement.area, inbox.planned_offers(context.company));
    if placement.focused {
        canvas.page_rows = inside.height.max(1);
    }
    let from = (inbox.scroll as usize).min(planned.len().saturating_sub(inside.height as usize));
    for (row, one) in row_rects(inside).zip(planned.iter().skip(from)) {
        draw_planned_offer(canvas, row, one);
    }
}

fn draw_planned_offer(canvas: &mut Canvas<'_>, row: Rect, (thread, offers): &PlannedOffer<'_>) {
    // The number is sufficient to identify the enterprise. The name is shown only in wide rows.
    let named = row.width >= MIN_WIDTH_FOR_NAMES;
    let head = if named { thread.customer_label() } else { format!("#{} {}", thread.customer, thread.group) };
    let width = if named { NAMED_WIDTH } else { NUMBERED_WIDTH }.min(row.width);
    canvas.draw_text(Rect { width: width.saturating_sub(1), ..row }, &head, Role::Text);
    let rest = Rect { x: row.x + width, width: row.width - width, ..row };
    let offers = match offers {
        Ok(offers) => offers,
        Err(why) => return canvas.draw_text(rest, &format!("skipped: {why}"), Role::Warning),
    };
    let before = match (thread.last_offer(), thread.asked_price()) {
        ([], None) => thread.asked_plan().map_or("–".to_owned(), |plan| format!("plan {plan}?")),
        ([], Some((_, price))) => format!("asks {}", dollars_and_cents(price)),
        ([(_, price)], _) => dollars_and_cents(*price),
        (last_offers, _) => format!("{} offers", last_offers.len()),
    };
    let value = format!("{}/mo", dollars(max_monthly_revenue(thread, offers)));
    let room = rest.width.saturating_sub(value.len() as u16 + 1);
    let text = format!("{before} → {}", format_offer_lines(offers));
    // The monthly amount is omitted if the offer would otherwise be cut off.
    if text.chars().count() as u16 <= room {
        canvas.draw_aligned(rest, &value, Role::Strong, Align::Right);
    }
    canvas.draw_text(remaining_area(rest, &text, room), &text, Role::Text);
}

fn remaining_area(rest: Rect, text: &str, room: u16) -> Rect {
    if text.chars().count() as u16 <= room { Rect { width: room, ..rest } } else { rest }
}
