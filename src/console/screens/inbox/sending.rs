//! Sends offers and rejections, and handles the answers.

use std::collections::BTreeSet;

use serde_json::{Value, json};

use super::estimate::plan_economics;
use super::model::{Thread, ThreadState};
use super::{Inbox, list_prices};
use crate::context::Figure;
use crate::effect::Effect;
use novamind_base::formatting::{dollars_and_cents, percent};
use novamind_rules::{OfferLineEconomics, OfferTotals, PlanEconomics};
use novamind_session::identifiers::Plan;
use novamind_tools::{Answer, DealResult, ToolId};
use novamind_tui::text::format_count;
use novamind_worker::company::DisplayedCompany;

const SEND_TOOL: ToolId = ToolId::SendEnterpriseDeal;
const REJECT_TOOL: ToolId = ToolId::RejectEnterpriseDeal;

/// Maximum number of enterprises that a confirmation names.
const MAX_NAMED: usize = 4;

/// A thread with its planned offer, or the reason why no offer is sent.
pub(super) type PlannedOffer<'a> = (&'a Thread, Result<Vec<(Plan, f64)>, String>);

/// Returns the effect that opens a query for the rows of a thread in the SQL editor.
pub(super) fn open_thread_query(thread: &Thread) -> Effect {
    Effect::EditSql(format!(
        "SELECT day, turn_number, sender, message_text, offer_json, seat_count, close_reason\n\
         FROM enterprise_turns WHERE thread_id = {} ORDER BY message_id",
        thread.number
    ))
}

/// Returns a figure of a thread, with a query for the turns of the thread.
pub(super) fn thread_figure(thread: &Thread, what: &str, term: &'static str) -> Figure {
    let sql = match open_thread_query(thread) {
        Effect::EditSql(sql) => Some(sql),
        _ => None,
    };
    Figure { title: format!("{what} {}", thread.customer_label()), term, sql, week_quantity: None }
}

/// Returns the usage of the group on the last day as a figure. The compute estimate uses this figure.
pub(super) fn usage_figure(thread: &Thread) -> Figure {
    let group = &thread.group;
    Figure {
        title: format!("estimated usage of a seat in {group}"),
        term: "usage",
        sql: Some(format!(
            "SELECT u.day, u.customer_id, s.plan, s.seat_count AS seats, u.usage_units AS units\n\
             FROM daily_usage u JOIN subscriptions s USING (customer_id) JOIN customers c USING (customer_id)\n\
             WHERE c.group_id = '{group}' AND s.status = 'subscribed'\n    \
             AND u.day = (SELECT max(day) FROM service_day) ORDER BY units DESC"
        )),
        week_quantity: None,
    }
}

/// Returns the maximum payment of an enterprise for an offer, $ per month.
pub(super) fn max_monthly_revenue(thread: &Thread, offers: &[(Plan, f64)]) -> f64 {
    offers.iter().map(|(_, price)| price * thread.seats).fold(0.0, f64::max)
}

/// Returns revenue and costs of each line of an offer.
pub(super) fn offer_economics(
    thread: &Thread,
    offers: &[(Plan, f64)],
    economics: &PlanEconomics,
) -> Vec<OfferLineEconomics> {
    offers.iter().map(|line| economics.offer_line(&thread.group, thread.seats as u32, *line)).collect()
}

