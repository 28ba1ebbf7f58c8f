//! The clock of a person: stopping and starting it, and what limits say of the time they were active.

use super::personal_clock::TimeLeft;
use crate::state::Session;
use novamind_record::clock::{now, seconds};
use novamind_record::trajectory::record::{Activity, Clock, ClockEvent, Limit, LimitEvent, LimitScope};
use novamind_tools::Refusal;

/// Rationale of a week that is filed because its time is over.
pub const TIME_LIMIT: &str = "time limit";

impl Session {
    /// Whether the person has stopped the clock.
    pub fn clock_stands(&self) -> bool {
        self.clock.stopped.is_some()
    }

    /// Whether a limit has stopped it, and nobody has started it since: leaving the run does not.
    pub fn is_held(&self) -> bool {
        self.clock.held
    }

    /// Stops the clock: the time from now on is nobody's.
    ///
    /// # Errors
    /// `clock_stands`, and `reason_needed` where the rules ask for a reason and none is given.
    pub fn stop_clock(&mut self, reason: Option<&str>) -> Result<(), Refusal> {
        let reason = reason.map(str::trim).filter(|reason| !reason.is_empty());
        if self.clock_stands() {
            return Err(Refusal::new("clock_stands", "the clock is stopped already"));
        }
        if self.rules().pause_reason && reason.is_none() {
            return Err(Refusal::new("reason_needed", "say why you stop the clock"));
        }
        let reason = reason.map(str::to_owned);
        self.note_clock(Clock { event: ClockEvent::Stopped, reason, stood_ms: None });
        Ok(())
    }

    /// Starts it again; returns the seconds that it stood.
    ///
    /// # Errors
    /// `clock_runs`.
    pub fn start_clock(&mut self) -> Result<f64, Refusal> {
        self.start_after(ClockEvent::Started).ok_or_else(|| Refusal::new("clock_runs", "the clock runs"))
    }

    /// Starts a clock that stood when the program left the run.
    pub(crate) fn start_forgotten_clock(&mut self) {
        self.start_after(ClockEvent::Forgotten);
    }

    fn start_after(&mut self, event: ClockEvent) -> Option<f64> {
        let stood = (seconds(&now()) - self.clock.stopped?).max(0.0);
        self.note_clock(Clock { event, reason: None, stood_ms: Some((stood * 1e3) as u64) });
        Some(stood)
    }

    fn note_clock(&mut self, clock: Clock) {
        let event = clock.event;
        let stopped = (event == ClockEvent::Stopped).then(|| seconds(&now()));
        self.note_activity(Activity::Clock(clock));
        // Where the rules leave clocks out of the record, the screen is covered all the same.
        self.clock.stopped = stopped;
        self.clock.held &= event != ClockEvent::Started;
    }

    /// Time that is left to each limit of the rules; while the clock stands, as when it was stopped.
    pub fn time_left(&self) -> Vec<TimeLeft> {
        let limits = self.rules().limits;
        let all = [
            (LimitScope::Week, limits.week_minutes),
            (LimitScope::Session, limits.session_minutes),
            (LimitScope::Study, limits.study_minutes),
        ];
        let left = |(scope, minutes): (LimitScope, Option<u32>)| {
            let minutes = minutes?;
            let seconds = f64::from(minutes) * 60.0 - self.time_spent(scope).active_ms() as f64 / 1e3;
            Some(TimeLeft { scope, minutes, seconds })
        };
        all.into_iter().filter_map(left).collect()
    }

    /// Limits that are near or reached and were not told yet; each is recorded once.
    pub fn check_limits(&mut self) -> Vec<Limit> {
        let limits = self.rules().limits;
        if self.history.ended.is_some() || self.clock_stands() {
            return Vec::new();
        }
        let mut told = Vec::new();
        for left in self.time_left() {
            let Some(event) = self.clock.due(left, &limits) else { continue };
            let used_ms = ((f64::from(left.minutes) * 60.0 - left.seconds) * 1e3) as u64;
            let limit = Limit { limit: left.scope, event, minutes: left.minutes, used_ms };
            self.note_activity(Activity::Limit(limit.clone()));
            // Also where the rules leave limits out of the record.
            self.clock.told.insert((limit.limit, event != LimitEvent::Warned));
            self.clock.held |= event == LimitEvent::Paused;
            told.push(limit);
        }
        told
    }
}
