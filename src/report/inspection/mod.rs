//! Texts for inspections of hidden state, which plain mode and the console share.

mod breakpoints;
mod command;
mod difference;
mod enterprise;
mod individual;
mod leads;
mod market;
mod number_cleanup;
mod quality;
mod reputation;
mod satisfaction;
mod spillover;
mod streams;
mod writes;

pub use breakpoints::{
    describe_breakpoints, describe_condition_days, describe_condition_history, describe_stop,
};
pub use command::{InspectionCommand, InspectionOutput};
pub use difference::{describe_day_difference, describe_run_difference, difference_to_json};
pub use enterprise::describe_enterprise;
pub use individual::{SATISFACTION_PREFIX, describe_individual};
pub use leads::{describe_lead_equation, factor_line_index};
pub use market::{describe_competitors, describe_drift};
pub use quality::describe_quality;
pub use reputation::describe_reputation;
pub use satisfaction::describe_satisfaction;
pub use spillover::{HEAT_MARKS, SpilloverCell, SpilloverMap, SpilloverRow, describe_spillover};
pub use streams::describe_next_draws;
pub use writes::{describe_source, describe_writes};

use self::number_cleanup::{clean_up_line, clean_up_numbers};
use crate::formatting::pluralize;

/// Prefix of the line that describes the last days of a group.
pub const RECENT_DAYS_PREFIX: &str = "  end of day, last";

/// Describes the range of a figure over the last days. Returns `None` if the figure has no values.
fn describe_recent_days(values: impl Iterator<Item = f64> + Clone) -> Option<String> {
    let days = values.clone().count();
    let (least, most) =
        (values.clone().fold(f64::INFINITY, f64::min), values.fold(f64::NEG_INFINITY, f64::max));
    (days > 0)
        .then(|| format!("{RECENT_DAYS_PREFIX} {}: {least:.4} to {most:.4}", pluralize(days as u32, "day")))
}

fn indented_table(head: &[&str], rows: &[Vec<String>]) -> Vec<String> {
    let rows: Vec<Vec<String>> =
        rows.iter().map(|row| row.iter().map(|cell| clean_up_line(cell)).collect()).collect();
    let wide = |at: usize| rows.iter().filter_map(move |row| row.get(at)).map(|cell| cell.chars().count());
    let width = |at: usize| wide(at).chain([head[at].chars().count()]).max().unwrap_or(0);
    let widths: Vec<usize> = (0..head.len()).map(width).collect();
    let line = |cells: &mut dyn Iterator<Item = &str>| {
        let padded = cells.zip(&widths).map(|(cell, &width)| format!("  {cell:<width$}"));
        padded.collect::<String>().trim_end().to_owned()
    };
    let head = line(&mut head.iter().copied());
    std::iter::once(head).chain(rows.iter().map(|row| line(&mut row.iter().map(String::as_str)))).collect()
}
