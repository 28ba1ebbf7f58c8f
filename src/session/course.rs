//! How a run of the folder went, read from the lines that close its weeks: for lists and comparisons, without
//! simulating anything.

use std::io::{BufRead, BufReader};
use std::path::Path;

use serde::Serialize;
use serde_json::Value;

use super::error::RunError;
use super::manifest::Manifest;
use super::runs::run_folder;

/// The course of a run.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct RunCourse {
    /// Day and cash: day 0, then every day on which a week ended.
    pub cash: Vec<(u32, f64)>,
    /// Active subscriptions of individuals after the last week.
    pub subscribers: u64,
    /// Seats of companies after the last week.
    pub seats: u64,
    /// Monthly recurring revenue after the last week, dollars.
    pub recurring_revenue: f64,
}

/// Reads the course of a run. Lines that cannot be read are passed over: opening the run tells what is wrong with it.
///
/// # Errors
/// The run or its files are not there.
pub fn run_course(runs: &Path, id: &str) -> Result<RunCourse, RunError> {
    let folder = run_folder(runs, id);
    let manifest = Manifest::read(&folder)?;
    let path = folder.join("trajectory.jsonl");
    let file = std::fs::File::open(&path).map_err(RunError::io(&path))?;
    let mut course = RunCourse { cash: vec![(0, manifest.cash)], ..RunCourse::default() };
    let closing = ["\"kind\":\"week\"", "\"kind\":\"step\"", "\"kind\":\"end\""];
    for line in BufReader::new(file).split(b'\n') {
        let line = line.map_err(RunError::io(&path))?;
        let text = String::from_utf8_lossy(&line);
        // Most lines are calls; only those that look like the end of a week are read.
        if closing.iter().any(|kind| text.contains(kind))
            && let Ok(line) = serde_json::from_str::<Value>(&text)
        {
            course.add(&line);
        }
    }
    Ok(course)
}

impl RunCourse {
    fn add(&mut self, line: &Value) {
        let kind = line.get("kind").and_then(Value::as_str).unwrap_or_default();
        let day = line.get("day").and_then(Value::as_u64).and_then(|day| u32::try_from(day).ok());
        let cash = line.get("cash").and_then(Value::as_f64);
        let (true, Some(day), Some(cash)) = (["week", "step", "end"].contains(&kind), day, cash) else {
            return;
        };
        match self.cash.last_mut() {
            Some(last) if last.0 == day => last.1 = cash,
            _ => self.cash.push((day, cash)),
        }
        let figure = |name: &str| line.get("figures").and_then(|figures| figures.get(name));
        if let Some(count) = figure("individual_subscribers").and_then(Value::as_u64) {
            self.subscribers = count;
        }
        if let Some(count) = figure("enterprise_seats").and_then(Value::as_u64) {
            self.seats = count;
        }
        if let Some(dollars) = figure("recurring_revenue").and_then(Value::as_f64) {
            self.recurring_revenue = dollars;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::session::{Configuration, NewRun, Session, Storage, Via};
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
        assert_eq!(run_course(runs.path(), &id).expect("day 0").cash, [(0, 1_000_000.0)]);
        session.call("set_prices", &json!({"A": 12, "B": 25, "C": 55}), Via::Form).expect("prices");
        session.call("set_daily_spend", &json!({"operations": 200}), Via::Form).expect("spend");
        for _ in 0..3 {
            let forecasts = session.naive_forecasts();
            session.advance("as planned", &forecasts, Via::Form, &mut |_| {}).expect("a week");
        }
        let course = run_course(runs.path(), &id).expect("a course");
        let days: Vec<u32> = course.cash.iter().map(|point| point.0).collect();
        assert_eq!(days, [0, 7, 14, 17]);
        for (day, cash) in &course.cash {
            assert!((cash - session.cash_by_day()[*day as usize]).abs() < 1e-6, "day {day}");
        }
        assert_eq!(course.subscribers, u64::from(session.observe().subscribers));
    }

    #[test]
    fn odd_lines_are_passed_over_and_missing_runs_are_errors() {
        let mut course = RunCourse::default();
        for line in [
            json!({}),
            json!({"kind": "week"}),
            json!({"kind": "week", "day": -1, "cash": 1}),
            json!({"kind": "call", "day": 7, "cash": 1}),
            json!({"kind": "week", "day": 7, "cash": 5, "figures": 3}),
            json!({"kind": "end", "day": 7, "cash": 4}),
        ] {
            course.add(&line);
        }
        assert_eq!(course.cash, [(7, 4.0)]);
        let runs = tempfile::tempdir().expect("a folder");
        assert!(run_course(runs.path(), "nothing").is_err());
    }
}
