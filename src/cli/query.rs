//! `novamind query`: SQL on a run.

use std::path::Path;

use clap::{Args, ValueEnum};

use super::run::progress_bar;
use super::{Context, Failure, print};
use crate::notation::printable;
use crate::session::record::Outcome;
use crate::session::{
    Access, Cell, Line, Record, Refusal, Rows, RunError, Session, Trajectory, connection_to_file,
    find_run_to_read, rebuild_database, rows_as_json,
};

/// Options of `query`.
#[derive(Debug, Args)]
pub struct Options {
    /// Run, or `latest`: the newest.
    run: String,
    /// One read-only statement.
    // A statement may begin with a comment, which begins with hyphens.
    #[arg(allow_hyphen_values = true)]
    sql: String,
    /// Format of the result.
    #[arg(long, value_enum, default_value = "table")]
    format: RowFormat,
}

/// Format of a result.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum RowFormat {
    /// Aligned columns.
    Table,
    /// Comma-separated values.
    Csv,
    /// One JSON object.
    Json,
}

/// Runs the command.
pub fn run(options: &Options, context: &Context) -> Result<(), Failure> {
    let folder = find_run_to_read(&context.runs()?, &options.run)?;
    let rows = ask(&folder, &options.sql)?;
    match options.format {
        RowFormat::Table => print(&printable(&crate::plain::table(&rows))),
        RowFormat::Csv => print(&as_csv(&rows)?),
        RowFormat::Json => print(&format!("{}\n", serde_json::Value::Object(rows_as_json(&rows)))),
    }
}

/// Asks the run's database, which is brought up to date on the disk if it is not complete. Where somebody plays the run,
/// or its folder cannot be written, a database in memory is made from the trajectory.
fn ask(folder: &Path, sql: &str) -> Result<Rows, Failure> {
    if let Some(rows) = ask_file(folder, sql)? {
        return Ok(rows);
    }
    let mut progress = None;
    let rebuilt = rebuild_database(folder, &mut |day, days| {
        let bar = progress.get_or_insert_with(|| progress_bar(u64::from(days), "days of the database"));
        bar.set_position(u64::from(day));
    });
    if let Some(bar) = progress {
        bar.finish_and_clear();
    }
    match rebuilt {
        Ok(()) => {
            if let Some(rows) = ask_file(folder, sql)? {
                return Ok(rows);
            }
        }
        Err(RunError::InUse { .. } | RunError::NotWritable { .. } | RunError::Projection(_)) => {}
        Err(error) => return Err(error.into()),
    }
    let mut session = Session::open(folder, Access::Read, true)?;
    Ok(session.query(sql)?)
}

/// Asks the run's database if it is complete.
fn ask_file(folder: &Path, sql: &str) -> Result<Option<Rows>, Failure> {
    let trajectory = Trajectory::read(&folder.join("trajectory.jsonl"))?;
    // Queries and views do not move the database on; only lines that change the company do.
    let last = trajectory.lines.iter().rev().find(|line| moves_database(line));
    if let (Ok((connection, position)), Some(last)) = (connection_to_file(folder), last)
        && position.seq >= last.seq
        && trajectory.lines.get(position.seq as usize).is_some_and(|line| line.hash == position.line_hash)
    {
        let time = std::time::Duration::from_secs(120);
        let limits = crate::database::query::Limits { rows: 5000, time, steps: None };
        return connection.ask(sql, limits).map(Some).map_err(|error| Refusal::from(error).into());
    }
    Ok(None)
}

fn moves_database(line: &Line) -> bool {
    match &line.record {
        Record::Call(call) => matches!(call.outcome, Outcome::Accepted(_)) && call.tool.spec().kind.acts(),
        Record::Start(_) | Record::Week(_) | Record::Step(_) | Record::End(_) => true,
        _ => false,
    }
}

/// A result as comma-separated values with a header.
pub fn as_csv(rows: &Rows) -> Result<String, Failure> {
    let wrong = |error: String| Failure::failed(format!("the result cannot be written as CSV: {error}"));
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(&rows.columns).map_err(|error| wrong(error.to_string()))?;
    for row in &rows.rows {
        let cells = row.iter().map(|cell| match cell {
            Cell::Null => String::new(),
            other => crate::plain::cell_text(other),
        });
        writer.write_record(cells).map_err(|error| wrong(error.to_string()))?;
    }
    let bytes = writer.into_inner().map_err(|error| wrong(error.to_string()))?;
    String::from_utf8(bytes).map_err(|error| wrong(error.to_string()))
}
