//! Rules that answer enterprises (docs/interfaces/rules.md). The console and plain mode use the same grammar. Rules do
//! not send replies themselves: they produce ordinary calls of the two tools for deals.
//!
//! `grammar` parses rules, `condition` matches threads, and `filter` parses conditions that are not part of a rule.
//! `thread` contains the fields of a waiting thread, and `batch` applies rules to all waiting threads.
//! `plan_economics` computes what an offer earns, `turn` parses turns of any thread, and `lost_thread` collects what
//! the record shows about a thread that ended without a deal. All modules use only data that is visible to players.

mod batch;
mod condition;
mod filter;
mod grammar;
mod lost_thread;
mod offer_row;
mod plan_economics;
mod seat_usage;
mod thread;
mod turn;

pub use batch::{RuleBatch, RuleOutcome, calls_for_waiting_threads};
pub use filter::Filter;
pub use grammar::{Rule, RuleError, parse};
pub use lost_thread::{LossCause, LostThread, MIN_TURNS_PARAMETER, Subscription};
pub use plan_economics::{OfferLineEconomics, OfferTotals, PlanEconomics};
pub use seat_usage::{SEAT_USAGE_SQL, SeatUsage};
pub use thread::{LAST_MESSAGES_SQL, RequestedPlans, ThreadContext, first_plan_in};
pub use turn::{Turn, format_offer_lines};
