//! `notes.csv`: a row for each time the notes were kept.

use super::place::{PLACE, Placed, with_place};
use super::{Heading, flag, heading};
use crate::measures::Wording;
use novamind_session::Record;

const OWN: [Heading; 8] = [
    heading("version", "number", "how often they had been kept with this time, from 1"),
    heading("afterwards", "0 or 1", "1: after the end of the run"),
    heading("digest", "hash", "BLAKE3 hash of the text"),
    heading("length", "bytes", "length of the text"),
    heading(
        "words",
        "count",
        "words of the text; this and what follows is empty where the line does not hold the text",
    ),
    heading("planning_words", "count", "words of planning among them (as in runs.csv)"),
    heading("if_words", "count", "how often it says \"if\""),
    heading("text", "text", "the text; empty in format 1 and where the rules mask it"),
];

/// The columns.
pub(super) const HEADINGS: [Heading; PLACE.len() + OWN.len()] = with_place(&OWN);

/// The rows of a run.
pub(super) fn rows(lines: &[Placed<'_>]) -> Vec<Vec<String>> {
    let kept = lines.iter().filter_map(|placed| {
        let (digest, length, text) = match &placed.line.record {
            Record::Memo(memo) => (&memo.digest, memo.length, None),
            Record::Note(note) => (&note.digest, note.length, note.text.as_deref()),
            _ => return None,
        };
        Some((placed, digest, length, text))
    });
    let row =
        |(version, (placed, digest, length, text)): (usize, (&Placed<'_>, &String, u64, Option<&str>))| {
            let wording = text.map(Wording::of);
            let count = |of: fn(&Wording) -> usize| {
                wording.as_ref().map(|own| of(own).to_string()).unwrap_or_default()
            };
            let cells: [String; OWN.len()] = [
                (version + 1).to_string(),
                flag(placed.is_afterwards),
                digest.clone(),
                length.to_string(),
                count(|own| own.words),
                count(|own| own.planning),
                count(|own| own.ifs),
                text.unwrap_or_default().to_owned(),
            ];
            placed.row(cells)
        };
    kept.enumerate().map(row).collect()
}
