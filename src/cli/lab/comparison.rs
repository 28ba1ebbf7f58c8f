//! `novamind lab compare`: compares runs.

use clap::Args;
use serde_json::json;

use super::output::terminal_columns;
use super::runs::map_runs;
use crate::cli::runs::to_csv;
use crate::cli::{Context, Failure, print};
use crate::formatting::escape_control_characters;
use crate::lab::comparison::{compare_runs, comparison_to_rows, comparison_to_text};
use crate::report::Logbook;
use crate::report::ranking::published_results;

#[derive(Debug, Args)]
pub struct Options {
    /// Ids of runs, or `latest` for the newest run
    #[arg(required = true, value_name = "RUN")]
    runs: Vec<String>,
    /// Print one JSON object, with the logbook of every run
    #[arg(long, conflicts_with = "csv")]
    json: bool,
    /// Print comma-separated values: one figure or day per row
    #[arg(long)]
    csv: bool,
    /// Maximum line width in columns; runs are shown side by side if they fit [default: the terminal's width]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(40..))]
    width: Option<u16>,
}

/// Line width in columns if standard output is not a terminal.
const PAGE_WIDTH: usize = 160;

/// Prints a comparison of runs. Does not modify the runs.
pub fn run(options: &Options, context: &Context) -> Result<(), Failure> {
    let compared = map_runs(&options.runs, "compare", context, |session, trajectory| {
        Logbook::new(session, &trajectory.lines, &[])
    })?;
    let all = compare_runs(&compared);
    if options.csv {
        return print(&to_csv(&comparison_to_rows(&all))?);
    }
    if !options.json {
        let width = options.width.map(usize::from).or_else(terminal_columns).unwrap_or(PAGE_WIDTH);
        return print(&escape_control_characters(&comparison_to_text(&all, width)));
    }
    let published = published_results();
    let agents = json!({
        "source": published.paper().source,
        "agents": published.paper().agent,
        "not_ranked": published.unranked_agents().collect::<Vec<_>>(),
    });
    let runs: Vec<_> = compared.iter().map(|logbook| json!({ "logbook": logbook })).collect();
    let object = json!({ "comparison": all, "runs": runs, "published": agents });
    print(&(serde_json::to_string_pretty(&object).unwrap_or_default() + "\n"))
}
