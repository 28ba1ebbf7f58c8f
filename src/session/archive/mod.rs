//! Archives: a run as one file, sealed on export and checked on import.
//!
//! An archive is a tar file, compressed with gzip if its name ends in `.gz` or `.tgz`. It contains one folder, named
//! after the run, with these files:
//! | file | |
//! |---|---|
//! | `seal.toml` | length and BLAKE3 hash of every file, last line of the trajectory, a checksum of all this |
//! | `seal.sig` | the signature of the seal, if a lab signed it |
//! | `run.toml` | the manifest |
//! | `trajectory.jsonl` | the trajectory, up to its last confirmed line |
//! | `afterwards.jsonl` | lines recorded after the end of the run, if there are any |
//! | `lesson.toml`, `lesson.md` | the lesson, if the run belongs to one |
//! | `memo.md` | the player's notes, if there are any |
//! | `world.db` | the observable company in ordinary tables, for any SQLite tool |
//!
//! It contains no other files of the run's folder. In particular it has no snapshot, so no hidden state. The export
//! simulates the run again to create the database, so every archive is verified. The import writes all files but the
//! seal, the signature and the database, which is rebuilt.

mod export;
mod import;
mod lab_key;
mod seal;
mod workshop;

use std::path::Path;

pub use export::Export;
pub use import::{Imported, import_run};
pub use lab_key::{LabKey, LabPublicKey};
pub use lab_key::{read_seal_key, write_seal_key};
pub use seal::Seal;
pub use workshop::{Workshop, close_workshops};

use crate::recording::recorder::AFTERWARDS;
use novamind_record::error::RunError;
use novamind_record::lesson::{PLAN_FILE, TEXTS_FILE};

/// Files that an archive can contain, with their maximum sizes in bytes: enough for any run, too few to fill a disk.
const FILES: [(&str, u64); 9] = [
    (SEAL, 1 << 20),
    (SIGNATURE, 1 << 10),
    (MANIFEST, 1 << 20),
    (TRAJECTORY, 4 << 30),
    (AFTERWARDS, 1 << 30),
    (PLAN_FILE, 1 << 20),
    (TEXTS_FILE, 1 << 20),
    (MEMO, 64 << 20),
    (DATABASE, 16 << 30),
];

const SEAL: &str = "seal.toml";
const SIGNATURE: &str = "seal.sig";
const MANIFEST: &str = "run.toml";
const TRAJECTORY: &str = "trajectory.jsonl";
const MEMO: &str = "memo.md";
const DATABASE: &str = "world.db";

fn is_compressed(archive: &Path) -> bool {
    let ending = archive.extension().map(|ending| ending.to_ascii_lowercase());
    ending.is_some_and(|ending| ending == "gz" || ending == "tgz")
}

/// Whether the name is that of an archive.
pub fn is_archive_name(name: &str) -> bool {
    [".tar", ".tar.gz", ".tgz"].iter().any(|ending| name.ends_with(ending))
}

/// Whether the name is a run identifier: eight hexadecimal digits.
pub fn is_run_name(name: &str) -> bool {
    name.len() == 8 && name.bytes().all(|digit| matches!(digit, b'0'..=b'9' | b'a'..=b'f'))
}

/// Returns the error for an unusable archive. Nothing was changed.
fn refused(archive: &Path, problem: impl AsRef<str>) -> RunError {
    RunError::Archive {
        path: archive.to_owned(),
        problem: printable(problem.as_ref()),
        safe:
            "Nothing was imported and no run was changed; ask for the archive again, or export the run again"
                .to_owned(),
    }
}

/// Makes a text that can quote bytes of a foreign file safe to print on one line: escapes control characters and
/// truncates it.
fn printable(text: &str) -> String {
    const MOST: usize = 400;
    let mut line = String::new();
    for (place, letter) in text.chars().enumerate() {
        if place == MOST {
            line.push('…');
            break;
        }
        if letter.is_control() { line.extend(letter.escape_default()) } else { line.push(letter) }
    }
    line
}
