//! Time and data: the tools whose work is done by the session itself, and the checks of a week's forecasts.

mod get_vars;
mod next_week;
mod query;

pub use get_vars::GetVars;
pub use next_week::{FORECAST_KEYS, Forecast, NextWeek, forecasts, rationale};
pub use query::Query;
