//! What a language model is asked that lends the public its voice, and what counts as an answer (docs/interfaces/voice.md).
//!
//! Text goes in and comes out. Whoever asks owns the connection, the clock and the record.

mod answer;
pub mod scoring;
pub mod settings;
pub mod wording;

/// What is sent to the model.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ModelPrompt {
    /// What it is to do.
    pub task: String,
    /// What it is to do it with: JSON.
    pub material: String,
}
