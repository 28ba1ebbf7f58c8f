//! Stopping the clock, and time limits, in plain mode.

use std::time::Duration;

use serde_json::json;

use super::answers::Answer;
use super::commands::Interpreter;
use super::grammar::Line;
use super::next::{self, Filing};
use novamind_record::trajectory::record::{Limit, LimitEvent};
use novamind_session::TIME_LIMIT;
use novamind_tools::Refusal;

/// Commands that work while the clock is stopped.
const WHILE_STOPPED: [&str; 4] = ["resume", "help", "quit", "exit"];
/// Interval between checks of the limits while waiting for a line.
const BETWEEN_LOOKS: Duration = Duration::from_secs(1);

impl Interpreter {
    /// `pause [REASON]`.
    pub(super) fn pause(&mut self, reason: &str) -> Answer {
        match self.session.activity().stop_clock(Some(reason)) {
            Ok(()) => {
                let text = "the clock is stopped; resume restarts it".to_owned();
                Answer::done("pause", text, json!({ "stopped": true }))
            }
            Err(refusal) => Answer::refused("pause", refusal),
        }
    }

    /// `resume`, with the experimenter's code if a limit stopped the clock.
    pub(super) fn resume(&mut self, code: &str) -> Answer {
        let right = self.code_check.as_ref().is_none_or(|check| check(code));
        if self.session.log().is_held() && !right {
            let text = "the time limit is reached; the experimenter starts the clock with resume CODE";
            return Answer::refused("resume", Refusal::new("code_needed", text));
        }
        match self.session.activity().start_clock() {
            Ok(stood) => {
                let text = format!("the clock is running; it was stopped for {stood:.0} s");
                Answer::done("resume", text, json!({ "stood_seconds": stood }))
            }
            Err(refusal) => Answer::refused("resume", refusal),
        }
    }

    /// Rejects commands that show the run or act on it while the clock is stopped.
    pub(super) fn refuse_while_stopped(&self, line: &Line) -> Option<Answer> {
        let word = match line {
            Line::Empty => return None,
            Line::Text { word, .. } | Line::Call { word, .. } => word,
        };
        if !self.session.log().clock_stands() || WHILE_STOPPED.contains(&word.as_str()) {
            return None;
        }
        let text = "the clock is stopped: type resume to restart it; help and quit work, too";
        Some(Answer::refused(word, Refusal::new("clock_stopped", text)))
    }

    /// Reports limits that are near or reached, and applies their consequences.
    pub(super) fn check_limits(&mut self) -> Vec<Answer> {
        let told = self.session.activity().check_limits();
        told.into_iter().flat_map(|limit| self.reach(&limit)).collect()
    }

    fn reach(&mut self, limit: &Limit) -> Vec<Answer> {
        let left = self.session.log().time_left().into_iter().find(|left| left.scope == limit.limit);
        let words = left.map_or(String::new(), |left| left.in_words());
        let follows = left.map_or("", |left| left.what_follows(self.session.rules().limits.at_limit));
        let data = json!({ "limit": limit.limit, "event": limit.event, "minutes": limit.minutes, "used_ms": limit.used_ms });
        let tell = |what: &str| Answer::done("limit", format!("time limit: {words}{what}"), data.clone());
        match limit.event {
            LimitEvent::Warned => vec![tell(&format!("; {follows}"))],
            LimitEvent::Reminded => vec![tell("; please finish soon")],
            LimitEvent::FiledNaively => {
                let filing = Filing::at_limit(&self.session);
                let filed = next::run(&mut self.session, filing);
                vec![tell("; the week is submitted with the naive projection"), filed]
            }
            LimitEvent::Paused => {
                let stopped = self.session.activity().stop_clock(Some(TIME_LIMIT));
                let rest = if self.code_check.is_some() { "resume CODE" } else { "resume" };
                let stopped = stopped.map_or("", |()| "; the clock is stopped");
                vec![tell(&format!("{stopped}; {rest} restarts it"))]
            }
        }
    }

    /// Returns how long to wait for a line before the limits are checked again. Returns `None` if there are no limits.
    pub(super) fn patience(&self) -> Option<Duration> {
        let limits = !self.session.log().time_left().is_empty() && !self.session.log().clock_stands();
        limits.then_some(BETWEEN_LOOKS)
    }

    /// Returns the prompt.
    pub(super) fn prompt_text(&self) -> String {
        if self.session.log().clock_stands() {
            return "clock stopped> ".to_owned();
        }
        let day = self.session.day();
        let least = self
            .session
            .log()
            .time_left()
            .into_iter()
            .min_by(|one, other| one.seconds.total_cmp(&other.seconds));
        match least {
            Some(left) => format!("day {day} · {}> ", left.in_words()),
            None => format!("day {day}> "),
        }
    }

    /// Stops the clock again if a time limit had stopped it before the run was reopened.
    pub(super) fn hold_limit(&mut self) -> Option<Answer> {
        if !self.session.log().is_held() {
            return None;
        }
        // The clock may already be stopped.
        let _ = self.session.activity().stop_clock(Some(TIME_LIMIT));
        let rest = if self.code_check.is_some() { "resume CODE" } else { "resume" };
        let text = format!("a time limit has stopped the clock; {rest} restarts it");
        Some(Answer::done("limit", text, json!({ "stopped": true })))
    }
}
