//! How a dialogue ends: its name in answers, its cause in the record, its exit code.

use novamind_record::trajectory::record::LeavingCause;

/// Number of the signal that a terminal sends when it is closed.
const HANGUP: i32 = 1;

/// How a dialogue ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum End {
    /// The person left.
    Quit,
    /// There are no more lines.
    InputOver,
    /// A line was refused, and the first refusal ends the dialogue.
    Strict,
    /// The run's file is no longer there.
    RecordLost,
    /// A signal asked for it.
    Signal(i32),
    /// The run of a study is over, and its questions are answered.
    Over,
    /// The person withdrew from the study.
    Withdrawn,
}

impl End {
    /// Name in the answers.
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

    /// Cause in the record.
    pub fn cause(self) -> LeavingCause {
        match self {
            End::Quit | End::Over => LeavingCause::Quit,
            End::InputOver => LeavingCause::EndOfInput,
            End::Strict => LeavingCause::Strict,
            // No line can say it.
            End::RecordLost => LeavingCause::Quit,
            End::Signal(HANGUP) => LeavingCause::Hangup,
            End::Signal(_) => LeavingCause::Signal,
            End::Withdrawn => LeavingCause::Withdrawn,
        }
    }

    /// Exit code.
    pub fn code(self) -> u8 {
        match self {
            End::Quit | End::InputOver | End::Over | End::Withdrawn => 0,
            End::Strict => 1,
            End::RecordLost => 3,
            End::Signal(number) => 128u8.saturating_add(number as u8),
        }
    }
}
