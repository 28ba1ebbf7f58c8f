//! Machine figures: calibration time, memory, folder sizes.

use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

const CALIBRATION_STEPS: u64 = 60_000_000;

/// Returns the time in seconds that a fixed amount of integer and floating-point work takes on one processor.
/// Figures of different machines can be compared relative to this time.
pub fn calibration_seconds() -> f64 {
    let started = Instant::now();
    black_box(run_fixed_work(black_box(CALIBRATION_STEPS)));
    started.elapsed().as_secs_f64()
}

/// Runs steps that each depend on the previous step and consist of shifts, a multiplication, a division and a root.
fn run_fixed_work(steps: u64) -> f64 {
    let (mut word, mut value) = (0x9e37_79b9_7f4a_7c15_u64, 1.0_f64);
    for _ in 0..steps {
        word ^= word << 13;
        word ^= word >> 7;
        word ^= word << 17;
        let fraction = (word >> 11) as f64 * (1.0 / (1u64 << 53) as f64);
        value = (value * 0.75 + fraction).sqrt() + 0.5;
    }
    value
}

/// Returns the peak memory of the process in megabytes, or `None` if the system does not report the peak memory.
pub fn peak_memory_megabytes() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kibibytes: f64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kibibytes * 1024.0 / 1e6)
}

/// Returns the total size of the files in a folder, in megabytes.
pub fn folder_megabytes(folder: &Path) -> std::io::Result<f64> {
    let mut bytes = 0;
    for entry in std::fs::read_dir(folder)? {
        bytes += entry?.metadata()?.len();
    }
    Ok(bytes as f64 / 1e6)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fixed_work_is_deterministic() {
        assert_eq!(run_fixed_work(1000).to_bits(), run_fixed_work(1000).to_bits());
        assert!(run_fixed_work(1000).is_finite());
    }

    #[test]
    fn folder_size_counts_files() {
        let folder = tempfile::tempdir().expect("a folder");
        std::fs::write(folder.path().join("a"), [0; 1500]).expect("a file");
        std::fs::write(folder.path().join("b"), [0; 500]).expect("a file");
        assert_eq!(folder_megabytes(folder.path()).expect("a size"), 0.002);
        assert!(folder_megabytes(&folder.path().join("none")).is_err());
    }
}
