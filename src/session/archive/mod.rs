//! A run as one file, to be handed over: sealed on the way out, checked on the way in.
//!
//! An archive is a tar file, compressed with gzip when its name ends in `.gz` or `.tgz`. It holds one folder with the
//! name of the run, and in it
//!
//! | file | |
//! |---|---|
//! | `seal.toml` | what the archive holds: length and BLAKE3 hash of every file, last line of the trajectory, a checksum over it all |
//! | `seal.sig` | the signature of the seal, if a lab signed it |
//! | `run.toml` | what the run is |
//! | `trajectory.jsonl` | the truth, up to its last confirmed line |
//! | `afterwards.jsonl` | what was done after the end, if anything was |
//! | `lesson.toml`, `lesson.md` | the lesson, if the run belongs to one |
//! | `memo.md` | the player's notes, if there are any |
//! | `world.db` | the observable company, with ordinary tables only, for any SQLite tool |
//!
//! There is nothing else in it, whatever lies in the folder of the run: no snapshot, so no hidden state. The database is
//! made from the trajectory while the run is simulated again, so an archive that exists has been verified. Who imports
//! it gets these files but the seal; the database is a projection and is made anew.

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

/// Files an archive may hold and the most bytes each may have: enough for any run, too few to fill a disk by surprise.
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

/// Whether an archive with this name is compressed.
fn is_compressed(archive: &Path) -> bool {
    let ending = archive.extension().map(|ending| ending.to_ascii_lowercase());
    ending.is_some_and(|ending| ending == "gz" || ending == "tgz")
}

/// Whether a file with this name is taken for an archive.
pub fn is_archive_name(name: &str) -> bool {
    [".tar", ".tar.gz", ".tgz"].iter().any(|ending| name.ends_with(ending))
}

/// Whether this can be the name of a run: eight hexadecimal digits.
pub fn is_run_name(name: &str) -> bool {
    name.len() == 8 && name.bytes().all(|digit| matches!(digit, b'0'..=b'9' | b'a'..=b'f'))
}

/// An archive that cannot be used; nothing was changed by looking at it.
fn refused(archive: &Path, problem: impl AsRef<str>) -> RunError {
    RunError::Archive {
        path: archive.to_owned(),
        problem: printable(problem.as_ref()),
        safe:
            "Nothing was imported and no run was changed; ask for the archive again, or export the run again"
                .to_owned(),
    }
}

/// A text that may quote bytes of a foreign file, as one line that cannot steer a terminal: control characters are
/// written out, and what is long is cut.
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
