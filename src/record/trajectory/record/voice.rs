//! What a language model said that lends the public its voice. Whoever replays a run takes it from here.

use serde::{Deserialize, Serialize};

use super::shortest;
use novamind_voice::model::scoring::ModelScore;

/// An answer of a language model, or that there was none that could be used.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "what", rename_all = "lowercase")]
pub enum VoiceAnswer {
    /// How readers take a post of the player.
    Scores(JudgedPost),
    /// Posts of others in its words.
    Words(WordedPosts),
    /// The built-in voice spoke instead.
    Failed(FailedAnswer),
}

/// How readers take a post of the player.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct JudgedPost {
    /// Number of the post.
    pub post: u32,
    /// Day it was made.
    pub posted: u32,
    /// Its text.
    pub content: String,
    /// Number of the post that it answers.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reply_to: Option<u32>,
    /// One score for each group that was known.
    pub scores: Vec<ModelScore>,
    /// Milliseconds the answer took.
    #[serde(serialize_with = "shortest")]
    pub took_ms: f64,
}

/// Posts of others in the words of a model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct WordedPosts {
    /// Number and text of each.
    pub posts: Vec<WordedPost>,
    /// Milliseconds the answer took.
    #[serde(serialize_with = "shortest")]
    pub took_ms: f64,
}

/// A post of somebody else in the words of a model.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct WordedPost {
    /// Number of the post.
    pub post: u32,
    /// Its text.
    pub text: String,
}

/// A question to a model without an answer that can be used.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FailedAnswer {
    /// What was asked for.
    pub asked: AskedOfModel,
    /// What went wrong.
    pub problem: String,
    /// Milliseconds it took.
    #[serde(serialize_with = "shortest")]
    pub took_ms: f64,
}

/// What a model is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum AskedOfModel {
    /// Scores of a post of the player.
    Scores,
    /// Posts of others in its words.
    Words,
}
