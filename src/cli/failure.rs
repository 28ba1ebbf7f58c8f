//! Command failures and their exit codes.

use std::fmt;
use std::io::ErrorKind;

use crate::lab;
use crate::record::error::RunError;
use crate::tools::Rejection;

/// The reason why a command failed, with its exit code. An empty message is not printed.
#[derive(Debug)]
pub struct Failure {
    /// Exit code of the command.
    pub code: u8,
    message: String,
}

impl Failure {
    /// Returns a failure with exit code 1: the operation failed.
    pub fn failed(message: impl Into<String>) -> Failure {
        Failure { code: 1, message: message.into() }
    }

    /// Returns a failure with exit code 2: the command line is wrong.
    pub fn usage(message: impl Into<String>) -> Failure {
        Failure { code: 2, message: message.into() }
    }

    /// Returns a failure with exit code 3: a run, file or configuration cannot be read.
    pub fn unreadable(message: impl Into<String>) -> Failure {
        Failure { code: 3, message: message.into() }
    }

    /// Returns a failure with exit code 4: a run ended in bankruptcy and `--fail-on-bankruptcy` was given.
    pub fn bankrupt() -> Failure {
        Failure { code: 4, message: String::new() }
    }

    /// Returns a failure with exit code 128 plus the number of the signal that ended the command.
    pub fn signal(number: i32) -> Failure {
        Failure { code: 128u8.saturating_add(number as u8), message: String::new() }
    }

    /// Returns a failure with exit code 0 and no message: the reader of standard output closed the pipe.
    pub fn broken_pipe() -> Failure {
        Failure { code: 0, message: String::new() }
    }

    /// Returns a failure with a command-specific exit code.
    #[cfg(feature = "server")]
    pub fn with_code(code: u8, message: impl Into<String>) -> Failure {
        Failure { code, message: message.into() }
    }

    /// Prefixes the message with a subject, such as a file name.
    pub fn with_subject(self, subject: &str) -> Failure {
        Failure { message: format!("{subject}: {}", self.message), ..self }
    }

    /// Returns a failure with an exit code and no message.
    pub fn code_only(code: u8) -> Failure {
        Failure { code, message: String::new() }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.message)
    }
}

impl std::error::Error for Failure {}

impl From<RunError> for Failure {
    fn from(error: RunError) -> Failure {
        match error {
            RunError::InvalidRequest(_)
            | RunError::UnknownScenario { .. }
            | RunError::UnknownLesson { .. } => Failure::usage(error.to_string()),
            RunError::Io { error: ref io_error, .. } if is_write_failure(io_error.kind()) => {
                Failure::failed(error.to_string())
            }
            RunError::InUse { .. } | RunError::AlreadyExists(_) => Failure::failed(error.to_string()),
            _ => Failure::unreadable(error.to_string()),
        }
    }
}

/// Returns whether an error of this kind occurs only while writing. For these errors, the exit code is 1, not
/// the code for an unreadable file.
fn is_write_failure(kind: ErrorKind) -> bool {
    matches!(
        kind,
        ErrorKind::StorageFull
            | ErrorKind::QuotaExceeded
            | ErrorKind::FileTooLarge
            | ErrorKind::ReadOnlyFilesystem
            | ErrorKind::WriteZero
            | ErrorKind::BrokenPipe
    )
}

impl From<Rejection> for Failure {
    fn from(rejection: Rejection) -> Failure {
        Failure::failed(rejection.to_string())
    }
}

impl From<lab::PolicyError> for Failure {
    fn from(error: lab::PolicyError) -> Failure {
        match error.is_unknown {
            true => Failure::usage(error.to_string()),
            false => Failure::unreadable(error.to_string()),
        }
    }
}

impl From<lab::GoldenError> for Failure {
    fn from(error: lab::GoldenError) -> Failure {
        Failure::unreadable(error.to_string())
    }
}

impl From<lab::experiment::ExperimentError> for Failure {
    fn from(error: lab::experiment::ExperimentError) -> Failure {
        use lab::experiment::ExperimentError::{Run, Stopped, Store};
        let message = error.to_string();
        match error {
            Run { error, .. } => Failure { message, ..(*error).into() },
            Store { .. } => Failure::failed(message),
            // Shells use exit code 130 after ctrl-c.
            Stopped { .. } => Failure { code: 130, message },
        }
    }
}

impl From<lab::RunError> for Failure {
    fn from(error: lab::RunError) -> Failure {
        match error {
            lab::RunError::Start(error) => (*error).into(),
            refused @ lab::RunError::Refused { .. } => Failure::failed(refused.to_string()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn full_disk_error_has_the_exit_code_of_a_failed_operation() {
        let code = |kind: ErrorKind| {
            Failure::from(RunError::Io { path: "run.toml".into(), error: kind.into() }).code
        };
        assert_eq!(code(ErrorKind::StorageFull), 1);
        assert_eq!(code(ErrorKind::ReadOnlyFilesystem), 1);
        assert_eq!(code(ErrorKind::NotFound), 3);
        assert_eq!(code(ErrorKind::InvalidData), 3);
    }
}