impl Inbox {
    /// Returns the planned offer of every recipient.
    pub(super) fn planned_offers(&self, company: &DisplayedCompany) -> Vec<PlannedOffer<'_>> {
        let (offer, lists) = (self.current_offer(company), list_prices(company));
        self.targets().into_iter().map(|thread| (thread, offer.resolve(thread, lists))).collect()
    }

    /// Sends the offer to all recipients. Asks for confirmation first if necessary.
    pub(super) fn send_offers(&self, company: &DisplayedCompany) -> Vec<Effect> {
        if !company.is_running() {
            return vec![Effect::ShowError("The run is over; no offer will be answered".to_owned())];
        }
        let planned = self.planned_offers(company);
        let sent: Vec<(&Thread, &Vec<(Plan, f64)>)> =
            planned.iter().filter_map(|(thread, offers)| Some((*thread, offers.as_ref().ok()?))).collect();
        let Some((first, offers)) = sent.first() else {
            let why = planned.first().map(|(_, offers)| offers.clone());
            let why = match why {
                Some(Err(why)) => format!("Nothing to send: {why}"),
                _ => "No thread is selected. Press o for other threads.".to_owned(),
            };
            return vec![Effect::ShowError(why)];
        };
        let deal = |(thread, offers): &(&Thread, &Vec<(Plan, f64)>)| {
            let offers: Vec<Value> = offers.iter().map(|(plan, price)| json!([plan.id(), price])).collect();
            json!([thread.customer, offers])
        };
        let arguments = json!({ "deals": sent.iter().map(deal).collect::<Vec<_>>() });
        let economics = plan_economics(company, &self.usage);
        let text = match sent.len() {
            1 => {
                let percentages = self.current_offer(company).describe_percentages(first, list_prices(company));
                single_offer_text(first, offers, percentages, &economics)
            }
            _ => self.bulk_offer_text(&planned, &economics, company),
        };
        vec![Effect::ConfirmCall { tool: SEND_TOOL, arguments, text }]
    }

    /// Describes a bulk offer before it is sent: its terms, its totals, the offers that lose money, and the offers that
    /// it replaces.
    fn bulk_offer_text(
        &self,
        planned: &[PlannedOffer<'_>],
        economics: &PlanEconomics,
        company: &DisplayedCompany,
    ) -> String {
        let terms = self.current_offer(company).describe(list_prices(company));
        let mut lines = vec![
            format!("{}. Each offer uses up a turn.", summary(planned, economics)),
            format!("All receive {terms}."),
        ];
        let losses: Vec<String> = planned.iter().filter_map(|offer| describe_loss(offer, economics)).collect();
        if !losses.is_empty() {
            lines.push(format!("Estimated loss after compute: {}.", list_first(&losses)));
        }
        let replaced: Vec<String> =
            self.replaced_drafts(company).into_iter().map(Thread::customer_label).collect();
        if !replaced.is_empty() {
            lines.push(format!("It replaces what you wrote for {}.", list_first(&replaced)));
        }
        lines.join("\n")
    }

    /// Requests confirmation before the threads are ended.
    pub(super) fn confirm_rejection(&self, company: &DisplayedCompany) -> Vec<Effect> {
        let open: Vec<&Thread> = self.targets().into_iter().filter(|thread| thread.state.is_open()).collect();
        if !company.is_running() || open.is_empty() {
            return vec![Effect::ShowError("No open thread to end".to_owned())];
        }
        let leads = open.iter().filter(|thread| thread.kind == "new_lead");
        let (leads, seats) = leads.fold((0, 0.0), |(count, seats), thread| (count + 1, seats + thread.seats));
        let mut text = String::new();
        if leads > 0 {
            text += &format!(
                "{} with {} {} lost for good and will not ask again. ",
                format_count(leads as f64, "new lead"),
                format_count(seats, "seat"),
                if leads == 1 { "is" } else { "are" },
            );
        }
        let others = open.len() - leads;
        if others > 0 {
            text += &format!(
                "{others} subscriber{} on the current terms; you can open new threads from the next day.",
                if others == 1 { " stays" } else { "s stay" }
            );
        }
        let deals: Vec<Value> = open.iter().map(|thread| json!({ "customer_id": thread.customer })).collect();
        let arguments = json!({ "deals": deals });
        vec![Effect::ConfirmCall { tool: REJECT_TOOL, arguments, text: text.trim_end().to_owned() }]
    }

    /// Clears the drafts and marks of all processed threads.
    pub(super) fn handle_send_result(&mut self, answer: &Answer, company: &DisplayedCompany) -> Vec<Effect> {
        let (offered, results) = match answer {
            Answer::SendEnterpriseDeal(answer) => (true, &answer.results),
            Answer::RejectEnterpriseDeal(answer) => (false, &answer.results),
            _ => return Vec::new(),
        };
        let done: BTreeSet<u32> = results.iter().filter_map(DealResult::sent_customer).collect();
        if offered && self.marked.is_empty() && self.current_offer(company).is_reusable() {
            self.last_offer = self
                .selected_thread()
                .and_then(|thread| self.drafts.get(&thread.number))
                .cloned()
                .or(self.last_offer.take());
        }
        let processed_threads = self.threads.threads.iter().filter(|thread| done.contains(&thread.customer));
        for number in processed_threads.map(|thread| thread.number).collect::<Vec<_>>() {
            if self.marked.remove(&number) && self.marked.is_empty() {
                self.bulk_offer = None;
            }
            self.drafts.remove(&number);
        }
        let failed = results.len() - done.len();
        let (noun, what) = if offered { ("offer", "sent") } else { ("thread", "ended") };
        let succeeded = format!("{} {what}", format_count(done.len() as f64, noun));
        match failed {
            0 => vec![Effect::ShowStatus(succeeded)],
            _ => vec![Effect::ShowError(format!("{succeeded}, {failed} rejected. Press 0 for the reasons."))],
        }
    }
}

