//! The x-ray: hidden state of debug runs, and of runs that are over (docs/debugging.md).
//!
//! Past days are simulated again beside the run, and watched on the way: what is shown is what the functions of the
//! world were given and what they said, never a second calculation. Each look is a line of the trajectory.

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
