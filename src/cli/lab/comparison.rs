//! `novamind lab compare`: runs side by side.

use std::io::IsTerminal;

use clap::Args;
use serde_json::json;

use crate::cli::run::progress_bar;
use crate::cli::runs::as_csv;
use crate::cli::{Context, Failure, print};
use crate::lab::comparison::{as_rows, as_text, beside};
use crate::notation::printable;
use crate::report::Logbook;
use crate::report::ranking::published;
use crate::session::{Access, Session, Trajectory, find_run_to_read};

/// Options of `lab compare`.
#[derive(Debug, Args)]
pub struct Options {
    /// Runs, or `latest`: the newest.
    #[arg(required = true, value_name = "RUN")]
    runs: Vec<String>,
    /// Print as one JSON object, with the logbook of every run.
    #[arg(long, conflicts_with = "csv")]
    json: bool,
    /// Print as comma-separated values: one figure or day per row.
    #[arg(long)]
    csv: bool,
    /// Widest line of the text: runs stand side by side if they have room, else one a row [default: the terminal's].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(40..))]
    width: Option<u16>,
}

/// Columns of a page that is not read in a terminal.
const PAGE_WIDTH: usize = 160;

/// Columns of the terminal; those of a page where there is none.
fn terminal_width() -> usize {
    let size = std::io::stdout().is_terminal().then(crossterm::terminal::size).and_then(Result::ok);
    size.map_or(PAGE_WIDTH, |(width, _)| usize::from(width))
}

/// Runs the command; nothing of the runs is changed.
pub fn run(options: &Options, context: &Context) -> Result<(), Failure> {
    let folder = context.runs()?;
    let progress = progress_bar(options.runs.len() as u64, "runs");
    let mut compared = Vec::new();
    for name in &options.runs {
        let own = find_run_to_read(&folder, name)?;
        context.look(&own, "compare", &options.runs.join(" "))?;
        let session = Session::open(&own, Access::Read, true)?;
        let trajectory = Trajectory::read(&own.join("trajectory.jsonl"))?;
        compared.push(Logbook::of(&session, &trajectory.lines, &[]));
        progress.inc(1);
    }
    progress.finish_and_clear();
    let all = beside(&compared);
    if options.csv {
        return print(&as_csv(&as_rows(&all))?);
    }
    if !options.json {
        return print(&printable(&as_text(&all, options.width.map_or_else(terminal_width, usize::from))));
    }
    let agents = json!({ "source": published().source, "agents": published().agent });
    let runs: Vec<_> = compared.iter().map(|logbook| json!({ "logbook": logbook })).collect();
    let object = json!({ "comparison": all, "runs": runs, "published": agents });
    print(&(serde_json::to_string_pretty(&object).unwrap_or_default() + "\n"))
}
