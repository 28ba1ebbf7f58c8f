//! What the x-ray shows, in words: the same lines for plain mode and for the console.

mod breakpoints;
mod company;
mod customer;
mod difference;
mod leads;
mod market;
mod quality;
mod reputation;
mod satisfaction;
mod streams;
mod writes;

pub use breakpoints::{breakpoints_in_words, found_in_words, look_back_in_words, stop_in_words};
pub use company::company_in_words;
pub use customer::customer_in_words;
pub use difference::{difference_as_data, difference_in_words, runs_in_words};
pub use leads::leads_in_words;
pub use market::{drift_in_words, rivals_in_words};
pub use quality::quality_in_words;
pub use reputation::{reputation_in_words, spillover_in_words};
pub use satisfaction::satisfaction_in_words;
pub use streams::streams_in_words;
pub use writes::{writes_in_words, written_by};

/// A table, indented.
fn table(head: &[&str], rows: &[Vec<String>]) -> Vec<String> {
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
