//! Errors that concern a whole run. Their messages name the file and line, the data that is safe, and the next step.

use std::path::{Path, PathBuf};

use thiserror::Error;

use crate::consent::ConsentText;

use novamind_database::ProjectionError;
use novamind_world::params::ParameterError;

/// An error that occurred while creating, opening or reading a run.
#[derive(Debug, Error)]
pub enum RunError {
    /// A file cannot be read or written.
    #[error("{path}: {error}", path = .path.display())]
    Io {
        /// Path of the file or folder.
        path: PathBuf,
        /// Error of the operating system.
        error: std::io::Error,
    },
    /// A file of a run was changed after it was written.
    #[error("{path}, line {line}: {problem}. {remedy}", path = .path.display())]
    Damaged {
        /// Path of the file.
        path: PathBuf,
        /// Number of the damaged line, from 1.
        line: usize,
        /// Description of the defect.
        problem: String,
        /// The data that is still valid, and the next step.
        remedy: String,
    },
    /// A manifest or configuration is invalid.
    #[error("{0}")]
    Configuration(#[from] ParameterError),
    /// The run was recorded with parameters that differ from the parameters of this program.
    #[error(
        "run {id} was recorded by version {version} with parameters {recorded}, but this program has {expected}. \
         Nothing was changed; open the run with that version"
    )]
    OtherParameters {
        /// ID of the run.
        id: String,
        /// Version that recorded the run.
        version: String,
        /// Parameter digest in the manifest.
        recorded: String,
        /// Digest of the parameters that this program loaded.
        expected: String,
    },
    /// The run was recorded with mechanics that differ from the mechanics of this program.
    #[error(
        "run {id} was recorded by version {version} with mechanics {recorded}, but this program has \
         mechanics {expected}. Nothing was changed; open the run with that version"
    )]
    OtherMechanics {
        /// ID of the run.
        id: String,
        /// Version that recorded the run.
        version: String,
        /// Mechanics number in the manifest.
        recorded: u32,
        /// Mechanics number of this program.
        expected: u32,
    },
    /// The participant has not agreed to the consent text yet.
    #[error("{}", .0.instructions())]
    ConsentNeeded(ConsentText),
    /// The run has a format that this program cannot read.
    #[error(
        "run {id} has format {format}, but this program reads format {known}. Nothing was changed; use a \
         newer version"
    )]
    OtherFormat {
        /// ID of the run.
        id: String,
        /// Format number in the manifest.
        format: u32,
        /// Newest format that this program can read.
        known: u32,
    },
    /// Another program is writing the run.
    #[error(
        "run {id} is open in another program ({holder}); close it there, or watch it from here: `novamind play --run {id} --watch`"
    )]
    InUse {
        /// ID of the run.
        id: String,
        /// Process that has locked the run.
        holder: String,
    },
    /// The trajectory file was moved, removed, hard-linked or changed while the run was open.
    #[error(
        "your decisions are no longer on disk: {path} was moved, removed or linked, or another program has written to it. \
        No more decisions will be saved. {}", describe_saved_copy(.saved_copy), path = .path.display()
    )]
    FileReplaced {
        /// Path of the trajectory.
        path: PathBuf,
        /// Path of the copy of all confirmed lines, or the error message if they could not be copied.
        saved_copy: Result<PathBuf, String>,
    },
    /// The program panicked while closing a run.
    #[error("the program has a defect and failed while closing run {run}. {}", describe_saved_lines(run, folder.as_deref()))]
    Defect {
        /// ID of the run.
        run: String,
        /// Folder of the run; `None` for a run in memory.
        folder: Option<PathBuf>,
    },
    /// The folder of a run is not writable.
    #[error(
        "run {id} cannot be written ({error}): its folder {folder} is read-only or belongs to another user; open the \
         run read-only with `novamind play --run {id} --watch`, or copy it to a folder that you can write",
        folder = .folder.display()
    )]
    NotWritable {
        /// ID of the run.
        id: String,
        /// Folder of the run.
        folder: PathBuf,
        /// Error of the operating system.
        error: std::io::Error,
    },
    /// The folder has no runs, so there is no latest run.
    #[error("there are no runs in {folder} yet; start a run with `novamind play`", folder = .folder.display())]
    NoRuns {
        /// Folder that was searched.
        folder: PathBuf,
    },
    /// All runs have ended, so there is no run to continue.
    #[error(
        "all runs in {folder} have ended; start a new run with `novamind play`, or watch the newest run with `novamind replay latest`",
        folder = .folder.display()
    )]
    AllRunsEnded {
        /// Folder that was searched.
        folder: PathBuf,
    },
    /// The run does not exist.
    #[error("there is no run {id} in {folder}; `novamind runs` lists the runs", folder = .folder.display())]
    NotFound {
        /// Run id that the user requested.
        id: String,
        /// Folder that was searched.
        folder: PathBuf,
    },
    /// A file is not an archive of a run, or was changed after it was sealed.
    #[error("{path}: {problem}. {remedy}", path = .path.display())]
    InvalidArchive {
        /// Path of the archive.
        path: PathBuf,
        /// Description of the defect, with the name of the file inside the archive.
        problem: String,
        /// The data that is still valid, and the next step.
        remedy: String,
    },
    /// The operation would overwrite an existing file or run.
    #[error("{0}")]
    AlreadyExists(String),
    /// The scenario does not exist.
    #[error("there is no scenario {name}; the scenarios are {known}")]
    UnknownScenario {
        /// Scenario name that the user requested.
        name: String,
        /// Names of the existing scenarios, separated by commas.
        known: String,
    },
    /// The lesson does not exist.
    #[error("there is no lesson {name}; the lessons are {known}")]
    UnknownLesson {
        /// Lesson name that the user requested.
        name: String,
        /// Names of the existing lessons, separated by commas.
        known: String,
    },
    /// The run cannot be started with these options.
    #[error("{0}")]
    InvalidRequest(String),
    /// The SQL tables of the run cannot be written.
    #[error("{0}")]
    Projection(#[from] ProjectionError),
}

/// Describes where the confirmed lines were saved, and the next step.
fn describe_saved_copy(kept: &Result<PathBuf, String>) -> String {
    match kept {
        Ok(file) => format!(
            "All confirmed lines are in {}. Quit the program. If trajectory.jsonl no longer exists, rename this copy to \
             trajectory.jsonl and open the run again; otherwise, keep both files and inform the experimenter",
            file.display()
        ),
        Err(problem) if problem.is_empty() => {
            "Quit the program, and find the file before you open the run again".to_owned()
        }
        Err(problem) => format!(
            "A copy could not be written either ({problem}). Quit the program, and find the file before you open the \
             run again"
        ),
    }
}

/// Describes which data is safe after a defect, and the next step.
fn describe_saved_lines(run: &str, folder: Option<&Path>) -> String {
    match folder {
        Some(folder) => format!(
            "All confirmed lines are in {}. Open the run again with `novamind play --run {run}`: the program rebuilds \
             the other files from that file",
            folder.join("trajectory.jsonl").display()
        ),
        None => "The run was only in memory and is lost".to_owned(),
    }
}

impl RunError {
    /// Returns a function that adds a path to an error of the operating system.
    pub fn io(path: &Path) -> impl FnOnce(std::io::Error) -> RunError + '_ {
        move |error| RunError::Io { path: path.to_owned(), error }
    }
}
