//! How often the program took up a run, as its lines tell. The one definition, for tables and audit.

use std::collections::BTreeSet;

use serde::Serialize;

use super::attendance::WATCHES_KEYS;
use novamind_record::trajectory::record::{Activity, ClockEvent, PresenceEvent};
use novamind_record::trajectory::{Line, Record, end_of};

/// How often the program took up the run.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct SittingCount {
    /// How often; 0 where lines do not tell.
    pub opened: u32,
    /// Of them, in the console, which sees screens, dialogs and keys.
    pub in_console: u32,
    /// How often it did not leave the run before it took it up again, or, of an unfinished run, at all: it was killed, or
    /// still plays.
    pub not_closed: u32,
    /// How often the clock was stopped.
    pub clock_stopped: u32,
    /// Machines it was played on.
    pub machines: u32,
}

impl SittingCount {
    /// Counts in the lines of a trajectory.
    pub fn of(lines: &[Line]) -> SittingCount {
        let (mut count, mut machines, mut is_open) = (SittingCount::default(), BTreeSet::new(), false);
        for line in lines {
            let presence = match &line.record {
                Record::Activity(Activity::Session(presence)) => presence,
                Record::Activity(Activity::Clock(clock)) => {
                    count.clock_stopped += u32::from(clock.event == ClockEvent::Stopped);
                    continue;
                }
                _ => continue,
            };
            machines.insert(presence.machine.as_str());
            match presence.event {
                PresenceEvent::Opened => {
                    count.opened += 1;
                    count.in_console += u32::from(presence.interface.as_deref() == Some(WATCHES_KEYS));
                    count.not_closed += u32::from(is_open);
                    is_open = true;
                }
                PresenceEvent::Closed => is_open = false,
                _ => {}
            }
        }
        // What closes the sitting in which a run ends stands after its end.
        count.not_closed += u32::from(is_open && end_of(lines).is_none());
        count.machines = machines.len() as u32;
        count
    }
}
