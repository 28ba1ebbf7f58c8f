//! Ids of new runs, and removal of stale staging folders.

use std::path::Path;

use novamind_record::folder::lock::lock_run;
use novamind_record::folder::runs::is_staging_folder;

/// Returns a run id: eight hexadecimal digits that are almost certainly unique.
pub fn new_run_id() -> String {
    static COUNT: std::sync::atomic::AtomicU64 = std::sync::atomic::AtomicU64::new(0);
    let count = COUNT.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
    let moment =
        std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).map_or(0, |d| d.as_nanos());
    let mix = format!("{moment} {} {count}", std::process::id());
    blake3::hash(mix.as_bytes()).to_hex()[..8].to_owned()
}

/// Removes staging folders that a stopped program left. Keeps staging folders in use, which are locked.
pub(crate) fn remove_stale_staging_folders(runs: &Path) {
    let entries = std::fs::read_dir(runs).into_iter().flatten().flatten();
    for folder in entries.map(|entry| entry.path()).filter(|path| is_staging_folder(path)) {
        if lock_run(&folder, "").is_ok() {
            let _ = std::fs::remove_dir_all(&folder);
        }
    }
}
