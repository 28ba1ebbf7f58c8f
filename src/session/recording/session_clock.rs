//! The state of the user's clock and of the time limits, derived from the lines of a run.

use std::collections::BTreeSet;

use crate::figures::attendance::SESSION_BREAK_SECONDS;
use novamind_record::rules::{LimitAction, TimeLimits};
use novamind_record::trajectory::record::{Activity, ClockEvent, LimitEvent, LimitScope, PresenceEvent};
use novamind_record::trajectory::{Record, Trajectory};

#[derive(Debug, Clone, Default)]
pub(crate) struct SessionClock {
    /// Time at which the clock was stopped, in seconds since the Unix epoch; `None` while the clock is running.
    pub(super) stopped_at: Option<f64>,
    /// Whether a time limit has stopped the clock and the clock was not started since.
    pub(super) is_stopped_by_limit: bool,
    /// Reported limits. The flag is true if the limit was reached, and false if the limit was near.
    pub(super) reported_limits: BTreeSet<(LimitScope, bool)>,
    /// Limits that have stopped the clock. They stop the clock only once.
    pausing_limits: BTreeSet<LimitScope>,
    /// Time of the last line, in seconds since the Unix epoch.
    last_line_at: Option<f64>,
}

/// A time limit and the time that is left until it is reached.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TimeLeft {
    /// Scope of the limit.
    pub scope: LimitScope,
    /// Allowed time in minutes.
    pub minutes: u32,
    /// Seconds left until the limit is reached; negative if the limit is exceeded.
    pub seconds: f64,
}

impl SessionClock {
    pub(crate) fn from_trajectory(trajectory: &Trajectory) -> SessionClock {
        let mut clock = SessionClock::default();
        trajectory.lines.iter().for_each(|line| clock.apply(&line.record, line.at_seconds()));
        clock
    }

    /// Updates the state with a line. `at` is the time at which the line was written, in seconds since the Unix epoch.
    pub(crate) fn apply(&mut self, record: &Record, at: f64) {
        match record {
            Record::Branch(_) => *self = SessionClock::default(),
            Record::Week(_) => self.forget_limit(LimitScope::Week),
            Record::Activity(Activity::Session(presence)) if presence.event == PresenceEvent::Opened => {
                if self.last_line_at.is_some_and(|last| at - last >= SESSION_BREAK_SECONDS) {
                    self.forget_limit(LimitScope::Session);
                }
                // Near and reached limits are reported again after the run was opened, because the program may have
                // ended before it showed the warning or submitted the week.
                let pausing = &self.pausing_limits;
                self.reported_limits.retain(|(scope, reached)| *reached && pausing.contains(scope));
            }
            Record::Activity(Activity::Clock(clock)) => {
                self.stopped_at = (clock.event == ClockEvent::Stopped).then_some(at);
                self.is_stopped_by_limit &= clock.event != ClockEvent::Started;
            }
            Record::Activity(Activity::Limit(limit)) => {
                self.reported_limits.insert((limit.limit, limit.event != LimitEvent::Warned));
                if limit.event == LimitEvent::Paused {
                    self.is_stopped_by_limit = true;
                    self.pausing_limits.insert(limit.limit);
                }
            }
            _ => {}
        }
        self.last_line_at = Some(at);
    }

    fn forget_limit(&mut self, of: LimitScope) {
        self.reported_limits.retain(|(scope, _)| *scope != of);
        self.pausing_limits.remove(&of);
    }

    /// Returns the event of a time limit that must be reported now, if any.
    pub(super) fn due_event(&self, left: TimeLeft, limits: &TimeLimits) -> Option<LimitEvent> {
        let is_reported = |reached| self.reported_limits.contains(&(left.scope, reached));
        if left.seconds <= 0.0 {
            return (!is_reported(true)).then_some(match (limits.at_limit, left.scope) {
                (LimitAction::Remind, _) => LimitEvent::Reminded,
                (LimitAction::Naive, LimitScope::Week) => LimitEvent::FiledNaively,
                // Only a week can be submitted automatically. For other limits, stop the clock.
                (LimitAction::Naive | LimitAction::Pause, _) => LimitEvent::Paused,
            });
        }
        let warning = limits.warning_minutes.map(|minutes| f64::from(minutes) * 60.0)?;
        (left.seconds <= warning && !is_reported(false) && !is_reported(true)).then_some(LimitEvent::Warned)
    }
}

impl TimeLeft {
    /// Returns the minutes left, rounded up.
    pub fn whole_minutes(&self) -> i64 {
        (self.seconds / 60.0).ceil() as i64
    }

    /// Describes the limit and the time left, for the user.
    pub fn describe(&self) -> String {
        let scope = match self.scope {
            LimitScope::Week => "this week",
            LimitScope::Session => "this session",
            LimitScope::Study => "the study",
        };
        match self.whole_minutes() {
            minutes if minutes <= 0 => format!("the {} min for {scope} are used up", self.minutes),
            minutes => format!("{minutes} of {} min left for {scope}", self.minutes),
        }
    }

