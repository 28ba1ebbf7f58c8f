//! A file of results with one line per run. Several processes can write to the file. A run with a truncated or changed
//! line is played again.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::{File, OpenOptions};
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use serde::{Deserialize, Serialize};

use super::RunResult;

/// A file with the results of experiment runs.
#[derive(Debug)]
pub struct ResultStore {
    path: PathBuf,
    file: Mutex<File>,
}

#[derive(Serialize, Deserialize)]
struct StoredLine<R> {
    key: String,
    result: R,
    /// Checksum of the key and the result as written, which detects accidental changes.
    sum: String,
}

impl<R: Serialize> StoredLine<R> {
    fn new(key: &str, result: R) -> io::Result<StoredLine<R>> {
        let sum = checksum(key, &result)?;
        Ok(StoredLine { key: key.to_owned(), result, sum })
    }

    fn is_intact(&self) -> bool {
        checksum(&self.key, &self.result).is_ok_and(|sum| sum == self.sum)
    }
}

fn checksum(key: &str, result: &impl Serialize) -> io::Result<String> {
    let mut hasher = blake3::Hasher::new();
    hasher.update(key.as_bytes());
    hasher.update(&serde_json::to_vec(result).map_err(io::Error::other)?);
    Ok(hasher.finalize().to_hex()[..16].to_owned())
}

impl ResultStore {
    /// Opens or creates a results file.
    ///
    /// # Errors
    /// Fails if the file cannot be created or written.
    pub fn open(path: &Path) -> io::Result<ResultStore> {
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder)?;
        }
        // Devices and pipes have no end at which reading would stop.
        if std::fs::metadata(path).is_ok_and(|found| !found.is_file()) {
            return Err(io::Error::other(
                "it is not a regular file. Delete it to store results in a new file",
            ));
        }
        let file = OpenOptions::new().create(true).read(true).append(true).open(path)?;
        Ok(ResultStore { path: path.to_owned(), file: Mutex::new(file) })
    }

    /// Returns the path of the results file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Returns the latest result of each key. Damaged lines are skipped.
    ///
    /// # Errors
    /// Fails if the file cannot be read.
    pub(super) fn load(&self, keys: &BTreeSet<&str>) -> io::Result<BTreeMap<String, RunResult>> {
        let mut reader = BufReader::new(File::open(&self.path)?);
        let (mut known, mut line) = (BTreeMap::new(), Vec::new());
        while reader.read_until(b'\n', &mut line)? > 0 {
            let stored: Option<StoredLine<RunResult>> = serde_json::from_slice(&line).ok();
            let wanted = stored
                .filter(|stored_line| keys.contains(stored_line.key.as_str()) && stored_line.is_intact());
            if let Some(stored_line) = wanted {
                known.insert(stored_line.key, stored_line.result);
            }
            line.clear();
        }
        Ok(known)
    }

    /// Appends a result and syncs the file to disk.
    ///
    /// # Errors
    /// Fails if the write fails; the file is then unchanged.
    pub(super) fn append_result(&self, key: &str, result: &RunResult) -> io::Result<()> {
        let stored = StoredLine::new(key, result)?;
        let mut line = serde_json::to_vec(&stored).map_err(io::Error::other)?;
        line.push(b'\n');
        let mut file = self.file.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        file.lock()?;
        let written = append_line(&mut file, line);
        file.unlock()?;
        written
    }
}

fn append_line(file: &mut File, mut line: Vec<u8>) -> io::Result<()> {
    let end = file.seek(SeekFrom::End(0))?;
    if end > 0 {
        let mut last = [0];
        file.seek(SeekFrom::Start(end - 1))?;
        file.read_exact(&mut last)?;
        if last != *b"\n" {
            line.insert(0, b'\n');
        }
    }
    let written = file.write_all(&line).and_then(|()| file.sync_data());
    if written.is_err() {
        // A partial line, for example after a full disk, would corrupt the next line.
        let _ = file.set_len(end);
    }
    written
}
