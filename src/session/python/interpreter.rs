//! The Python interpreter that executes scripts.

use std::ffi::OsString;
use std::io::{Error, ErrorKind};
use std::path::{Path, PathBuf};

use super::confinement;
use novamind_record::mode::Mode;

/// Locations of Python for baseline runs, in search order. `/usr/bin/python3` is omitted because it may be a stub that
/// opens an installer.
#[cfg(target_os = "macos")]
const SYSTEM_PYTHONS: [&str; 5] = [
    "/Library/Developer/CommandLineTools/usr/bin/python3",
    "/Library/Frameworks/Python.framework/Versions/Current/bin/python3",
    "/opt/homebrew/bin/python3",
    "/usr/local/bin/python3",
    "/opt/local/bin/python3",
];
/// Locations of Python for baseline runs, in search order.
#[cfg(not(target_os = "macos"))]
const SYSTEM_PYTHONS: [&str; 4] =
    ["/usr/bin/python3", "/usr/local/bin/python3", "/run/current-system/sw/bin/python3", "/opt/bin/python3"];
/// Value of `PATH` for scripts in baseline runs.
const SYSTEM_PATH: &str = "/usr/bin:/bin";

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Interpreter {
    /// The first `python3` on `PATH`.
    FromPath,
    /// The first existing file in a fixed list of absolute paths, so that a participant cannot change the interpreter
    /// through `PATH`.
    System,
}

impl Interpreter {
    /// Returns the interpreter for a mode. Runs of studies are baseline runs. Restricted scripts never search `PATH`.
    pub fn for_mode(mode: Mode) -> Interpreter {
        if mode == Mode::Baseline || confinement::is_restricted() {
            Interpreter::System
        } else {
            Interpreter::FromPath
        }
    }

    /// Returns the program to start and the `PATH` for its process. `path` is the `PATH` of the current process.
    ///
    /// # Errors
    /// None of the fixed paths exists.
    pub fn program(self, path: OsString) -> std::io::Result<(PathBuf, OsString)> {
        if self == Interpreter::FromPath {
            return Ok((PathBuf::from("python3"), path));
        }
        let found = SYSTEM_PYTHONS.into_iter().find(|program| Path::new(program).is_file());
        found
            .map(|program| (program.into(), SYSTEM_PATH.into()))
            .ok_or_else(|| Error::from(ErrorKind::NotFound))
    }

    /// Returns the message for the player if the interpreter does not exist.
    pub fn missing_message(self) -> String {
        match self {
            Interpreter::FromPath => {
                "python3 is not on the PATH of this machine: install Python 3.8 or newer, or write SQL \
                                    statements instead"
                    .to_owned()
            }
            Interpreter::System => format!(
                "a baseline run does not search PATH for python3, and none of these files exists: {}. Install Python 3.8 or \
                 newer there, or write SQL statements instead",
                SYSTEM_PYTHONS.join(", ")
            ),
        }
    }
}
