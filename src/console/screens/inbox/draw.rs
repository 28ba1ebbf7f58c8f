//! The three panes: the list, the thread or the preview of a rule, and the offer.

use ratatui::layout::{Constraint, Layout, Rect};

use super::estimate::Money;
use super::model::{State, Thread, Turn};
use super::offer::{Choice, Offer, in_words};
use super::post::{Planned, monthly, summary};
use super::{Inbox, LIST, OFFER, THREAD, View, list_prices};
use crate::console::action::Action;
use crate::console::canvas::{Align, Canvas, Click, rows_of};
use crate::console::screens::Look;
use crate::console::text::{count, wrapped};
use crate::console::theme::Role;
use crate::notation::{cents, dollars, grouped, percent};
use crate::world::identifiers::Plan;

/// Height of the offer, with its border.
const OFFER_HEIGHT: u16 = 10;

/// Width in which a line of the offer has all its columns.
const WORTH: u16 = 59;

/// More width for the column that compares with what the company asks.
const VERSUS: u16 = 10;

/// Draws the screen.
pub(super) fn draw(inbox: &Inbox, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
    let batch = !inbox.marked.is_empty();
    if canvas.zoomed {
        match inbox.focus {
            LIST => draw_list(inbox, canvas, area, look),
            OFFER => draw_offer(inbox, canvas, area, look),
            _ if batch => draw_preview(inbox, canvas, area, look),
            _ => draw_thread(inbox, canvas, area, true),
        }
        return;
    }
    if area.width >= 104 {
        // The offer needs its columns; a list that loses its last column shows more with the right key.
        let right = (area.width * 43 / 100).max(WORTH + 2);
        let [list, right] = Layout::horizontal([Constraint::Min(0), Constraint::Length(right)]).areas(area);
        let [above, offer] =
            Layout::vertical([Constraint::Min(0), Constraint::Length(OFFER_HEIGHT)]).areas(right);
        draw_list(inbox, canvas, list, look);
        if batch && above.height >= 20 {
            let [thread, preview] =
                Layout::vertical([Constraint::Percentage(45), Constraint::Min(0)]).areas(above);
            draw_thread(inbox, canvas, thread, false);
            draw_preview(inbox, canvas, preview, look);
        } else if batch {
            draw_preview(inbox, canvas, above, look);
        } else {
            draw_thread(inbox, canvas, above, true);
        }
        draw_offer(inbox, canvas, offer, look);
        return;
    }
    let below = (OFFER_HEIGHT + 1).min(area.height.div_ceil(2));
    let [list, below] = Layout::vertical([Constraint::Min(0), Constraint::Length(below)]).areas(area);
    let [thread, offer] = Layout::horizontal([Constraint::Min(0), Constraint::Length(44)]).areas(below);
    draw_list(inbox, canvas, list, look);
    if batch {
        draw_preview(inbox, canvas, thread, look);
    } else {
        draw_thread(inbox, canvas, thread, true);
    }
    draw_offer(inbox, canvas, offer, look);
}

fn draw_list(inbox: &Inbox, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
    let focused = inbox.focus == LIST;
    canvas.click(area, Click::Pane(LIST));
    let count = inbox.rows.len();
    let (title, worth) = match inbox.view {
        View::Waiting => (format!("{count} waiting for you"), true),
        View::Theirs => (format!("{count} waiting for them"), true),
        View::Over => (format!("{count} ended"), false),
    };
    let threads = inbox.rows.iter().filter_map(|at| inbox.letters.threads.get(*at));
    let seats: f64 = threads.map(|thread| thread.seats).sum();
    let mut note = inbox.table.note();
    if note.is_empty() && worth && count > 0 {
        note = crate::console::text::count(seats, "seat");
    }
    if !inbox.marked.is_empty() {
        note = format!("{} marked · {note}", inbox.marked.len());
    }
    let inside = canvas.pane(area, &title, &note, focused);
    if count == 0 {
        let inside = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside };
        let mut lines = wrapped(&nobody(inbox, look), inside.width as usize);
        if lines.len() > inside.height as usize {
            let zoom = look.keys.label(Action::Zoom).unwrap_or_default();
            lines.truncate((inside.height as usize).saturating_sub(1));
            lines.push(format!("… {zoom} shows the rest"));
        }
        for (row, line) in rows_of(inside).zip(lines) {
            canvas.text(row, &line, Role::Dim);
        }
    } else {
        inbox.table.draw(canvas, inside, focused, LIST);
    }
    if focused {
        let keys = look.hints(&[Action::Mark, Action::MarkAll, Action::Filter, Action::OtherThreads]);
        canvas.pane_keys(area, &keys);
    }
}

