//! The writer thread, which receives entries and commits them in one transaction per week or tool call.

use std::cell::RefCell;
use std::fmt;
use std::path::Path;
use std::sync::mpsc::{Receiver, Sender, SyncSender, channel, sync_channel};
use std::sync::{Arc, Mutex, MutexGuard, RwLock};
use std::thread::JoinHandle;

use rusqlite::{Connection, OptionalExtension};

use super::block_loading::{BlockSource, load_store};
use super::blocks::SharedStore;
use super::catalogue::{Scope, Surface};
use super::location::DatabaseLocation;
use super::query::QueryConnection;
use super::rows::{LAYOUT_VERSION, ProjectionEntry, RowWriter, create_tables};
use novamind_world::events::Facts;
use novamind_world::params::{Interface, Params};

/// Maximum number of queued entries, to limit memory usage. The simulation waits if the queue is full.
const QUEUE_CAPACITY: usize = 16;
/// Maximum number of written facts that are kept to reuse their memory: one per day of a week.
const MAX_SPARE_FACTS: usize = 7;

/// Position of a database: the last trajectory line whose data the database contains.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ProjectionPosition {
    /// Number of the trajectory line.
    pub seq: u64,
    /// Hash of the trajectory line.
    pub line_hash: String,
}

impl ProjectionPosition {
    fn checksum(&self) -> String {
        blake3::hash(format!("{} {}", self.seq, self.line_hash).as_bytes()).to_hex()[..16].to_owned()
    }
}

/// An error that occurred while writing the database. The run is safe, because the trajectory is complete.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ProjectionError(pub String);

impl fmt::Display for ProjectionError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            formatter,
            "the database could not be written ({}); the run is safe, and the database is rebuilt when the run is opened again",
            self.0
        )
    }
}

impl std::error::Error for ProjectionError {}

/// A task that the writer thread runs after all earlier jobs.
type WriterTask = Box<dyn FnOnce(&Connection) + Send>;

enum WriterJob {
    Write(Box<ProjectionEntry>),
    Commit(ProjectionPosition),
    Run(WriterTask),
    Flush(Sender<Result<(), ProjectionError>>),
}

/// Handle of the background thread that keeps a database up to date.
pub struct Projector {
    jobs: Option<SyncSender<WriterJob>>,
    thread: Option<JoinHandle<()>>,
    pub(super) location: DatabaseLocation,
    pub(super) interface: Interface,
    pub(super) store: SharedStore,
    gate: Arc<RwLock<()>>,
    spare: FactsPool,
    failed: SharedFailure,
}

#[derive(Clone, Default)]
struct SharedFailure(Arc<Mutex<Option<ProjectionError>>>);

impl SharedFailure {
    fn get(&self) -> Option<ProjectionError> {
        self.0.lock().unwrap_or_else(|poisoned| poisoned.into_inner()).clone()
    }

    fn set(&self, error: ProjectionError) {
        *self.0.lock().unwrap_or_else(|poisoned| poisoned.into_inner()) = Some(error);
    }
}

impl Projector {
    /// Starts a projector on a database. Continues an existing database if `accepts_position` returns true for its
    /// position. Otherwise, creates a new database that stores `owner`, the number of its run.
    ///
    /// # Errors
    /// The database can neither be read nor created.
    pub fn start(
        location: DatabaseLocation,
        owner: u32,
        params: Arc<Params>,
        accepts_position: impl Fn(&ProjectionPosition) -> bool,
    ) -> Result<(Projector, Option<ProjectionPosition>), ProjectionError> {
        let store = SharedStore::default();
        let opened = open_existing(&location, &store, accepts_position);
        let (mut connection, position) = match opened {
            Some(opened) => opened,
            None => (recreate(&location, owner).map_err(to_error)?, None),
        };
        let gate = Arc::new(RwLock::new(()));
        let (jobs, queue) = sync_channel(QUEUE_CAPACITY);
        let spare = FactsPool::default();
        let failed = SharedFailure::default();
        let map_error: fn(rusqlite::Error) -> ProjectionError =
            if location.path().is_some() { to_error } else { to_memory_error };
        let interface = params.fidelity.interface;
        let (writer_spare, writer_failed) = (spare.clone(), failed.clone());
        let (writer_gate, writer_store) = (gate.clone(), store.clone());
        let thread = std::thread::Builder::new()
            .name("projection".to_owned())
            .spawn(move || {
                let rows = RowWriter::new(params, writer_store);
                let connection = &mut connection;
                let has_write_ahead_log = uses_write_ahead_log(connection);
                let (gate, spare, failed) = (writer_gate, writer_spare, writer_failed);
                ProjectionWriter {
                    connection,
                    rows,
                    gate,
                    readers_are_not_blocked: has_write_ahead_log,
                    spare,
                    failed,
                    to_error: map_error,
                }
                .run(&queue);
            })
            .map_err(|error| ProjectionError(error.to_string()))?;
        let (jobs, thread) = (Some(jobs), Some(thread));
        let projector = Projector { jobs, thread, location, interface, store, gate, spare, failed };
        Ok((projector, position))
    }

