//! Counts of sessions from the lines of a run, for tables and audits.

use std::collections::BTreeSet;

use serde::Serialize;

use super::attendance::KEY_WATCHING_INTERFACE;
use novamind_record::trajectory::record::{Activity, ClockEvent, PresenceEvent};
use novamind_record::trajectory::{Line, Record, find_end};

/// Counts of the sessions of a run.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct SessionCount {
    /// Number of sessions; 0 if no `session` line exists.
    pub opened: u32,
    /// Number of sessions in the console, which records screens, dialogs and idle times.
    pub in_console: u32,
    /// Number of sessions without a closing line, because the program was killed or is still running.
    pub not_closed: u32,
    /// Number of times that the clock was stopped.
    pub clock_stopped: u32,
    /// Number of machines on which the run was opened.
    pub machines: u32,
}

impl SessionCount {
    /// Counts the sessions in the lines of a trajectory.
    pub fn from_lines(lines: &[Line]) -> SessionCount {
        let (mut count, mut machines, mut is_open) = (SessionCount::default(), BTreeSet::new(), false);
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
                    count.in_console +=
                        u32::from(presence.interface.as_deref() == Some(KEY_WATCHING_INTERFACE));
                    count.not_closed += u32::from(is_open);
                    is_open = true;
                }
                PresenceEvent::Closed => is_open = false,
                _ => {}
            }
        }
        // The last session of an ended run counts as closed: its closing line is recorded after the end of the run.
        count.not_closed += u32::from(is_open && find_end(lines).is_none());
        count.machines = machines.len() as u32;
        count
    }
}