/// Describes an offer before it is sent: the prices that the user entered as `percentages`, each line compared with the
/// list price and the compute cost, the asked price, and the effect on the thread.
fn single_offer_text(
    thread: &Thread,
    offers: &[(Plan, f64)],
    percentages: Option<String>,
    economics: &PlanEconomics,
) -> String {
    let mut lines = vec![format!(
        "Offer to {}, {}, {}:",
        thread.customer_label(),
        thread.group,
        format_count(thread.seats, "seat")
    )];
    lines.extend(percentages.map(|text| format!("You entered {text}.")));
    lines.extend(offer_economics(thread, offers, economics).iter().map(OfferLineEconomics::describe));
    if let Some((plan, price)) = thread.asked_price() {
        let plan = plan.map_or(String::new(), |plan| format!(" for plan {plan}"));
        lines.push(format!("It asked {}{plan}.", dollars_and_cents(price)));
    }
    lines.push(match thread.state {
        ThreadState::WaitingForPlayer(_) => "The offer uses up a turn and cannot be taken back.".to_owned(),
        ThreadState::WaitingForCustomer => "It has not answered your last offer yet. The new offer replaces your last \
                                            offer and uses up another turn."
            .to_owned(),
        _ => "Its thread is closed. For a subscriber, the offer opens a new thread; if the new thread fails, the \
              subscription ends."
            .to_owned(),
    });
    lines.join("\n")
}

/// Describes the lines of an offer whose estimated compute cost exceeds the payment, or returns `None` if there are none.
fn describe_loss((thread, offers): &PlannedOffer<'_>, economics: &PlanEconomics) -> Option<String> {
    let lines = offer_economics(thread, offers.as_ref().ok()?, economics);
    let loss = |line: &OfferLineEconomics| {
        let margin = line.margin().filter(|margin| *margin < 0.0)?;
        Some(format!("{} {} ({})", line.plan, dollars_and_cents(line.price), percent(margin, 0)))
    };
    let losses: Vec<String> = lines.iter().filter_map(loss).collect();
    (!losses.is_empty()).then(|| format!("{} {}", thread.customer_label(), losses.join(", ")))
}

/// Lists the first items, and counts the rest.
fn list_first(items: &[String]) -> String {
    let shown = items[..items.len().min(MAX_NAMED)].join("; ");
    match items.len().saturating_sub(MAX_NAMED) {
        0 => shown,
        more => format!("{shown}; and {more} more"),
    }
}

/// Describes the totals of the planned offers in one line.
pub(super) fn summary(planned: &[PlannedOffer<'_>], economics: &PlanEconomics) -> String {
    let mut totals = OfferTotals::default();
    for (thread, offers) in planned {
        match offers {
            Ok(offers) => totals.add_offer(&offer_economics(thread, offers, economics), thread.seats as u32),
            Err(_) => totals.skipped += 1,
        }
    }
    totals.describe(false)
}
