//! The judge of the company's posts: text in, one reaction per group out, with reasons
//! (docs/mechanics/market/social/judge.md).
//!
//! It stands in for readers who scroll past or stop. Reactions lie within -1..=1; from 0.6 on, either way, people
//! answer and leads follow. Unlike the readers of a real network these compare what a post claims with what they
//! have lived through, so honesty pays. Pure: no chance, no clock; equal input gives equal output everywhere.

pub mod circumstances;
mod claims;
mod features;
pub mod lexicon;
mod score;
pub mod text;

#[cfg(test)]
mod tests;

use std::fmt::Write;

use serde::{Deserialize, Serialize};

pub use circumstances::Circumstances;
pub use lexicon::Lexicon;

use crate::model::scoring::ModelScore;
use features::Features;
use novamind_world::identifiers::Group;
use std::borrow::Cow;
use text::{Reading, pair_overlap};

/// A post of the company and what came before it.
#[derive(Debug, Clone, Default)]
pub struct Submission<'a> {
    /// Its text.
    pub content: &'a str,
    /// Day it was made.
    pub day: u32,
    /// The post it answers.
    pub original: Option<Original<'a>>,
    /// Earlier posts of the company: day and text.
    pub earlier: Vec<(u32, &'a str)>,
}

/// A post that is answered.
#[derive(Debug, Clone, Copy)]
pub struct Original<'a> {
    /// Its text.
    pub content: &'a str,
    /// Whether it complains.
    pub negative: bool,
    /// Group of its author; none for the press.
    pub group: Option<Group>,
}

/// How a group takes a post, and why.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Judgement {
    /// The group.
    pub group: Group,
    /// Reaction, -1..=1 in hundredths.
    pub effect: f64,
    /// What it is made of, before the group's gain, in a fixed order; zeros are left out.
    pub terms: Vec<Term>,
    /// Why, in the words of a language model, where that judged.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub said: Option<String>,
}

/// One part of a reaction.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Term {
    /// Name.
    pub name: Cow<'static, str>,
    /// Size with its sign.
    pub value: f64,
    /// Topics, claims or events behind it.
    pub because: Vec<String>,
}

impl Judgement {
    /// The terms by their size, the largest first.
    pub fn leading(&self) -> Vec<&Term> {
        let mut terms: Vec<&Term> = self.terms.iter().collect();
        terms.sort_by(|one, other| other.value.abs().total_cmp(&one.value.abs()));
        terms
    }

    /// The same readers as a language model scored them. What the post is about stays known, for comments name it.
    pub fn scored_by_model(self, score: &ModelScore) -> Judgement {
        let Judgement { group, mut terms, .. } = self;
        terms.retain(|term| term.name == "topics");
        Judgement { group, effect: score.score, terms, said: Some(score.reason.clone()) }
    }

    /// The three largest terms in one line, for instance `topics +0.40 (api, limits), specific +0.20`; what a language model
    /// gave as its reason, where that judged.
    pub fn reason(&self) -> String {
        if let Some(said) = &self.said {
            return said.clone();
        }
        let mut text = String::new();
        for term in self.leading().into_iter().take(3) {
            let comma = if text.is_empty() { "" } else { ", " };
            let _ = write!(text, "{comma}{} {:+.2}", term.name, term.value);
            if !term.because.is_empty() {
                let _ = write!(text, " ({})", term.because.join(", "));
            }
        }
        text
    }
}

/// What a post is like for everybody, read once for all groups.
struct Case<'a> {
    features: Features,
    /// Topics of the post that is answered.
    original: Option<(Features, Original<'a>)>,
    /// Earlier posts of the last four weeks.
    recent: Vec<Features>,
    /// Largest overlap with an earlier post.
    overlap: f64,
    circumstances: &'a Circumstances,
    lexicon: &'a Lexicon,
}

/// Judges a post in the eyes of these groups.
pub fn judge(
    submission: &Submission<'_>,
    groups: impl IntoIterator<Item = Group>,
    circumstances: &Circumstances,
    lexicon: &Lexicon,
) -> Vec<Judgement> {
    let since = |days: u32| {
        let within = move |day: u32| submission.day.saturating_sub(day) <= days;
        submission.earlier.iter().filter(move |(day, _)| within(*day))
    };
    let features = Features::of(submission.content, lexicon);
    let overlaps = since(lexicon.terms.repetition_days)
        .map(|(_, content)| pair_overlap(&features.reading, &Reading::of(content)));
    let case = Case {
        overlap: overlaps.fold(0.0, f64::max),
        recent: since(lexicon.terms.recipe_days).map(|(_, text)| Features::of(text, lexicon)).collect(),
        original: submission.original.map(|own| (Features::of(own.content, lexicon), own)),
        features,
        circumstances,
        lexicon,
    };
    groups.into_iter().map(|group| score::judge_group(group, &case)).collect()
}
