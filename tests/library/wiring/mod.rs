//! Values are passed on unchanged and in the correct position: arguments of calls, copied days and weeks of branches,
//! columns of tables, limits and exit codes.
//!
//! All numbers of a fixture are different, so that swapped values are detected.

mod branches_and_forecasts;
mod settings;
mod support_budget;

use novamind::record::folder::configuration::Configuration;
use novamind::record::mode::Mode;
use novamind::session::{NewRun, Session, Storage};

/// Creates a run in memory, or in a folder.
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
    Session::create(new, &Configuration::bundled()).expect("the run begins")
}
