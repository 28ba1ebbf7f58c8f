//! A file of results, a line a run. Several programs may write into it; a line that was cut off or changed is a run to play
//! again.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::{File, OpenOptions};
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use serde::{Deserialize, Serialize};

use super::RunResult;

/// Results that are kept.
#[derive(Debug)]
pub struct ResultStore {
    path: PathBuf,
    file: Mutex<File>,
}

#[derive(Serialize, Deserialize)]
struct StoredLine<R> {
    key: String,
    result: R,
    /// Of key and result as they are written: a line that was changed by accident is not believed.
    sum: String,
}

impl<R: Serialize> StoredLine<R> {
    fn of(key: &str, result: R) -> io::Result<StoredLine<R>> {
        let sum = sum_of(key, &result)?;
        Ok(StoredLine { key: key.to_owned(), result, sum })
    }

    fn is_whole(&self) -> bool {
        sum_of(&self.key, &self.result).is_ok_and(|sum| sum == self.sum)
    }
}

fn sum_of(key: &str, result: &impl Serialize) -> io::Result<String> {
    let mut hasher = blake3::Hasher::new();
    hasher.update(key.as_bytes());
    hasher.update(&serde_json::to_vec(result).map_err(io::Error::other)?);
    Ok(hasher.finalize().to_hex()[..16].to_owned())
}

impl ResultStore {
    /// Opens a file of results, or begins it.
    ///
    /// # Errors
    /// It cannot be made or written.
    pub fn open(path: &Path) -> io::Result<ResultStore> {
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder)?;
        }
        // A device or a pipe has no end, or none to read.
        if std::fs::metadata(path).is_ok_and(|found| !found.is_file()) {
            return Err(io::Error::other("it is no file: delete it, and results are kept in a new one"));
        }
        let file = OpenOptions::new().create(true).read(true).append(true).open(path)?;
        Ok(ResultStore { path: path.to_owned(), file: Mutex::new(file) })
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The results of these keys; of two with one key, the later. Lines that are not as they were written are
    /// passed over.
    ///
    /// # Errors
    /// The file cannot be read.
    pub(super) fn known(&self, keys: &BTreeSet<&str>) -> io::Result<BTreeMap<String, RunResult>> {
        let mut reader = BufReader::new(File::open(&self.path)?);
        let (mut known, mut line) = (BTreeMap::new(), Vec::new());
        while reader.read_until(b'\n', &mut line)? > 0 {
            let stored: Option<StoredLine<RunResult>> = serde_json::from_slice(&line).ok();
            let wanted = stored.filter(|own| keys.contains(own.key.as_str()) && own.is_whole());
            if let Some(own) = wanted {
                known.insert(own.key, own.result);
            }
            line.clear();
        }
        Ok(known)
    }

    /// Keeps a result: its line is on the disk when this returns.
    ///
    /// # Errors
    /// The disk does not take it; the file is then as it was.
    pub(super) fn keep(&self, key: &str, result: &RunResult) -> io::Result<()> {
        let stored = StoredLine::of(key, result)?;
        let mut line = serde_json::to_vec(&stored).map_err(io::Error::other)?;
        line.push(b'\n');
        let mut file = self.file.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        file.lock()?;
        let written = append(&mut file, line);
        file.unlock()?;
        written
    }
}

fn append(file: &mut File, mut line: Vec<u8>) -> io::Result<()> {
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
        // What a full disk took of the line would stand in the way of the next one.
        let _ = file.set_len(end);
    }
    written
}
