//! Who is there, and when: the program taking up and leaving a run, on which machine, by which clocks.

use std::time::Duration;

use crate::figures::attendance::TimeSpent;
use crate::play::machine::Machine;
use crate::play::recorder::Recorder;
use crate::state::Session;
use novamind_record::clock::{nanoseconds, now};
use novamind_record::trajectory::record::{Activity, LeavingCause, LimitScope, Presence, PresenceEvent};
use novamind_record::trajectory::{Durability, Record};

/// Time without a key after which a person counts as idle, where keys are watched.
pub const IDLE_AFTER: Duration = Duration::from_secs(60);

/// What a person plays with, and in which window.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Interface {
    /// `console`, `plain`, `http`.
    pub name: &'static str,
    /// Columns and rows of the terminal, where there is one.
    pub window: Option<(u16, u16)>,
}

impl Session {
    /// Records that a person takes up the run.
    pub fn take_up(&mut self, interface: Interface) {
        let presence = Presence {
            interface: Some(interface.name.to_owned()),
            window: interface.window,
            version: Some(env!("CARGO_PKG_VERSION").to_owned()),
            ..presence(PresenceEvent::Opened)
        };
        self.note_activity(Activity::Session(Box::new(presence)));
        self.start_forgotten_clock();
    }

    /// Records that the program leaves the run.
    pub fn leave(&mut self, cause: LeavingCause) {
        let presence = Presence { cause: Some(cause), ..presence(PresenceEvent::Closed) };
        self.note_activity(Activity::Session(Box::new(presence)));
    }

    /// Records that the person went away or came back, or that the window changed.
    pub fn note_presence(&mut self, event: PresenceEvent, idle_ms: Option<u64>, window: Option<(u16, u16)>) {
        let presence = Presence { idle_ms, window, ..presence(event) };
        self.note_activity(Activity::Session(Box::new(presence)));
    }

    /// What was spent of what a time limit is on, up to now; nothing of a run that is only read.
    pub fn time_spent(&self, scope: LimitScope) -> TimeSpent {
        let attendance = self.recorder.as_ref().map(Recorder::attendance);
        attendance.map(|time| time.so_far(scope, nanoseconds(&now()))).unwrap_or_default()
    }

    /// Records something that a person did besides acting, unless the rules leave it out. It changes nothing, so a disk
    /// that refuses it is no reason to stop.
    pub fn note_activity(&mut self, activity: Activity) {
        if !self.rules().records(activity.kind()) {
            return;
        }
        self.answers.note(&activity);
        let durability = if activity.is_evidence() { Durability::Synced } else { Durability::Written };
        let _ = self.append(&Record::Activity(activity), durability);
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
