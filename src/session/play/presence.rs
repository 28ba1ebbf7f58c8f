//! Who is there, and when: the program taking up and leaving a run, on which machine, by which clocks.

use std::time::Instant;

use crate::session::state::Session;
use crate::session::trajectory::Durability;
use crate::session::trajectory::Record;
use crate::session::trajectory::record::{Activity, LeavingCause, Presence, PresenceEvent};

/// The machine, as records name it: nobody learns from them which one it is, but two records of one machine agree.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Machine {
    /// 16 hexadecimal digits.
    pub id: String,
    /// The time since it was started, likewise.
    pub boot: String,
}

/// What a person plays with, and in which window.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Interface {
    /// `console`, `plain`, `http`.
    pub name: &'static str,
    /// Columns and rows of the terminal, where there is one.
    pub window: Option<(u16, u16)>,
}

impl Machine {
    /// This machine.
    pub fn here() -> Machine {
        let read = |path: &str| std::fs::read_to_string(path).ok().filter(|text| !text.trim().is_empty());
        let name = read("/etc/machine-id").or_else(|| read("/var/lib/dbus/machine-id"));
        let name = name.or_else(|| std::env::var("COMPUTERNAME").ok()).or_else(|| read("/etc/hostname"));
        let boot = read("/proc/sys/kernel/random/boot_id");
        // Where the system does not tell, each start of the program counts as one of the machine.
        let boot = boot.unwrap_or_else(|| format!("{} {:?}", std::process::id(), began()));
        Machine {
            id: hashed("novamind machine", name.unwrap_or_default().trim()),
            boot: hashed("novamind boot", boot.trim()),
        }
    }

    /// Milliseconds since the machine was started; since the program was, where the system does not tell.
    pub fn monotonic_ms() -> u64 {
        let uptime = std::fs::read_to_string("/proc/uptime").ok();
        let seconds = uptime.and_then(|text| text.split_whitespace().next()?.parse::<f64>().ok());
        seconds.map_or_else(|| began().elapsed().as_millis() as u64, |seconds| (seconds * 1e3) as u64)
    }
}

fn hashed(context: &str, name: &str) -> String {
    let key = blake3::derive_key(context, name.as_bytes());
    blake3::hash(&key).to_hex()[..16].to_owned()
}

/// When the program first asked.
fn began() -> Instant {
    static BEGAN: std::sync::OnceLock<Instant> = std::sync::OnceLock::new();
    *BEGAN.get_or_init(Instant::now)
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
    }
}
