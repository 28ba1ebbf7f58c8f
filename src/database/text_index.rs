//! Indexes of packed days by text, for statements that look up many texts: SQLite does not index virtual tables.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::{Arc, Mutex};

/// Maximum total size in bytes of the indexes of a table that are built for one statement.
const MAX_INDEX_BYTES: usize = 256 << 20;
/// Number of lookups in the same days before an index is built. Building an index costs little more than two scans.
const LOOKUPS_BEFORE_INDEX: usize = 2;

/// The hash of a row's text and the position of the row: index of the day, and position within the day.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct TextRow {
    hash: u64,
    pub day: u32,
    pub place: u32,
}

impl TextRow {
    pub fn new(text: &str, day: usize, place: u64) -> TextRow {
        TextRow { hash: hash(text), day: day as u32, place: place as u32 }
    }
}

/// Rows of a range of days, grouped by the hash of their text. The rows of a group are in table order. Different texts
/// can have the same hash.
pub(super) struct TextIndex(Vec<TextRow>);

impl TextIndex {
    fn from_rows(mut rows: Vec<TextRow>) -> TextIndex {
        rows.sort_unstable();
        TextIndex(rows)
    }

    /// Returns the range of index rows that may have this text.
    pub fn row_range(&self, text: &str) -> Range<usize> {
        let wanted = hash(text);
        let first = self.0.partition_point(|row| row.hash < wanted);
        first..first + self.0[first..].partition_point(|row| row.hash == wanted)
    }

    pub fn row(&self, at: usize) -> TextRow {
        self.0[at]
    }
}

/// Computes the FNV-1a hash of a text. FNV-1a distributes short texts well, even texts that differ only in numbers.
fn hash(text: &str) -> u64 {
    text.bytes()
        .fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3))
}

/// The indexes of one table by range of days, built for the running statement.
#[derive(Default)]
pub(super) struct TextIndexes(Mutex<BTreeMap<(usize, usize), TextLookups>>);

#[derive(Default)]
struct TextLookups {
    count: usize,
    rows: usize,
    index: Option<Arc<TextIndex>>,
}

impl TextIndexes {
    /// Returns the index of a range of days with `rows` rows. Returns `None` for the first lookups, and if the index
    /// would need too much memory.
    pub fn get(
        &self,
        days: &Range<usize>,
        rows: u64,
        make: impl FnOnce() -> Vec<TextRow>,
    ) -> Option<Arc<TextIndex>> {
        let mut all = self.0.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        let held: usize = all.values().map(|text_lookups| text_lookups.rows).sum();
        let lookups = all.entry((days.start, days.end)).or_default();
        lookups.count += 1;
        let fits = (held as u64 + rows).saturating_mul(size_of::<TextRow>() as u64) <= MAX_INDEX_BYTES as u64;
        if lookups.index.is_none() && lookups.count > LOOKUPS_BEFORE_INDEX && fits {
            lookups.rows = rows as usize;
            lookups.index = Some(Arc::new(TextIndex::from_rows(make())));
        }
        lookups.index.clone()
    }

    /// Removes all indexes and lookup counts.
    pub fn clear(&self) {
        self.0.lock().unwrap_or_else(|poisoned| poisoned.into_inner()).clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_index_returns_rows_in_order() {
        let texts = [("b", 0, 1), ("a", 0, 0), ("b", 2, 0), ("a", 1, 7), ("c", 1, 8)];
        let index = TextIndex::from_rows(
            texts.iter().map(|(text, day, place)| TextRow::new(text, *day, *place)).collect(),
        );
        let found = |text: &str| -> Vec<(u32, u32)> {
            index.row_range(text).map(|at| index.row(at)).map(|row| (row.day, row.place)).collect()
        };
        assert_eq!((found("a"), found("b")), (vec![(0, 0), (1, 7)], vec![(0, 1), (2, 0)]));
        assert!(found("d").is_empty());
    }

    #[test]
    fn text_index_is_built_at_the_third_lookup_within_the_memory_limit() {
        let indexes = TextIndexes::default();
        let get = |days: Range<usize>, rows: u64| {
            indexes.get(&days, rows, || vec![TextRow::new("a", 0, 0)]).is_some()
        };
        assert_eq!([get(0..3, 1), get(0..3, 1), get(0..3, 1), get(0..4, 1)], [false, false, true, false]);
        (0..3).for_each(|_| assert!(!get(0..9, 1 << 40)));
        indexes.clear();
        assert!(!get(0..3, 1));
    }
}
