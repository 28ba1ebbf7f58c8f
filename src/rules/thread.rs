//! Waiting threads with all fields that rules use.

use std::collections::BTreeMap;

use serde_json::{Value, json};

use super::plan_economics::PlanEconomics;
use super::seat_usage::{SEAT_USAGE_SQL, SeatUsage};
use novamind_base::formatting::json_number;
use novamind_database::{QueryResult, number_at, text_at};
use novamind_session::identifiers::Plan;
use novamind_session::{EnterpriseNames, Session, WaitingThread};
use novamind_tools::{Rejection, ToolId};

/// SQL query for the last messages of enterprises. A thread ends a week after the last message.
pub const LAST_MESSAGES_SQL: &str = include_str!("../../assets/readings/last_letters.sql");

/// The plan that each enterprise named in its latest message, with a price or in a request, by thread number.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RequestedPlans(BTreeMap<u32, Plan>);

impl RequestedPlans {
    /// Reads the rows of [`LAST_MESSAGES_SQL`].
    pub fn from_rows(rows: &QueryResult) -> RequestedPlans {
        let plan = |row: &Vec<novamind_database::Cell>| {
            let plan = other_plan_in(text_at(row, 1), Plan::parse(text_at(row, 2)))?;
            Some((number_at(row, 0) as u32, plan))
        };
        RequestedPlans(rows.rows.iter().filter_map(plan).collect())
    }
}

/// Returns the first plan that a text names.
pub fn first_plan_in(text: &str) -> Option<Plan> {
    plans_in(text).first().copied()
}

/// Returns the first plan that a text names, other than the enterprise's current plan. A request may name both plans.
pub(super) fn other_plan_in(text: &str, present: Option<Plan>) -> Option<Plan> {
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

/// A waiting thread with all fields that rules use.
#[derive(Debug, Clone, PartialEq)]
pub struct ThreadContext {
    /// The thread, as the session lists it.
    pub waiting: WaitingThread,
    /// Plan for which the enterprise named a price or asked for the price.
    pub asked_plan: Option<Plan>,
    /// Quota that covers the usage of all seats, in units per day.
    pub required_quota: Option<f64>,
}

impl ThreadContext {
    /// Collects all fields that rules use, for one waiting thread.
    pub fn new(waiting: &WaitingThread, plans: &RequestedPlans, market: &PlanEconomics) -> ThreadContext {
        let only = || match waiting.last_offer.as_slice() {
            [(plan, _)] if waiting.asked.is_some() => Some(*plan),
            _ => None,
        };
        ThreadContext {
            asked_plan: plans.0.get(&waiting.thread).copied().or_else(only),
            required_quota: market.required_usage(waiting.group, waiting.seats),
            waiting: waiting.clone(),
        }
    }

    /// Returns all waiting threads and the plan data. Runs two queries, which are not recorded.
    ///
    /// # Errors
    /// Returns an error if the database cannot be read.
    pub fn read_all(session: &mut Session) -> Result<(Vec<ThreadContext>, PlanEconomics), Rejection> {
        let plans = RequestedPlans::from_rows(&session.query_unrecorded(LAST_MESSAGES_SQL)?);
        let usage = SeatUsage::from_rows(&session.query_unrecorded(SEAT_USAGE_SQL)?);
        let market = PlanEconomics::from_session(session, usage);
        let waiting = session.company().observe().waiting;
        let threads =
            waiting.iter().map(|waiting_thread| ThreadContext::new(waiting_thread, &plans, &market));
        Ok((threads.collect(), market))
    }

    /// Converts the fields to JSON, including the name of the enterprise.
    pub fn to_json(&self, names: &EnterpriseNames) -> Value {
        let mut row = json!({ "company": names.name(self.waiting.customer) });
        if let (Value::Object(row), Value::Object(fields)) = (&mut row, json!(self.waiting)) {
            row.extend(fields);
            row.insert("asked_plan".to_owned(), json!(self.asked_plan.map(Plan::id)));
            row.insert(
                "needed_quota".to_owned(),
                json!(self.required_quota.map(|units| json_number(units.round()))),
            );
        }
        row
    }
}

pub(super) const RULE_TOOLS: [ToolId; 2] = [ToolId::SendEnterpriseDeal, ToolId::RejectEnterpriseDeal];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn first_plan_in_finds_plans_in_messages() {
        for (text, plan) in [
            ("At $27.34 a seat for plan B we can sign.", Some(Plan::B)),
            ("Plan C, please", Some(Plan::C)),
            ("we plan better; plan A it is", Some(Plan::A)),
            ("we plan a move to plan", Some(Plan::A)),
            ("a plan", None),
            ("plan Bravo", None),
        ] {
            assert_eq!(first_plan_in(text), plan, "{text}");
        }
    }

    #[test]
    fn request_names_a_plan_other_than_the_current_one() {
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
