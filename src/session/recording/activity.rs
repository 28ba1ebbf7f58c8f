//! The log of user activities other than calls: sessions, screen views, the clock and time limits.

use std::time::Duration;

use super::RunLog;
use super::machine::Machine;
use novamind_record::clock::{now, parse_seconds};
use novamind_record::trajectory::record::{
    Activity, Clock, ClockEvent, DetachCause, Limit, LimitEvent, Presence, PresenceEvent, ScreenView,
};
use novamind_record::trajectory::{Durability, Record};
use novamind_tools::Rejection;

/// Rationale of a week that is submitted because its time limit was reached.
pub const TIME_LIMIT_RATIONALE: &str = "time limit";

/// Time without a key press after which a user is idle, if the interface monitors keys.
pub const IDLE_TIMEOUT: Duration = Duration::from_secs(60);

/// The interface through which a user attaches to a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Interface {
    /// Name of the interface: `console`, `plain` or `http`.
    pub name: &'static str,
    /// Columns and rows of the terminal, if the interface has a terminal.
    pub window: Option<(u16, u16)>,
}

/// A log that records user activities other than calls. Disk errors are ignored, because these lines have no effect on
/// the run.
pub struct ActivityLog<'a> {
    log: &'a mut RunLog,
    day: u32,
    is_over: bool,
}

impl<'a> ActivityLog<'a> {
    pub(crate) fn new(log: &'a mut RunLog, day: u32, is_over: bool) -> ActivityLog<'a> {
        ActivityLog { log, day, is_over }
    }

    /// Records an activity, unless the session rules exclude its kind.
    pub fn record(&mut self, activity: Activity) {
        if !self.log.rules.records_activity(activity.kind()) {
            return;
        }
        self.log.answers.record_activity(&activity);
        let durability = if activity.is_evidence() { Durability::Synced } else { Durability::Written };
        let _ = self.log.append((self.day, self.is_over), &Record::Activity(activity), durability);
    }

    /// Records that a user attaches to the run.
    pub fn attach(&mut self, interface: Interface) {
        let presence = Presence {
            interface: Some(interface.name.to_owned()),
            window: interface.window,
            version: Some(env!("CARGO_PKG_VERSION").to_owned()),
            ..new_presence(PresenceEvent::Opened)
        };
        self.record(Activity::Session(Box::new(presence)));
        // Restart a clock that was still stopped when the program closed the run.
        self.restart_clock(ClockEvent::Forgotten);
    }

    /// Records that the program closes the run.
    pub fn detach(&mut self, cause: DetachCause) {
        let presence = Presence { cause: Some(cause), ..new_presence(PresenceEvent::Closed) };
        self.record(Activity::Session(Box::new(presence)));
    }

    /// Records that the user became idle or returned, or that the window changed.
    pub fn record_presence(
        &mut self,
        event: PresenceEvent,
        idle_ms: Option<u64>,
        window: Option<(u16, u16)>,
    ) {
        let presence = Presence { idle_ms, window, ..new_presence(event) };
        self.record(Activity::Session(Box::new(presence)));
    }

    /// Records a screen view and its duration.
    pub fn record_view(&mut self, screen: &str, from: &str, for_ms: u64) {
        let view = ScreenView { screen: screen.to_owned(), from: from.to_owned(), for_ms };
        self.record(Activity::View(view));
    }

    /// Stops the clock, so that time does not count until the clock is started.
    ///
    /// # Errors
    /// `clock_stands`, and `reason_needed` if the rules require a reason and none is given.
    pub fn stop_clock(&mut self, reason: Option<&str>) -> Result<(), Rejection> {
        let reason = reason.map(str::trim).filter(|reason| !reason.is_empty());
        if self.log.is_clock_stopped() {
            return Err(Rejection::new("clock_stands", "the clock is stopped already"));
        }
        if self.log.rules.pause_reason && reason.is_none() {
            return Err(Rejection::new("reason_needed", "give a reason for stopping the clock"));
        }
        let reason = reason.map(str::to_owned);
        self.record_clock(Clock { event: ClockEvent::Stopped, reason, stood_ms: None });
        Ok(())
    }

    /// Restarts the clock. Returns the seconds for which the clock was stopped.
    ///
    /// # Errors
    /// The rejection `clock_runs`.
    pub fn start_clock(&mut self) -> Result<f64, Rejection> {
        self.restart_clock(ClockEvent::Started)
            .ok_or_else(|| Rejection::new("clock_runs", "the clock is running already"))
    }

    fn restart_clock(&mut self, event: ClockEvent) -> Option<f64> {
        let stood = (parse_seconds(&now()) - self.log.clock.stopped_at?).max(0.0);
        self.record_clock(Clock { event, reason: None, stood_ms: Some((stood * 1e3) as u64) });
        Some(stood)
    }

    fn record_clock(&mut self, clock: Clock) {
        let event = clock.event;
        let stopped = (event == ClockEvent::Stopped).then(|| parse_seconds(&now()));
        self.record(Activity::Clock(clock));
        // Update the clock even if the rules exclude clock lines from the record, because the screen is covered in any
        // case.
        self.log.clock.stopped_at = stopped;
        self.log.clock.is_stopped_by_limit &= event != ClockEvent::Started;
    }

    /// Returns the time limits that are near or reached but have not been reported yet. Records each limit event once.
    pub fn check_limits(&mut self) -> Vec<Limit> {
        if self.is_over || self.log.is_clock_stopped() {
            return Vec::new();
        }
        let mut limits = Vec::new();
        for left in self.log.time_left() {
            let Some(event) = self.log.clock.due_event(left, &self.log.rules.limits) else { continue };
            let used_ms = ((f64::from(left.minutes) * 60.0 - left.seconds) * 1e3) as u64;
            let limit = Limit { limit: left.scope, event, minutes: left.minutes, used_ms };
            self.record(Activity::Limit(limit.clone()));
            // Mark the limit as reported even if the rules exclude limit lines from the record.
            self.log.clock.reported_limits.insert((limit.limit, event != LimitEvent::Warned));
            self.log.clock.is_stopped_by_limit |= event == LimitEvent::Paused;
            limits.push(limit);
        }
        limits
    }
}

fn new_presence(event: PresenceEvent) -> Presence {
    let Machine { id, boot } = Machine::current();
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
