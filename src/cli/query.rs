//! `novamind query`: runs SQL on a run.

use std::path::Path;

use clap::{Args, ValueEnum};

use super::run::progress_bar;
use super::{Context, Failure, print};
use crate::database::{Cell, QueryResult};
use crate::formatting::{escape_control_characters, escape_csv_cell};
use crate::insight::Inspect;
use crate::record::error::RunError;
use crate::record::folder::manifest_check::read_manifest;
use crate::record::folder::query_library::QueryLibrary;
use crate::record::folder::runs::find_run_to_read;
use crate::record::trajectory::record::Outcome;
use crate::record::trajectory::{Line, Record, Trajectory};
use crate::session::{
    Access, SealKey, Session, can_inspect, open_database_file, query_rejection, rebuild_database,
    rows_to_json, with_hidden_table_hint,
};

#[derive(Debug, Args)]
pub struct Options {
    /// ID of the run, or `latest` for the newest run
    run: String,
    /// One read-only statement, or the name of a query in the library
    // A statement may begin with a comment, and therefore with hyphens.
    #[arg(allow_hyphen_values = true)]
    sql: String,
    /// Include the hidden tables; for debug runs and finished runs. The inspection is recorded
    #[arg(long)]
    xray: bool,
    /// Day that the table hidden.customers describes [default: the last day]
    #[arg(long, value_name = "DAY", requires = "xray")]
    day: Option<u32>,
    /// Output format of the query result
    #[arg(long, value_enum, default_value = "table")]
    format: RowFormat,
}

/// Output format of a query result.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum RowFormat {
    /// Table with aligned columns
    Table,
    /// Comma-separated values
    Csv,
    /// One JSON object
    Json,
    /// A Markdown table
    Md,
}

pub fn run(options: &Options, context: &Context) -> Result<(), Failure> {
    let folder = find_run_to_read(&context.runs_folder()?, &options.run)?;
    let rows = if options.xray {
        query_hidden_tables(&folder, options, context)?
    } else {
        let statement = resolve_statement(&options.sql, context)?;
        context.authorize_view(&folder, "query", &statement)?;
        query_run(&folder, &statement, &context.seal_key()?)?
    };
    match options.format {
        RowFormat::Table => print(&escape_control_characters(&crate::plain::format_result(&rows))),
        RowFormat::Csv => print(&to_csv(&rows)?),
        RowFormat::Md => print(&to_markdown(&rows)),
        RowFormat::Json => print(&format!("{}\n", serde_json::Value::Object(rows_to_json(&rows)))),
    }
}

/// Returns the statement to run. A single word is never a statement, so it is treated as the name of a query
/// in the library.
fn resolve_statement(given: &str, context: &Context) -> Result<String, Failure> {
    let is_name =
        given.contains('-') && given.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'-');
    let library = QueryLibrary::load(&context.configuration);
    match library.find(given) {
        Some(query) => Ok(query.body().to_owned()),
        None if is_name && !given.starts_with('-') => {
            let near = library.similar_names(given);
            let near =
                if near.is_empty() { String::new() } else { format!("; did you mean {}?", near.join(", ")) };
            Err(Failure::usage(format!("there is no query {given}{near}")))
        }
        None => Ok(given.to_owned()),
    }
}

/// Runs a query that may read the hidden tables. Opens the run for writing, because the inspection is
/// recorded.
fn query_hidden_tables(folder: &Path, options: &Options, context: &Context) -> Result<QueryResult, Failure> {
    context.check_view_allowed(folder)?;
    let mut session = Session::open_sealed(folder, Access::Write, true, context.seal_key()?)?;
    session.check_inspection()?;
    let statement = resolve_statement(&options.sql, context)?;
    let rows = session.inspect().query_hidden_tables(&statement, options.day)?;
    session.save()?;
    Ok(rows)
}

/// Queries the database of the run. If necessary, first completes the database on disk. If the run is being
/// played or the folder is read-only, builds the database in memory from the trajectory instead.
fn query_run(folder: &Path, sql: &str, key: &SealKey) -> Result<QueryResult, Failure> {
    if let Some(rows) = query_database_file(folder, sql, key)? {
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
            if let Some(rows) = query_database_file(folder, sql, key)? {
                return Ok(rows);
            }
        }
        Err(RunError::InUse { .. } | RunError::NotWritable { .. } | RunError::Projection(_)) => {}
        Err(error) => return Err(error.into()),
    }
    let mut session = Session::open_sealed(folder, Access::Read, true, key.clone())?;
    Ok(session.query(sql)?)
}

/// Queries the database file. Returns `None` if the file is incomplete.
fn query_database_file(folder: &Path, sql: &str, key: &SealKey) -> Result<Option<QueryResult>, Failure> {
    // The trajectory and the database are large files, so each is read by its own thread.
    let (trajectory, opened) = std::thread::scope(|scope| {
        let opened = scope.spawn(|| open_database_file(folder, key));
        (Trajectory::read(&folder.join("trajectory.jsonl")), opened.join())
    });
    let (trajectory, opened) = (trajectory?, opened.unwrap_or_else(|panic| std::panic::resume_unwind(panic)));
    // The database must contain every line that changes the company. Lines of queries and views do not count.
    let last = trajectory.lines.iter().rev().find(|line| changes_database(line));
    if let (Ok((connection, position)), Some(last)) = (opened, last)
        && position.seq >= last.seq
        && trajectory.lines.get(position.seq as usize).is_some_and(|line| line.hash == position.line_hash)
    {
        let time = std::time::Duration::from_secs(120);
        let limits = crate::database::query::QueryLimits { rows: 5000, time, steps: None };
        let answer = connection.query(sql, limits);
        if !connection.has_found_damage() {
            let may_look = || {
                let ended = trajectory.end_line().and_then(|line| match &line.record {
                    Record::End(end) => Some(end.reason),
                    _ => None,
                });
                read_manifest(folder).is_ok_and(|manifest| can_inspect(&manifest, ended, Some(folder)))
            };
            return answer.map(Some).map_err(|error| match query_rejection(error) {
                rejection if may_look() => with_hidden_table_hint(rejection).into(),
                rejection => rejection.into(),
            });
        }
    }
    Ok(None)
}

fn changes_database(line: &Line) -> bool {
    match &line.record {
        Record::Call(call) => {
            let acts = call.tool.tool_id().is_some_and(|tool| tool.spec().kind.changes_company());
            acts && matches!(call.outcome, Outcome::Accepted(_))
        }
        Record::Start(_) | Record::Week(_) | Record::Step(_) | Record::End(_) => true,
        _ => false,
    }
}

fn to_markdown(rows: &QueryResult) -> String {
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
            other => escaped(&crate::plain::format_cell(other)),
        };
        text += &line(row.iter().map(cell).collect());
    }
    escape_control_characters(&text).into_owned()
}

/// Formats a result as comma-separated values with a header.
pub fn to_csv(rows: &QueryResult) -> Result<String, Failure> {
    let wrong = |error: String| Failure::failed(format!("cannot write the result as CSV: {error}"));
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(&rows.columns).map_err(|error| wrong(error.to_string()))?;
    for row in &rows.rows {
        let cells = row.iter().map(|cell| match cell {
            Cell::Null => String::new(),
            Cell::Text(text) => escape_csv_cell(text).into_owned(),
            other => crate::plain::format_cell(other),
        });
        writer.write_record(cells).map_err(|error| wrong(error.to_string()))?;
    }
    let bytes = writer.into_inner().map_err(|error| wrong(error.to_string()))?;
    String::from_utf8(bytes).map_err(|error| wrong(error.to_string()))
}
