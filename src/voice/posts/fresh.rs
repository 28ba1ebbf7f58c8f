//! A memory of what was written lately, so that the feed does not repeat itself.

use std::collections::VecDeque;

use serde::{Deserialize, Serialize};

/// Posts within which no text comes twice.
pub const MEMORY: usize = 60;
/// Posts within which two should not begin alike.
const OPENINGS: usize = 15;
/// Drafts that are compared before the freshest is taken.
const DRAFTS: usize = 24;
/// Drafts that are tried at most to find one that is new as a whole.
const MOST_DRAFTS: usize = 400;

/// The last texts, oldest first.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct Recent(VecDeque<Remembered>);

/// A text without capitals, taken apart once: it is compared with hundreds of drafts.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Remembered {
    text: String,
    sentences: Vec<String>,
    opening: Vec<String>,
}

impl Remembered {
    fn of(text: &str) -> Remembered {
        let text = text.to_lowercase();
        let sentences = sentences(&text).map(str::to_owned).collect();
        let opening = opening(&text).map(str::to_owned).collect();
        Remembered { text, sentences, opening }
    }
}

impl Recent {
    /// Takes the freshest of some drafts, and remembers it. A text that was written within the last 60 is taken
    /// only when hundreds of drafts bring nothing else.
    pub fn freshest(&mut self, mut draft: impl FnMut() -> String) -> String {
        let mut best: Option<(usize, String)> = None;
        for number in 0..MOST_DRAFTS {
            let text = draft();
            let staleness = self.staleness(&text);
            if best.as_ref().is_none_or(|(least, _)| staleness < *least) {
                best = Some((staleness, text));
            }
            let least = best.as_ref().map_or(usize::MAX, |(least, _)| *least);
            if least == 0 || (number + 1 >= DRAFTS && least < MOST_DRAFTS) {
                break;
            }
        }
        let (_, text) = best.unwrap_or_default();
        self.remember(&text);
        text
    }

    fn remember(&mut self, text: &str) {
        if self.0.len() == MEMORY {
            self.0.pop_front();
        }
        self.0.push_back(Remembered::of(text));
    }

    /// How much of a text was read lately: sentences, the beginning, or, far worse, all of it.
    fn staleness(&self, text: &str) -> usize {
        let text = text.to_lowercase();
        if self.0.iter().any(|other| other.text == text) {
            return MOST_DRAFTS;
        }
        let was_read = |own: &&str| self.0.iter().any(|other| other.sentences.iter().any(|it| it == own));
        let known = sentences(&text).filter(was_read).count();
        let alike = self.0.iter().rev().take(OPENINGS).any(|other| opening(&text).eq(&other.opening));
        2 * known + usize::from(alike)
    }
}

/// The sentences of a text, without their marks.
fn sentences(text: &str) -> impl Iterator<Item = &str> {
    text.split(['.', '!', '?', ':']).map(str::trim).filter(|sentence| sentence.len() > 3)
}

/// The first three words.
fn opening(text: &str) -> impl Iterator<Item = &str> {
    text.split_whitespace().take(3)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_freshest_draft_is_taken() {
        let mut recent = Recent::default();
        let drafts = |texts: &'static [&'static str]| {
            let mut next = texts.iter().cycle();
            move || (*next.next().expect("a cycle")).to_owned()
        };
        let all: &[&str] = &["It is down. I wait.", "I wait. All day.", "Quite another thing."];
        assert_eq!(recent.freshest(drafts(all)), all[0]);
        assert_eq!(recent.freshest(drafts(all)), all[2]);
        assert_eq!(recent.freshest(drafts(all)), all[1]);
        assert_eq!(recent.freshest(drafts(&["Same."])), "Same.");
        assert_eq!(recent.freshest(drafts(&["Same."])), "Same.", "there is nothing else to say");
    }

    #[test]
    fn a_text_is_remembered_for_as_many_posts_as_the_memory_has() {
        let mut recent = Recent::default();
        recent.remember("The first of all.");
        for other in 1..MEMORY {
            recent.remember(&format!("Number {other}."));
        }
        assert_eq!(recent.staleness("The first of all."), MOST_DRAFTS);
        recent.remember("One more.");
        assert_eq!(recent.staleness("The first of all."), 0);
    }
}
