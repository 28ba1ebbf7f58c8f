//! Tests of the record that need a session to write the record.

mod derived;
mod failed_sync;
mod library;
mod preview;
mod trajectory;
