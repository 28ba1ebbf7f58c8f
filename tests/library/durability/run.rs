//! Helpers that create, open and copy a run, and that compare two sessions of the same run.

use std::fs;
use std::path::{Path, PathBuf};

use novamind::record::folder::configuration::Configuration;
use novamind::session::{Access, NewRun, Session, Storage};
use serde_json::{Value, json};
use tempfile::TempDir;

/// Returns a temporary folder for runs.
pub fn temporary_runs_folder() -> TempDir {
    tempfile::tempdir().expect("a folder")
}

/// Creates a run with a seed and a number of days.
pub fn create_run(runs: &Path, seed: u64, days: u32) -> Session {
    let storage = Storage::Runs(runs.to_owned());
    let new = NewRun { seed: Some(seed), days: Some(days), storage, ..NewRun::default() };
    Session::create(new, &Configuration::bundled()).expect("the run begins")
}

/// Opens a run for play.
#[track_caller]
pub fn open_run(folder: &Path) -> Session {
    Session::open(folder, Access::Write, true).unwrap_or_else(|error| panic!("{error}"))
}

/// Copies a run folder.
pub fn copy_run(folder: &Path, to: &Path) -> PathBuf {
    let path = to.join(folder.file_name().expect("a name"));
    fs::create_dir_all(&path).expect("a folder");
    for entry in fs::read_dir(folder).expect("a folder").flatten() {
        fs::copy(entry.path(), path.join(entry.file_name())).expect("a copy");
    }
    path
}

/// Returns all visible data of a session, and its state hash.
pub fn session_view(session: &mut Session) -> Value {
    let totals = [
        "SELECT COUNT(*), SUM(amount), SUM(id * amount) FROM ledger",
        "SELECT COUNT(*), SUM(customer_id * start_day) FROM subscriptions",
        "SELECT COUNT(*), SUM(usage_units * customer_id) FROM daily_usage",
        "SELECT COUNT(*), SUM(issue_id * days_open) FROM issues",
        "SELECT COUNT(*), SUM(predicted_value), SUM(submitted_at) FROM predictions",
        "SELECT COUNT(*), SUM(LENGTH(message_text)) FROM enterprise_turns",
        "SELECT COUNT(*), SUM(LENGTH(content)) FROM social_media_posts",
        "SELECT COUNT(*), SUM(LENGTH(type || message)) FROM notifications",
        "SELECT COUNT(*), MAX(day) FROM config_history",
    ];
    // The tool `query` is not used, because its calls would be recorded.
    session.wait_for_database().expect("a database");
    let connection = session.database().open_connection().expect("a connection");
    let limits = session.company().query_limits();
    let rows: Vec<String> = totals
        .iter()
        .map(|sql| {
            format!(
                "{:?}",
                connection.query(sql, limits).unwrap_or_else(|error| panic!("{sql}: {error:?}")).rows
            )
        })
        .collect();
    json!({
        "state": session.state_hash(),
        "observation": session.company().observe(),
        "journal": session.journal(),
        "decisions": session.company().decisions(),
        "notices": session.company().notices(),
        "posts": session.company().posts(),
        "asked": session.company().query_history(),
        "cash": session.cash_by_day(),
        "weeks": session.weeks(),
        "rows": rows,
    })
}
