//! Tools for time and data. The session implements the tools; this module checks their arguments.

mod get_vars;
mod next_week;
mod query;

pub use get_vars::GetVars;
pub use next_week::{FORECAST_KEYS, Forecast, NextWeek, parse_forecasts, parse_rationale};
pub use query::Query;
