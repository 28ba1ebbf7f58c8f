//! The x-ray: hidden state of debug runs and finished runs (docs/debugging.md).
//!
//! Past days are re-simulated and observed in a copy of the run. The views show the inputs and results of the
//! simulator's functions and do not recalculate them. Each inspection is recorded as an event in the trajectory.

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