    /// Sends an entry to the writer thread. Blocks only if the queue is full.
    pub fn enqueue(&self, entry: ProjectionEntry) {
        self.send(WriterJob::Write(Box::new(entry)));
    }

    /// Returns empty facts whose memory can be reused, if any are available.
    pub fn spare_facts(&self) -> Option<Arc<Facts>> {
        self.spare.take()
    }

    /// Commits all previously sent entries, together with the trajectory position.
    pub fn commit(&self, position: ProjectionPosition) {
        self.send(WriterJob::Commit(position));
    }

    /// Runs `work` on the writer thread after all earlier commits. If `digest` is true, `work` receives the digest of
    /// the database file. Otherwise, and for a database in memory or an unreadable file, `work` receives `None`.
    pub fn run_after_commit(&self, digest: bool, work: impl FnOnce(Option<String>) + Send + 'static) {
        let path = self.location.path().filter(|_| digest).map(Path::to_owned);
        self.send(WriterJob::Run(Box::new(move |connection| {
            work(path.and_then(|path| checkpointed_digest(connection, &path)));
        })));
    }

    /// Waits until the writer thread has processed all earlier jobs.
    ///
    /// # Errors
    /// The database could not be written.
    pub fn flush(&self) -> Result<(), ProjectionError> {
        let (done, answer) = channel();
        self.send(WriterJob::Flush(done));
        answer.recv().unwrap_or_else(|_| Err(ProjectionError("the writer has stopped".to_owned())))
    }

    /// Returns the error that stopped the writing of the database, or `None` if no error has occurred.
    pub fn failure(&self) -> Option<ProjectionError> {
        self.failed.get()
    }

    /// Returns a connection for guarded queries. Several connections can run concurrently with the writer.
    ///
    /// # Errors
    /// The database cannot be opened for reading.
    pub fn connection(&self, scope: Scope) -> Result<QueryConnection, ProjectionError> {
        let source = BlockSource::Writer(self.store.clone(), self.gate.clone());
        let surface = Surface { interface: self.interface, scope };
        QueryConnection::open(&self.location, source, surface).map_err(to_error)
    }

    /// Limits the growth of the database to `more` pages, to simulate a full disk.
    #[cfg(any(test, feature = "test-kit"))]
    pub fn limit_pages(&self, more: Option<u32>) {
        self.send(WriterJob::Run(Box::new(move |connection| {
            let pages: u32 = connection.query_row("PRAGMA page_count", [], |row| row.get(0)).expect("pages");
            let max = more.map_or(u32::MAX - 1, |more| pages + more);
            connection.query_row(&format!("PRAGMA max_page_count = {max}"), [], |_| Ok(())).expect("a bound");
        })));
    }

    fn send(&self, job: WriterJob) {
        if let Some(jobs) = &self.jobs {
            // The next `flush` reports a stopped writer.
            let _ = jobs.send(job);
        }
    }
}

impl Drop for Projector {
    fn drop(&mut self) {
        self.jobs = None;
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

fn to_error(error: rusqlite::Error) -> ProjectionError {
    ProjectionError(error.to_string())
}

/// Converts an error of a database in memory. If the database is full, the message explains SQLite's size limit.
fn to_memory_error(error: rusqlite::Error) -> ProjectionError {
    match error.sqlite_error_code() {
        Some(rusqlite::ErrorCode::DiskFull) => ProjectionError(
            "a database in memory is limited to 1 GiB; the database is on disk if the folder is writable and no \
             other program plays the run"
                .to_owned(),
        ),
        _ => to_error(error),
    }
}

struct ProjectionWriter<'a> {
    connection: &'a mut Connection,
    rows: RowWriter,
    gate: Arc<RwLock<()>>,
    /// Whether readers can read the previous state during a transaction.
    readers_are_not_blocked: bool,
    spare: FactsPool,
    failed: SharedFailure,
    /// Function that converts errors of SQLite.
    to_error: fn(rusqlite::Error) -> ProjectionError,
}

/// Cleared facts whose memory the simulation can reuse.
#[derive(Clone, Default)]
struct FactsPool(Arc<Mutex<Vec<Arc<Facts>>>>);

impl FactsPool {
    fn recycle(&self, mut facts: Arc<Facts>) {
        let Some(unread) = Arc::get_mut(&mut facts) else { return };
        // Not every caller that reuses the facts calls `start_day`, so the facts must be cleared completely.
        unread.start_day(0);
        let mut kept = self.lock();
        if kept.len() < MAX_SPARE_FACTS {
            kept.push(facts);
        }
    }

