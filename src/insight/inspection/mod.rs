//! The x-ray: hidden state of debug runs and finished runs (docs/debugging.md).
//!
//! Past days are re-simulated separately from the run and observed. The views show inputs and results of the simulator's functions,
//! never a second calculation. Each inspection is an event of the trajectory.

pub(crate) mod breakpoint;
pub(crate) mod competitor_state;
pub(crate) mod customer_view;
pub(crate) mod day_end;
pub(crate) mod day_replay;
pub(crate) mod difference;
pub(crate) mod drift_state;
pub(crate) mod enterprise_thread_day;
pub(crate) mod enterprise_view;
pub(crate) mod group_views;
pub(crate) mod hidden_day;
pub(crate) mod hidden_query;
pub(crate) mod hidden_rows;
pub(crate) mod hidden_tables;
pub(crate) mod hidden_values;
pub(crate) mod individual_recorder;
pub(crate) mod individual_view;
pub(crate) mod inspector;
pub(crate) mod lead_equation;
pub(crate) mod next_draws;
pub(crate) mod quality_equation;
pub(crate) mod reputation_equation;
pub(crate) mod satisfaction_equation;
pub(crate) mod weighed_decision;
pub(crate) mod writes;

#[cfg(test)]
mod tests;
