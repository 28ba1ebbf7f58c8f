//! Time and data: tools that the session implements, and the checks of forecasts.

mod get_vars;
mod next_week;
mod query;

pub use get_vars::GetVars;
pub use next_week::{FORECAST_KEYS, Forecast, NextWeek, parse_forecasts, parse_rationale};
pub use query::Query;
