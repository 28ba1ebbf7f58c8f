//! Archives: a run as one file, sealed on export and checked on import.
//!
//! An archive is a tar file, compressed with gzip if its name ends in `.gz` or `.tgz`. The archive contains one
//! folder, named after the run, with these files:
//! | file | content |
//! |---|---|
//! | `seal.toml` | length and BLAKE3 hash of every file, last line of the trajectory, and a checksum of the seal |
//! | `seal.sig` | the signature of the seal, if a lab signed it |
//! | `run.toml` | the manifest |
//! | `trajectory.jsonl` | the trajectory, up to its last confirmed line |
//! | `afterwards.jsonl` | lines recorded after the end of the run, if there are any |
//! | `lesson.toml`, `lesson.md` | the lesson, if the run belongs to one |
//! | `memo.md` | the player's notes, if there are any |
//! | `world.db` | the observable company in ordinary tables, for any SQLite tool |
//!
//! An archive contains no other files of the run folder. In particular, an archive contains no snapshot and therefore
//! no hidden state. The export simulates the run again to create the database, so every archive is verified. The import
//! writes all files except the seal, the signature and the database. The database is rebuilt.

mod export;
mod import;
mod lab_key;
mod seal;
mod temporary_folder;

use std::path::Path;

pub use export::Export;
pub use import::{ImportOutcome, import_run};
pub use lab_key::{LabKey, LabPublicKey};
pub use lab_key::{read_seal_key, write_seal_key};
pub use seal::Seal;
pub use temporary_folder::{TemporaryFolder, remove_temporary_folders};

use crate::recording::recorder::AFTERWARDS_FILE;
use novamind_record::error::RunError;
use novamind_record::lesson::{PLAN_FILE, TEXTS_FILE};

/// Files that an archive can contain, with their maximum sizes in bytes. The limits are large enough for any run and
/// too small to fill a disk.
const ENTRY_LIMITS: [(&str, u64); 9] = [
    (SEAL_FILE, 1 << 20),
    (SIGNATURE_FILE, 1 << 10),
    (MANIFEST_FILE, 1 << 20),
    (TRAJECTORY_FILE, 4 << 30),
    (AFTERWARDS_FILE, 1 << 30),
    (PLAN_FILE, 1 << 20),
    (TEXTS_FILE, 1 << 20),
    (NOTES_FILE, 64 << 20),
    (DATABASE_FILE, 16 << 30),
];

const SEAL_FILE: &str = "seal.toml";
const SIGNATURE_FILE: &str = "seal.sig";
const MANIFEST_FILE: &str = "run.toml";
const TRAJECTORY_FILE: &str = "trajectory.jsonl";
const NOTES_FILE: &str = "memo.md";
const DATABASE_FILE: &str = "world.db";

fn is_compressed(archive: &Path) -> bool {
    let ending = archive.extension().map(|ending| ending.to_ascii_lowercase());
    ending.is_some_and(|ending| ending == "gz" || ending == "tgz")
}

/// Returns whether a file name has the extension of an archive.
pub fn is_archive_name(name: &str) -> bool {
    [".tar", ".tar.gz", ".tgz"].iter().any(|ending| name.ends_with(ending))
}

/// Returns whether a name is a run id: eight hexadecimal digits.
pub fn is_run_id(name: &str) -> bool {
    name.len() == 8 && name.bytes().all(|digit| matches!(digit, b'0'..=b'9' | b'a'..=b'f'))
}

/// Returns the error for an unusable archive. The message says that nothing was changed.
fn archive_error(archive: &Path, problem: impl AsRef<str>) -> RunError {
    RunError::InvalidArchive {
        path: archive.to_owned(),
        problem: escape_untrusted(problem.as_ref()),
        remedy:
            "Nothing was imported and no run was changed; ask for the archive again, or export the run again"
                .to_owned(),
    }
}

/// Escapes control characters in a text from an untrusted file and truncates the text, so that it can be printed on one
/// line.
fn escape_untrusted(text: &str) -> String {
    const MAX_CHARACTERS: usize = 400;
    let mut line = String::new();
    for (place, letter) in text.chars().enumerate() {
        if place == MAX_CHARACTERS {
            line.push('…');
            break;
        }
        if letter.is_control() { line.extend(letter.escape_default()) } else { line.push(letter) }
    }
    line
}
