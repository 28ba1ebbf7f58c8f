//! Data that rules use: waiting threads and the plans on sale.

use std::collections::BTreeMap;

use serde_json::{Value, json};

use super::usage::{SEAT_USAGE, SeatUsage};
use novamind_base::notation::json_number;
use novamind_database::{Rows, number_at, text_at};
use novamind_session::identifiers::{Group, Plan};
use novamind_session::{CompanyNames, Session, WaitingThread};
use novamind_tools::{Refusal, ToolId};

/// Query for the last messages of enterprises. A thread ends a week after its last message.
pub const LAST_LETTERS: &str = include_str!("../../assets/readings/last_letters.sql");

const MONTH: f64 = 30.0;

/// The plan that enterprises named in their latest message, by thread: with a price, or as a wish.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Letters(BTreeMap<u32, Plan>);

impl Letters {
    /// Reads the rows of [`LAST_LETTERS`].
    pub fn read(rows: &Rows) -> Letters {
        let plan = |row: &Vec<novamind_database::Cell>| {
            let plan = other_plan_in(text_at(row, 1), Plan::parse(text_at(row, 2)))?;
            Some((number_at(row, 0) as u32, plan))
        };
        Letters(rows.rows.iter().filter_map(plan).collect())
    }
}

/// Returns the first plan that a text names.
pub fn plan_in(text: &str) -> Option<Plan> {
    plans_in(text).first().copied()
}

/// Returns the first plan that a text names other than the enterprise's current one, because a wish may name both.
fn other_plan_in(text: &str, present: Option<Plan>) -> Option<Plan> {
    plans_in(text).into_iter().find(|plan| Some(*plan) != present)
}

fn plans_in(text: &str) -> Vec<Plan> {
    let lower = text.to_lowercase();
    let named = |(at, _): (usize, &str)| {
        let mut rest = lower[at + 5..].chars();
        let letter = rest.next()?.to_ascii_uppercase().to_string();
        let ends = rest.next().is_none_or(|next| !next.is_alphanumeric());
        Plan::parse(&letter).filter(|_| ends)
    };
    lower.match_indices("plan ").filter_map(named).collect()
}

/// Plans on sale and the usage of a seat.
#[derive(Debug, Clone, Default)]
pub struct Market {
    /// List prices, dollars a month.
    pub lists: [f64; 3],
    /// Quotas, units a day and customer.
    pub quotas: [f64; 3],
    /// Compute cost, dollars a unit.
    pub unit_costs: [f64; 3],
    /// Measured usage.
    pub usage: SeatUsage,
    /// Usage estimated by the last study, units a day and seat.
    pub studied: BTreeMap<Group, f64>,
}

impl Market {
    /// Returns the plans and usage of a run today.
    pub fn of(session: &Session, usage: SeatUsage) -> Market {
        let (core, terms) = (&session.settings().core, session.company().tool_limits());
        let unit_cost = |plan: Plan| {
            let model = terms.models.iter().find(|model| model.tier == core.tiers[plan]);
            model.map_or(0.0, |model| model.unit_cost)
        };
        let studied = session.company().estimates().into_iter().map(|own| (own.group, own.usage)).collect();
        Market {
            lists: Plan::ALL.map(|plan| core.prices[plan]),
            quotas: Plan::ALL.map(|plan| core.quotas[plan].units()),
            unit_costs: Plan::ALL.map(unit_cost),
            usage,
            studied,
        }
    }

    /// Returns the usage of all seats of an enterprise, units a day.
    pub fn wanted(&self, group: &str, seats: u32) -> Option<f64> {
        let studied = || Group::parse(group).and_then(|group| self.studied.get(&group)).copied();
        self.usage.measured(group).or_else(studied).map(|units| units * f64::from(seats))
    }

    /// Returns the compute cost of an enterprise on a plan, dollars a month. All its seats share one quota.
    pub fn compute(&self, plan: Plan, wanted: f64) -> f64 {
        wanted.min(self.quotas[plan as usize]) * MONTH * self.unit_costs[plan as usize]
    }
}

/// A waiting thread with all fields that rules use.
#[derive(Debug, Clone, PartialEq)]
pub struct AskingThread {
    /// The thread in the session.
    pub waiting: WaitingThread,
    /// Plan that the enterprise named with its price, or whose price it asked for.
    pub asked_plan: Option<Plan>,
    /// Usage of all its seats, units a day: the quota that covers them.
    pub needed_quota: Option<f64>,
}

impl AskingThread {
    /// Collects the fields of a waiting thread.
    pub fn of(waiting: &WaitingThread, letters: &Letters, market: &Market) -> AskingThread {
        let only = || match waiting.last_offer.as_slice() {
            [(plan, _)] if waiting.asked.is_some() => Some(*plan),
            _ => None,
        };
        AskingThread {
            asked_plan: letters.0.get(&waiting.thread).copied().or_else(only),
            needed_quota: market.wanted(waiting.group, waiting.seats),
            waiting: waiting.clone(),
        }
    }

    /// Returns all waiting threads and the plans on sale. Runs two queries, which are not recorded.
    ///
    /// # Errors
    /// Returns an error if the database cannot be read.
    pub fn all(session: &mut Session) -> Result<(Vec<AskingThread>, Market), Refusal> {
        let letters = Letters::read(&session.look_into_database(LAST_LETTERS)?);
        let usage = SeatUsage::read(&session.look_into_database(SEAT_USAGE)?);
        let market = Market::of(session, usage);
        let waiting = session.company().observe().waiting;
        let threads = waiting.iter().map(|own| AskingThread::of(own, &letters, &market));
        Ok((threads.collect(), market))
    }

    /// Returns the fields as JSON, with the name of the enterprise.
    pub fn row(&self, names: &CompanyNames) -> Value {
        let mut row = json!({ "company": names.of(self.waiting.customer) });
        if let (Value::Object(row), Value::Object(fields)) = (&mut row, json!(self.waiting)) {
            row.extend(fields);
            row.insert("asked_plan".to_owned(), json!(self.asked_plan.map(Plan::id)));
            row.insert(
                "needed_quota".to_owned(),
                json!(self.needed_quota.map(|units| json_number(units.round()))),
            );
        }
        row
    }
}

pub(super) const TOOLS: [ToolId; 2] = [ToolId::SendEnterpriseDeal, ToolId::RejectEnterpriseDeal];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plans_are_found_in_words() {
        for (text, plan) in [
            ("At $27.34 a seat for plan B we can sign.", Some(Plan::B)),
            ("Plan C, please", Some(Plan::C)),
            ("we plan better; plan A it is", Some(Plan::A)),
            ("we plan a move to plan", Some(Plan::A)),
            ("a plan", None),
            ("plan Bravo", None),
        ] {
            assert_eq!(plan_in(text), plan, "{text}");
        }
    }

    #[test]
    fn a_wish_names_the_plan_that_the_company_does_not_have() {
        for (text, present, plan) in [
            ("We think of plan A rather than plan B for our 78 seats.", Some(Plan::B), Some(Plan::A)),
            ("Our 210 seats do not need all of plan C; what about plan B?", Some(Plan::C), Some(Plan::B)),
            ("What would plan C cost for our 60 seats?", Some(Plan::A), Some(Plan::C)),
            ("At $20.00 a seat for plan B we can sign.", None, Some(Plan::B)),
            ("It may be time for another plan.", Some(Plan::A), None),
        ] {
            assert_eq!(other_plan_in(text, present), plan, "{text}");
        }
    }
}
