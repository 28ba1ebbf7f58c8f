//! `notes.csv`: a row for each saved version of the notes.

use super::column::{Column, columns};
use super::place::{LineRow, Placed, with_place};
use crate::measures::Wording;
use novamind_record::trajectory::Record;

pub(super) struct KeptNotes<'a> {
    version: usize,
    digest: &'a str,
    length: u64,
    text: Option<&'a str>,
    wording: Option<Wording>,
}

pub(super) fn columns<'a>() -> Vec<Column<LineRow<'a, KeptNotes<'a>>>> {
    with_place(columns! { row: LineRow<'a, KeptNotes<'a>>;
        "version", "number", "number of the version, from 1" => row.own.version;
        "afterwards", "0 or 1", "1: after the end of the run" => row.placed.is_afterwards;
        "digest", "hash", "BLAKE3 hash of the text" => row.own.digest;
        "length", "bytes", "length of the text" => row.own.length;
        "words", "count", "words of the text; this and the following columns are empty if the line does not contain the text"
            => row.own.wording.map(|wording| wording.words);
        "planning_words", "count", "planning words among them (as in runs.csv)"
            => row.own.wording.map(|wording| wording.planning);
        "if_words", "count", "occurrences of \"if\"" => row.own.wording.map(|wording| wording.ifs);
        "text", "text", "the text; empty in format 1 and if the rules mask it" => row.own.text;
    })
}

pub(super) fn rows<'a>(lines: &'a [Placed<'a>]) -> impl Iterator<Item = LineRow<'a, KeptNotes<'a>>> {
    let kept = lines.iter().filter_map(|placed| match &placed.line.record {
        Record::Memo(memo) => Some((placed, &memo.digest, memo.length, None)),
        Record::Note(note) => Some((placed, &note.digest, note.length, note.text.as_deref())),
        _ => None,
    });
    (1..).zip(kept).map(|(version, (placed, digest, length, text))| {
        let wording = text.map(Wording::of);
        LineRow { placed, own: KeptNotes { version, digest, length, text, wording } }
    })
}
