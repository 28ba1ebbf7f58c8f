//! Presence: attached programs, absences of the user, the stopped clock, time limits.

use serde::{Deserialize, Serialize};
use serde_json::Value;

/// A change in the presence of the program or of the user.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Presence {
    /// Kind of the event.
    pub event: PresenceEvent,
    /// Why the program detached from the run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cause: Option<DetachCause>,
    /// Interface that attached to the run: `console`, `plain`, `http` or `policy`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub interface: Option<String>,
    /// Pseudonym of the machine: 16 hexadecimal digits of a keyed hash.
    pub machine: String,
    /// Pseudonym of the current boot of the machine: 16 hexadecimal digits of a keyed hash.
    pub boot: String,
    /// Milliseconds since the boot, according to the monotonic clock.
    pub monotonic_ms: u64,
    /// Size of the terminal, in columns and rows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub window: Option<(u16, u16)>,
    /// Version of the program that recorded the event.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub version: Option<String>,
    /// Milliseconds since the last key press, if the user was idle.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub idle_ms: Option<u64>,
    /// Length and last hash of `worlds.jsonl`, a file of earlier builds. The field is read and never written.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub worlds: Option<Value>,
}

/// Kind of a presence event.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PresenceEvent {
    /// The program attached to the run.
    Opened,
    /// The program detached from the run.
    Closed,
    /// The user has not pressed a key for a minute.
    Idle,
    /// The user pressed the first key after an idle period.
    Active,
    /// The terminal lost focus.
    FocusLost,
    /// The terminal regained focus.
    FocusGained,
    /// The shell suspended the program.
    Suspended,
    /// The program resumed after a suspension.
    Resumed,
    /// The window was resized.
    Resized,
}

/// Why the program detached from a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DetachCause {
    /// The user quit.
    Quit,
    /// The standard input of plain mode ended.
    EndOfInput,
    /// A signal terminated the program.
    Signal,
    /// The terminal was closed.
    Hangup,
    /// Strict plain mode stopped after a rejection.
    Strict,
    /// The participant withdrew from the study.
    Withdrawn,
}

/// A stop or start of the clock.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Clock {
    /// Kind of the event.
    pub event: ClockEvent,
    /// The user's reason for stopping the clock, if the study asks for a reason.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// Milliseconds for which the clock was stopped; only in events that start the clock.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stood_ms: Option<u64>,
}

/// Kind of a clock event.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ClockEvent {
    /// The user stopped the clock, and the screen is covered.
    Stopped,
    /// The user started the clock.
    Started,
    /// The clock started when the run was reopened, because the program had detached with a stopped clock.
    Forgotten,
}

/// An event of a time limit.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Limit {
    /// Scope of the limit: `week`, `session` or `study`.
    pub limit: LimitScope,
    /// Kind of the event.
    pub event: LimitEvent,
    /// Allowed time in minutes.
    pub minutes: u32,
    /// Time used in the scope, in milliseconds.
    pub used_ms: u64,
}

/// Scope of a time limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum LimitScope {
    /// One simulated week.
    Week,
    /// One session of the participant.
    Session,
    /// All sessions of the participant in the study.
    Study,
}

/// Kind of a limit event.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LimitEvent {
    /// The participant was warned before the limit was reached.
    Warned,
    /// The limit was reached, and the participant was reminded.
    Reminded,
    /// The limit was reached, and the week was submitted with naive forecasts.
    FiledNaively,
    /// The limit was reached, and the clock was stopped.
    Paused,
}
