//! The measures of a study, recomputed by a Python script that shares no code with the program.

use std::path::Path;
use std::process::Command;

/// Returns the output and the exit code of the script for an export; `None` on a machine without Python 3.11.
pub fn recompute_measures(tables: &Path) -> Option<(String, Option<i32>)> {
    let fits = Command::new("python3").args(["-c", "import tomllib"]).output();
    if !fits.is_ok_and(|done| done.status.success()) {
        return None;
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut script = Command::new("python3");
    script.arg(root.join("tests/python/recompute.py")).args([tables, &root.join("configs/world")]);
    let done = script.output().expect("it runs");
    let text = [done.stdout, done.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned()).concat();
    Some((text, done.status.code()))
}
