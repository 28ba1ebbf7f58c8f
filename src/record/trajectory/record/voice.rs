//! Recorded responses of the language model that words public texts. A replay uses these responses instead of the
//! model.

use serde::{Deserialize, Serialize};

use super::serialize_shortest;
use novamind_voice::model::scoring::ModelScore;

/// A response of the language model, or a failed request.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "what", rename_all = "lowercase")]
pub enum VoiceAnswer {
    /// Scores for a post of the player.
    Scores(JudgedPost),
    /// Reworded posts of other authors.
    Words(RewordedPosts),
    /// A request to the model failed, and the built-in voice was used.
    Failed(FailedModelRequest),
}

/// Scores of the language model for a post of the player.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct JudgedPost {
    /// Number of the post among the player's posts, from 1.
    pub post: u32,
    /// Day on which the post was published.
    pub posted: u32,
    /// Text of the post.
    pub content: String,
    /// Number of the post to which the player's post replies.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reply_to: Option<u32>,
    /// One score for each group that was known on the day of the post.
    pub scores: Vec<ModelScore>,
    /// Duration of the response in milliseconds.
    #[serde(serialize_with = "serialize_shortest")]
    pub took_ms: f64,
}

/// Posts of other authors, reworded by the model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RewordedPosts {
    /// Reworded posts, each with its number and text.
    pub posts: Vec<RewordedPost>,
    /// Duration of the response in milliseconds.
    #[serde(serialize_with = "serialize_shortest")]
    pub took_ms: f64,
}

/// A reworded post.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct RewordedPost {
    /// Number of the post among the posts that the player did not write, from 1.
    pub post: u32,
    /// Text of the post after rewording.
    pub text: String,
}

/// A request to the model without a usable response.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FailedModelRequest {
    /// Task that was requested from the model.
    pub asked: ModelTask,
    /// Description of the problem.
    pub problem: String,
    /// Duration of the request in milliseconds.
    #[serde(serialize_with = "serialize_shortest")]
    pub took_ms: f64,
}

/// A task for the language model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ModelTask {
    /// Score a post of the player.
    Scores,
    /// Reword posts of other authors.
    Words,
}
