//! Helpers for a company that is played through the library: calls, weeks and queries.

use std::path::Path;

use novamind::database::Cell;
use novamind::record::folder::configuration::Configuration;
use novamind::record::mode::Mode;
use novamind::record::trajectory::record::Via;
use novamind::session::{NewRun, Session, Storage, WeekResult};
use serde_json::{Value, json};

/// Calls a tool and asserts that the call is accepted.
#[track_caller]
pub fn call_tool(session: &mut Session, tool: &str, arguments: Value) -> Value {
    let answer = session.call(tool, &arguments, Via::Script);
    answer.unwrap_or_else(|refusal| panic!("{tool}: {refusal}")).to_json()
}

/// Creates a run with seed 7 and this number of days in a folder of runs.
#[track_caller]
pub fn begin_run(runs: &Path, mode: Mode, days: u32) -> Session {
    let new = NewRun {
        seed: Some(7),
        days: Some(days),
        mode,
        participant: (mode == Mode::Baseline).then(|| "P01".to_owned()),
        storage: Storage::Runs(runs.to_owned()),
        ..NewRun::default()
    };
    Session::create(new, &Configuration::bundled()).expect("the run begins")
}

/// Applies the first decisions of a sensible beginner.
pub fn apply_opening_decisions(session: &mut Session) {
    for (tool, arguments) in opening_calls() {
        call_tool(session, tool, arguments);
    }
}

/// Returns the calls of [`apply_opening_decisions`].
pub fn opening_calls() -> [(&'static str, Value); 6] {
    [
        ("set_prices", json!({"A": 12, "B": 25, "C": 55})),
        ("set_model_tiers", json!({"B": 2, "C": 4})),
        ("set_usage_quotas", json!({"A": 60000, "B": 250000, "C": 1200000})),
        ("set_daily_spend", json!({"operations": 200, "development": 200})),
        ("set_targeted_dev_spend", json!({"targeted_spend": {"S1": 6000}})),
        (
            "set_targeted_ad_spend",
            json!({"targeted_spend": {"content_marketing": {"S1": 750}, "linkedin": {"E1": 3000}}}),
        ),
    ]
}

/// Runs a week with naive forecasts.
#[track_caller]
pub fn advance_week(session: &mut Session) -> WeekResult {
    let forecasts = session.company().naive_forecasts();
    session.advance("if leads hold, grow", &forecasts, Via::Script, &mut |_| {}).expect("a week")
}

/// Runs a number of weeks with naive forecasts.
#[track_caller]
pub fn advance_weeks(session: &mut Session, count: usize) {
    for _ in 0..count {
        advance_week(session);
    }
}

/// Returns the rows of an SQL statement, up to the row limit of a query.
#[track_caller]
pub fn query_rows(session: &mut Session, sql: &str) -> Vec<Vec<Cell>> {
    session.query(sql).unwrap_or_else(|refusal| panic!("{sql}: {refusal}")).rows
}

/// Returns the rows of an SQL statement as numbers.
#[track_caller]
pub fn query_numbers(session: &mut Session, sql: &str) -> Vec<Vec<f64>> {
    let number = |cell: &Cell| match cell {
        Cell::Integer(number) => *number as f64,
        Cell::Real(number) => *number,
        other => panic!("{sql}: {other:?}"),
    };
    query_rows(session, sql).iter().map(|row| row.iter().map(number).collect()).collect()
}

/// Returns the first column of an SQL statement as numbers.
#[track_caller]
pub fn query_column(session: &mut Session, sql: &str) -> Vec<f64> {
    query_numbers(session, sql).iter().map(|row| row[0]).collect()
}

/// Returns the first cell of an SQL statement as a number.
#[track_caller]
pub fn query_number(session: &mut Session, sql: &str) -> f64 {
    query_column(session, sql)[0]
}

/// Returns the first cell of an SQL statement as a string.
#[track_caller]
pub fn query_text(session: &mut Session, sql: &str) -> String {
    match &query_rows(session, sql)[0][0] {
        Cell::Text(text) => text.clone(),
        other => panic!("{sql}: {other:?}"),
    }
}
