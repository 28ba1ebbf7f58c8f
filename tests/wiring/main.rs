//! What one part hands to the next arrives there, unchanged and in the right place: arguments of calls, days and weeks
//! of a past that is taken over, columns of tables, limits and exit codes at the edge of the program.
//!
//! Fixtures are lopsided on purpose: with different numbers everywhere, whatever is swapped shows.

#[allow(dead_code, reason = "shared with other stories, which need all of it")]
#[path = "../hardship/home.rs"]
mod home;

mod edges;
mod forged;
mod past;
mod settings;
mod support;

use novamind::session::{Cell, Configuration, Mode, NewRun, Session, Storage, Via};
use serde_json::Value;

/// A run in memory, or below a folder.
fn create(storage: Storage, overrides: &[(&str, &str)]) -> Session {
    let overrides = overrides.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
    let new = NewRun {
        seed: Some(7),
        days: Some(140),
        cash: Some(10_000_000.0),
        mode: Mode::Debug,
        overrides,
        storage,
        ..NewRun::default()
    };
    Session::create(new, &Configuration::shipped()).expect("the run begins")
}

fn call(session: &mut Session, tool: &str, arguments: Value) -> Value {
    let answer = session.call(tool, &arguments, Via::Script);
    answer.unwrap_or_else(|refusal| panic!("{tool}: {refusal}")).to_json()
}

fn week(session: &mut Session) {
    let forecasts = session.naive_forecasts();
    session.advance("as planned", &forecasts, Via::Script, &mut |_| {}).expect("a week");
}

/// All rows of a statement as numbers.
fn numbers(session: &mut Session, sql: &str) -> Vec<Vec<f64>> {
    let rows = session.query(sql).unwrap_or_else(|refusal| panic!("{sql}: {refusal}"));
    assert!(!rows.truncated, "{sql}");
    let number = |cell: &Cell| match cell {
        Cell::Integer(number) => *number as f64,
        Cell::Real(number) => *number,
        other => panic!("{sql}: {other:?}"),
    };
    rows.rows.iter().map(|row| row.iter().map(number).collect()).collect()
}
