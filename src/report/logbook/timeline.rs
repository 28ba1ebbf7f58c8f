//! The lines of a trajectory as spans of time: one for each week and what was done before it.

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use super::Effort;
use crate::session::Line;

/// Seconds without a line after which somebody is taken to be away: ten minutes.
pub const BREAK_SECONDS: f64 = 600.0;

/// A time without a line.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Pause {
    /// Day of the run.
    pub day: u32,
    /// When it began, RFC 3339.
    pub from: String,
    /// When it ended, RFC 3339.
    pub to: String,
    /// How long it was.
    pub seconds: f64,
}

/// A forecast as a line has it.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub(super) struct Said {
    pub horizon_days: u32,
    pub point: f64,
    pub lower: f64,
    pub upper: f64,
    #[serde(default)]
    pub filled_naively: bool,
}

/// What was done before a week, and the week.
#[derive(Debug, Clone, Default)]
pub(super) struct Span {
    pub decision_day: u32,
    pub day: u32,
    pub days_run: u32,
    pub inherited: bool,
    pub began_at: String,
    pub decided_at: String,
    pub effort: Effort,
    pub rationale: Option<String>,
    pub forecasts: Vec<Said>,
    pub figures: Map<String, Value>,
    pub state_hash: String,
}

/// All spans of a run.
#[derive(Debug, Clone, Default)]
pub(super) struct Timeline {
    /// One for each line that closes days.
    pub spans: Vec<Span>,
    /// What came after the last of them.
    pub open: Span,
    pub breaks: Vec<Pause>,
    pub clock_set_back: u32,
}

impl Timeline {
    /// Reads lines in their order.
    pub fn of(lines: &[Line]) -> Timeline {
        let mut timeline = Timeline::default();
        // What a branch took over was played in another run, at another time.
        let copied = lines.iter().position(|line| line.kind == "branch").unwrap_or(0);
        let mut before: Option<&Line> = None;
        for (at, line) in lines.iter().enumerate() {
            if timeline.open.began_at.is_empty() {
                timeline.open.began_at = before.unwrap_or(line).at.clone();
                timeline.open.decision_day = before.unwrap_or(line).day;
            }
            timeline.open.inherited = at < copied;
            if let Some(before) = before.filter(|_| at > copied) {
                timeline.pass_time(before, line);
            }
            timeline.count(line);
            before = Some(line);
        }
        timeline
    }

    /// Counts the time between two lines. The time before a week's closing line is the simulator's.
    fn pass_time(&mut self, before: &Line, line: &Line) {
        if line.closes_days() {
            return;
        }
        let passed = line.moment() - before.moment();
        if passed < 0.0 {
            self.clock_set_back += 1;
            return;
        }
        let effort = &mut self.open.effort;
        effort.elapsed_seconds += passed;
        if passed <= BREAK_SECONDS {
            effort.active_seconds += passed;
            return;
        }
        effort.breaks += 1;
        self.breaks.push(Pause {
            day: line.day,
            from: before.at.clone(),
            to: line.at.clone(),
            seconds: passed,
        });
    }

    fn count(&mut self, line: &Line) {
        let text = |name: &str| line.fields.get(name).and_then(Value::as_str).unwrap_or_default().to_owned();
        let effort = &mut self.open.effort;
        match line.kind.as_str() {
            "call" if line.is_accepted_call() => {
                effort.calls += 1;
                effort.undone += u32::from(line.fields.contains_key("undoes"));
                *effort.tools.entry(text("tool")).or_default() += 1;
            }
            "call" => effort.refused += 1,
            "query" => {
                effort.queries += 1;
                effort.queries_failed +=
                    u32::from(line.fields.get("error").is_some_and(|error| !error.is_null()));
            }
            "view" => {
                let seconds = self.seconds_looked(line);
                let effort = &mut self.open.effort;
                effort.views += 1;
                *effort.screens.entry(text("screen")).or_default() += seconds;
            }
            "memo" => effort.memos += 1,
            "advance" => {
                self.open.decided_at.clone_from(&line.at);
                self.open.rationale = Some(text("rationale"));
                let said = line.fields.get("forecasts").cloned().unwrap_or_default();
                self.open.forecasts = serde_json::from_value(said).unwrap_or_default();
            }
            _ if line.closes_days() => self.close(line),
            _ => {}
        }
    }

