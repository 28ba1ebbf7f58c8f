//! What a player sees of a run, in figures: at a glance, by week and by group, what was decided, and what is expected.

pub(in crate::session) mod alike_plans;
pub(in crate::session) mod attendance;
pub(in crate::session) mod attended_week;
pub(in crate::session) mod best_channels;
pub(in crate::session) mod booked;
pub(in crate::session) mod capacity_by_usage;
pub(in crate::session) mod changes;
pub(in crate::session) mod churn;
pub(in crate::session) mod dashboard;
pub(in crate::session) mod estimates;
pub(in crate::session) mod groups;
pub(in crate::session) mod journal;
pub(in crate::session) mod naive;
pub(in crate::session) mod notices;
pub(in crate::session) mod observe;
pub(in crate::session) mod pace;
pub(in crate::session) mod research_outlook;
pub(in crate::session) mod scored_forecast;
pub(in crate::session) mod setting;
pub(in crate::session) mod sitting_count;
pub(in crate::session) mod tool_limits;
pub(in crate::session) mod truth;
pub(in crate::session) mod week;
