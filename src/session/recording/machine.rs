//! The machine a run is played on, and its clock that nobody sets.

use std::time::Instant;

use novamind_record::clock::scripted_steady;

/// The machine, as records name it: nobody learns from them which one it is, but two records of one machine agree.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Machine {
    /// 16 hexadecimal digits.
    pub id: String,
    /// The time since it was started, likewise.
    pub boot: String,
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
        if let Some(scripted) = scripted_steady() {
            return scripted.as_millis() as u64;
        }
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
