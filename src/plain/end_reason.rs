//! Reasons why a plain-mode session ended. Each reason has a name in responses, a cause in the record, and an
//! exit code.

use novamind_record::trajectory::record::DetachCause;

/// Number of the signal SIGHUP, which a closed terminal sends.
const HANGUP: i32 = 1;

/// Reason why a plain-mode session ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EndReason {
    /// The player entered `quit` or `exit`.
    Quit,
    /// The input ended.
    EndOfInput,
    /// A line was rejected with `--strict`.
    StrictRejection,
    /// The trajectory of the run was removed.
    RecordLost,
    /// A signal was received.
    Signal(i32),
    /// The run of a study is over and its questions are answered.
    RunOver,
    /// The participant withdrew from the study.
    Withdrawn,
}

impl EndReason {
    /// Returns the name of the reason in responses.
    pub fn id(self) -> &'static str {
        match self {
            EndReason::Quit => "quit",
            EndReason::EndOfInput => "end_of_input",
            EndReason::StrictRejection => "strict",
            EndReason::RecordLost => "record_lost",
            EndReason::Signal(_) => "signal",
            EndReason::RunOver => "over",
            EndReason::Withdrawn => "withdrawn",
        }
    }

    /// Returns the cause that is recorded for this reason.
    pub fn leaving_cause(self) -> DetachCause {
        match self {
            EndReason::Quit | EndReason::RunOver => DetachCause::Quit,
            EndReason::EndOfInput => DetachCause::EndOfInput,
            EndReason::StrictRejection => DetachCause::Strict,
            // The cause is never written, because the record no longer has a file.
            EndReason::RecordLost => DetachCause::Quit,
            EndReason::Signal(HANGUP) => DetachCause::Hangup,
            EndReason::Signal(_) => DetachCause::Signal,
            EndReason::Withdrawn => DetachCause::Withdrawn,
        }
    }

    /// Returns the exit code of the program for this reason.
    pub fn exit_code(self) -> u8 {
        match self {
            EndReason::Quit | EndReason::EndOfInput | EndReason::RunOver | EndReason::Withdrawn => 0,
            EndReason::StrictRejection => 1,
            EndReason::RecordLost => 3,
            EndReason::Signal(number) => 128u8.saturating_add(number as u8),
        }
    }
}
