//! Figures of a company as plain data, and the functions that compute them: weeks, groups, decisions, forecasts,
//! estimates and presence. This module does not read runs or files.

pub(crate) mod attendance;
pub(crate) mod capacity_by_usage;
pub(crate) mod changes;
pub(crate) mod dashboard;
pub(crate) mod estimates;
pub(crate) mod groups;
pub(crate) mod journal;
pub(crate) mod outlook;
pub(crate) mod scored_forecast;
pub(crate) mod session_count;
pub(crate) mod setting;
pub(crate) mod week;
