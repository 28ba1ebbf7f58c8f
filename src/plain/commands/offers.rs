//! Notes on offers to enterprises: the price compared with the list price, the asked price and the compute cost.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::Value;

use super::Interpreter;
use super::inbox::describe_request;
use novamind_database::{number_at, text_at};
use novamind_report::deals::parse_deal;
use novamind_rules::{OfferLineEconomics, OfferTotals, ThreadContext};
use novamind_session::identifiers::{Group, Plan};
use novamind_tools::{Answer, DealResult, ToolId};

/// An offer to one enterprise that is not sent yet.
struct PlannedOffer {
    customer: u32,
    seats: u32,
    lines: Vec<OfferLineEconomics>,
    /// What the enterprise asked for.
    request: Option<String>,
}

/// The offers of a call, read before the call is executed, because afterwards the threads no longer wait for
/// the player.
#[derive(Default)]
pub(super) struct PlannedOffers(Vec<PlannedOffer>);

impl Interpreter {
    /// Returns the offers in the arguments of a call. Offers that cannot be read are omitted.
    pub(super) fn planned_offers(&mut self, tool: ToolId, arguments: &Value) -> PlannedOffers {
        let deals = arguments.get("deals").and_then(Value::as_array);
        let Some(deals) = deals.filter(|_| tool == ToolId::SendEnterpriseDeal) else {
            return PlannedOffers::default();
        };
        let deals: Vec<(u32, Vec<(Plan, f64)>)> = deals.iter().filter_map(read_deal).collect();
        let Ok((waiting, economics)) = ThreadContext::read_all(&mut self.session) else {
            return PlannedOffers::default();
        };
        let waiting: BTreeMap<u32, ThreadContext> =
            waiting.into_iter().map(|thread| (thread.waiting.customer, thread)).collect();
        let others: Vec<u32> = deals
            .iter()
            .map(|(customer, _)| *customer)
            .filter(|customer| !waiting.contains_key(customer))
            .collect();
        let others = self.groups_and_seats(&others);
        let offer = |(customer, lines): &(u32, Vec<(Plan, f64)>)| {
            let thread = waiting.get(customer);
            let (group, seats) = match thread {
                Some(thread) => (thread.waiting.group, thread.waiting.seats),
                None => others.get(customer).copied()?,
            };
            let lines = lines.iter().map(|line| economics.offer_line(group, seats, *line)).collect();
            Some(PlannedOffer {
                customer: *customer,
                seats,
                lines,
                request: thread.and_then(describe_request),
            })
        };
        PlannedOffers(deals.iter().filter_map(offer).collect())
    }

    /// Returns the group and the seats of subscribed enterprises whose threads do not wait for the player.
    fn groups_and_seats(&mut self, customers: &[u32]) -> BTreeMap<u32, (&'static str, u32)> {
        if customers.is_empty() {
            return BTreeMap::new();
        }
        let list = customers.iter().map(u32::to_string).collect::<Vec<_>>().join(", ");
        let mut rows =
            |sql: String| self.session.query_unrecorded(&sql).map(|found| found.rows).unwrap_or_default();
        // Seats are queried separately, because queries that name the table of customers have no column of
        // seats.
        let seats =
            rows(format!("SELECT customer_id, seat_count FROM subscriptions WHERE customer_id IN ({list})"));
        let groups =
            rows(format!("SELECT customer_id, group_id FROM customers WHERE customer_id IN ({list})"));
        let seats: BTreeMap<u32, u32> =
            seats.iter().map(|row| (number_at(row, 0) as u32, number_at(row, 1) as u32)).collect();
        let found = groups.iter().filter_map(|row| {
            let customer = number_at(row, 0) as u32;
            Some((customer, (Group::parse(text_at(row, 1))?.id(), *seats.get(&customer)?)))
        });
        found.collect()
    }

    /// Describes the offers: one line for each plan of a single offer, otherwise the totals.
    pub(super) fn describe_offers(&self, planned: &PlannedOffers) -> Vec<String> {
        let names = self.session.company().enterprise_names();
        match planned.0.as_slice() {
            [] => Vec::new(),
            [single] => {
                let name = names.name_with_number(single.customer);
                let line = |line: &OfferLineEconomics| format!("{name}, {}", line.describe());
                let request = single.request.iter().map(|request| format!("{name} {request}"));
                single.lines.iter().map(line).chain(request).collect()
            }
            several => {
                let mut totals = OfferTotals::default();
                several.iter().for_each(|offer| totals.add_offer(&offer.lines, offer.seats));
                vec![totals.describe(false)]
            }
        }
    }
}

impl PlannedOffers {
    /// Returns the offers that were sent, according to an answer.
    pub(super) fn sent_in(self, answer: &Answer) -> PlannedOffers {
        let Answer::SendEnterpriseDeal(answer) = answer else { return PlannedOffers::default() };
        let sent: BTreeSet<u32> = answer.results.iter().filter_map(DealResult::sent_customer).collect();
        PlannedOffers(self.0.into_iter().filter(|offer| sent.contains(&offer.customer)).collect())
    }
}

fn read_deal(deal: &Value) -> Option<(u32, Vec<(Plan, f64)>)> {
    let (customer, offerings) = parse_deal(deal)?;
    let lines: Option<Vec<(Plan, f64)>> =
        offerings.into_iter().map(|(plan, price)| Some((Plan::parse(plan)?, price))).collect();
    Some((customer, lines?))
}
