//! A memory of what was written lately, so that the feed does not repeat itself (chapter 30 §14).

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

/// The last texts without capitals, oldest first.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct Recent(VecDeque<String>);

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
        self.0.push_back(text.to_lowercase());
    }

    /// How much of a text was read lately: sentences, the beginning, or, far worse, all of it.
    fn staleness(&self, text: &str) -> usize {
        let text = text.to_lowercase();
        if self.0.iter().any(|other| *other == text) {
            return MOST_DRAFTS;
        }
        let known =
            sentences(&text).filter(|own| self.0.iter().any(|other| sentences(other).any(|it| it == *own)));
        let alike = self.0.iter().rev().take(OPENINGS).any(|other| opening(other) == opening(&text));
        2 * known.count() + usize::from(alike)
    }
}

/// The sentences of a text, without their marks.
fn sentences(text: &str) -> impl Iterator<Item = &str> {
    text.split(['.', '!', '?', ':']).map(str::trim).filter(|sentence| sentence.len() > 3)
}

/// The first three words.
fn opening(text: &str) -> Vec<&str> {
    text.split_whitespace().take(3).collect()
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
}
