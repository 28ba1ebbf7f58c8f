//! The ends of a plain-mode session: names in answers, causes in the record, exit codes.

use novamind_record::trajectory::record::LeavingCause;

/// Number of the signal for a closed terminal.
const HANGUP: i32 = 1;

/// How a session ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EndReason {
    /// The player left.
    Quit,
    /// The input ended.
    EndOfInput,
    /// A line was rejected with `--strict`.
    StrictRejection,
    /// The trajectory of the run is no longer there.
    RecordLost,
    /// A signal was received.
    Signal(i32),
    /// The run of a study is over and its questions are answered.
    RunOver,
    /// The participant withdrew from the study.
    Withdrawn,
}

impl EndReason {
    /// Returns the name in answers.
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

    /// Returns the cause in the record.
    pub fn leaving_cause(self) -> LeavingCause {
        match self {
            EndReason::Quit | EndReason::RunOver => LeavingCause::Quit,
            EndReason::EndOfInput => LeavingCause::EndOfInput,
            EndReason::StrictRejection => LeavingCause::Strict,
            // Without its file the record cannot be written.
            EndReason::RecordLost => LeavingCause::Quit,
            EndReason::Signal(HANGUP) => LeavingCause::Hangup,
            EndReason::Signal(_) => LeavingCause::Signal,
            EndReason::Withdrawn => LeavingCause::Withdrawn,
        }
    }

    /// Returns the exit code.
    pub fn exit_code(self) -> u8 {
        match self {
            EndReason::Quit | EndReason::EndOfInput | EndReason::RunOver | EndReason::Withdrawn => 0,
            EndReason::StrictRejection => 1,
            EndReason::RecordLost => 3,
            EndReason::Signal(number) => 128u8.saturating_add(number as u8),
        }
    }
}
