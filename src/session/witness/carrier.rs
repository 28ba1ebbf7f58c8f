//! Tells the witness in the background, and keeps what it cannot tell.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Condvar, Mutex, MutexGuard};
use std::time::Duration;

use super::queue::Queue;
use super::record::{Told, file_name};

/// Pause after a first failure; it doubles with each one that follows.
const FIRST_PAUSE: Duration = Duration::from_millis(500);
/// Longest pause between two tries.
const LONGEST_PAUSE: Duration = Duration::from_secs(30);
/// How long the end of a session waits for a witness that hangs.
const PATIENCE: Duration = Duration::from_secs(2);

/// A witness of one run. What it is told goes to its folder in the background; while that cannot be reached it waits in
/// `witness-queue.jsonl` beside the run. Nothing that happens to the folder stops or slows the run.
pub struct Witness {
    shared: Arc<Shared>,
    run: String,
    machine: String,
}

struct Shared {
    /// The file in the folder of the witness.
    file: PathBuf,
    state: Mutex<State>,
    changed: Condvar,
}

struct State {
    queue: Queue,
    /// Why the last try failed; none once one has succeeded.
    problem: Option<String>,
    /// No more lines will come.
    closing: bool,
    /// Nothing more will be told.
    closed: bool,
}

impl Witness {
    /// Begins to tell a folder about the run whose files are in `run_folder`, first of all what an earlier end of the
    /// program left untold. The folder itself is never made: one that is missing is a share that is not there.
    pub fn start(folder: &Path, machine: &str, run: &str, run_folder: &Path) -> Witness {
        let state = State { queue: Queue::of(run_folder), problem: None, closing: false, closed: false };
        let shared = Arc::new(Shared {
            file: folder.join(file_name(run, machine)),
            state: Mutex::new(state),
            changed: Condvar::new(),
        });
        let own = Arc::clone(&shared);
        let started = std::thread::Builder::new().name("witness".to_owned()).spawn(move || own.carry());
        if let Err(error) = started {
            let mut state = shared.lock();
            (state.closed, state.problem) = (true, Some(error.to_string()));
        }
        Witness { shared, run: run.to_owned(), machine: machine.to_owned() }
    }

    /// Tells of a line that is on the disk: its number, its hash, and the moment it carries. Does not wait.
    pub fn tell(&self, seq: u64, hash: &str, at: &str) {
        let (run, machine) = (self.run.clone(), self.machine.clone());
        let told = Told { run, seq, hash: hash.to_owned(), at: at.to_owned(), machine };
        self.shared.lock().queue.push(&told.text());
        self.shared.changed.notify_all();
    }

    /// Tells a folder that a run is erased because its participant has withdrawn.
    ///
    /// # Errors
    /// The folder cannot be told. Nothing waits then: the run's own folder is about to go.
    pub fn tell_withdrawal(folder: &Path, machine: &str, run: &str, at: &str) -> io::Result<()> {
        let told = Told::withdrawal(run, at, machine);
        append(&folder.join(file_name(run, machine)), told.text().as_bytes())
    }

    /// Why the folder could not be told when it was last tried; none while all is well.
    pub fn problem(&self) -> Option<String> {
        self.shared.lock().problem.clone()
    }
}

impl Drop for Witness {
    fn drop(&mut self) {
        let mut state = self.shared.lock();
        state.closing = true;
        self.shared.changed.notify_all();
        // A folder that hangs is left behind; what it was not told stands in the queue.
        let _ = self.shared.changed.wait_timeout_while(state, PATIENCE, |state| !state.closed);
    }
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
    }

    fn carry(&self) {
        let mut pause = FIRST_PAUSE;
        let mut state = self.lock();
        loop {
            let Some(lines) = state.queue.next() else {
                if state.closing {
                    break;
                }
                state = self.changed.wait(state).unwrap_or_else(|poisoned| poisoned.into_inner());
                continue;
            };
            drop(state);
            let delivered = self.deliver(&lines);
            state = self.lock();
            match delivered {
                Ok(()) => {
                    state.queue.forget(lines.len());
                    state.problem = None;
                    pause = FIRST_PAUSE;
                }
                Err(error) => {
                    state.problem = Some(format!("{}: {error}", self.file.display()));
                    if state.closing {
                        break;
                    }
                    let waited = self.changed.wait_timeout_while(state, pause, |state| !state.closing);
                    state = waited.unwrap_or_else(|poisoned| poisoned.into_inner()).0;
                    pause = (pause * 2).min(LONGEST_PAUSE);
                }
            }
        }
        state.queue.close();
        state.closed = true;
        self.changed.notify_all();
    }

    /// Appends lines to the file. It is opened each time: a share comes and goes.
    fn deliver(&self, lines: &[u8]) -> io::Result<()> {
        append(&self.file, lines)
    }
}

fn append(path: &Path, lines: &[u8]) -> io::Result<()> {
    let mut file = File::options().read(true).append(true).create(true).open(path)?;
    let mut bytes = Vec::with_capacity(lines.len() + 1);
    if is_torn(&mut file)? {
        bytes.push(b'\n');
    }
    bytes.extend_from_slice(lines);
    file.write_all(&bytes)?;
    file.sync_data()
}

/// Whether the last line of a file lacks its end, because a connection broke.
fn is_torn(file: &mut File) -> io::Result<bool> {
    if file.seek(SeekFrom::End(0))? == 0 {
        return Ok(false);
    }
    file.seek(SeekFrom::End(-1))?;
    let mut last = [0];
    file.read_exact(&mut last)?;
    Ok(last != *b"\n")
}
