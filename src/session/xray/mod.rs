//! The x-ray: hidden state of debug runs, and of runs that are over (docs/debugging.md).
//!
//! Past days are simulated again beside the run, and watched on the way: what is shown is what the functions of the
//! world were given and what they said, never a second calculation. Each look is a line of the trajectory.

pub(in crate::session) mod breakpoint;
pub(in crate::session) mod company_day;
pub(in crate::session) mod company_lens;
pub(in crate::session) mod customer_diary;
pub(in crate::session) mod customer_lens;
pub(in crate::session) mod day_end;
pub(in crate::session) mod difference;
pub(in crate::session) mod drift_state;
pub(in crate::session) mod group_views;
pub(in crate::session) mod hidden_day;
pub(in crate::session) mod hidden_rows;
pub(in crate::session) mod hidden_tables;
pub(in crate::session) mod hidden_values;
pub(in crate::session) mod last_day;
pub(in crate::session) mod lead_equation;
pub(in crate::session) mod lens;
pub(in crate::session) mod measured_group;
pub(in crate::session) mod metrics;
pub(in crate::session) mod mood;
pub(in crate::session) mod next_draws;
pub(in crate::session) mod permission;
pub(in crate::session) mod quality_equation;
pub(in crate::session) mod reputation_equation;
pub(in crate::session) mod rival_state;
pub(in crate::session) mod satisfaction_equation;
pub(in crate::session) mod shadow;
pub(in crate::session) mod sql;
pub(in crate::session) mod weighed;
pub(in crate::session) mod writes;

#[cfg(test)]
mod tests;
