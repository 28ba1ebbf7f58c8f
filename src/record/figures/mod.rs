//! Figures of a week: figures in the trajectory line of the week, and figures for lessons and explanations.

mod category_totals;
mod churn;
mod group_figures;
mod simulated_week;
mod week;
mod week_figure;

pub use category_totals::CategoryTotals;
pub use churn::{churn, last_week_churn};
pub use group_figures::GroupFigures;
pub use simulated_week::{SimulatedWeek, WeekGroupFigures};
pub use week::WeekFigures;
pub use week_figure::{FigureUnit, WeekFigure};
