//! What can go wrong with a run as a whole: which file, which line, what is safe, what to do next.

use std::path::{Path, PathBuf};

use thiserror::Error;

use crate::consent::ConsentText;

use novamind_database::ProjectionError;
use novamind_world::params::ParameterError;

/// Why a run cannot be created, opened or read.
#[derive(Debug, Error)]
pub enum RunError {
    /// A file cannot be read or written.
    #[error("{path}: {error}", path = .path.display())]
    Io {
        /// File or folder.
        path: PathBuf,
        /// What the system said.
        error: std::io::Error,
    },
    /// A file of a run is not what was written.
    #[error("{path}, line {line}: {problem}. {safe}", path = .path.display())]
    Damaged {
        /// File.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// What is wrong.
        problem: String,
        /// What is still good, and what can be done.
        safe: String,
    },
    /// A manifest or configuration is wrong.
    #[error("{0}")]
    Configuration(#[from] ParameterError),
    /// The run was recorded with other parameters than this program has.
    #[error(
        "run {id} was recorded by version {version} with parameters {recorded}, but this program has {own}. \
         Nothing was changed; open the run with that version"
    )]
    OtherParameters {
        /// Run.
        id: String,
        /// Version that recorded it.
        version: String,
        /// Digest in the manifest.
        recorded: String,
        /// Digest of the parameters as this program reads them.
        own: String,
    },
    /// The run was played by other mechanics than this program has.
    #[error(
        "run {id} was recorded by version {version} with mechanics {recorded}, but this program has \
         mechanics {own}. Nothing was changed; open the run with that version"
    )]
    OtherMechanics {
        /// Run.
        id: String,
        /// Version that recorded it.
        version: String,
        /// Number in the manifest.
        recorded: u32,
        /// Number of this program.
        own: u32,
    },
    /// The person has to agree to a text first.
    #[error("{}", .0.explained())]
    ConsentNeeded(ConsentText),
    /// The run was written in a format this program does not know.
    #[error(
        "run {id} has format {format}, but this program reads format {known}. Nothing was changed; use a \
         newer version"
    )]
    OtherFormat {
        /// Run.
        id: String,
        /// Format in the manifest.
        format: u32,
        /// Format of this program.
        known: u32,
    },
    /// Another program is writing the run.
    #[error(
        "run {id} is open in another program ({holder}); close it there, or watch it from here: `novamind play --run {id} --watch`"
    )]
    InUse {
        /// Run.
        id: String,
        /// Who holds it.
        holder: String,
    },
    /// The file of a run that is played is not the one it was.
    #[error(
        "your decisions are no longer on disk: {path} was moved, removed or linked, or another program has written to it. \
         Nothing more is saved. {}", kept_words(.kept), path = .path.display()
    )]
    Astray {
        /// The trajectory.
        path: PathBuf,
        /// The file that everything was written to, or why it could not be.
        kept: Result<PathBuf, String>,
    },
    /// The program failed while it closed a run.
    #[error("the program has a defect and failed while it closed run {run}. {}", safe_words(run, folder.as_deref()))]
    Defect {
        /// Run.
        run: String,
        /// Its folder; `None` in memory.
        folder: Option<PathBuf>,
    },
    /// The folder of a run takes no changes.
    #[error(
        "run {id} cannot be written ({error}): its folder {folder} is on read-only media or belongs to somebody else; \
         open it read-only with `novamind play --run {id} --watch`, or copy it to a place of your own",
        folder = .folder.display()
    )]
    NotWritable {
        /// Run.
        id: String,
        /// Its folder.
        folder: PathBuf,
        /// What the system said.
        error: std::io::Error,
    },
    /// There is no such run.
    #[error("there is no run {id} in {folder}; `novamind runs` lists the runs", folder = .folder.display())]
    NotFound {
        /// What was asked for.
        id: String,
        /// Where it was looked for.
        folder: PathBuf,
    },
    /// A file is no archive of a run, or not the one that was sealed.
    #[error("{path}: {problem}. {safe}", path = .path.display())]
    Archive {
        /// The archive.
        path: PathBuf,
        /// What is wrong with it; names the file inside.
        problem: String,
        /// What is still good, and what can be done.
        safe: String,
    },
    /// Something would be overwritten.
    #[error("{0}")]
    Exists(String),
    /// There is no such scenario.
    #[error("there is no scenario {name}; the scenarios are {known}")]
    NoScenario {
        /// What was asked for.
        name: String,
        /// Those there are.
        known: String,
    },
    /// There is no such lesson.
    #[error("there is no lesson {name}; the lessons are {known}")]
    NoLesson {
        /// What was asked for.
        name: String,
        /// Those there are.
        known: String,
    },
    /// The run cannot be started as asked.
    #[error("{0}")]
    NotPossible(String),
    /// The database cannot be written.
    #[error("{0}")]
    Projection(#[from] ProjectionError),
}

/// Where everything is that was confirmed, and what to do.
fn kept_words(kept: &Result<PathBuf, String>) -> String {
    match kept {
        Ok(file) => format!(
            "Everything confirmed so far is in {}. Leave. If trajectory.jsonl is gone, give this file its name and open the \
             run again; if it is there, keep both files and tell whoever runs the session",
            file.display()
        ),
        Err(problem) if problem.is_empty() => {
            "Leave, and look for the file before you open the run again".to_owned()
        }
        Err(problem) => format!(
            "It could not be written beside its place either ({problem}). Leave, and look for the file before you open the \
             run again"
        ),
    }
}

/// What is safe after a defect, and what to do.
fn safe_words(run: &str, folder: Option<&Path>) -> String {
    match folder {
        Some(folder) => format!(
            "Everything that was confirmed is in {}. Open the run again with `novamind play --run {run}`: whatever else was not \
             saved is rebuilt from that file",
            folder.join("trajectory.jsonl").display()
        ),
        None => "It was only in memory and is gone".to_owned(),
    }
}

impl RunError {
    /// An error of the system at a path.
    pub fn io(path: &Path) -> impl FnOnce(std::io::Error) -> RunError + '_ {
        move |error| RunError::Io { path: path.to_owned(), error }
    }
}