    fn take(&self) -> Option<Arc<Facts>> {
        self.lock().pop()
    }

    fn lock(&self) -> MutexGuard<'_, Vec<Arc<Facts>>> {
        self.0.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
    }
}

impl ProjectionWriter<'_> {
    /// Processes jobs until the queue is closed. Entries are written only when a week or tool call is complete. The
    /// simulation can then use all processors, and readers of a database in memory wait for at most one short
    /// transaction.
    fn run(mut self, queue: &Receiver<WriterJob>) {
        let mut pending: Vec<ProjectionEntry> = Vec::new();
        loop {
            let Ok(job) = queue.recv() else { return };
            match job {
                WriterJob::Flush(done) => {
                    let _ = done.send(self.failed.get().map_or(Ok(()), Err));
                }
                WriterJob::Run(errand) => errand(self.connection),
                WriterJob::Commit(position) => {
                    self.run_unless_failed(|worker| worker.commit_pending(&mut pending, &position))
                }
                // After a failure, nothing is written, and all pending entries are dropped.
                WriterJob::Write(entry) if self.failed.get().is_none() => pending.push(*entry),
                WriterJob::Write(_) => pending.clear(),
            }
        }
    }

    /// Runs `work` unless an earlier job failed. Without this check, the database would have gaps.
    fn run_unless_failed(&mut self, work: impl FnOnce(&mut Self) -> rusqlite::Result<()>) {
        if self.failed.get().is_none()
            && let Err(error) = work(self)
        {
            self.failed.set((self.to_error)(error));
        }
    }

    fn commit_pending(
        &mut self,
        pending: &mut Vec<ProjectionEntry>,
        position: &ProjectionPosition,
    ) -> rusqlite::Result<()> {
        let gate = self.gate.clone();
        let close = || gate.write().unwrap_or_else(|poisoned| poisoned.into_inner());
        // Without a write-ahead log, acquire the gate's write lock before the transaction starts. Otherwise, a reader
        // with the read lock would wait for the transaction while the writer waits for the write lock.
        let early = (!self.readers_are_not_blocked).then(close);
        let transaction = self.connection.transaction()?;
        for entry in pending.drain(..) {
            self.rows.write(&transaction, &entry)?;
            self.spare.recycle(entry.facts);
        }
        self.rows.flush(&transaction)?;
        transaction.execute(
            "INSERT OR REPLACE INTO projection VALUES (1, ?1, ?2, ?3)",
            rusqlite::params![position.seq as i64, position.line_hash, position.checksum()],
        )?;
        let closed = early.unwrap_or_else(close);
        transaction.commit()?;
        self.rows.publish();
        drop(closed);
        Ok(())
    }
}

/// Returns whether the database uses a write-ahead log, which does not block readers.
fn uses_write_ahead_log(connection: &Connection) -> bool {
    let journal = connection.query_row("PRAGMA journal_mode", [], |row| row.get::<_, String>(0));
    journal.is_ok_and(|journal| journal == "wal")
}

/// Returns the digest of a database file after a checkpoint.
fn checkpointed_digest(connection: &Connection, path: &Path) -> Option<String> {
    let busy: i64 = connection.query_row("PRAGMA wal_checkpoint(TRUNCATE)", [], |row| row.get(0)).ok()?;
    (busy == 0).then(|| file_digest(path)).flatten()
}

/// Returns the digest of a file's bytes, or `None` if the file cannot be read.
pub fn file_digest(path: &Path) -> Option<String> {
    let mut hasher = blake3::Hasher::new();
    hasher.update_reader(std::fs::File::open(path).ok()?).ok()?;
    Some(hasher.finalize().to_hex().to_string())
}

