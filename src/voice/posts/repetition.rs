//! A memory of recent posts that prevents repetition in the feed.

use std::collections::VecDeque;

use serde::{Deserialize, Serialize};

/// Number of consecutive posts in which no text should occur twice.
pub const REMEMBERED_POSTS: usize = 60;
/// Number of consecutive posts that should all start with different words.
const REMEMBERED_OPENINGS: usize = 15;
/// Number of drafts that are compared for each post.
const DRAFTS_PER_POST: usize = 24;
/// Maximum number of drafts that are generated to avoid a repeated text.
const MAX_DRAFTS: usize = 400;

/// Texts of recent posts, oldest first.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct RecentPosts(VecDeque<RecentText>);

/// A lowercase text that is split in advance, because it is compared with hundreds of drafts.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct RecentText {
    text: String,
    sentences: Vec<String>,
    opening: Vec<String>,
}

impl RecentText {
    fn new(text: &str) -> RecentText {
        let text = text.to_lowercase();
        let sentences = sentences(&text).map(str::to_owned).collect();
        let opening = opening(&text).map(str::to_owned).collect();
        RecentText { text, sentences, opening }
    }
}

impl RecentPosts {
    /// Picks the draft that repeats recent posts least, and remembers it. Repeats a text of the last 60 posts only if
    /// none of hundreds of drafts is new.
    pub fn pick_freshest(&mut self, mut draft: impl FnMut() -> String) -> String {
        let mut best: Option<(usize, String)> = None;
        for number in 0..MAX_DRAFTS {
            let text = draft();
            let staleness = self.repetition_score(&text);
            if best.as_ref().is_none_or(|(min, _)| staleness < *min) {
                best = Some((staleness, text));
            }
            let min = best.as_ref().map_or(usize::MAX, |(min, _)| *min);
            if min == 0 || (number + 1 >= DRAFTS_PER_POST && min < MAX_DRAFTS) {
                break;
            }
        }
        let (_, text) = best.unwrap_or_default();
        self.remember(&text);
        text
    }

    fn remember(&mut self, text: &str) {
        if self.0.len() == REMEMBERED_POSTS {
            self.0.pop_front();
        }
        self.0.push_back(RecentText::new(text));
    }

    /// Returns how much a text repeats recent posts. Counts equal sentences, an equal opening and, with the largest
    /// weight, an equal text.
    fn repetition_score(&self, text: &str) -> usize {
        let text = text.to_lowercase();
        if self.0.iter().any(|other| other.text == text) {
            return MAX_DRAFTS;
        }
        let is_repeated =
            |sentence: &&str| self.0.iter().any(|other| other.sentences.iter().any(|it| it == sentence));
        let known = sentences(&text).filter(is_repeated).count();
        let alike =
            self.0.iter().rev().take(REMEMBERED_OPENINGS).any(|other| opening(&text).eq(&other.opening));
        2 * known + usize::from(alike)
    }
}

/// Returns the sentences of a text without punctuation.
fn sentences(text: &str) -> impl Iterator<Item = &str> {
    text.split(['.', '!', '?', ':']).map(str::trim).filter(|sentence| sentence.len() > 3)
}

/// Returns the first three words of a text.
fn opening(text: &str) -> impl Iterator<Item = &str> {
    text.split_whitespace().take(3)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pick_freshest_takes_the_least_repeated_draft() {
        let mut recent = RecentPosts::default();
        let drafts = |texts: &'static [&'static str]| {
            let mut next = texts.iter().cycle();
            move || (*next.next().expect("a cycle")).to_owned()
        };
        let all: &[&str] = &["It is down. I wait.", "I wait. All day.", "Quite another thing."];
        assert_eq!(recent.pick_freshest(drafts(all)), all[0]);
        assert_eq!(recent.pick_freshest(drafts(all)), all[2]);
        assert_eq!(recent.pick_freshest(drafts(all)), all[1]);
        assert_eq!(recent.pick_freshest(drafts(&["Same."])), "Same.");
        assert_eq!(recent.pick_freshest(drafts(&["Same."])), "Same.", "the only draft is repeated");
    }

    #[test]
    fn texts_are_remembered_for_sixty_posts() {
        let mut recent = RecentPosts::default();
        recent.remember("The first of all.");
        for other in 1..REMEMBERED_POSTS {
            recent.remember(&format!("Number {other}."));
        }
        assert_eq!(recent.repetition_score("The first of all."), MAX_DRAFTS);
        recent.remember("One more.");
        assert_eq!(recent.repetition_score("The first of all."), 0);
    }
}