    /// Describes the consequence of reaching the limit.
    pub fn describe_consequence(&self, at_limit: LimitAction) -> &'static str {
        match at_limit {
            LimitAction::Remind => "then you are asked to finish",
            LimitAction::Naive if self.scope == LimitScope::Week => {
                "then the week is submitted with naive forecasts, without your text"
            }
            LimitAction::Naive | LimitAction::Pause => "then the clock is stopped",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use novamind_record::trajectory::record::{Clock, ClosedDays, Limit};

    fn limit_record(limit: LimitScope, event: LimitEvent) -> Record {
        Record::Activity(Activity::Limit(Limit { limit, event, minutes: 10, used_ms: 0 }))
    }

    fn clock_record(event: ClockEvent) -> Record {
        Record::Activity(Activity::Clock(Clock { event, reason: None, stood_ms: None }))
    }

    #[test]
    fn limit_events_are_reported_once() {
        let limits =
            TimeLimits { warning_minutes: Some(2), at_limit: LimitAction::Naive, ..TimeLimits::default() };
        let left = |scope, seconds| TimeLeft { scope, minutes: 10, seconds };
        let mut session_clock = SessionClock::default();
        assert_eq!(session_clock.due_event(left(LimitScope::Week, 121.0), &limits), None);
        assert_eq!(session_clock.due_event(left(LimitScope::Week, 119.0), &limits), Some(LimitEvent::Warned));
        session_clock.apply(&limit_record(LimitScope::Week, LimitEvent::Warned), 0.0);
        assert_eq!(session_clock.due_event(left(LimitScope::Week, 60.0), &limits), None);
        assert_eq!(
            session_clock.due_event(left(LimitScope::Week, 0.0), &limits),
            Some(LimitEvent::FiledNaively)
        );
        session_clock.apply(&limit_record(LimitScope::Week, LimitEvent::FiledNaively), 0.0);
        assert_eq!(session_clock.due_event(left(LimitScope::Week, -5.0), &limits), None);
        let (figures, state_hash, parts) = Default::default();
        session_clock
            .apply(&Record::Week(ClosedDays { days_run: 7, figures, cash: 0.0, state_hash, parts }), 0.0);
        assert_eq!(
            session_clock.due_event(left(LimitScope::Week, 100.0), &limits),
            Some(LimitEvent::Warned),
            "a new week"
        );
        let paused = session_clock.due_event(left(LimitScope::Session, 0.0), &limits);
        assert_eq!(paused, Some(LimitEvent::Paused), "a session cannot be submitted");
        assert_eq!(left(LimitScope::Week, 61.0).describe(), "2 of 10 min left for this week");
    }

    fn opened_record() -> Record {
        Record::Activity(Activity::Session(Box::new(novamind_record::trajectory::record::Presence {
            event: PresenceEvent::Opened,
            cause: None,
            interface: Some("console".to_owned()),
            machine: String::new(),
            boot: String::new(),
            monotonic_ms: 0,
            window: None,
            version: None,
            idle_ms: None,
            worlds: None,
        })))
    }

    #[test]
    fn reached_limit_is_applied_again_after_the_program_was_killed() {
        let limits = TimeLimits { at_limit: LimitAction::Naive, ..TimeLimits::default() };
        let reached = |scope| TimeLeft { scope, minutes: 10, seconds: -1.0 };
        let mut clock = SessionClock::default();
        clock.apply(&limit_record(LimitScope::Week, LimitEvent::FiledNaively), 5.0);
        assert_eq!(clock.due_event(reached(LimitScope::Week), &limits), None);
        // The program was killed before it submitted the week.
        clock.apply(&opened_record(), 9.0);
        let due = clock.due_event(reached(LimitScope::Week), &limits);
        assert_eq!(due, Some(LimitEvent::FiledNaively));
    }

    #[test]
    fn limit_that_the_experimenter_lifted_stays_lifted_within_the_session() {
        let limits = TimeLimits { at_limit: LimitAction::Pause, ..TimeLimits::default() };
        let reached = TimeLeft { scope: LimitScope::Session, minutes: 10, seconds: -1.0 };
        let mut clock = SessionClock::default();
        clock.apply(&limit_record(LimitScope::Session, LimitEvent::Paused), 0.0);
        clock.apply(&clock_record(ClockEvent::Started), 5.0);
        clock.apply(&opened_record(), 9.0);
        assert_eq!(clock.due_event(reached, &limits), None);
        clock.apply(&opened_record(), 9.0 + SESSION_BREAK_SECONDS);
        assert_eq!(clock.due_event(reached, &limits), Some(LimitEvent::Paused));
    }

    #[test]
    fn clock_stopped_by_limit_stays_stopped_until_started() {
        let mut session_clock = SessionClock::default();
        for record in [
            limit_record(LimitScope::Study, LimitEvent::Paused),
            clock_record(ClockEvent::Stopped),
            clock_record(ClockEvent::Forgotten),
        ] {
            session_clock.apply(&record, 5.0);
        }
        assert!(
            session_clock.is_stopped_by_limit && session_clock.stopped_at.is_none(),
            "closing the run does not start it"
        );
        session_clock.apply(&clock_record(ClockEvent::Started), 6.0);
        assert!(!session_clock.is_stopped_by_limit);
    }
}
