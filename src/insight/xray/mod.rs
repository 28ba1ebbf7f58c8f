//! The x-ray: hidden state of debug runs and finished runs (docs/debugging.md).
//!
//! Past days are re-simulated separately from the run and observed. The views show inputs and results of the simulator's functions,
//! never a second calculation. Each inspection is an event of the trajectory.

pub(crate) mod breakpoint;
pub(crate) mod company_day;
pub(crate) mod company_lens;
pub(crate) mod customer_diary;
pub(crate) mod customer_lens;
pub(crate) mod day_end;
pub(crate) mod difference;
pub(crate) mod drift_state;
pub(crate) mod group_views;
pub(crate) mod hidden_day;
pub(crate) mod hidden_rows;
pub(crate) mod hidden_tables;
pub(crate) mod hidden_values;
pub(crate) mod inspector;
pub(crate) mod lead_equation;
pub(crate) mod lens;
pub(crate) mod metrics;
pub(crate) mod next_draws;
pub(crate) mod quality_equation;
pub(crate) mod reputation_equation;
pub(crate) mod rival_state;
pub(crate) mod satisfaction_equation;
pub(crate) mod sql;
pub(crate) mod weighed;
pub(crate) mod writes;

#[cfg(test)]
mod tests;
