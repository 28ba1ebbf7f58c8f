//! Tests of the record that need a session to write it.

mod derived;
mod failed_sync;
mod library;
mod preview;
mod trajectory;
