//! Prompts for language models that word or judge posts, and validation of their responses (docs/interfaces/voice.md).
//!
//! This module only builds and parses text. The caller manages the connection, time limits and recording.

mod response;
pub mod scoring;
pub mod settings;
pub mod wording;

/// A prompt for a language model.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ModelPrompt {
    /// Instructions to the model.
    pub task: String,
    /// Input data of the task, as JSON.
    pub input: String,
}