    /// Seconds of a view without the breaks that fall into it.
    fn seconds_looked(&self, line: &Line) -> f64 {
        let looked = line.fields.get("for_ms").and_then(Value::as_f64).unwrap_or(0.0) / 1e3;
        let away = self.breaks.iter().rev().map_while(|pause| {
            // Only the break that this line ended, and older ones as far as the view reaches back.
            let until = crate::session::moment_of(&pause.to);
            (until > line.moment() - looked).then_some((until, pause.seconds))
        });
        let from = line.moment() - looked;
        let away: f64 = away.map(|(until, seconds)| seconds.min(until - from)).sum();
        (looked - away).max(0.0)
    }

    fn close(&mut self, line: &Line) {
        let mut span = std::mem::take(&mut self.open);
        let number = |name: &str| line.fields.get(name).and_then(Value::as_u64).unwrap_or(0);
        span.day = line.day;
        span.days_run = number("days_run") as u32;
        span.decision_day = line.day.saturating_sub(span.days_run);
        if span.decided_at.is_empty() {
            span.decided_at.clone_from(&line.at);
        }
        span.figures = line.fields.get("figures").and_then(Value::as_object).cloned().unwrap_or_default();
        span.state_hash =
            line.fields.get("state_hash").and_then(Value::as_str).unwrap_or_default().to_owned();
        self.spans.push(span);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn lines(all: &[(&str, &str, Value)]) -> Vec<Line> {
        let line = |(at, (moment, kind, fields)): (usize, &(&str, &str, Value))| Line {
            seq: at as u64,
            kind: (*kind).to_owned(),
            day: 0,
            at: format!("2026-11-21T{moment}Z"),
            fields: fields.as_object().cloned().unwrap_or_default(),
            hash: String::new(),
        };
        all.iter().enumerate().map(line).collect()
    }

    #[test]
    fn breaks_are_counted_apart_and_the_simulator_takes_no_time_of_the_player() {
        let timeline = Timeline::of(&lines(&[
            ("10:00:00", "start", json!({})),
            ("10:05:00", "call", json!({"ok": true, "tool": "set_prices"})),
            ("10:30:00", "view", json!({"screen": "cash", "from": "", "for_ms": 1_560_000})),
            ("10:31:00", "advance", json!({"rationale": "wait"})),
            ("10:32:00", "week", json!({"days_run": 7})),
            ("10:33:00", "query", json!({"sql": "x", "error": null})),
        ]));
        let effort = &timeline.spans[0].effort;
        assert_eq!((effort.elapsed_seconds, effort.active_seconds, effort.breaks), (1860.0, 360.0, 1));
        assert_eq!(timeline.breaks[0].seconds, 1500.0);
        assert_eq!(effort.screens["cash"], 60.0, "26 minutes less the break of 25");
        assert_eq!((timeline.open.effort.queries, timeline.open.effort.queries_failed), (1, 0));
        assert_eq!(timeline.open.effort.active_seconds, 60.0);
    }

    #[test]
    fn a_clock_that_was_set_back_takes_no_time_away() {
        let timeline = Timeline::of(&lines(&[
            ("10:00:00", "start", json!({})),
            ("10:01:00", "memo", json!({})),
            ("09:00:00", "memo", json!({})),
            ("09:02:00", "memo", json!({})),
        ]));
        assert_eq!((timeline.open.effort.active_seconds, timeline.clock_set_back), (180.0, 1));
    }

    #[test]
    fn weeks_of_a_parent_are_marked_and_take_no_time() {
        let timeline = Timeline::of(&lines(&[
            ("10:00:00", "start", json!({})),
            ("10:00:01", "advance", json!({"rationale": "x"})),
            ("10:00:02", "week", json!({"days_run": 7})),
            ("10:00:03", "branch", json!({})),
            ("10:01:03", "advance", json!({"rationale": "y"})),
            ("10:01:04", "week", json!({"days_run": 7})),
        ]));
        let seen: Vec<(bool, f64)> =
            timeline.spans.iter().map(|span| (span.inherited, span.effort.active_seconds)).collect();
        assert_eq!(seen, [(true, 0.0), (false, 60.0)]);
    }
}
