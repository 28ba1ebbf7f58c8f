//! Prompts for language models that word or judge posts, and validation of their responses (docs/interfaces/voice.md).
//!
//! This module handles text only. The caller owns the connection, the clock and the record.

mod response;
pub mod scoring;
pub mod settings;
pub mod wording;

/// A prompt for the model.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ModelPrompt {
    /// The task.
    pub task: String,
    /// The input as JSON.
    pub input: String,
}
