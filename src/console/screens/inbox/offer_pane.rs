//! The offer being edited: terms, value and notes.

use crossterm::event::KeyEvent;
use ratatui::layout::Rect;

use super::estimate::{Money, per_seat};
use super::model::Thread;
use super::offer::{Offer, TERMS, TermChoice};
use super::post::{self, summary};
use super::{Inbox, list_prices};
use crate::action::{Action, Scope};
use crate::context::{Figure, Look};
use crate::effect::Effect;
use crate::screens::panes::{Border, Pane, Seat};
use novamind_base::notation::{cents, dollars, grouped, percent};
use novamind_session::identifiers::Plan;
use novamind_tui::canvas::{Canvas, Click, rows_of};
use novamind_tui::text::wrapped;
use novamind_tui::theme::Role;
use novamind_tui::widgets::Field;
use novamind_tui::widgets::field::ONLY_NUMBERS;

/// Width at which a line of the offer has all its columns.
pub const WORTH: u16 = 59;

/// Additional width for the comparison with the asking price.
const VERSUS: u16 = 10;

pub struct OfferPane;

impl Pane<Inbox> for OfferPane {
    fn scopes(&self, inbox: &Inbox) -> Vec<Scope> {
        match (&inbox.typing, &inbox.ruling) {
            (_, Some(ruling)) if !ruling.typing => vec![Scope::Inbox, Scope::List],
            (Some(_), _) | (_, Some(_)) => vec![Scope::Field, Scope::Inbox],
            (None, None) => vec![Scope::Inbox, Scope::List],
        }
    }

    fn hints(&self, inbox: &Inbox) -> Vec<Action> {
        match (&inbox.typing, &inbox.ruling) {
            (_, Some(ruling)) if !ruling.typing => vec![Action::InboxRules, Action::SendOffer, Action::Close],
            (Some(_), _) | (_, Some(_)) => vec![Action::Commit, Action::SendOffer, Action::Discard],
            (None, None) => super::OFFER_HINTS.to_vec(),
        }
    }

    fn figure(&self, inbox: &Inbox, _: &Look<'_>) -> Option<Figure> {
        inbox.here().map(post::usage_figure)
    }

    fn act(&self, inbox: &mut Inbox, action: Action, look: &Look<'_>) -> Vec<Effect> {
        match action {
            Action::Up | Action::CommitPrevious => inbox.term = inbox.term.saturating_sub(1),
            Action::Down | Action::CommitDown | Action::CommitNext => {
                inbox.term = (inbox.term + 1).min(TERMS - 1);
            }
            Action::First => inbox.term = 0,
            Action::Last => inbox.term = TERMS - 1,
            Action::Open => inbox.type_value(),
            Action::Right => inbox.turn_plan(),
            Action::Left => inbox.turn_basis(list_prices(look.company)),
            Action::Close => inbox.focus = inbox.first_pane(),
            _ => {}
        }
        Vec::new()
    }

    fn key(&self, inbox: &mut Inbox, key: &KeyEvent, look: &Look<'_>) -> Vec<Effect> {
        if inbox.ruling.is_some() {
            inbox.rules_key(key, look.company);
            return Vec::new();
        }
        let taken = inbox.typing.as_mut().is_none_or(|field| field.number_key(key));
        if taken { Vec::new() } else { vec![Effect::Complain(ONLY_NUMBERS.to_owned())] }
    }

    fn paste(&self, inbox: &mut Inbox, text: &str, look: &Look<'_>) -> Vec<Effect> {
        match inbox.ruling {
            Some(_) => inbox.type_rules(look.company, &mut |field| field.insert(text)),
            None => self.filter(inbox, &mut |field| field.insert(text)),
        }
        Vec::new()
    }

    fn filter(&self, inbox: &mut Inbox, edit: &mut dyn FnMut(&mut Field)) {
        if let Some(field) = &mut inbox.typing {
            edit(field);
        }
    }

    fn click(&self, inbox: &mut Inbox, row: usize, _: &Look<'_>) -> Vec<Effect> {
        let again = inbox.term == row;
        inbox.term = row.min(TERMS - 1);
        if again {
            inbox.type_value();
        }
        Vec::new()
    }