/// Opens an existing database and loads its packed days into the store. Returns `None` if the database is damaged or
/// its position is unknown.
fn open_existing(
    location: &DatabaseLocation,
    store: &SharedStore,
    accepts_position: impl Fn(&ProjectionPosition) -> bool,
) -> Option<(Connection, Option<ProjectionPosition>)> {
    if !location.path()?.exists() {
        return None;
    }
    let connection = location.open_writer().ok()?;
    let position = stored_position(&connection).ok()??;
    if !accepts_position(&position) || !is_current_layout(&connection) {
        return None;
    }
    let loaded = load_store(&connection)?;
    *store.write().unwrap_or_else(|poisoned| poisoned.into_inner()) = loaded;
    Some((connection, Some(position)))
}

/// Opens a connection for queries on a database that no [`Projector`] writes. `interface` is the release that the run
/// follows. Also returns the trajectory position that the database stores.
///
/// # Errors
/// The database does not exist, or is not the database of a run.
pub fn query_connection(
    location: &DatabaseLocation,
    interface: Interface,
    scope: Scope,
) -> Result<(QueryConnection, ProjectionPosition), ProjectionError> {
    let missing = || ProjectionError("there is no database yet".to_owned());
    if location.path().is_none_or(|path| !path.exists()) {
        return Err(missing());
    }
    let connection = location.open_reader().map_err(to_error)?;
    let position = stored_position(&connection).map_err(to_error)?.ok_or_else(missing)?;
    if !is_current_layout(&connection) {
        return Err(ProjectionError("another version of the program created world.db".to_owned()));
    }
    let source = BlockSource::File(RefCell::default());
    let connection =
        QueryConnection::open(location, source, Surface { interface, scope }).map_err(to_error)?;
    Ok((connection, position))
}

/// Returns whether the database at a location has the layout of this version.
pub fn has_current_layout(location: &DatabaseLocation) -> bool {
    location.open_reader().is_ok_and(|connection| is_current_layout(&connection))
}

fn is_current_layout(connection: &Connection) -> bool {
    let layout = connection.query_row("PRAGMA user_version", [], |row| row.get::<_, u32>(0));
    layout.is_ok_and(|layout| layout == LAYOUT_VERSION)
}

/// Returns whether SQLite's quick check of the database at a location succeeds. The check is slow for large databases.
pub fn is_consistent(location: &DatabaseLocation) -> bool {
    let check = |connection: Connection| {
        connection.query_row("PRAGMA quick_check(1)", [], |row| row.get::<_, String>(0))
    };
    location.open_reader().and_then(check).is_ok_and(|answer| answer == "ok")
}

/// Returns the trajectory position that the database at a location stores, or `None` if the position cannot be read.
pub fn read_position(location: &DatabaseLocation) -> Option<ProjectionPosition> {
    location.path().filter(|path| path.exists())?;
    stored_position(&location.open_reader().ok()?).ok()?
}

/// Returns the number of the run that owns the database at a location, or `None` if the database cannot be read.
pub fn read_owner(location: &DatabaseLocation) -> Option<u32> {
    location.path().filter(|path| path.exists())?;
    let connection = location.open_reader().ok()?;
    let owner: i32 = connection.query_row("PRAGMA application_id", [], |row| row.get(0)).ok()?;
    (owner != 0).then_some(owner as u32)
}

fn stored_position(connection: &Connection) -> rusqlite::Result<Option<ProjectionPosition>> {
    connection
        .query_row("SELECT seq, line_hash, own_check FROM projection", [], |row| {
            let position = ProjectionPosition { seq: row.get::<_, i64>(0)? as u64, line_hash: row.get(1)? };
            // Ignore a damaged position, because the error would name the wrong file.
            let whole = row.get::<_, String>(2)? == position.checksum();
            Ok(whole.then_some(position))
        })
        .optional()
        .map(Option::flatten)
}

fn recreate(location: &DatabaseLocation, owner: u32) -> rusqlite::Result<Connection> {
    if let Some(path) = location.path() {
        for suffix in ["", "-wal", "-shm", "-journal"] {
            let mut file = path.as_os_str().to_owned();
            file.push(suffix);
            // Ignore errors, because creating the tables fails if the file cannot be removed.
            let _ = std::fs::remove_file(file);
        }
    }
    let mut connection = location.open_writer()?;
    create_tables(&mut connection)?;
    // The pragma accepts only signed numbers, so the bits are reinterpreted.
    connection.pragma_update(None, "application_id", owner as i32)?;
    Ok(connection)
}
