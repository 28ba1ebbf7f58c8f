//! Location of a database: a file, or shared memory.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use rusqlite::{Connection, ErrorCode, OpenFlags};

/// Page cache of a connection; negative values are KiB for SQLite.
const CACHE_SIZE: i64 = -65_536;

const MAX_CACHED_STATEMENTS: usize = 64;

/// Location of a database.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum DatabaseLocation {
    /// A file.
    File(PathBuf),
    /// Named memory of this process.
    Memory(String),
}

impl DatabaseLocation {
    /// Returns a new location in memory.
    pub fn new_in_memory() -> DatabaseLocation {
        static NEXT: AtomicU64 = AtomicU64::new(0);
        let number = NEXT.fetch_add(1, Ordering::Relaxed);
        DatabaseLocation::Memory(format!("file:/novamind-{}-{number}?vfs=memdb", std::process::id()))
    }

    /// Returns the path of a file.
    pub fn path(&self) -> Option<&Path> {
        match self {
            DatabaseLocation::File(path) => Some(path),
            DatabaseLocation::Memory(_) => None,
        }
    }

    /// Opens the only writing connection.
    pub(super) fn open_writer(&self) -> rusqlite::Result<Connection> {
        let connection = self.open(OpenFlags::SQLITE_OPEN_READ_WRITE | OpenFlags::SQLITE_OPEN_CREATE)?;
        if self.path().is_some() {
            // Readers keep the state before a week while the week is written.
            connection.pragma_update(None, "journal_mode", "WAL")?;
            connection.pragma_update(None, "synchronous", "NORMAL")?;
        }
        connection.pragma_update(None, "cache_size", CACHE_SIZE)?;
        // More than a day needs, because an evicted statement would be compiled again every day.
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
            // On read-only media, SQLite cannot create its shared-memory file.
            (Err(error), Some(path)) if error.sqlite_error_code() == Some(ErrorCode::CannotOpen) => {
                let escaped = path.replace('%', "%25").replace('?', "%3f").replace('#', "%23");
                DatabaseLocation::Memory(format!("file:{escaped}?immutable=1"))
                    .open(OpenFlags::SQLITE_OPEN_READ_ONLY)
            }
            (opened, _) => opened,
        }?;
        // Enough to sort a table of the largest runs without a temporary file.
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
