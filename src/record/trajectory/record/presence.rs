//! Whether somebody is there: the program taking up and leaving a run, absences, the stopped clock, time limits.

use serde::{Deserialize, Serialize};
use serde_json::Value;

/// The program or the person came or went.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Presence {
    /// What happened.
    pub event: PresenceEvent,
    /// Why the program left the run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cause: Option<LeavingCause>,
    /// What the person plays with: `console`, `plain`, `http`, `policy`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub interface: Option<String>,
    /// Names the machine without telling which it is: 16 hexadecimal digits of a keyed hash.
    pub machine: String,
    /// Names the time since the machine was started, likewise.
    pub boot: String,
    /// Milliseconds since the machine was started, by a clock that nobody can set.
    pub monotonic_ms: u64,
    /// Columns and rows of the terminal.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub window: Option<(u16, u16)>,
    /// Version of the program.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub version: Option<String>,
    /// Milliseconds since the last key, where the person was found to be idle.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub idle_ms: Option<u64>,
    /// Length and last hash of `worlds.jsonl`, a list that earlier builds kept. Read, never written.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub worlds: Option<Value>,
}

/// What happened to the presence of program or person.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PresenceEvent {
    /// The program took up the run.
    Opened,
    /// The program left the run.
    Closed,
    /// No key for a while: the person reads, thinks, or is gone.
    Idle,
    /// The first key after that.
    Active,
    /// The terminal lost the focus: another window has it.
    FocusLost,
    /// The terminal has the focus again.
    FocusGained,
    /// The program was stopped by the shell.
    Suspended,
    /// It goes on.
    Resumed,
    /// The window has another size.
    Resized,
}

/// Why the program left a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LeavingCause {
    /// The person left it.
    Quit,
    /// The input was at its end.
    EndOfInput,
    /// A signal: somebody ended the program.
    Signal,
    /// The terminal was closed.
    Hangup,
    /// Strict plain mode met a refusal.
    Strict,
    /// The person withdrew from the study.
    Withdrawn,
}

/// The clock was stopped or started.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Clock {
    /// What happened.
    pub event: ClockEvent,
    /// Why it was stopped, as the person says, where the study asks.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// Milliseconds that it stood, when it is started.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stood_ms: Option<u64>,
}

/// What happened to the clock.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ClockEvent {
    /// Stopped: the screen is covered.
    Stopped,
    /// Started by the person.
    Started,
    /// It stood when the program left the run, and is started as the run is taken up.
    Forgotten,
}

/// A time limit.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Limit {
    /// Which: `week`, `session`, `study`.
    pub limit: LimitScope,
    /// What happened.
    pub event: LimitEvent,
    /// Minutes that are allowed.
    pub minutes: u32,
    /// Active milliseconds that were used.
    pub used_ms: u64,
}

/// What a limit is on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum LimitScope {
    /// One week of the company.
    Week,
    /// One sitting.
    Session,
    /// All sittings.
    Study,
}

/// What came of a limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LimitEvent {
    /// The person was warned.
    Warned,
    /// It was reached, and the person was reminded.
    Reminded,
    /// It was reached, and the week was filed naively.
    FiledNaively,
    /// It was reached, and the clock was stopped.
    Paused,
}
