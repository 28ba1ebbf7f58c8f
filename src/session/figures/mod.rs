//! What a player sees of a run, in figures: at a glance, by week and by group, what was decided, and what is expected.

pub(crate) mod alike_plans;
pub(crate) mod attendance;
pub(crate) mod attended_week;
pub(crate) mod best_channels;
pub(crate) mod capacity_by_usage;
pub(crate) mod changes;
pub(crate) mod dashboard;
pub(crate) mod estimates;
pub(crate) mod groups;
pub(crate) mod journal;
pub(crate) mod mood;
pub(crate) mod naive;
pub(crate) mod notices;
pub(crate) mod observe;
pub(crate) mod pace;
pub(crate) mod research_outlook;
pub(crate) mod scored_forecast;
pub(crate) mod setting;
pub(crate) mod sitting_count;
pub(crate) mod tool_limits;
pub(crate) mod truth;
pub(crate) mod week;
