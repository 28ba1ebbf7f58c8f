//! Calculations: named SQL statements or Python that run before every week, for the dashboard.

mod list_daily_calculations;
mod register_daily_calculation;
mod remove_daily_calculation;

pub use list_daily_calculations::ListDailyCalculations;
pub use register_daily_calculation::RegisterDailyCalculation;
pub use remove_daily_calculation::RemoveDailyCalculation;

use super::notebook::{NamedStatements, NotebookSection};
use super::rejection::Rejection;
use super::tool_context::ToolContext;

fn calculations<'a>(view: &ToolContext<'a>) -> &'a NamedStatements {
    view.session().notebook().statements(NotebookSection::Calculation)
}

fn not_found_rejection(name: &str, view: &ToolContext<'_>) -> Rejection {
    let names = calculations(view).names();
    let known = if names.is_empty() {
        "none is registered".to_owned()
    } else {
        format!("registered: {}", names.join(", "))
    };
    Rejection::for_field(
        "name",
        "calculation_not_found",
        format!("calculation {name} does not exist; {known}"),
    )
}