/// What an empty list says.
fn nobody(inbox: &Inbox, look: &Look<'_>) -> String {
    let key = |action: Action| look.keys.label(action).unwrap_or_default();
    if !inbox.letters.threads.is_empty() {
        return format!("No threads here. {} shows others.", key(Action::OtherThreads));
    }
    let funnels: Vec<String> =
        look.company.funnels.iter().map(|own| format!("· {}", own.in_words())).collect();
    format!(
        "No company has asked for an offer yet. Ads bring companies ({} set_targeted_ad_spend). A better model tier, \
         development for their group and a quota for a whole office make a plan better for them.\n\n{}",
        key(Action::Tools),
        funnels.join("\n")
    )
}

fn draw_thread(inbox: &Inbox, canvas: &mut Canvas<'_>, area: Rect, own: bool) {
    let focused = own && inbox.focus == THREAD;
    canvas.click(area, Click::Pane(THREAD));
    let Some(thread) = inbox.here() else {
        canvas.pane(area, "Thread", "", focused);
        return;
    };
    let title = format!("#{} {} · {}", thread.customer, thread.group, thread.kind_in_words());
    let state = match thread.state {
        State::Waiting(1) => "1 day left".to_owned(),
        State::Waiting(days) => format!("{days} days left"),
        state => state.words().to_owned(),
    };
    // In a small window the list beside it says how many seats; the days are what presses.
    let note = match area.width {
        ..50 => state,
        _ => format!("{} · {state}", count(thread.seats, "seat")),
    };
    let inside = canvas.pane(area, &title, &note, focused);
    let inside = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside };
    if focused {
        canvas.page = inside.height.max(1);
    }
    let lines = conversation(inbox, thread, inside.width as usize);
    let height = inside.height as usize;
    // The newest words are what an answer is about.
    let last = lines.len().saturating_sub(height);
    let from = last.saturating_sub(if own { inbox.scroll as usize } else { 0 });
    for (row, (line, role)) in rows_of(inside).zip(lines.iter().skip(from)) {
        canvas.text(row, line, *role);
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
    if thread.turns.first().is_some_and(|turn| turn.number > 0) {
        lines.push(("earlier turns: SQL".to_owned(), Role::Dim));
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

fn draw_preview(inbox: &Inbox, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
    let focused = inbox.focus == THREAD;
    canvas.click(area, Click::Pane(THREAD));
    let planned = inbox.planned(look.company);
    let title = format!("What {} would get", planned.len());
    let inside = canvas.pane(area, &title, "before → offer", focused);
    if focused {
        canvas.page = inside.height.max(1);
    }
    let from = (inbox.scroll as usize).min(planned.len().saturating_sub(inside.height as usize));
    for (row, one) in rows_of(inside).zip(planned.iter().skip(from)) {
        draw_planned(canvas, row, one);
    }
}

fn draw_planned(canvas: &mut Canvas<'_>, row: Rect, (thread, offers): &Planned<'_>) {
    let head = format!("#{} {}", thread.customer, thread.group);
    canvas.text(Rect { width: row.width.min(13), ..row }, &head, Role::Text);
    let rest = Rect { x: row.x + 14.min(row.width), width: row.width.saturating_sub(14), ..row };
    let offers = match offers {
        Ok(offers) => offers,
        Err(why) => return canvas.text(rest, &format!("skipped: {why}"), Role::Warning),
    };
    let before = match (thread.offered(), thread.asked()) {
        ([], None) => "–".to_owned(),
        ([], Some((_, price))) => format!("asks {}", cents(price)),
        ([(_, price)], _) => cents(*price),
        (own, _) => format!("{} offers", own.len()),
    };
    let value = format!("{}/mo", dollars(monthly(thread, offers)));
    let room = rest.width.saturating_sub(value.len() as u16 + 1);
    let text = format!("{before} → {}", in_words(offers));
    // Without the money a month rather than with half an offer.
    if text.chars().count() as u16 <= room {
        canvas.aligned(rest, &value, Role::Strong, Align::Right);
    }
    canvas.text(rest_of(rest, &text, room), &text, Role::Text);
}

fn rest_of(rest: Rect, text: &str, room: u16) -> Rect {
    if text.chars().count() as u16 <= room { Rect { width: room, ..rest } } else { rest }
}

fn draw_offer(inbox: &Inbox, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
    let focused = inbox.focus == OFFER;
    canvas.click(area, Click::Pane(OFFER));
    let batch = !inbox.marked.is_empty();
    let title =
        if batch { format!("Bulk offer for {}", inbox.marked.len()) } else { "Your offer".to_owned() };
    let inside = canvas.pane(area, &title, "", focused);
    let lists = list_prices(look.company);
    let offer = inbox.offer();
    let mut rows = rows_of(inside);
    if inbox.here().is_none() && !batch {
        return;
    }
    if let Some(row) = rows.next() {
        let mut worth = if batch { String::new() } else { format!(" {:>8} {:>9}", "a seat", "a month") };
        if !batch && inside.width >= WORTH {
            worth += &format!(" {:>9} {:>7}", "compute", "margin");
        }
        if !batch && inside.width >= WORTH + VERSUS {
            worth += &format!(" {:>9}", "vs. ask");
        }
        canvas.text(row, &format!("plan   of     {:>8}{worth}", "value"), Role::Header);
    }
    for at in 0..offer.0.len() {
        let Some(row) = rows.next() else { return };
        draw_term(inbox, canvas, row, &offer, at, look);
    }
    rows.next();
    let list = ["A", "B", "C"].iter().zip(lists).map(|(plan, price)| format!("{plan} {}", cents(price)));
    let lists = (format!("list {}", list.collect::<Vec<_>>().join(" · ")), Role::Dim);
    let mut notes = Vec::new();
    let planned = inbox.planned(look.company);
    match planned.first() {
        _ if batch => {
            let lines = wrapped(&summary(&planned), inside.width as usize).into_iter();
            notes.extend(lines.map(|line| (line, Role::Strong)));
        }
        Some((_, Err(why))) => notes.push((format!("can't send: {why}"), Role::Warning)),
        Some((thread, Ok(offers))) => notes = offer_notes(inbox, thread, offers, inside.width, look),
        None => {}
    }
    notes.push(lists);
    for (row, (text, role)) in rows.zip(notes) {
        canvas.text(row, &text, role);
    }
    if focused {
        let keys = [Action::OfferPlan, Action::OfferBasis, Action::SendOffer];
        canvas.pane_keys(area, &look.hints(&keys));
    }
}

/// What there is to know of an offer, the most important first: what a quota does not cover, what they ask, and what the
/// estimate of compute rests on; where its columns do not fit, the estimate itself.
fn offer_notes(
    inbox: &Inbox,
    thread: &Thread,
    offers: &[(Plan, f64)],
    width: u16,
    look: &Look<'_>,
) -> Vec<(String, Role)> {
    let priced = || {
        let money = |sold: &(Plan, f64)| (sold.0, Money::of(&inbox.usage, look.company, thread, *sold));
        offers.iter().map(money)
    };
    let mut notes = Vec::new();
    for (plan, (quota, wanted)) in priced().filter_map(|(plan, money)| Some((plan, money.covered?))) {
        let (quota, share) = (grouped(quota, 0), percent(quota / wanted, 0));
        let text = format!("! {plan}: quota {quota} covers {share} of {} units a day", grouped(wanted, 0));
        notes.push((text, Role::Warning));
    }
    if let Some((_, price)) = thread.asked() {
        let best = offers.iter().map(|(_, own)| own - price).fold(f64::INFINITY, f64::min);
        let sign = if best < 0.0 { "-" } else { "+" };
        notes.push((format!("they ask {}; yours {sign}{}", cents(price), cents(best.abs())), Role::Text));
    }
    let Some((units, source)) = inbox.usage.per_seat(look.company, &thread.group) else {
        notes.push(("compute unknown: nobody in the group uses it yet".to_owned(), Role::Dim));
        return notes;
    };
    if width >= WORTH {
        let text = format!("compute est.: {} units/seat/day, {source}", grouped(units, 0));
        notes.push((text, Role::Dim));
        return notes;
    }
    for (plan, money) in priced() {
        if let (Some(compute), Some(margin)) = (money.compute, money.margin()) {
            let role = if margin < 0.0 { Role::Bad } else { Role::Text };
            let text = format!("{plan} est. compute {}/mo, margin {}", dollars(compute), percent(margin, 0));
            notes.push((text, role));
        }
    }
    notes
}

fn draw_term(inbox: &Inbox, canvas: &mut Canvas<'_>, row: Rect, offer: &Offer, at: usize, look: &Look<'_>) {
    let lists = list_prices(look.company);
    let term = &offer.0[at];
    let here = inbox.focus == OFFER && inbox.term == at;
    let role = match (here, term.plan) {
        (true, _) => Role::Selection,
        (false, Choice::Nothing) => Role::Dim,
        (false, _) => Role::Text,
    };
    canvas.clear(row, role);
    canvas.click(row, Click::Row(OFFER, at));
    let value = if term.plan == Choice::Nothing && !here { String::new() } else { term.value_in_words() };
    let basis = if term.plan == Choice::Nothing && !here { "" } else { term.basis.words() };
    let mut text = format!("{:<6} {basis:<6} {value:>8}", term.plan_in_words());
    let single = inbox.here().filter(|_| inbox.marked.is_empty());
    if let Some((thread, sold)) = single.and_then(|thread| Some((thread, term.price(thread, lists)?))) {
        text += &format!(" {:>8} {:>9}", cents(sold.1), dollars(sold.1 * thread.seats));
        if row.width >= WORTH {
            let money = Money::of(&inbox.usage, look.company, thread, sold);
            let compute = money.compute.map_or("–".to_owned(), dollars);
            let margin = money.margin().map_or("–".to_owned(), |margin| percent(margin, 0));
            let loses = if money.margin().is_some_and(|margin| margin < 0.0) { "!" } else { "" };
            text += &format!(" {compute:>9} {:>7}", format!("{loses}{margin}"));
        }
        if row.width >= WORTH + VERSUS {
            let versus = thread.asked().map_or("–".to_owned(), |(_, asked)| {
                let sign = if sold.1 < asked { '-' } else { '+' };
                format!("{sign}{}", cents((sold.1 - asked).abs()))
            });
            text += &format!(" {versus:>9}");
        }
    }
    canvas.text(row, &text, role);
    if let Some(field) = inbox.typing.as_ref().filter(|_| here) {
        let place = Rect { x: row.x + 14.min(row.width), width: row.width.saturating_sub(14).min(9), ..row };
        field.draw(canvas, place);
    }
}
