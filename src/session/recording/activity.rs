//! The log of user activities other than calls: sessions, views, the clock, time limits.

use std::time::Duration;

use super::RunLog;
use super::machine::Machine;
use novamind_record::clock::{now, seconds};
use novamind_record::trajectory::record::{
    Activity, Clock, ClockEvent, LeavingCause, Limit, LimitEvent, Presence, PresenceEvent, View,
};
use novamind_record::trajectory::{Durability, Record};
use novamind_tools::Refusal;

/// Rationale of a week that is submitted because its time limit was reached.
pub const TIME_LIMIT: &str = "time limit";

/// Time without a key after which a user is idle, if keys are watched.
pub const IDLE_AFTER: Duration = Duration::from_secs(60);

/// The interface of a session, and its window.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Interface {
    /// `console`, `plain` or `http`.
    pub name: &'static str,
    /// Columns and rows of the terminal, if there is one.
    pub window: Option<(u16, u16)>,
}

/// Records activities of the user other than calls. Ignores disk errors, because these lines have no effect on the
/// run.
pub struct ActivityLog<'a> {
    log: &'a mut RunLog,
    day: u32,
    is_over: bool,
}

impl<'a> ActivityLog<'a> {
    pub(crate) fn new(log: &'a mut RunLog, day: u32, is_over: bool) -> ActivityLog<'a> {
        ActivityLog { log, day, is_over }
    }

    /// Records an activity, unless the rules exclude its kind.
    pub fn note(&mut self, activity: Activity) {
        if !self.log.rules.records(activity.kind()) {
            return;
        }
        self.log.answers.note(&activity);
        let durability = if activity.is_evidence() { Durability::Synced } else { Durability::Written };
        let _ = self.log.append((self.day, self.is_over), &Record::Activity(activity), durability);
    }

    /// Records that a user attaches to the run.
    pub fn take_up(&mut self, interface: Interface) {
        let presence = Presence {
            interface: Some(interface.name.to_owned()),
            window: interface.window,
            version: Some(env!("CARGO_PKG_VERSION").to_owned()),
            ..presence(PresenceEvent::Opened)
        };
        self.note(Activity::Session(Box::new(presence)));
        // The clock was stopped when the program closed the run.
        self.start_after(ClockEvent::Forgotten);
    }

    /// Records that the program closes the run.
    pub fn leave(&mut self, cause: LeavingCause) {
        let presence = Presence { cause: Some(cause), ..presence(PresenceEvent::Closed) };
        self.note(Activity::Session(Box::new(presence)));
    }

    /// Records that the user became idle or returned, or that the window changed.
    pub fn note_presence(&mut self, event: PresenceEvent, idle_ms: Option<u64>, window: Option<(u16, u16)>) {
        let presence = Presence { idle_ms, window, ..presence(event) };
        self.note(Activity::Session(Box::new(presence)));
    }

    /// Records a view and its duration.
    pub fn note_view(&mut self, screen: &str, from: &str, for_ms: u64) {
        let view = View { screen: screen.to_owned(), from: from.to_owned(), for_ms };
        self.note(Activity::View(view));
    }

    /// Stops the clock: from now on, time does not count.
    ///
    /// # Errors
    /// `clock_stands`, and `reason_needed` if the rules require a reason and none is given.
    pub fn stop_clock(&mut self, reason: Option<&str>) -> Result<(), Refusal> {
        let reason = reason.map(str::trim).filter(|reason| !reason.is_empty());
        if self.log.clock_stands() {
            return Err(Refusal::new("clock_stands", "the clock is stopped already"));
        }
        if self.log.rules.pause_reason && reason.is_none() {
            return Err(Refusal::new("reason_needed", "give a reason for stopping the clock"));
        }
        let reason = reason.map(str::to_owned);
        self.note_clock(Clock { event: ClockEvent::Stopped, reason, stood_ms: None });
        Ok(())
    }

    /// Starts the clock again. Returns the seconds that it was stopped.
    ///
    /// # Errors
    /// `clock_runs`.
    pub fn start_clock(&mut self) -> Result<f64, Refusal> {
        self.start_after(ClockEvent::Started).ok_or_else(|| Refusal::new("clock_runs", "the clock runs"))
    }

    fn start_after(&mut self, event: ClockEvent) -> Option<f64> {
        let stood = (seconds(&now()) - self.log.clock.stopped?).max(0.0);
        self.note_clock(Clock { event, reason: None, stood_ms: Some((stood * 1e3) as u64) });
        Some(stood)
    }

    fn note_clock(&mut self, clock: Clock) {
        let event = clock.event;
        let stopped = (event == ClockEvent::Stopped).then(|| seconds(&now()));
        self.note(Activity::Clock(clock));
        // Set even if the rules exclude clock lines from the record, because the screen is covered in any case.
        self.log.clock.stopped = stopped;
        self.log.clock.held &= event != ClockEvent::Started;
    }

    /// Returns limits that are near or reached and not reported yet. Records each once.
    pub fn check_limits(&mut self) -> Vec<Limit> {
        if self.is_over || self.log.clock_stands() {
            return Vec::new();
        }
        let mut told = Vec::new();
        for left in self.log.time_left() {
            let Some(event) = self.log.clock.due(left, &self.log.rules.limits) else { continue };
            let used_ms = ((f64::from(left.minutes) * 60.0 - left.seconds) * 1e3) as u64;
            let limit = Limit { limit: left.scope, event, minutes: left.minutes, used_ms };
            self.note(Activity::Limit(limit.clone()));
            // Set even if the rules exclude limit lines from the record.
            self.log.clock.told.insert((limit.limit, event != LimitEvent::Warned));
            self.log.clock.held |= event == LimitEvent::Paused;
            told.push(limit);
        }
        told
    }
}

fn presence(event: PresenceEvent) -> Presence {
    let Machine { id, boot } = Machine::here();
    Presence {
        event,
        cause: None,
        interface: None,
        machine: id,
        boot,
        monotonic_ms: Machine::monotonic_ms(),
        window: None,
        version: None,
        idle_ms: None,
        worlds: None,
    }
}
