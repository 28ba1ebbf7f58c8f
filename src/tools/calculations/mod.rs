//! Calculations: named SQL statements or Python that run before every week, for the dashboard.

mod list_daily_calculations;
mod register_daily_calculation;
mod remove_daily_calculation;

pub use list_daily_calculations::ListDailyCalculations;
pub use register_daily_calculation::RegisterDailyCalculation;
pub use remove_daily_calculation::RemoveDailyCalculation;

use super::notebook::{Kept, NamedStatements};
use super::refusal::Refusal;
use super::view::View;

fn kept<'a>(view: &View<'a>) -> &'a NamedStatements {
    view.surroundings().notebook().statements(Kept::Calculation)
}

fn not_found(name: &str, view: &View<'_>) -> Refusal {
    let names = kept(view).names();
    let known = if names.is_empty() {
        "none is registered".to_owned()
    } else {
        format!("registered: {}", names.join(", "))
    };
    Refusal::at("name", "calculation_not_found", format!("calculation {name} does not exist; {known}"))
}
