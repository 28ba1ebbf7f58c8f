//! Typing statistics: characters typed, deleted and pasted, and pauses.

use std::collections::BTreeMap;
use std::time::Duration;

use super::stopwatch::ms;
use novamind_record::trajectory::record::{Draft, DraftOutcome};

/// Separates the cells of a form in a combined text; not counted as a character.
pub const BETWEEN_CELLS: &str = "\u{1f}";

/// Minimum gap between two keys that counts as a pause.
const PAUSE: Duration = Duration::from_secs(2);

/// Source of a change of a text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Edit {
    /// A key.
    Typed,
    /// The clipboard.
    Pasted,
    /// The program.
    Filled,
}

/// Statistics of the texts that are being edited, by place.
#[derive(Debug, Default)]
pub struct Typing {
    texts: BTreeMap<String, Episode>,
}

/// Statistics of one text, from its first change until it is sent or left.
#[derive(Debug)]
struct Episode {
    text: String,
    typed: u64,
    deleted: u64,
    pasted: u64,
    pauses: u32,
    first: Duration,
    last: Duration,
}

impl Typing {
    /// Records a change of a text.
    pub fn change(&mut self, place: &str, before: &str, after: String, edit: Edit, now: Duration) {
        if edit == Edit::Filled && !self.texts.contains_key(place) {
            // A text that only the program filled in is not a draft of the user.
            return;
        }
        let (added, removed) = difference(before, &after);
        let fresh = || Episode {
            text: String::new(),
            typed: 0,
            deleted: 0,
            pasted: 0,
            pauses: 0,
            first: now,
            last: now,
        };
        let own = self.texts.entry(place.to_owned()).or_insert_with(fresh);
        own.pauses += u32::from(now.saturating_sub(own.last) > PAUSE);
        own.last = now;
        own.text = after;
        match edit {
            Edit::Typed => (own.typed, own.deleted) = (own.typed + added, own.deleted + removed),
            Edit::Pasted => (own.pasted, own.deleted) = (own.pasted + added, own.deleted + removed),
            Edit::Filled => {}
        }
    }

    /// Ends a draft and returns its statistics, or `None` if it was not edited. With `keep`, the text of a draft that
    /// was left is included.
    pub fn end(&mut self, place: &str, outcome: DraftOutcome, keep: bool) -> Option<Draft> {
        self.texts.remove(place).map(|episode| episode.told(place, outcome, keep))
    }

    /// Returns the places of the texts that are being edited.
    pub fn places(&self) -> Vec<String> {
        self.texts.keys().cloned().collect()
    }
}

impl Episode {
    fn told(self, place: &str, outcome: DraftOutcome, keep: bool) -> Draft {
        Draft {
            place: place.to_owned(),
            outcome,
            length: letters(&self.text).len() as u64,
            typed: self.typed,
            deleted: self.deleted,
            pasted: self.pasted,
            pauses: self.pauses,
            for_ms: ms(self.last.saturating_sub(self.first)),
            text: (keep && outcome == DraftOutcome::Left).then(|| self.text.replace(BETWEEN_CELLS, " ")),
        }
    }
}

fn letters(text: &str) -> Vec<char> {
    text.chars().filter(|letter| !BETWEEN_CELLS.contains(*letter)).collect()
}

/// Counts the characters added and removed between two texts that differ in one place.
fn difference(before: &str, after: &str) -> (u64, u64) {
    let (old, new) = (letters(before), letters(after));
    let same = old.iter().zip(&new).take_while(|(own, other)| own == other).count();
    let (old, new) = (&old[same..], &new[same..]);
    let tail = old.iter().rev().zip(new.iter().rev()).take_while(|(own, other)| own == other).count();
    ((new.len() - tail) as u64, (old.len() - tail) as u64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_are_counted_by_where_they_came_from() {
        assert_eq!(difference("abc", "abXc"), (1, 0));
        assert_eq!(difference("aa", "aaa"), (1, 0));
        assert_eq!(difference("añ日", "a日"), (0, 1));
        assert_eq!(difference("one two", "one four"), (4, 3));
        let at = Duration::from_secs;
        let mut typing = Typing::default();
        for (before, after, edit, now) in [
            ("", "p", Edit::Typed, 10),
            ("p", "pr", Edit::Typed, 11),
            ("pr", "p", Edit::Typed, 14),
            ("p", "pasted", Edit::Pasted, 15),
            ("pasted", "pasted, filled", Edit::Filled, 16),
        ] {
            typing.change("sql", before, after.to_owned(), edit, at(now));
        }
        let draft = typing.end("sql", DraftOutcome::Left, true).expect("it was edited");
        assert_eq!((draft.length, draft.typed, draft.deleted, draft.pasted), (14, 2, 1, 5));
        assert_eq!((draft.pauses, draft.for_ms, draft.text.as_deref()), (1, 6000, Some("pasted, filled")));
        assert_eq!(typing.end("sql", DraftOutcome::Sent, true), None);
    }
}
