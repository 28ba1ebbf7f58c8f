//! Location of a database: a file, or shared memory.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use rusqlite::{Connection, ErrorCode, OpenFlags};

/// Size of a connection's page cache. SQLite reads negative values as KiB.
const CACHE_SIZE: i64 = -65_536;

const MAX_CACHED_STATEMENTS: usize = 64;

/// Location of a database: a file or shared memory.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum DatabaseLocation {
    /// A database file.
    File(PathBuf),
    /// A named database in the memory of this process.
    Memory(String),
}

impl DatabaseLocation {
    /// Returns the location of a new database in memory.
    pub fn new_in_memory() -> DatabaseLocation {
        static NEXT: AtomicU64 = AtomicU64::new(0);
        let number = NEXT.fetch_add(1, Ordering::Relaxed);
        DatabaseLocation::Memory(format!("file:/novamind-{}-{number}?vfs=memdb", std::process::id()))
    }

    /// Returns the path of a database file, or `None` for a database in memory.
    pub fn path(&self) -> Option<&Path> {
        match self {
            DatabaseLocation::File(path) => Some(path),
            DatabaseLocation::Memory(_) => None,
        }
    }

    /// Opens the writing connection. A database has at most one writing connection.
    pub(super) fn open_writer(&self) -> rusqlite::Result<Connection> {
        let connection = self.open(OpenFlags::SQLITE_OPEN_READ_WRITE | OpenFlags::SQLITE_OPEN_CREATE)?;
        if self.path().is_some() {
            // While the writer writes a week, readers see the state before that week.
            connection.pragma_update(None, "journal_mode", "WAL")?;
            connection.pragma_update(None, "synchronous", "NORMAL")?;
        }
        connection.pragma_update(None, "cache_size", CACHE_SIZE)?;
        // The cache has room for all statements of a day. An evicted statement would be compiled again every day.
        connection.set_prepared_statement_cache_capacity(MAX_CACHED_STATEMENTS);
        Ok(connection)
    }

    /// Opens a read-only connection.
    pub(super) fn open_reader(&self) -> rusqlite::Result<Connection> {
        let opened = self.open(OpenFlags::SQLITE_OPEN_READ_ONLY).and_then(|connection| {
            connection.query_row("SELECT COUNT(*) FROM sqlite_master", [], |_| Ok(()))?;
            Ok(connection)
        });
        let connection = match (opened, self.path().and_then(Path::to_str)) {
            // On read-only media, SQLite cannot create its shared-memory file, so the database is opened as immutable.
            (Err(error), Some(path)) if error.sqlite_error_code() == Some(ErrorCode::CannotOpen) => {
                let escaped = path.replace('%', "%25").replace('?', "%3f").replace('#', "%23");
                DatabaseLocation::Memory(format!("file:{escaped}?immutable=1"))
                    .open(OpenFlags::SQLITE_OPEN_READ_ONLY)
            }
            (opened, _) => opened,
        }?;
        // The cache is large enough to sort a table of the largest runs without a temporary file.
        connection.pragma_update(None, "cache_size", CACHE_SIZE)?;
        Ok(connection)
    }

    fn open(&self, flags: OpenFlags) -> rusqlite::Result<Connection> {
        let flags = flags | OpenFlags::SQLITE_OPEN_NO_MUTEX | OpenFlags::SQLITE_OPEN_URI;
        let connection = match self {
            DatabaseLocation::File(path) => Connection::open_with_flags(path, flags)?,
            DatabaseLocation::Memory(name) => Connection::open_with_flags(name, flags)?,
        };
        connection.busy_timeout(Duration::from_secs(150))?;
        Ok(connection)
    }
}
