//! Previews of runs for lists and comparisons, read without simulation from the lines that close weeks.

use std::io::{BufRead, BufReader};
use std::path::Path;

use serde::Serialize;
use serde_json::Value;

use super::manifest_check::ManifestCheck;
use super::runs::run_folder;
use crate::error::RunError;
use crate::files::open_regular_file;
use crate::trajectory::{Line, Record};

/// Cash by week and the final subscribers of a run.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct RunPreview {
    /// Day and cash at the start of the run and at the end of each week.
    pub cash: Vec<(u32, f64)>,
    /// Active subscriptions of individuals after the last week.
    pub subscribers: u64,
    /// Enterprise seats after the last week.
    pub seats: u64,
    /// Monthly recurring revenue after the last week, dollars.
    pub recurring_revenue: f64,
}

/// Reads the preview of a run. Skips unreadable lines; opening the run reports these lines.
///
/// # Errors
/// The run or its files do not exist.
pub fn read_preview(runs: &Path, id: &str) -> Result<RunPreview, RunError> {
    let folder = run_folder(runs, id);
    let ManifestCheck { manifest, .. } = ManifestCheck::read(&folder)?;
    let path = folder.join("trajectory.jsonl");
    let file = open_regular_file(&path).map_err(RunError::io(&path))?;
    let mut preview = RunPreview { cash: vec![(0, manifest.cash)], ..RunPreview::default() };
    let closing = ["\"kind\":\"week\"", "\"kind\":\"step\"", "\"kind\":\"end\""];
    for line in BufReader::new(file).split(b'\n') {
        let line = line.map_err(RunError::io(&path))?;
        let text = String::from_utf8_lossy(&line);
        // Most lines are tool calls, so parse only lines that may close a week or the run.
        if closing.iter().any(|kind| text.contains(kind))
            && let Some(line) = Line::parse_unchecked(text.as_bytes())
        {
            preview.add_closed_days(line.day, &line.record);
        }
    }
    Ok(preview)
}

impl RunPreview {
    fn add_closed_days(&mut self, day: u32, record: &Record) {
        let cash = match record {
            Record::Week(closing) | Record::Step(closing) => closing.cash,
            Record::End(end) => end.cash,
            _ => return,
        };
        match self.cash.last_mut() {
            Some(last) if last.0 == day => last.1 = cash,
            _ => self.cash.push((day, cash)),
        }
        let Some(figures) = record.closed_days().map(|closing| &closing.figures) else { return };
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
