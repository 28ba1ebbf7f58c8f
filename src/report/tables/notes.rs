//! `notes.csv`: a row for each saved version of the notes.

use super::column::{Column, columns};
use super::located_line::{LineRow, LocatedLine, with_location_columns};
use crate::measures::WordCounts;
use novamind_record::trajectory::Record;

pub(super) struct NotesVersion<'a> {
    version: usize,
    digest: &'a str,
    length: u64,
    text: Option<&'a str>,
    wording: Option<WordCounts>,
}

pub(super) fn columns<'a>() -> Vec<Column<LineRow<'a, NotesVersion<'a>>>> {
    with_location_columns(columns! { row: LineRow<'a, NotesVersion<'a>>;
        "version", "number", "number of the version, from 1" => row.row.version;
        "afterwards", "0 or 1", "1: after the end of the run" => row.located.is_after_end;
        "digest", "hash", "BLAKE3 hash of the text" => row.row.digest;
        "length", "bytes", "length of the text" => row.row.length;
        "words", "count", "words of the text; this and the following columns are empty if the line does not contain the text"
            => row.row.wording.map(|wording| wording.words);
        "planning_words", "count", "planning words of the text (as in runs.csv)"
            => row.row.wording.map(|wording| wording.planning);
        "if_words", "count", "occurrences of \"if\" in the text" => row.row.wording.map(|wording| wording.ifs);
        "text", "text", "the text; empty in format 1 and if the rules mask it" => row.row.text;
    })
}

pub(super) fn rows<'a>(lines: &'a [LocatedLine<'a>]) -> impl Iterator<Item = LineRow<'a, NotesVersion<'a>>> {
    let kept = lines.iter().filter_map(|placed| match &placed.line.record {
        Record::Memo(memo) => Some((placed, &memo.digest, memo.length, None)),
        Record::Note(note) => Some((placed, &note.digest, note.length, note.text.as_deref())),
        _ => None,
    });
    (1..).zip(kept).map(|(version, (placed, digest, length, text))| {
        let wording = text.map(WordCounts::from_text);
        LineRow { located: placed, row: NotesVersion { version, digest, length, text, wording } }
    })
}
