//! Pane of the offer that the user edits: terms, values and notes.

use crossterm::event::KeyEvent;
use ratatui::layout::Rect;

use super::estimate::plan_economics;
use super::model::Thread;
use super::offer::{MAX_TERMS, OfferDraft, OfferTerm, PlanChoice};
use super::sending::{self, offer_economics, summary};
use super::{Inbox, list_prices};
use crate::action::{Action, Scope};
use crate::context::{Figure, ScreenContext};
use crate::effect::Effect;
use crate::screens::panes::{Pane, PaneBorder, PanePlacement};
use novamind_base::formatting::{dollars, dollars_and_cents, grouped_number, parse_number, percent};
use novamind_rules::PlanEconomics;
use novamind_session::identifiers::Plan;
use novamind_tui::canvas::{Canvas, Click, row_rects};
use novamind_tui::text::wrap;
use novamind_tui::theme::Role;
use novamind_tui::widgets::TextField;
use novamind_tui::widgets::field::NUMBER_HINT;

/// Width at which a line of the offer shows all columns except the comparison.
pub const MIN_FULL_WIDTH: u16 = 59;

/// Additional width for the comparison with the asked price.
const COMPARISON_WIDTH: u16 = 10;

pub struct OfferPane;

impl Pane<Inbox> for OfferPane {
    fn scopes(&self, inbox: &Inbox) -> Vec<Scope> {
        match (&inbox.value_field, &inbox.rules_form) {
            (_, Some(ruling)) if !ruling.is_typing => vec![Scope::Inbox, Scope::List],
            (Some(_), _) | (_, Some(_)) => vec![Scope::Field, Scope::Inbox],
            (None, None) => vec![Scope::Inbox, Scope::List],
        }
    }

    fn hints(&self, inbox: &Inbox) -> Vec<Action> {
        match (&inbox.value_field, &inbox.rules_form) {
            (_, Some(ruling)) if !ruling.is_typing => {
                vec![Action::InboxRules, Action::SendOffer, Action::Close]
            }
            (Some(_), _) | (_, Some(_)) => vec![Action::Commit, Action::SendOffer, Action::Discard],
            (None, None) => super::OFFER_HINTS.to_vec(),
        }
    }

    fn figure(&self, inbox: &Inbox, _: &ScreenContext<'_>) -> Option<Figure> {
        inbox.selected_thread().map(sending::usage_figure)
    }

    fn handle_action(&self, inbox: &mut Inbox, action: Action, context: &ScreenContext<'_>) -> Vec<Effect> {
        match action {
            Action::Up | Action::CommitPrevious => {
                inbox.selected_term = inbox.selected_term.saturating_sub(1)
            }
            Action::Down | Action::CommitDown | Action::CommitNext => {
                inbox.selected_term = (inbox.selected_term + 1).min(MAX_TERMS - 1);
            }
            Action::First => inbox.selected_term = 0,
            Action::Last => inbox.selected_term = MAX_TERMS - 1,
            Action::Open => inbox.start_typing(context.company),
            Action::Right => inbox.cycle_plan(context.company),
            Action::Left => return inbox.cycle_basis(context.company),
            Action::Close => inbox.focus = inbox.left_pane(),
            _ => {}
        }
        Vec::new()
    }

    fn handle_key(&self, inbox: &mut Inbox, key: &KeyEvent, context: &ScreenContext<'_>) -> Vec<Effect> {
        if inbox.rules_form.is_some() {
            inbox.handle_rules_key(key, context.company);
            return Vec::new();
        }
        let taken = inbox.value_field.as_mut().is_none_or(|field| field.handle_number_key(key));
        if taken { Vec::new() } else { vec![Effect::ShowError(NUMBER_HINT.to_owned())] }
    }

    fn paste(&self, inbox: &mut Inbox, text: &str, context: &ScreenContext<'_>) -> Vec<Effect> {
        match inbox.rules_form {
            Some(_) => inbox.edit_rules(context.company, &mut |field| field.insert(text)),
            None => {
                let pasted = inbox.value_field.as_mut().map(|field| field.paste_number(text));
                return pasted.and_then(Result::err).map(Effect::ShowError).into_iter().collect();
            }
        }
        Vec::new()
    }

    fn edit_filter(&self, inbox: &mut Inbox, edit: &mut dyn FnMut(&mut TextField)) {
        if let Some(field) = &mut inbox.value_field {
            edit(field);
        }
    }

