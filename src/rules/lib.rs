//! Rules that answer enterprises (docs/interfaces/rules.md). The console and plain mode use the same grammar. Rules do
//! not send replies themselves: they produce ordinary calls of the two tools for deals.
//!
//! `grammar` parses rules, `condition` matches threads, and `filter` parses conditions without a rule. `thread`
//! contains the fields of a thread, `batch` applies rules to all threads, and `offer_row` parses offers in database rows.
//! Conditions use only data that is visible to players.

mod batch;
mod condition;
mod filter;
mod grammar;
mod offer_row;
mod seat_usage;
mod thread;

pub use batch::{RuleBatch, RuleOutcome, calls_for_waiting_threads};
pub use filter::Filter;
pub use grammar::{Rule, RuleError, parse};
pub use offer_row::parse_offer;
pub use seat_usage::{SEAT_USAGE_SQL, SeatUsage};
pub use thread::{LAST_MESSAGES_SQL, PlanEconomics, RequestedPlans, ThreadContext, first_plan_in};
