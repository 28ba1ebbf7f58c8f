//! Hashes a large value on several threads.
//!
//! BLAKE3 hashes a tree of input chunks. Each thread therefore collects and hashes a separate part of the bytes while
//! the part is in its cache. The result equals the hash of all bytes in sequence.

use std::ops::Range;

use blake3::hazmat::{ChainingValue, HasherExt, Mode, merge_subtrees_non_root, merge_subtrees_root};
use rayon::prelude::*;

use super::CanonicalHasher;

/// Size of one subtree of the hash, in input bytes. The size is a power of two, and a subtree fits into the cache of a
/// processor core.
const SUBTREE_BYTES: usize = 1 << 20;

/// Number of subtrees that one thread hashes in sequence to reuse its buffer. The number is lower for small inputs, so
/// that two threads can share the work.
const SUBTREES_PER_TASK: usize = 4;

/// A sequence of canonical bytes with a known length.
pub struct HashSegment<'a> {
    length: usize,
    feed: Box<dyn Fn(&mut CanonicalHasher) + Sync + 'a>,
}

impl<'a> HashSegment<'a> {
    /// Creates a segment whose `length` bytes are written by `feed`.
    pub fn new(length: usize, feed: impl Fn(&mut CanonicalHasher) + Sync + 'a) -> HashSegment<'a> {
        HashSegment { length, feed: Box::new(feed) }
    }
}

/// Returns the hash of the concatenated bytes of `segments`.
///
/// # Panics
/// Panics if a segment feeds more or fewer bytes than its declared length.
pub fn hash_segments(segments: &[HashSegment<'_>]) -> blake3::Hash {
    let mut total = 0;
    let begins: Vec<usize> = segments
        .iter()
        .map(|hash_segment| {
            total += hash_segment.length;
            total - hash_segment.length
        })
        .collect();
    let collect = |collector: &mut CanonicalHasher, from: usize, to: usize| -> Range<usize> {
        let first = begins.partition_point(|begin| *begin <= from).max(1) - 1;
        let last = begins.partition_point(|begin| *begin < to);
        collector.pending.clear();
        for (hash_segment, begin) in segments[first..last].iter().zip(&begins[first..last]) {
            (hash_segment.feed)(collector);
            let until = begin + hash_segment.length - begins[first];
            assert_eq!(collector.pending.len(), until, "a segment has its declared length");
        }
        let skipped = from - begins.get(first).unwrap_or(&0);
        skipped..skipped + to - from
    };
    if total <= SUBTREE_BYTES {
        let mut collector = CanonicalHasher::collector(total);
        collect(&mut collector, 0, total);
        return blake3::hash(&collector.pending);
    }
    let count = total.div_ceil(SUBTREE_BYTES);
    let subtrees: Vec<ChainingValue> = (0..count)
        .into_par_iter()
        .with_min_len((count / 2).clamp(1, SUBTREES_PER_TASK))
        .map_init(
            || CanonicalHasher::collector(SUBTREE_BYTES + SUBTREE_BYTES / 2),
            |collector, number| {
                let (from, to) = (number * SUBTREE_BYTES, ((number + 1) * SUBTREE_BYTES).min(total));
                let range = collect(collector, from, to);
                let mut hasher = blake3::Hasher::new();
                hasher.set_input_offset(from as u64);
                hasher.update(&collector.pending[range]);
                hasher.finalize_non_root()
            },
        )
        .collect();
    let (left, right) = split_tree(&subtrees);
    merge_subtrees_root(&merge_subtrees(left), &merge_subtrees(right), Mode::Hash)
}

/// Returns the chaining value of a tree that covers only a part of the input.
fn merge_subtrees(subtrees: &[ChainingValue]) -> ChainingValue {
    match subtrees {
        [single] => *single,
        several => {
            let (left, right) = split_tree(several);
            merge_subtrees_non_root(&merge_subtrees(left), &merge_subtrees(right), Mode::Hash)
        }
    }
}

/// Splits the subtrees at the largest power of two that leaves at least one subtree on the right.
fn split_tree(subtrees: &[ChainingValue]) -> (&[ChainingValue], &[ChainingValue]) {
    subtrees.split_at(subtrees.len().next_power_of_two() / 2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hash_segments_matches_hash_of_all_bytes() {
        let lengths = [
            0,
            5,
            SUBTREE_BYTES / 3,
            1,
            SUBTREE_BYTES / 2 + 77,
            SUBTREE_BYTES,
            2 * SUBTREE_BYTES + 1,
            0,
            300_000,
            3 * SUBTREE_BYTES,
        ];
        for count in 0..=lengths.len() {
            let texts: Vec<Vec<u8>> = lengths[..count]
                .iter()
                .zip(1..)
                .map(|(length, seed)| {
                    (0..*length as u32).map(|at| (at.wrapping_mul(seed) >> 7) as u8).collect()
                })
                .collect();
            let hash_segment =
                |text| HashSegment::new(Vec::len(text), move |hasher| hasher.append_bytes(text));
            let segments: Vec<HashSegment<'_>> = texts.iter().map(hash_segment).collect();
            assert_eq!(hash_segments(&segments), blake3::hash(&texts.concat()), "{count} segments");
        }
    }

    #[test]
    fn hash_segments_handles_complete_subtrees() {
        for subtrees in 1..=9 {
            let text = vec![7u8; subtrees * SUBTREE_BYTES];
            let segments = [HashSegment::new(text.len(), |hasher| hasher.append_bytes(&text))];
            assert_eq!(hash_segments(&segments), blake3::hash(&text), "{subtrees} subtrees");
        }
    }
}
