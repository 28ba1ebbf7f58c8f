//! Text for inspections of hidden state, shared by plain mode and the console.

mod asked;
mod breakpoints;
mod company;
mod customer;
mod difference;
mod leads;
mod market;
mod quality;
mod reputation;
mod satisfaction;
mod settled;
mod spillover;
mod streams;
mod writes;

pub use asked::{AskedWords, WordsFound};
pub use breakpoints::{breakpoints_in_words, found_in_words, look_back_in_words, stop_in_words};
pub use company::company_in_words;
pub use customer::{SATISFACTION, customer_in_words};
pub use difference::{days_in_words, difference_as_data, runs_in_words};
pub use leads::{leads_in_words, line_of_factor};
pub use market::{drift_in_words, rivals_in_words};
pub use quality::quality_in_words;
pub use reputation::reputation_in_words;
pub use satisfaction::satisfaction_in_words;
pub use spillover::{HEAT, SpillCell, SpillMap, SpillRow, spillover_in_words};
pub use streams::streams_in_words;
pub use writes::{writes_in_words, written_by};

use self::settled::{settle, settled};
use crate::words::count;

/// Start of the line about the last days of a group.
pub const EVENINGS: &str = "  end of day, last";

/// Describes the range of a figure over some days; `None` without values.
fn evenings_in_words(values: impl Iterator<Item = f64> + Clone) -> Option<String> {
    let days = values.clone().count();
    let (least, most) =
        (values.clone().fold(f64::INFINITY, f64::min), values.fold(f64::NEG_INFINITY, f64::max));
    (days > 0).then(|| format!("{EVENINGS} {}: {least:.4} to {most:.4}", count(days as u32, "day")))
}

fn table(head: &[&str], rows: &[Vec<String>]) -> Vec<String> {
    let rows: Vec<Vec<String>> =
        rows.iter().map(|row| row.iter().map(|cell| settle(cell)).collect()).collect();
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
