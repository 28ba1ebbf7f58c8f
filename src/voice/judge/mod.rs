//! The judge of the player's posts: returns the reaction of each group, with reasons
//! (docs/mechanics/market/social/judge.md).
//!
//! The judge models readers who either ignore or answer a post. Reactions are within -1..=1. Reactions of at least
//! 0.6, positive or negative, cause comments and change leads. Readers compare claims with their experience, so honest
//! posts score higher. The judge is deterministic: it uses neither random draws nor a clock.

mod claims;
pub mod context;
mod features;
pub mod lexicon;
mod score;
pub mod text;

#[cfg(test)]
mod tests;

use std::fmt::Write;

use serde::{Deserialize, Serialize};

pub use context::JudgeContext;
pub use lexicon::Lexicon;

use crate::model::scoring::ModelScore;
use features::Features;
use novamind_world::identifiers::Group;
use std::borrow::Cow;
use text::{TokenizedText, pair_overlap};

/// A post of the player, with the post that it answers and the player's earlier posts.
#[derive(Debug, Clone, Default)]
pub struct SubmittedPost<'a> {
    /// Text of the post.
    pub content: &'a str,
    /// Day on which the post was published.
    pub day: u32,
    /// The post to which the player replies.
    pub original: Option<OriginalPost<'a>>,
    /// Day and text of the player's earlier posts.
    pub earlier: Vec<(u32, &'a str)>,
}

/// A post to which the player replies.
#[derive(Debug, Clone, Copy)]
pub struct OriginalPost<'a> {
    /// Text of the post.
    pub content: &'a str,
    /// Whether the post is a complaint.
    pub negative: bool,
    /// Group of the post's author; `None` for the press.
    pub group: Option<Group>,
}

/// The reaction of a group to a post, with reasons.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Judgement {
    /// The group of readers that reacts.
    pub group: Group,
    /// The reaction, -1..=1, rounded to hundredths.
    pub effect: f64,
    /// Nonzero terms of the reaction, in a fixed order, before multiplication by the group's factor.
    pub terms: Vec<ScoreTerm>,
    /// The reason that a language model gave, if a model judged the post.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub model_reason: Option<String>,
}

/// One term in the sum of a reaction.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ScoreTerm {
    /// Name of the term.
    pub name: Cow<'static, str>,
    /// Signed value of the term.
    pub value: f64,
    /// Topics, claims or events that caused the term.
    pub because: Vec<String>,
}

impl Judgement {
    /// Returns the terms in descending order of absolute value.
    pub fn terms_by_size(&self) -> Vec<&ScoreTerm> {
        let mut terms: Vec<&ScoreTerm> = self.terms.iter().collect();
        terms.sort_by(|one, other| other.value.abs().total_cmp(&one.value.abs()));
        terms
    }

    /// Replaces the reaction with a language model's score. Keeps the topics, because comments name them.
    pub fn with_model_score(self, score: &ModelScore) -> Judgement {
        let Judgement { group, mut terms, .. } = self;
        terms.retain(|term| term.name == "topics");
        Judgement { group, effect: score.score, terms, model_reason: Some(score.reason.clone()) }
    }

    /// Returns the three largest terms on one line, for instance `topics +0.40 (api, limits), specific +0.20`. Returns
    /// the model's reason instead if a language model judged the post.
    pub fn reason(&self) -> String {
        if let Some(reason) = &self.model_reason {
            return reason.clone();
        }
        let mut text = String::new();
        for term in self.terms_by_size().into_iter().take(3) {
            let comma = if text.is_empty() { "" } else { ", " };
            let _ = write!(text, "{comma}{} {:+.2}", term.name, term.value);
            if !term.because.is_empty() {
                let _ = write!(text, " ({})", term.because.join(", "));
            }
        }
        text
    }
}

/// Data about a post that is the same for all groups.
struct SharedPostData<'a> {
    features: Features,
    /// The post to which the player replies, with its features.
    original: Option<(Features, OriginalPost<'a>)>,
    /// Features of the player's recent posts.
    recent: Vec<Features>,
    /// Largest text overlap with a recent post, 0..=1.
    overlap: f64,
    context: &'a JudgeContext,
    lexicon: &'a Lexicon,
}

/// Returns the reaction of each group to a post.
pub fn judge_post(
    submission: &SubmittedPost<'_>,
    groups: impl IntoIterator<Item = Group>,
    context: &JudgeContext,
    lexicon: &Lexicon,
) -> Vec<Judgement> {
    let since = |days: u32| {
        let within = move |day: u32| submission.day.saturating_sub(day) <= days;
        submission.earlier.iter().filter(move |(day, _)| within(*day))
    };
    let features = Features::from_post(submission.content, lexicon);
    let overlaps = since(lexicon.terms.repetition_days)
        .map(|(_, content)| pair_overlap(&features.text, &TokenizedText::new(content)));
    let case = SharedPostData {
        overlap: overlaps.fold(0.0, f64::max),
        recent: since(lexicon.terms.recipe_days)
            .map(|(_, text)| Features::from_post(text, lexicon))
            .collect(),
        original: submission
            .original
            .map(|original_post| (Features::from_post(original_post.content, lexicon), original_post)),
        features,
        context,
        lexicon,
    };
    groups.into_iter().map(|group| score::judge_group(group, &case)).collect()
}
