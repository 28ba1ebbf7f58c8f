//! Hashes a large value on several threads.
//!
//! BLAKE3 is a tree over parts of its input, so each thread collects and hashes its own bytes while they are
//! in its cache. The result equals the hash of all bytes in sequence.

use std::ops::Range;

use blake3::hazmat::{ChainingValue, HasherExt, Mode, merge_subtrees_non_root, merge_subtrees_root};
use rayon::prelude::*;

use super::CanonicalHasher;

/// Bytes of one subtree of the hash: a power of two that fits into the cache of a core.
const SUBTREE: usize = 1 << 20;

/// Subtrees that one thread hashes in a row to reuse its buffer. Smaller inputs use fewer, so that a second
/// thread has work.
const SUBTREES_TOGETHER: usize = 4;

/// A sequence of canonical bytes with a known length.
pub struct Stretch<'a> {
    length: usize,
    feed: Box<dyn Fn(&mut CanonicalHasher) + Sync + 'a>,
}

impl<'a> Stretch<'a> {
    /// Creates a segment of `length` bytes that `feed` writes.
    pub fn new(length: usize, feed: impl Fn(&mut CanonicalHasher) + Sync + 'a) -> Stretch<'a> {
        Stretch { length, feed: Box::new(feed) }
    }
}

/// Returns the hash of the bytes of all `stretches` in order.
///
/// # Panics
/// If a segment feeds a different number of bytes than its length.
pub fn hash_of_stretches(stretches: &[Stretch<'_>]) -> blake3::Hash {
    let mut total = 0;
    let begins: Vec<usize> = stretches
        .iter()
        .map(|stretch| {
            total += stretch.length;
            total - stretch.length
        })
        .collect();
    let collect = |collector: &mut CanonicalHasher, from: usize, to: usize| -> Range<usize> {
        let first = begins.partition_point(|begin| *begin <= from).max(1) - 1;
        let last = begins.partition_point(|begin| *begin < to);
        collector.pending.clear();
        for (stretch, begin) in stretches[first..last].iter().zip(&begins[first..last]) {
            (stretch.feed)(collector);
            let until = begin + stretch.length - begins[first];
            assert_eq!(collector.pending.len(), until, "a segment has its declared length");
        }
        let skipped = from - begins.get(first).unwrap_or(&0);
        skipped..skipped + to - from
    };
    if total <= SUBTREE {
        let mut collector = CanonicalHasher::collector(total);
        collect(&mut collector, 0, total);
        return blake3::hash(&collector.pending);
    }
    let count = total.div_ceil(SUBTREE);
    let subtrees: Vec<ChainingValue> = (0..count)
        .into_par_iter()
        .with_min_len((count / 2).clamp(1, SUBTREES_TOGETHER))
        .map_init(
            || CanonicalHasher::collector(SUBTREE + SUBTREE / 2),
            |collector, number| {
                let (from, to) = (number * SUBTREE, ((number + 1) * SUBTREE).min(total));
                let own = collect(collector, from, to);
                let mut hasher = blake3::Hasher::new();
                hasher.set_input_offset(from as u64);
                hasher.update(&collector.pending[own]);
                hasher.finalize_non_root()
            },
        )
        .collect();
    let (left, right) = halves(&subtrees);
    merge_subtrees_root(&merged(left), &merged(right), Mode::Hash)
}

/// Returns the chaining value of a tree that is not the whole input.
fn merged(subtrees: &[ChainingValue]) -> ChainingValue {
    match subtrees {
        [single] => *single,
        several => {
            let (left, right) = halves(several);
            merge_subtrees_non_root(&merged(left), &merged(right), Mode::Hash)
        }
    }
}

/// Splits at the largest power of two that leaves at least one subtree on the right.
fn halves(subtrees: &[ChainingValue]) -> (&[ChainingValue], &[ChainingValue]) {
    subtrees.split_at(subtrees.len().next_power_of_two() / 2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stretches_are_hashed_like_their_bytes_in_a_row() {
        let lengths =
            [0, 5, SUBTREE / 3, 1, SUBTREE / 2 + 77, SUBTREE, 2 * SUBTREE + 1, 0, 300_000, 3 * SUBTREE];
        for count in 0..=lengths.len() {
            let texts: Vec<Vec<u8>> = lengths[..count]
                .iter()
                .zip(1..)
                .map(|(length, seed)| {
                    (0..*length as u32).map(|at| (at.wrapping_mul(seed) >> 7) as u8).collect()
                })
                .collect();
            let stretch = |text| Stretch::new(Vec::len(text), move |hasher| hasher.bytes(text));
            let stretches: Vec<Stretch<'_>> = texts.iter().map(stretch).collect();
            assert_eq!(hash_of_stretches(&stretches), blake3::hash(&texts.concat()), "{count} stretches");
        }
    }

    #[test]
    fn whole_subtrees_leave_nothing_over() {
        for subtrees in 1..=9 {
            let text = vec![7u8; subtrees * SUBTREE];
            let stretches = [Stretch::new(text.len(), |hasher| hasher.bytes(&text))];
            assert_eq!(hash_of_stretches(&stretches), blake3::hash(&text), "{subtrees} subtrees");
        }
    }
}
