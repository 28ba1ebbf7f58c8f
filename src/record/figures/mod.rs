//! Figures of a week: those in its trajectory line, and those that lessons and explanations use.

mod booked;
mod churn;
mod measured_group;
mod simulated_week;
mod week;
mod week_figure;

pub use booked::Booked;
pub use churn::{churn, churn_of_last_week};
pub use measured_group::MeasuredGroup;
pub use simulated_week::{GroupOfWeek, SimulatedWeek};
pub use week::WeekFigures;
pub use week_figure::{FigureUnit, WeekFigure};
