//! Where a database lives: a file of a run, or memory that several connections share.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use rusqlite::{Connection, ErrorCode, OpenFlags};

/// Memory a connection may use for pages and sorting, as SQLite wants it said: less than 0 are KiB.
const CACHE: i64 = -65_536;

/// Compiled statements a connection keeps.
const STATEMENTS: usize = 64;

/// Place of a database.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Location {
    /// A file.
    File(PathBuf),
    /// Memory of this process, under a name.
    Memory(String),
}

impl Location {
    /// A new place in memory.
    pub fn memory() -> Location {
        static NEXT: AtomicU64 = AtomicU64::new(0);
        let number = NEXT.fetch_add(1, Ordering::Relaxed);
        Location::Memory(format!("file:/novamind-{}-{number}?vfs=memdb", std::process::id()))
    }

    /// The file, if it is one.
    pub fn path(&self) -> Option<&Path> {
        match self {
            Location::File(path) => Some(path),
            Location::Memory(_) => None,
        }
    }

    /// Opens the one connection that writes.
    pub(super) fn open_writer(&self) -> rusqlite::Result<Connection> {
        let connection = self.open(OpenFlags::SQLITE_OPEN_READ_WRITE | OpenFlags::SQLITE_OPEN_CREATE)?;
        if self.path().is_some() {
            // Readers see the state before a week while the week is written.
            connection.pragma_update(None, "journal_mode", "WAL")?;
            connection.pragma_update(None, "synchronous", "NORMAL")?;
        }
        connection.pragma_update(None, "cache_size", CACHE)?;
        // More statements than a day needs: one that is forgotten is compiled again every day.
        connection.set_prepared_statement_cache_capacity(STATEMENTS);
        Ok(connection)
    }

    /// Opens a connection that only reads.
    pub(super) fn open_reader(&self) -> rusqlite::Result<Connection> {
        let opened = self.open(OpenFlags::SQLITE_OPEN_READ_ONLY).and_then(|connection| {
            connection.query_row("SELECT COUNT(*) FROM sqlite_master", [], |_| Ok(()))?;
            Ok(connection)
        });
        let connection = match (opened, self.path().and_then(Path::to_str)) {
            // Where nothing can be written, SQLite has no place for its marks between readers and a writer.
            (Err(error), Some(path)) if error.sqlite_error_code() == Some(ErrorCode::CannotOpen) => {
                let escaped = path.replace('%', "%25").replace('?', "%3f").replace('#', "%23");
                Location::Memory(format!("file:{escaped}?immutable=1")).open(OpenFlags::SQLITE_OPEN_READ_ONLY)
            }
            (opened, _) => opened,
        }?;
        // Room to sort a table of the largest runs without a temporary file.
        connection.pragma_update(None, "cache_size", CACHE)?;
        Ok(connection)
    }

    fn open(&self, flags: OpenFlags) -> rusqlite::Result<Connection> {
        let flags = flags | OpenFlags::SQLITE_OPEN_NO_MUTEX | OpenFlags::SQLITE_OPEN_URI;
        let connection = match self {
            Location::File(path) => Connection::open_with_flags(path, flags)?,
            Location::Memory(name) => Connection::open_with_flags(name, flags)?,
        };
        connection.busy_timeout(Duration::from_secs(150))?;
        Ok(connection)
    }
}
