//! How a run of the folder went, read from the lines that close its weeks: for lists and comparisons, without
//! simulating anything.

use std::io::{BufRead, BufReader};
use std::path::Path;

use serde::Serialize;
use serde_json::Value;

use super::derived::Derived;
use super::runs::run_folder;
use crate::error::RunError;
use crate::trajectory::{Line, Record, open_regular_file};

/// The preview of a run.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct RunPreview {
    /// Day and cash: day 0, then every day on which a week ended.
    pub cash: Vec<(u32, f64)>,
    /// Active subscriptions of individuals after the last week.
    pub subscribers: u64,
    /// Seats of companies after the last week.
    pub seats: u64,
    /// Monthly recurring revenue after the last week, dollars.
    pub recurring_revenue: f64,
}

/// Reads the preview of a run. Lines that cannot be read are passed over: opening the run tells what is wrong with it.
///
/// # Errors
/// The run or its files are not there.
pub fn run_preview(runs: &Path, id: &str) -> Result<RunPreview, RunError> {
    let folder = run_folder(runs, id);
    let Derived { manifest, .. } = Derived::of(&folder)?;
    let path = folder.join("trajectory.jsonl");
    let file = open_regular_file(&path).map_err(RunError::io(&path))?;
    let mut preview = RunPreview { cash: vec![(0, manifest.cash)], ..RunPreview::default() };
    let closing = ["\"kind\":\"week\"", "\"kind\":\"step\"", "\"kind\":\"end\""];
    for line in BufReader::new(file).split(b'\n') {
        let line = line.map_err(RunError::io(&path))?;
        let text = String::from_utf8_lossy(&line);
        // Most lines are calls; only those that look like the end of a week are read.
        if closing.iter().any(|kind| text.contains(kind))
            && let Some(line) = Line::unchecked(text.as_bytes())
        {
            preview.add(line.day, &line.record);
        }
    }
    Ok(preview)
}

impl RunPreview {
    fn add(&mut self, day: u32, record: &Record) {
        let cash = match record {
            Record::Week(closing) | Record::Step(closing) => closing.cash,
            Record::End(end) => end.cash,
            _ => return,
        };
        match self.cash.last_mut() {
            Some(last) if last.0 == day => last.1 = cash,
            _ => self.cash.push((day, cash)),
        }
        let Some(figures) = record.closing().map(|closing| &closing.figures) else { return };
        if let Some(count) = figures.get("individual_subscribers").and_then(Value::as_u64) {
            self.subscribers = count;
        }
        if let Some(count) = figures.get("enterprise_seats").and_then(Value::as_u64) {
            self.seats = count;
        }
        if let Some(dollars) = figures.get("recurring_revenue").and_then(Value::as_f64) {
            self.recurring_revenue = dollars;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::folder::configuration::Configuration;
    use crate::folder::create::{NewRun, Storage};
    use crate::state::Session;
    use crate::trajectory::record::Via;
    use serde_json::json;

    #[test]
    fn the_course_is_what_the_session_saw() {
        let runs = tempfile::tempdir().expect("a folder");
        let new = NewRun {
            seed: Some(7),
            days: Some(17),
            storage: Storage::Runs(runs.path().to_owned()),
            ..NewRun::default()
        };
        let mut session = Session::create(new, &Configuration::shipped()).expect("a run");
        let id = session.manifest().id.clone();
        assert_eq!(run_preview(runs.path(), &id).expect("day 0").cash, [(0, 1_000_000.0)]);
        session.call("set_prices", &json!({"A": 12, "B": 25, "C": 55}), Via::Form).expect("prices");
        session.call("set_daily_spend", &json!({"operations": 200}), Via::Form).expect("spend");
        for _ in 0..3 {
            let forecasts = session.naive_forecasts();
            session.advance("as planned", &forecasts, Via::Form, &mut |_| {}).expect("a week");
        }
        let preview = run_preview(runs.path(), &id).expect("a preview");
        let days: Vec<u32> = preview.cash.iter().map(|point| point.0).collect();
        assert_eq!(days, [0, 7, 14, 17]);
        for (day, cash) in &preview.cash {
            assert!((cash - session.cash_by_day()[*day as usize]).abs() < 1e-6, "day {day}");
        }
        assert_eq!(preview.subscribers, u64::from(session.observe().subscribers));
    }

    #[test]
    fn odd_lines_are_passed_over_and_missing_runs_are_errors() {
        let runs = tempfile::tempdir().expect("a folder");
        let folder = runs.path().join("0123abcd");
        let new =
            NewRun { seed: Some(7), storage: Storage::Runs(runs.path().to_owned()), ..NewRun::default() };
        let session = Session::create(new, &Configuration::shipped()).expect("a run");
        std::fs::rename(session.folder().expect("a folder"), &folder).expect("moved");
        let closing = |cash: f64| {
            format!(
                "{{\"kind\":\"week\",\"day\":7,\"days_run\":7,\"figures\":{{}},\"cash\":{cash},\"state_hash\":\"\",\"parts\":{{}}}}"
            )
        };
        let lines = [
            "{}".to_owned(),
            json!({"kind": "week"}).to_string(),
            closing(1.0).replace("7,\"days_run", "-1,\"days_run"),
            closing(1.0).replace("week", "call"),
            closing(5.0),
            json!({"kind": "end", "day": 7, "reason": "horizon", "cash": 4, "score": 4}).to_string(),
        ];
        std::fs::write(folder.join("trajectory.jsonl"), lines.join("\n")).expect("written");
        let preview = run_preview(runs.path(), "0123abcd").expect("a preview");
        assert_eq!(preview.cash, [(0, 1_000_000.0), (7, 4.0)]);
        assert!(run_preview(runs.path(), "nothing").is_err());
    }
}
