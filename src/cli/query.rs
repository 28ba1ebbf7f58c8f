//! `novamind query`: runs SQL on a run.

use std::path::Path;

use clap::{Args, ValueEnum};

use super::run::progress_bar;
use super::{Context, Failure, print};
use crate::database::{Cell, Rows};
use crate::insight::Inspect;
use crate::notation::{csv_cell, printable};
use crate::record::error::RunError;
use crate::record::folder::derived::manifest_of;
use crate::record::folder::library::Library;
use crate::record::folder::runs::find_run_to_read;
use crate::record::trajectory::record::Outcome;
use crate::record::trajectory::{Line, Record, Trajectory};
use crate::session::{
    Access, SealKey, Session, connection_to_file, may_look_inside, query_refusal, rebuild_database,
    rows_as_json, with_the_way_to_hidden_tables,
};

#[derive(Debug, Args)]
pub struct Options {
    /// Run, or `latest` for the newest
    run: String,
    /// One read-only statement, or the name of a query of the library
    // A statement may begin with a comment, and so with hyphens.
    #[arg(allow_hyphen_values = true)]
    sql: String,
    /// Include the hidden tables; for debug runs and finished runs. The inspection is recorded
    #[arg(long)]
    xray: bool,
    /// Day that hidden.customers shows [default: the last one]
    #[arg(long, value_name = "DAY", requires = "xray")]
    day: Option<u32>,
    /// Format of the result
    #[arg(long, value_enum, default_value = "table")]
    format: RowFormat,
}

/// Format of a result.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum RowFormat {
    /// Aligned columns
    Table,
    /// Comma-separated values
    Csv,
    /// One JSON object
    Json,
    /// A Markdown table
    Md,
}

pub fn run(options: &Options, context: &Context) -> Result<(), Failure> {
    let folder = find_run_to_read(&context.runs()?, &options.run)?;
    let rows = if options.xray {
        ask_xray(&folder, options, context)?
    } else {
        let statement = statement(&options.sql, context)?;
        context.look(&folder, "query", &statement)?;
        ask(&folder, &statement, &context.seal_key()?)?
    };
    match options.format {
        RowFormat::Table => print(&printable(&crate::plain::table(&rows))),
        RowFormat::Csv => print(&as_csv(&rows)?),
        RowFormat::Md => print(&as_markdown(&rows)),
        RowFormat::Json => print(&format!("{}\n", serde_json::Value::Object(rows_as_json(&rows)))),
    }
}

/// Returns the statement. A single name, which is never a statement, selects a query of the library.
fn statement(given: &str, context: &Context) -> Result<String, Failure> {
    let is_name =
        given.contains('-') && given.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'-');
    let library = Library::of(&context.configuration);
    match library.find(given) {
        Some(query) => Ok(query.body().to_owned()),
        None if is_name && !given.starts_with('-') => {
            let near = library.near(given);
            let near =
                if near.is_empty() { String::new() } else { format!("; did you mean {}?", near.join(", ")) };
            Err(Failure::usage(format!("there is no query {given}{near}")))
        }
        None => Ok(given.to_owned()),
    }
}

/// Queries with the hidden tables. The run is opened for writing because the inspection is recorded.
fn ask_xray(folder: &Path, options: &Options, context: &Context) -> Result<Rows, Failure> {
    context.check_look(folder)?;
    let mut session = Session::open_sealed(folder, Access::Write, true, context.seal_key()?)?;
    session.refuse_to_look_inside()?;
    let statement = statement(&options.sql, context)?;
    let rows = session.inspect().xray_query(&statement, options.day)?;
    session.save()?;
    Ok(rows)
}

/// Queries the database of the run, which is completed on disk first if necessary. If the run is being played or its folder is
/// read-only, the database is built in memory from the trajectory.
fn ask(folder: &Path, sql: &str, key: &SealKey) -> Result<Rows, Failure> {
    if let Some(rows) = ask_file(folder, sql, key)? {
        return Ok(rows);
    }
    let mut progress = None;
    let rebuilt = rebuild_database(folder, key, &mut |day, days| {
        let bar = progress.get_or_insert_with(|| progress_bar(u64::from(days), "days in the database"));
        bar.set_position(u64::from(day));
    });
    if let Some(bar) = progress {
        bar.finish_and_clear();
    }
    match rebuilt {
        Ok(()) => {
            if let Some(rows) = ask_file(folder, sql, key)? {
                return Ok(rows);
            }
        }
        Err(RunError::InUse { .. } | RunError::NotWritable { .. } | RunError::Projection(_)) => {}
        Err(error) => return Err(error.into()),
    }
    let mut session = Session::open_sealed(folder, Access::Read, true, key.clone())?;
    Ok(session.query(sql)?)
}

