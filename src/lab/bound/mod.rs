//! The paper's upper-bound account, computed line by line from the current parameters (docs/laboratory/bound.md).

mod account;
mod account_line;
mod acquisition_costs;
mod assumptions;
mod attainable_market;
mod differences;
mod improvement_costs;
mod operating_costs;
#[cfg(test)]
mod page_tests;
mod renewals;
mod report;
mod required_quality;
mod research_costs;
mod shared_quality;
mod targeted_development;

pub use account::{BoundAccount, SensitivityRow, sensitivity};
pub use account_line::AccountLine;
pub use assumptions::BoundAssumptions;
pub use report::bound_report;
