//! How commands of the laboratory write what they show.

use std::io::IsTerminal;
use std::path::{Path, PathBuf};

use clap::Args;

use crate::cli::output_file::write_text;
use crate::cli::runs::as_csv;
use crate::cli::{Failure, print};
use crate::lab::exhibit::{Exhibit, WIDTH};

/// Options that all commands of the laboratory share.
#[derive(Debug, Clone, Args)]
pub struct OutputOptions {
    /// Print as one JSON object, every number in full.
    #[arg(long, conflicts_with = "csv")]
    json: bool,
    /// Print the table as comma-separated values, every number in full.
    #[arg(long)]
    csv: bool,
    /// With --csv, the table of this name [default: the first].
    #[arg(long, value_name = "NAME", requires = "csv")]
    table: Option<String>,
    /// Draw the graphs into this file as well.
    #[arg(long, value_name = "FILE")]
    svg: Option<PathBuf>,
    /// Widest line of the text [default: the terminal's, at most 100].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(40..))]
    width: Option<u16>,
}

impl OutputOptions {
    /// Whether rows for programs are asked for, where those are what a command prints unless it is told otherwise.
    pub fn is_of_rows(&self) -> bool {
        !self.json && self.svg.is_none()
    }

    /// For commands that draw nothing: better known before they play than after it.
    ///
    /// # Errors
    /// A drawing is asked for.
    pub fn refuse_graphs(&self) -> Result<(), Failure> {
        match self.svg {
            Some(_) => Err(Failure::usage("this command has no graph: leave out --svg")),
            None => Ok(()),
        }
    }

    /// The file that the graphs are drawn into, if they are asked for.
    pub fn graphs(&self) -> Option<&Path> {
        self.svg.as_deref()
    }

    /// Writes an exhibit as it was asked for.
    ///
    /// # Errors
    /// There is no such table or nothing to draw; the drawing or standard output fails.
    pub fn show(&self, exhibit: &Exhibit) -> Result<(), Failure> {
        if let Some(path) = &self.svg {
            let drawn = exhibit
                .as_svg()
                .ok_or_else(|| Failure::usage("this command has no graph: leave out --svg"))?;
            write_text(path, &drawn)?;
        }
        if self.json {
            return print(&(serde_json::to_string_pretty(&exhibit.as_json()).unwrap_or_default() + "\n"));
        }
        if !self.csv {
            return print(&exhibit.as_text(self.room()));
        }
        let table = match &self.table {
            None => exhibit.tables.first(),
            Some(name) => exhibit.table(name),
        };
        let Some(table) = table else {
            let names: Vec<&str> = exhibit.tables.iter().map(|table| table.name.as_str()).collect();
            return Err(Failure::usage(format!("--table takes one of {}", names.join(", "))));
        };
        print(&as_csv(&table.as_csv())?)
    }

    fn room(&self) -> usize {
        let asked = self.width.map(usize::from);
        asked.unwrap_or_else(|| terminal_columns().map_or(WIDTH, |columns| columns.min(WIDTH)))
    }
}

/// Columns of the terminal; none where standard output is none.
pub fn terminal_columns() -> Option<usize> {
    let size = std::io::stdout().is_terminal().then(crossterm::terminal::size)?;
    size.ok().map(|(columns, _)| usize::from(columns))
}