    fn handle_click(&self, inbox: &mut Inbox, row: usize, context: &ScreenContext<'_>) -> Vec<Effect> {
        let again = inbox.selected_term == row;
        inbox.selected_term = row.min(MAX_TERMS - 1);
        if again {
            inbox.start_typing(context.company);
        }
        Vec::new()
    }

    fn border(&self, inbox: &Inbox, _: Rect, context: &ScreenContext<'_>) -> PaneBorder {
        if inbox.rules_form.is_some() {
            return inbox.rules_border(context);
        }
        let title = match inbox.marked.len() {
            0 => "Your offer".to_owned(),
            marked => format!("Bulk offer for {marked}"),
        };
        let shown = inbox.selected_thread().is_some() || !inbox.marked.is_empty();
        let keys = [Action::OfferPlan, Action::OfferBasis, Action::SendOffer];
        let keys = if shown { context.hints(&keys) } else { String::new() };
        PaneBorder { title, keys, ..PaneBorder::default() }
    }

    fn draw(
        &self,
        inbox: &Inbox,
        canvas: &mut Canvas<'_>,
        placement: PanePlacement,
        context: &ScreenContext<'_>,
    ) {
        if let Some(ruling) = &inbox.rules_form {
            return inbox.draw_rules(ruling, canvas, placement);
        }
        let (inside, batch) = (placement.area, !inbox.marked.is_empty());
        if inbox.selected_thread().is_none() && !batch {
            return;
        }
        let offer = inbox.current_offer(context.company);
        let mut rows = row_rects(inside);
        if let Some(row) = rows.next() {
            canvas.draw_text(row, &column_heads(inside.width, batch), Role::Header);
        }
        for at in 0..offer.0.len() {
            let Some(row) = rows.next() else { return };
            draw_term(inbox, canvas, PanePlacement { area: row, ..placement }, &offer, at, context);
        }
        rows.next();
        for (row, (text, role)) in rows.zip(offer_pane_notes(inbox, inside.width, context)) {
            canvas.draw_text(row, &text, role);
        }
    }
}

/// Returns the column headings that fit into a width.
fn column_heads(width: u16, batch: bool) -> String {
    let mut worth = if batch { String::new() } else { format!(" {:>8} {:>9}", "per seat", "per mo.") };
    if !batch && width >= MIN_FULL_WIDTH {
        worth += &format!(" {:>9} {:>7}", "compute", "margin");
    }
    if !batch && width >= MIN_FULL_WIDTH + COMPARISON_WIDTH {
        worth += &format!(" {:>9}", "vs. ask");
    }
    format!("plan   basis  {:>8}{worth}", "value")
}

fn offer_pane_notes(inbox: &Inbox, width: u16, context: &ScreenContext<'_>) -> Vec<(String, Role)> {
    let planned = inbox.planned_offers(context.company);
    let economics = plan_economics(context.company, &inbox.usage);
    let mut notes = match planned.first() {
        _ if !inbox.marked.is_empty() => {
            let lines = wrap(&summary(&planned, &economics), width as usize).into_iter();
            lines.map(|line| (line, Role::Strong)).collect()
        }
        Some((_, Err(why))) => vec![(format!("cannot send: {why}"), Role::Warning)],
        Some((thread, Ok(offers))) => offer_notes(thread, offers, width, &economics),
        None => Vec::new(),
    };
    let lists = list_prices(context.company);
    let list =
        ["A", "B", "C"].iter().zip(lists).map(|(plan, price)| format!("{plan} {}", dollars_and_cents(price)));
    notes.push((format!("list {}", list.collect::<Vec<_>>().join(" · ")), Role::Dim));
    notes
}

