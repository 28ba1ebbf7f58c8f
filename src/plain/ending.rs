//! The ends of a plain-mode session: names in answers, causes in the record, exit codes.

use novamind_record::trajectory::record::LeavingCause;

/// Number of the signal for a closed terminal.
const HANGUP: i32 = 1;

/// How a session ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum End {
    /// The player left.
    Quit,
    /// The input ended.
    InputOver,
    /// A line was rejected with `--strict`.
    Strict,
    /// The trajectory of the run is no longer there.
    RecordLost,
    /// A signal was received.
    Signal(i32),
    /// The run of a study is over and its questions are answered.
    Over,
    /// The participant withdrew from the study.
    Withdrawn,
}

impl End {
    /// Returns the name in answers.
    pub fn id(self) -> &'static str {
        match self {
            End::Quit => "quit",
            End::InputOver => "end_of_input",
            End::Strict => "strict",
            End::RecordLost => "record_lost",
            End::Signal(_) => "signal",
            End::Over => "over",
            End::Withdrawn => "withdrawn",
        }
    }

    /// Returns the cause in the record.
    pub fn cause(self) -> LeavingCause {
        match self {
            End::Quit | End::Over => LeavingCause::Quit,
            End::InputOver => LeavingCause::EndOfInput,
            End::Strict => LeavingCause::Strict,
            // Without its file the record cannot be written.
            End::RecordLost => LeavingCause::Quit,
            End::Signal(HANGUP) => LeavingCause::Hangup,
            End::Signal(_) => LeavingCause::Signal,
            End::Withdrawn => LeavingCause::Withdrawn,
        }
    }

    /// Returns the exit code.
    pub fn code(self) -> u8 {
        match self {
            End::Quit | End::InputOver | End::Over | End::Withdrawn => 0,
            End::Strict => 1,
            End::RecordLost => 3,
            End::Signal(number) => 128u8.saturating_add(number as u8),
        }
    }
}
