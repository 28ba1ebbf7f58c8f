//! Rules that answer companies: one grammar for the console and plain mode, and what every waiting thread would be sent
//! by it (docs/interfaces/rules.md). Rules send nothing: they become ordinary calls of the two tools for deals.
//!
//! `grammar` reads rules, `condition` says whom one means, `filter` takes conditions alone, `thread` is what rules see of
//! a thread, `batch` is what all threads get, `offer_row` reads the offers of the rows. Everything a rule asks is what the
//! tables and tools tell every player.

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