/// Returns the notes on an offer: quota shortfalls, the asked price, and the basis of the compute estimate. If the
/// compute columns do not fit, the notes contain the estimate.
fn offer_notes(
    thread: &Thread,
    offers: &[(Plan, f64)],
    width: u16,
    economics: &PlanEconomics,
) -> Vec<(String, Role)> {
    let priced = offer_economics(thread, offers, economics);
    let mut notes = Vec::new();
    for (plan, (quota, wanted)) in priced.iter().filter_map(|line| Some((line.plan, line.quota_shortfall?))) {
        let (quota, share) = (grouped_number(quota, 0), percent(quota / wanted, 0));
        let wanted = grouped_number(wanted, 0);
        let text = match width >= MIN_FULL_WIDTH {
            true => format!("! {plan}: quota {quota} covers {share} of {wanted} units a day"),
            false => format!("! {plan}: quota covers {share} of {wanted} a day"),
        };
        notes.push((text, Role::Warning));
    }
    if let Some((_, price)) = thread.asked_price() {
        let best = offers.iter().map(|(_, value)| value - price).fold(f64::INFINITY, f64::min);
        let sign = if best < 0.0 { "-" } else { "+" };
        notes.push((
            format!(
                "asked price {}; difference {sign}{}",
                dollars_and_cents(price),
                dollars_and_cents(best.abs())
            ),
            Role::Text,
        ));
    }
    let Some((units, source)) = economics.usage_per_seat(&thread.group) else {
        notes.push(("compute unknown: the group has no usage yet".to_owned(), Role::Dim));
        return notes;
    };
    if width >= MIN_FULL_WIDTH {
        let text = format!("compute est.: {} units/seat/day, {source}", grouped_number(units, 0));
        notes.extend(wrap(&text, width as usize).into_iter().map(|line| (line, Role::Dim)));
        return notes;
    }
    for line in priced {
        if let (Some(compute), Some(margin)) = (line.compute_cost, line.margin()) {
            let role = if margin < 0.0 { Role::Bad } else { Role::Text };
            let text =
                format!("{} est. compute {}/mo, margin {}", line.plan, dollars(compute), percent(margin, 0));
            notes.push((text, role));
        }
    }
    notes
}

fn draw_term(
    inbox: &Inbox,
    canvas: &mut Canvas<'_>,
    placement: PanePlacement,
    offer: &OfferDraft,
    at: usize,
    context: &ScreenContext<'_>,
) {
    let row = placement.area;
    let lists = list_prices(context.company);
    let term = &offer.0[at];
    let here = placement.focused && inbox.selected_term == at;
    let role = match (here, term.plan) {
        (true, _) => Role::Selection,
        (false, PlanChoice::Unused) => Role::Dim,
        (false, _) => Role::Text,
    };
    canvas.clear(row, role);
    canvas.register_click(row, Click::Row(placement.index, at));
    let value = if term.plan == PlanChoice::Unused && !here { String::new() } else { term.value_with_unit() };
    let basis = if term.plan == PlanChoice::Unused && !here { "" } else { term.basis.label() };
    let mut text = format!("{:<6} {basis:<6} {value:>8}", term.plan_label());
    let single = inbox.selected_thread().filter(|_| inbox.marked.is_empty());
    if let Some((thread, sold)) = single.and_then(|thread| Some((thread, term.price(thread, lists)?))) {
        text += &format!(" {:>8} {:>9}", dollars_and_cents(sold.1), dollars(sold.1 * thread.seats));
        if row.width >= MIN_FULL_WIDTH {
            let economics = plan_economics(context.company, &inbox.usage);
            let money = economics.offer_line(&thread.group, thread.seats as u32, sold);
            let compute = money.compute_cost.map_or("–".to_owned(), dollars);
            let margin = money.margin().map_or("–".to_owned(), |margin| percent(margin, 0));
            let loses = if money.margin().is_some_and(|margin| margin < 0.0) { "!" } else { "" };
            text += &format!(" {compute:>9} {:>7}", format!("{loses}{margin}"));
        }
        if row.width >= MIN_FULL_WIDTH + COMPARISON_WIDTH {
            let versus = thread.asked_price().map_or("–".to_owned(), |(_, asked)| {
                let sign = if sold.1 < asked { '-' } else { '+' };
                format!("{sign}{}", dollars_and_cents((sold.1 - asked).abs()))
            });
            text += &format!(" {versus:>9}");
        }
    }
    canvas.draw_text(row, &text, role);
    if let Some(field) = inbox.value_field.as_ref().filter(|_| here) {
        let place = Rect { x: row.x + 14.min(row.width), width: row.width.saturating_sub(14).min(9), ..row };
        field.draw(canvas, place);
        // While the user types, the basis of the value replaces the amounts of the value before the change.
        let typed = OfferTerm { value: parse_number(field.text()).unwrap_or(0.0), ..*term };
        let thread = single.filter(|_| typed.value > 0.0);
        let meaning = typed.describe_value(thread, lists);
        let after = Rect { x: place.right(), width: row.right().saturating_sub(place.right()), ..row };
        canvas.clear(after, role);
        canvas.draw_text(after, &format!(" {meaning}"), role);
    }
}
