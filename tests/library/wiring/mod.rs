//! What one part hands to the next arrives there, unchanged and in the right place: arguments of calls, days and weeks
//! of a past that is taken over, columns of tables, limits and exit codes at the edge of the program.
//!
//! Fixtures are lopsided on purpose: with different numbers everywhere, whatever is swapped shows.

mod past;
mod settings;
mod support_budget;

use novamind::record::folder::configuration::Configuration;
use novamind::record::mode::Mode;
use novamind::session::{NewRun, Session, Storage};

/// A run in memory, or below a folder.
fn create(storage: Storage, overrides: &[(&str, &str)]) -> Session {
    let overrides = overrides.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
    let new = NewRun {
        seed: Some(7),
        days: Some(140),
        cash: Some(10_000_000.0),
        mode: Mode::Debug,
        overrides,
        storage,
        ..NewRun::default()
    };
    Session::create(new, &Configuration::shipped()).expect("the run begins")
}
