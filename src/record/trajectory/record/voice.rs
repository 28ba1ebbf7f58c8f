//! Responses of the language model that words public texts. A replay uses these instead of the model.

use serde::{Deserialize, Serialize};

use super::serialize_shortest;
use novamind_voice::model::scoring::ModelScore;

/// A response of a language model, or its failure.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "what", rename_all = "lowercase")]
pub enum VoiceAnswer {
    /// Scores of a post of the player.
    Scores(JudgedPost),
    /// Reworded posts of other authors.
    Words(WordedPosts),
    /// The model failed, and the built-in voice was used.
    Failed(FailedAnswer),
}

/// Scores of a post of the player.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct JudgedPost {
    /// Number of the post.
    pub post: u32,
    /// Day of the post.
    pub posted: u32,
    /// Text.
    pub content: String,
    /// Number of the post to which it replies.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reply_to: Option<u32>,
    /// One score for each group that was known.
    pub scores: Vec<ModelScore>,
    /// Duration of the response in milliseconds.
    #[serde(serialize_with = "serialize_shortest")]
    pub took_ms: f64,
}

/// Posts of other authors, reworded by the model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct WordedPosts {
    /// Number and text of each.
    pub posts: Vec<WordedPost>,
    /// Duration of the response in milliseconds.
    #[serde(serialize_with = "serialize_shortest")]
    pub took_ms: f64,
}

/// A reworded post.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct WordedPost {
    /// Number of the post.
    pub post: u32,
    /// New text.
    pub text: String,
}

/// A request to the model without a usable response.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FailedAnswer {
    /// Requested response.
    pub asked: ModelTask,
    /// The problem.
    pub problem: String,
    /// Duration in milliseconds.
    #[serde(serialize_with = "serialize_shortest")]
    pub took_ms: f64,
}

/// Task of a model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ModelTask {
    /// Scores for a post of the player.
    Scores,
    /// Texts for posts of other authors.
    Words,
}
