//! Measures the memory that SQLite uses.
#![expect(unsafe_code, reason = "SQLite reports its memory usage only through its C interface")]

/// Returns the bytes that SQLite has allocated in this process.
pub(super) fn bytes_in_use() -> u64 {
    // SAFETY: the function has no parameters, may be called at any time from any thread, and only reads a counter.
    let bytes = unsafe { rusqlite::ffi::sqlite3_memory_used() };
    u64::try_from(bytes).unwrap_or(0)
}
