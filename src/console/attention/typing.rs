//! Typing statistics: characters typed, deleted and pasted, and pauses.

use std::collections::BTreeMap;
use std::time::Duration;

use super::stopwatch::millis;
use novamind_record::trajectory::record::{TextEdit, TextEditOutcome};

/// Separator between the cells of a form in a combined text. The separator is not counted as a character.
pub const CELL_SEPARATOR: &str = "\u{1f}";

/// Minimum time between two key presses that counts as a pause.
const MIN_PAUSE: Duration = Duration::from_secs(2);

/// Source of a change in a text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EditSource {
    /// A key press.
    Typed,
    /// Pasted text.
    Pasted,
    /// Text that the program filled in.
    Filled,
}

/// Typing statistics of the texts that are being edited, by recorded name.
#[derive(Debug, Default)]
pub struct TypingLog {
    texts: BTreeMap<String, EditEpisode>,
}

/// Typing statistics of one text, from its first change until it is sent or abandoned.
#[derive(Debug)]
struct EditEpisode {
    text: String,
    typed: u64,
    deleted: u64,
    pasted: u64,
    pauses: u32,
    first: Duration,
    last: Duration,
}

impl TypingLog {
    /// Records a change in a text.
    pub fn record_change(
        &mut self,
        place: &str,
        before: &str,
        after: String,
        edit: EditSource,
        now: Duration,
    ) {
        if edit == EditSource::Filled && !self.texts.contains_key(place) {
            // A text that only the program filled in is not a draft of the user.
            return;
        }
        let (added, removed) = count_added_and_removed(before, &after);
        let fresh = || EditEpisode {
            text: String::new(),
            typed: 0,
            deleted: 0,
            pasted: 0,
            pauses: 0,
            first: now,
            last: now,
        };
        let edit_episode = self.texts.entry(place.to_owned()).or_insert_with(fresh);
        edit_episode.pauses += u32::from(now.saturating_sub(edit_episode.last) > MIN_PAUSE);
        edit_episode.last = now;
        edit_episode.text = after;
        match edit {
            EditSource::Typed => {
                (edit_episode.typed, edit_episode.deleted) =
                    (edit_episode.typed + added, edit_episode.deleted + removed)
            }
            EditSource::Pasted => {
                (edit_episode.pasted, edit_episode.deleted) =
                    (edit_episode.pasted + added, edit_episode.deleted + removed)
            }
            EditSource::Filled => {}
        }
    }

    /// Ends a draft and returns its statistics, or `None` if the draft was not edited. If `keep` is true, the
    /// statistics include the text of an abandoned draft.
    pub fn finish(&mut self, place: &str, outcome: TextEditOutcome, keep: bool) -> Option<TextEdit> {
        self.texts.remove(place).map(|episode| episode.into_draft(place, outcome, keep))
    }

    /// Returns the recorded names of the texts that are being edited.
    pub fn places(&self) -> Vec<String> {
        self.texts.keys().cloned().collect()
    }
}

impl EditEpisode {
    fn into_draft(self, place: &str, outcome: TextEditOutcome, keep: bool) -> TextEdit {
        TextEdit {
            place: place.to_owned(),
            outcome,
            length: chars_without_separators(&self.text).len() as u64,
            typed: self.typed,
            deleted: self.deleted,
            pasted: self.pasted,
            pauses: self.pauses,
            for_ms: millis(self.last.saturating_sub(self.first)),
            text: (keep && outcome == TextEditOutcome::Left).then(|| self.text.replace(CELL_SEPARATOR, " ")),
        }
    }
}

fn chars_without_separators(text: &str) -> Vec<char> {
    text.chars().filter(|letter| !CELL_SEPARATOR.contains(*letter)).collect()
}

/// Counts the characters added and removed between two texts that differ in one place.
fn count_added_and_removed(before: &str, after: &str) -> (u64, u64) {
    let (old, new) = (chars_without_separators(before), chars_without_separators(after));
    let same = old.iter().zip(&new).take_while(|(character, other)| character == other).count();
    let (old, new) = (&old[same..], &new[same..]);
    let tail =
        old.iter().rev().zip(new.iter().rev()).take_while(|(old_char, other)| old_char == other).count();
    ((new.len() - tail) as u64, (old.len() - tail) as u64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn typing_log_counts_characters_by_edit_source() {
        assert_eq!(count_added_and_removed("abc", "abXc"), (1, 0));
        assert_eq!(count_added_and_removed("aa", "aaa"), (1, 0));
        assert_eq!(count_added_and_removed("añ日", "a日"), (0, 1));
        assert_eq!(count_added_and_removed("one two", "one four"), (4, 3));
        let at = Duration::from_secs;
        let mut typing = TypingLog::default();
        for (before, after, edit, now) in [
            ("", "p", EditSource::Typed, 10),
            ("p", "pr", EditSource::Typed, 11),
            ("pr", "p", EditSource::Typed, 14),
            ("p", "pasted", EditSource::Pasted, 15),
            ("pasted", "pasted, filled", EditSource::Filled, 16),
        ] {
            typing.record_change("sql", before, after.to_owned(), edit, at(now));
        }
        let draft = typing.finish("sql", TextEditOutcome::Left, true).expect("an edited text");
        assert_eq!((draft.length, draft.typed, draft.deleted, draft.pasted), (14, 2, 1, 5));
        assert_eq!((draft.pauses, draft.for_ms, draft.text.as_deref()), (1, 6000, Some("pasted, filled")));
        assert_eq!(typing.finish("sql", TextEditOutcome::Sent, true), None);
    }
}
