//! Rules that answer enterprises (docs/interfaces/rules.md), with one grammar for the console and plain mode. Rules
//! send nothing themselves: they produce ordinary calls of the two tools for deals.
//!
//! `grammar` parses rules, `condition` matches threads, `filter` parses conditions alone, `thread` contains the
//! fields of a thread, `batch` applies rules to all threads, and `offer_row` reads offers from database rows.
//! Conditions use only data that is visible to players.

mod batch;
mod condition;
mod filter;
mod grammar;
mod offer_row;
mod thread;
mod usage;

pub use batch::{Batch, RuledThread, answers_to_companies};
pub use filter::Filter;
pub use grammar::{Problem, Rule, parse};
pub use offer_row::offer_of;
pub use thread::{AskingThread, LAST_LETTERS, Letters, Market, plan_in};
pub use usage::{SEAT_USAGE, SeatUsage};
