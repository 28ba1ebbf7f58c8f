//! The stopped clock and the time limits in plain mode.

use std::time::Duration;

use serde_json::json;

use super::advance::NextWeekInput;
use super::commands::Interpreter;
use super::grammar::ParsedLine;
use super::response::CommandResponse;
use novamind_record::trajectory::record::{Limit, LimitEvent};
use novamind_session::TIME_LIMIT_RATIONALE;
use novamind_study::CodeOutcome;
use novamind_tools::Rejection;

/// Commands that are allowed while the clock is stopped.
const ALLOWED_WHILE_PAUSED: [&str; 4] = ["resume", "help", "quit", "exit"];
/// Interval between checks of the time limits while waiting for a line.
const LIMIT_CHECK_INTERVAL: Duration = Duration::from_secs(1);

impl Interpreter {
    /// Executes `pause [REASON]`.
    pub(super) fn pause(&mut self, reason: &str) -> CommandResponse {
        match self.session.activity().stop_clock(Some(reason)) {
            Ok(()) => {
                let text = "the clock is stopped. To restart it, type: resume".to_owned();
                CommandResponse::success("pause", text, json!({ "stopped": true }))
            }
            Err(rejection) => CommandResponse::rejected("pause", rejection),
        }
    }

    /// Executes `resume`. If a time limit stopped the clock, the experimenter's code is required.
    pub(super) fn resume(&mut self, code: &str) -> CommandResponse {
        let outcome = self.check_limit_code(code);
        if outcome != CodeOutcome::Right {
            let text = match outcome {
                CodeOutcome::Wait(_) => outcome.describe(),
                _ => "the time limit is reached. To restart the clock, the experimenter types: resume CODE"
                    .to_owned(),
            };
            return CommandResponse::rejected("resume", Rejection::new("code_needed", text));
        }
        match self.session.activity().start_clock() {
            Ok(stood) => {
                let text = format!("the clock is running; it was stopped for {stood:.0} s");
                CommandResponse::success("resume", text, json!({ "stood_seconds": stood }))
            }
            Err(rejection) => CommandResponse::rejected("resume", rejection),
        }
    }

    /// Checks the experimenter's code if a time limit has stopped the clock. An empty code is not an attempt.
    fn check_limit_code(&self, code: &str) -> CodeOutcome {
        match &self.code_check {
            Some(_) if self.session.log().is_stopped_by_limit() && code.trim().is_empty() => {
                CodeOutcome::Wrong
            }
            Some(check) if self.session.log().is_stopped_by_limit() => check(code),
            _ => CodeOutcome::Right,
        }
    }

    /// Rejects commands that show or change the run while the clock is stopped.
    pub(super) fn reject_while_paused(&self, line: &ParsedLine) -> Option<CommandResponse> {
        let word = match line {
            ParsedLine::Empty => return None,
            ParsedLine::TextCommand { word, .. } | ParsedLine::Call { word, .. } => word,
        };
        if !self.session.log().is_clock_stopped() || ALLOWED_WHILE_PAUSED.contains(&word.as_str()) {
            return None;
        }
        let text = "the clock is stopped. To restart it, type: resume. The commands help and quit also work";
        Some(CommandResponse::rejected(word, Rejection::new("clock_stopped", text)))
    }

    /// Reports time limits that are near or reached, and applies the consequences of reached limits.
    pub(super) fn check_limits(&mut self) -> Vec<CommandResponse> {
        let limits = self.session.activity().check_limits();
        limits.into_iter().flat_map(|limit| self.apply_limit(&limit)).collect()
    }

    fn apply_limit(&mut self, limit: &Limit) -> Vec<CommandResponse> {
        let left = self.session.log().time_left().into_iter().find(|left| left.scope == limit.limit);
        let words = left.map_or(String::new(), |left| left.describe());
        let follows = left.map_or("", |left| left.describe_consequence(self.session.rules().limits.at_limit));
        let data = json!({ "limit": limit.limit, "event": limit.event, "minutes": limit.minutes, "used_ms": limit.used_ms });
        let limit_response = |what: &str| {
            CommandResponse::success("limit", format!("time limit: {words}{what}"), data.clone())
        };
        match limit.event {
            LimitEvent::Warned => vec![limit_response(&format!("; {follows}"))],
            LimitEvent::Reminded => vec![limit_response("; please finish soon")],
            LimitEvent::FiledNaively => {
                let filing = NextWeekInput::for_time_limit(&self.session);
                let filed = self.advance(filing);
                vec![limit_response("; the week is submitted with naive forecasts"), filed]
            }
            LimitEvent::Paused => {
                let stopped = self.session.activity().stop_clock(Some(TIME_LIMIT_RATIONALE));
                let rest = if self.code_check.is_some() { "resume CODE" } else { "resume" };
                let stopped = stopped.map_or("", |()| "; the clock is stopped");
                vec![limit_response(&format!("{stopped}; to restart the clock, type: {rest}"))]
            }
        }
    }

    /// Returns the time to wait for a line before the time limits are checked again. Returns `None` if there are no limits.
    pub(super) fn limit_check_timeout(&self) -> Option<Duration> {
        let limits = !self.session.log().time_left().is_empty() && !self.session.log().is_clock_stopped();
        limits.then_some(LIMIT_CHECK_INTERVAL)
    }

    /// Returns the text of the prompt, with the day and the state of the clock.
    pub(super) fn prompt_text(&self) -> String {
        if self.session.log().is_clock_stopped() {
            return "clock stopped> ".to_owned();
        }
        let day = self.session.day();
        let min = self
            .session
            .log()
            .time_left()
            .into_iter()
            .min_by(|one, other| one.seconds.total_cmp(&other.seconds));
        match min {
            Some(left) => format!("day {day} · {}> ", left.describe()),
            None => format!("day {day}> "),
        }
    }

    /// Stops the clock again if a time limit had stopped the clock before the run was reopened.
    pub(super) fn restore_limit_pause(&mut self) -> Option<CommandResponse> {
        if !self.session.log().is_stopped_by_limit() {
            return None;
        }
        // The clock may already be stopped.
        let _ = self.session.activity().stop_clock(Some(TIME_LIMIT_RATIONALE));
        let rest = if self.code_check.is_some() { "resume CODE" } else { "resume" };
        let text = format!("a time limit has stopped the clock. To restart it, type: {rest}");
        Some(CommandResponse::success("limit", text, json!({ "stopped": true })))
    }
}
