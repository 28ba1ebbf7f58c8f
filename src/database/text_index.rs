//! Indexes of packed days by text, for statements that look up many texts: SQLite does not index virtual tables.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::{Arc, Mutex};

/// Maximum bytes of all indexes of a statement.
const MAX_INDEX_BYTES: usize = 256 << 20;
/// Number of lookups after which an index is built: an index costs little more than two scans.
const LOOKUPS_BEFORE_INDEX: usize = 2;

/// The position of a row: day in the store, place within the day.
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

/// Rows of a range of days, grouped by the hash of their text in table order. Different texts can have the same hash.
pub(super) struct TextIndex(Vec<TextRow>);

impl TextIndex {
    fn from_rows(mut rows: Vec<TextRow>) -> TextIndex {
        rows.sort_unstable();
        TextIndex(rows)
    }

    /// Returns the positions of the rows that may have a text.
    pub fn row_range(&self, text: &str) -> Range<usize> {
        let wanted = hash(text);
        let first = self.0.partition_point(|row| row.hash < wanted);
        first..first + self.0[first..].partition_point(|row| row.hash == wanted)
    }

    pub fn row(&self, at: usize) -> TextRow {
        self.0[at]
    }
}

/// FNV-1a, which suits short texts that differ in their numbers.
fn hash(text: &str) -> u64 {
    text.bytes()
        .fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3))
}

/// The indexes of the running statement for one table, by range of days.
#[derive(Default)]
pub(super) struct TextIndexes(Mutex<BTreeMap<(usize, usize), TextLookups>>);

#[derive(Default)]
struct TextLookups {
    count: usize,
    rows: usize,
    index: Option<Arc<TextIndex>>,
}

impl TextIndexes {
    /// Returns the index of a range of days with `rows` rows, or `None` for the first lookups and if it needs too much memory.
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

    /// Removes all indexes.
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
