//! The machine on which a run is played, and its monotonic clock.

use std::time::Instant;

use novamind_record::clock::scripted_monotonic_time;

/// Pseudonyms of a machine. All records from the machine have the same values, but the values do not reveal which
/// machine it is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Machine {
    /// Pseudonym of the machine: 16 hexadecimal digits.
    pub id: String,
    /// Pseudonym of the current boot of the machine: 16 hexadecimal digits.
    pub boot: String,
}

impl Machine {
    /// Returns the pseudonyms of this machine.
    pub fn current() -> Machine {
        let read = |path: &str| std::fs::read_to_string(path).ok().filter(|text| !text.trim().is_empty());
        let name = read("/etc/machine-id").or_else(|| read("/var/lib/dbus/machine-id"));
        let name = name.or_else(|| std::env::var("COMPUTERNAME").ok()).or_else(|| read("/etc/hostname"));
        let boot = read("/proc/sys/kernel/random/boot_id");
        // If there is no boot id, each start of the program counts as a boot of the machine.
        let boot = boot.unwrap_or_else(|| format!("{} {:?}", std::process::id(), program_start()));
        Machine {
            id: hash_name("novamind machine", name.unwrap_or_default().trim()),
            boot: hash_name("novamind boot", boot.trim()),
        }
    }

    /// Returns the milliseconds since the boot of the machine. If the system does not provide this time, returns the
    /// milliseconds since the program started.
    pub fn monotonic_ms() -> u64 {
        if let Some(scripted) = scripted_monotonic_time() {
            return scripted.as_millis() as u64;
        }
        let uptime = std::fs::read_to_string("/proc/uptime").ok();
        let seconds = uptime.and_then(|text| text.split_whitespace().next()?.parse::<f64>().ok());
        seconds.map_or_else(|| program_start().elapsed().as_millis() as u64, |seconds| (seconds * 1e3) as u64)
    }
}

fn hash_name(context: &str, name: &str) -> String {
    let key = blake3::derive_key(context, name.as_bytes());
    blake3::hash(&key).to_hex()[..16].to_owned()
}

fn program_start() -> Instant {
    static PROGRAM_START: std::sync::OnceLock<Instant> = std::sync::OnceLock::new();
    *PROGRAM_START.get_or_init(Instant::now)
}
