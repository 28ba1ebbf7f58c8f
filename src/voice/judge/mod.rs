//! The judge of the player's posts: returns one reaction per group with reasons
//! (docs/mechanics/market/social/judge.md).
//!
//! It models readers who either ignore or answer a post. Reactions are within -1..=1; from 0.6 on, positive
//! or negative, they cause comments and change leads. Readers compare claims with their experience, so honest
//! posts score higher. The judge is pure: it uses neither randomness nor a clock.

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

/// A post of the player with its context.
#[derive(Debug, Clone, Default)]
pub struct SubmittedPost<'a> {
    /// Its text.
    pub content: &'a str,
    /// Day it was made.
    pub day: u32,
    /// The post that it replies to.
    pub original: Option<OriginalPost<'a>>,
    /// Earlier posts of the player: day and text.
    pub earlier: Vec<(u32, &'a str)>,
}

/// A post that is replied to.
#[derive(Debug, Clone, Copy)]
pub struct OriginalPost<'a> {
    /// Its text.
    pub content: &'a str,
    /// Whether it is a complaint.
    pub negative: bool,
    /// Group of its author; `None` for the press.
    pub group: Option<Group>,
}

/// The reaction of a group, with reasons.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Judgement {
    /// The group.
    pub group: Group,
    /// Reaction, -1..=1 in hundredths.
    pub effect: f64,
    /// Terms of the reaction before the group's gain, in a fixed order without zeros.
    pub terms: Vec<ScoreTerm>,
    /// The reason given by a language model, if one judged.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub model_reason: Option<String>,
}

/// One term of a reaction.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ScoreTerm {
    /// Name.
    pub name: Cow<'static, str>,
    /// Signed size.
    pub value: f64,
    /// Topics, claims or events that caused it.
    pub because: Vec<String>,
}

impl Judgement {
    /// Returns the terms in descending order of size.
    pub fn terms_by_size(&self) -> Vec<&ScoreTerm> {
        let mut terms: Vec<&ScoreTerm> = self.terms.iter().collect();
        terms.sort_by(|one, other| other.value.abs().total_cmp(&one.value.abs()));
        terms
    }

    /// Replaces the reaction by a language model's score. The topics stay, because comments name them.
    pub fn with_model_score(self, score: &ModelScore) -> Judgement {
        let Judgement { group, mut terms, .. } = self;
        terms.retain(|term| term.name == "topics");
        Judgement { group, effect: score.score, terms, model_reason: Some(score.reason.clone()) }
    }

    /// Returns the three largest terms in one line, for instance `topics +0.40 (api, limits), specific
    /// +0.20`, or the reason given by a language model if one judged.
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

/// Group-independent data of a post.
struct Case<'a> {
    features: Features,
    /// Features of the post that is replied to.
    original: Option<(Features, OriginalPost<'a>)>,
    /// Earlier posts of the last four weeks.
    recent: Vec<Features>,
    /// Largest overlap with an earlier post.
    overlap: f64,
    circumstances: &'a JudgeContext,
    lexicon: &'a Lexicon,
}

/// Returns the reactions of these groups to a post.
pub fn judge_post(
    submission: &SubmittedPost<'_>,
    groups: impl IntoIterator<Item = Group>,
    circumstances: &JudgeContext,
    lexicon: &Lexicon,
) -> Vec<Judgement> {
    let since = |days: u32| {
        let within = move |day: u32| submission.day.saturating_sub(day) <= days;
        submission.earlier.iter().filter(move |(day, _)| within(*day))
    };
    let features = Features::from_post(submission.content, lexicon);
    let overlaps = since(lexicon.terms.repetition_days)
        .map(|(_, content)| pair_overlap(&features.text, &TokenizedText::new(content)));
    let case = Case {
        overlap: overlaps.fold(0.0, f64::max),
        recent: since(lexicon.terms.recipe_days)
            .map(|(_, text)| Features::from_post(text, lexicon))
            .collect(),
        original: submission
            .original
            .map(|original_post| (Features::from_post(original_post.content, lexicon), original_post)),
        features,
        circumstances,
        lexicon,
    };
    groups.into_iter().map(|group| score::judge_group(group, &case)).collect()
}