/// Queries the database file. Returns `None` if it is incomplete.
fn ask_file(folder: &Path, sql: &str, key: &SealKey) -> Result<Option<Rows>, Failure> {
    // Both read long files, so each has its own thread.
    let (trajectory, opened) = std::thread::scope(|scope| {
        let opened = scope.spawn(|| connection_to_file(folder, key));
        (Trajectory::read(&folder.join("trajectory.jsonl")), opened.join())
    });
    let (trajectory, opened) = (trajectory?, opened.unwrap_or_else(|panic| std::panic::resume_unwind(panic)));
    // Only lines that change the company count; queries and views do not.
    let last = trajectory.lines.iter().rev().find(|line| moves_database(line));
    if let (Ok((connection, position)), Some(last)) = (opened, last)
        && position.seq >= last.seq
        && trajectory.lines.get(position.seq as usize).is_some_and(|line| line.hash == position.line_hash)
    {
        let time = std::time::Duration::from_secs(120);
        let limits = crate::database::query::Limits { rows: 5000, time, steps: None };
        let answer = connection.ask(sql, limits);
        if !connection.found_damage() {
            let may_look = || {
                let ended = trajectory.end().and_then(|line| match &line.record {
                    Record::End(end) => Some(end.reason),
                    _ => None,
                });
                manifest_of(folder).is_ok_and(|manifest| may_look_inside(&manifest, ended, Some(folder)))
            };
            return answer.map(Some).map_err(|error| match query_refusal(error) {
                refusal if may_look() => with_the_way_to_hidden_tables(refusal).into(),
                refusal => refusal.into(),
            });
        }
    }
    Ok(None)
}

fn moves_database(line: &Line) -> bool {
    match &line.record {
        Record::Call(call) => {
            let acts = call.tool.known().is_some_and(|tool| tool.spec().kind.acts());
            acts && matches!(call.outcome, Outcome::Accepted(_))
        }
        Record::Start(_) | Record::Week(_) | Record::Step(_) | Record::End(_) => true,
        _ => false,
    }
}

fn as_markdown(rows: &Rows) -> String {
    let escaped = |text: &str| text.replace('|', "\\|").replace(['\n', '\r'], " ");
    let line = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
    let is_number = |at: usize| {
        let mut cells =
            rows.rows.iter().filter_map(|row| row.get(at)).filter(|cell| **cell != Cell::Null).peekable();
        cells.peek().is_some() && cells.all(|cell| matches!(cell, Cell::Integer(_) | Cell::Real(_)))
    };
    let ruler = (0..rows.columns.len()).map(|at| if is_number(at) { "--:" } else { "---" }.to_owned());
    let mut text = line(rows.columns.iter().map(|name| escaped(name)).collect()) + &line(ruler.collect());
    for row in &rows.rows {
        let cell = |cell: &Cell| match cell {
            Cell::Null => String::new(),
            other => escaped(&crate::plain::cell_text(other)),
        };
        text += &line(row.iter().map(cell).collect());
    }
    printable(&text).into_owned()
}

/// Formats a result as comma-separated values with a header.
pub fn as_csv(rows: &Rows) -> Result<String, Failure> {
    let wrong = |error: String| Failure::failed(format!("cannot write the result as CSV: {error}"));
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(&rows.columns).map_err(|error| wrong(error.to_string()))?;
    for row in &rows.rows {
        let cells = row.iter().map(|cell| match cell {
            Cell::Null => String::new(),
            Cell::Text(text) => csv_cell(text).into_owned(),
            other => crate::plain::cell_text(other),
        });
        writer.write_record(cells).map_err(|error| wrong(error.to_string()))?;
    }
    let bytes = writer.into_inner().map_err(|error| wrong(error.to_string()))?;
    String::from_utf8(bytes).map_err(|error| wrong(error.to_string()))
}
