//! Output options of laboratory commands.

use std::io::IsTerminal;
use std::path::{Path, PathBuf};

use clap::Args;

use crate::cli::output_file::write_text;
use crate::cli::runs::to_csv;
use crate::cli::{Failure, print};
use crate::lab::lab_report::{DEFAULT_WIDTH, LabReport};

/// Options that all commands of the laboratory share.
#[derive(Debug, Clone, Args)]
pub struct OutputOptions {
    /// Print one JSON object, with numbers at full precision
    #[arg(long, conflicts_with = "csv")]
    json: bool,
    /// Print the table as comma-separated values, with numbers at full precision
    #[arg(long)]
    csv: bool,
    /// With --csv: name of the table [default: the first]
    #[arg(long, value_name = "NAME", requires = "csv")]
    table: Option<String>,
    /// Also draw the graphs to this file
    #[arg(long, value_name = "FILE")]
    svg: Option<PathBuf>,
    /// Maximum line width in columns [default: the terminal's width, at most 100]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(40..))]
    width: Option<u16>,
}

impl OutputOptions {
    /// Returns whether to print rows, for commands that print rows unless JSON output or a graph is
    /// requested.
    pub fn prints_rows(&self) -> bool {
        !self.json && self.svg.is_none()
    }

    /// Rejects `--svg` for commands that draw no graph, before any run is played.
    ///
    /// # Errors
    /// `--svg` is given.
    pub fn reject_graphs(&self) -> Result<(), Failure> {
        match self.svg {
            Some(_) => Err(Failure::usage("this command has no graph: leave out --svg")),
            None => Ok(()),
        }
    }

    /// Returns the path given with `--svg`.
    pub fn graph_file(&self) -> Option<&Path> {
        self.svg.as_deref()
    }

    /// Prints a report in the chosen output format.
    ///
    /// # Errors
    /// The report does not have the requested table or graph, or the file or standard output cannot be written.
    pub fn show(&self, exhibit: &LabReport) -> Result<(), Failure> {
        if let Some(path) = &self.svg {
            let drawn = exhibit
                .to_svg()
                .ok_or_else(|| Failure::usage("this command has no graph: leave out --svg"))?;
            write_text(path, &drawn)?;
        }
        if self.json {
            return print(&(serde_json::to_string_pretty(&exhibit.to_json()).unwrap_or_default() + "\n"));
        }
        if !self.csv {
            return print(&exhibit.to_text(self.text_width()));
        }
        let table = match &self.table {
            None => exhibit.tables.first(),
            Some(name) => exhibit.table(name),
        };
        let Some(table) = table else {
            let names: Vec<&str> = exhibit.tables.iter().map(|table| table.name.as_str()).collect();
            return Err(Failure::usage(format!("--table must be one of {}", names.join(", "))));
        };
        print(&to_csv(&table.to_csv_rows())?)
    }

    fn text_width(&self) -> usize {
        let asked = self.width.map(usize::from);
        asked
            .unwrap_or_else(|| terminal_columns().map_or(DEFAULT_WIDTH, |columns| columns.min(DEFAULT_WIDTH)))
    }
}

/// Returns the width of the terminal in columns, or `None` if standard output is not a terminal.
pub fn terminal_columns() -> Option<usize> {
    let size = std::io::stdout().is_terminal().then(crossterm::terminal::size)?;
    size.ok().map(|(columns, _)| usize::from(columns))
}