    fn border(&self, inbox: &Inbox, _: Rect, look: &Look<'_>) -> Border {
        if inbox.ruling.is_some() {
            return inbox.rules_border(look);
        }
        let title = match inbox.marked.len() {
            0 => "Your offer".to_owned(),
            marked => format!("Bulk offer for {marked}"),
        };
        let shown = inbox.here().is_some() || !inbox.marked.is_empty();
        let keys = [Action::OfferPlan, Action::OfferBasis, Action::SendOffer];
        let keys = if shown { look.hints(&keys) } else { String::new() };
        Border { title, keys, ..Border::default() }
    }

    fn draw(&self, inbox: &Inbox, canvas: &mut Canvas<'_>, seat: Seat, look: &Look<'_>) {
        if let Some(ruling) = &inbox.ruling {
            return inbox.draw_rules(ruling, canvas, seat);
        }
        let (inside, batch) = (seat.area, !inbox.marked.is_empty());
        if inbox.here().is_none() && !batch {
            return;
        }
        let offer = inbox.offer();
        let mut rows = rows_of(inside);
        if let Some(row) = rows.next() {
            canvas.text(row, &head(inside.width, batch), Role::Header);
        }
        for at in 0..offer.0.len() {
            let Some(row) = rows.next() else { return };
            draw_term(inbox, canvas, Seat { area: row, ..seat }, &offer, at, look);
        }
        rows.next();
        for (row, (text, role)) in rows.zip(notes(inbox, inside.width, look)) {
            canvas.text(row, &text, role);
        }
    }
}

/// Returns the column headings that fit.
fn head(width: u16, batch: bool) -> String {
    let mut worth = if batch { String::new() } else { format!(" {:>8} {:>9}", "per seat", "per mo.") };
    if !batch && width >= WORTH {
        worth += &format!(" {:>9} {:>7}", "compute", "margin");
    }
    if !batch && width >= WORTH + VERSUS {
        worth += &format!(" {:>9}", "vs. ask");
    }
    format!("plan   of     {:>8}{worth}", "value")
}

fn notes(inbox: &Inbox, width: u16, look: &Look<'_>) -> Vec<(String, Role)> {
    let planned = inbox.planned(look.company);
    let mut notes = match planned.first() {
        _ if !inbox.marked.is_empty() => {
            let lines = wrapped(&summary(&planned), width as usize).into_iter();
            lines.map(|line| (line, Role::Strong)).collect()
        }
        Some((_, Err(why))) => vec![(format!("can't send: {why}"), Role::Warning)],
        Some((thread, Ok(offers))) => offer_notes(inbox, thread, offers, width, look),
        None => Vec::new(),
    };
    let lists = list_prices(look.company);
    let list = ["A", "B", "C"].iter().zip(lists).map(|(plan, price)| format!("{plan} {}", cents(price)));
    notes.push((format!("list {}", list.collect::<Vec<_>>().join(" · ")), Role::Dim));
    notes
}

/// Returns the notes on an offer, most important first: quota shortfalls, the asking price, and the basis of
/// the compute estimate, or the estimate itself if its columns do not fit.
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
        let wanted = grouped(wanted, 0);
        let text = match width >= WORTH {
            true => format!("! {plan}: quota {quota} covers {share} of {wanted} units a day"),
            false => format!("! {plan}: quota covers {share} of {wanted} a day"),
        };
        notes.push((text, Role::Warning));
    }
    if let Some((_, price)) = thread.asked() {
        let best = offers.iter().map(|(_, own)| own - price).fold(f64::INFINITY, f64::min);
        let sign = if best < 0.0 { "-" } else { "+" };
        notes.push((format!("asking price {}; yours {sign}{}", cents(price), cents(best.abs())), Role::Text));
    }
    let Some((units, source)) = per_seat(&inbox.usage, look.company, &thread.group) else {
        notes.push(("compute unknown: the group has no usage yet".to_owned(), Role::Dim));
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

fn draw_term(inbox: &Inbox, canvas: &mut Canvas<'_>, seat: Seat, offer: &Offer, at: usize, look: &Look<'_>) {
    let row = seat.area;
    let lists = list_prices(look.company);
    let term = &offer.0[at];
    let here = seat.focused && inbox.term == at;
    let role = match (here, term.plan) {
        (true, _) => Role::Selection,
        (false, TermChoice::Nothing) => Role::Dim,
        (false, _) => Role::Text,
    };
    canvas.clear(row, role);
    canvas.click(row, Click::Row(seat.number, at));
    let value = if term.plan == TermChoice::Nothing && !here { String::new() } else { term.value_in_words() };
    let basis = if term.plan == TermChoice::Nothing && !here { "" } else { term.basis.words() };
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
