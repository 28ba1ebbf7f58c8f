//! The canonical byte representation of the simulator state, which state hashes and snapshots use.
//!
//! Integers are little-endian, floats are stored as their bits, fields are in declaration order, and lists start with
//! their length (`docs/formats/snapshot.md`). Two worlds with equal bytes evolve identically, and
//! a world can be restored from its bytes ([`Restore`]).

mod restore;
mod segments;

use indexmap::IndexMap;

#[cfg(test)]
pub use restore::restore_all;
pub use restore::{CanonicalReader, Restore};
pub use segments::{HashSegment, hash_segments};

use super::identifiers::{ByChannel, ByGroup, ByPlan, Channel, Group, Plan};

/// A hasher that collects canonical bytes and hashes them in large chunks.
pub struct CanonicalHasher {
    hasher: blake3::Hasher,
    pending: Vec<u8>,
    /// Number of pending bytes at which complete chunks are hashed; `usize::MAX` for a collector.
    chunk_bytes: usize,
}

/// Number of bytes that are hashed at once. The number is a power of two, so that each chunk is a complete subtree of
/// the hash.
const CHUNK_BYTES: usize = 1 << 16;
/// Number of column values that are converted before their bytes are appended.
const VALUES_PER_BATCH: usize = 128;

impl Default for CanonicalHasher {
    fn default() -> Self {
        CanonicalHasher {
            hasher: blake3::Hasher::new(),
            pending: Vec::with_capacity(2 * CHUNK_BYTES),
            chunk_bytes: CHUNK_BYTES,
        }
    }
}

impl CanonicalHasher {
    /// Appends bytes to the hashed sequence.
    #[inline]
    pub fn append_bytes(&mut self, bytes: &[u8]) {
        self.pending.extend_from_slice(bytes);
        if self.pending.len() >= self.chunk_bytes {
            self.hash_complete_chunks();
        }
    }

    /// Creates a hasher that only collects bytes. `capacity` is the expected number of bytes.
    pub fn collector(capacity: usize) -> CanonicalHasher {
        let hasher = blake3::Hasher::new();
        CanonicalHasher { hasher, pending: Vec::with_capacity(capacity), chunk_bytes: usize::MAX }
    }

    /// Returns the bytes that a collector has collected.
    pub fn into_bytes(self) -> Vec<u8> {
        self.pending
    }

    /// Appends the bytes of a column in batches, which is faster than one value at a time. Columns make up most of the
    /// state.
    fn update_column<T: Copy, const WIDTH: usize>(
        &mut self,
        values: &[T],
        bytes_of: impl Fn(T) -> [u8; WIDTH],
    ) {
        let mut together = [[0; WIDTH]; VALUES_PER_BATCH];
        for values in values.chunks(VALUES_PER_BATCH) {
            let places = &mut together[..values.len()];
            places.iter_mut().zip(values).for_each(|(place, value)| *place = bytes_of(*value));
            self.append_bytes(places.as_flattened());
        }
    }

    /// Hashes complete chunks and keeps the remaining bytes, because BLAKE3 is several times faster on aligned input.
    #[cold]
    fn hash_complete_chunks(&mut self) {
        let whole = self.pending.len() / self.chunk_bytes * self.chunk_bytes;
        self.hasher.update(&self.pending[..whole]);
        self.pending.drain(..whole);
    }

    /// Returns the hash of all appended bytes.
    pub fn finish(mut self) -> blake3::Hash {
        self.hasher.update(&self.pending);
        self.hasher.finalize()
    }
}

/// A value that has a canonical byte representation.
pub trait Canonical {
    /// Feeds the bytes of this value to `hasher`.
    fn feed(&self, hasher: &mut CanonicalHasher);

    /// Feeds the bytes of all `values` in order to `hasher`.
    fn feed_all(values: &[Self], hasher: &mut CanonicalHasher)
    where
        Self: Sized,
    {
        values.iter().for_each(|value| value.feed(hasher));
    }
}

/// Returns the hash of a value's canonical bytes.
pub fn canonical_hash(value: &impl Canonical) -> blake3::Hash {
    let mut hasher = CanonicalHasher::default();
    value.feed(&mut hasher);
    hasher.finish()
}

/// Returns the canonical bytes of a value.
pub fn canonical_bytes(value: &impl Canonical) -> Vec<u8> {
    let mut collector = CanonicalHasher::collector(0);
    value.feed(&mut collector);
    collector.into_bytes()
}

macro_rules! canonical_numbers {
    ($($number:ty),*) => {$(
        impl Canonical for $number {
            #[inline]
            fn feed(&self, hasher: &mut CanonicalHasher) {
                hasher.append_bytes(&self.to_le_bytes());
            }

            fn feed_all(values: &[Self], hasher: &mut CanonicalHasher) {
                hasher.update_column(values, <$number>::to_le_bytes);
            }
        }
    )*};
}
canonical_numbers!(u8, u16, u32, u64, i64);

impl Canonical for f64 {
    #[inline]
    fn feed(&self, hasher: &mut CanonicalHasher) {
        hasher.append_bytes(&self.to_bits().to_le_bytes());
    }

    fn feed_all(values: &[Self], hasher: &mut CanonicalHasher) {
        hasher.update_column(values, |value| value.to_bits().to_le_bytes());
    }
}

impl Canonical for bool {
    #[inline]
    fn feed(&self, hasher: &mut CanonicalHasher) {
        hasher.append_bytes(&[u8::from(*self)]);
    }

    fn feed_all(values: &[Self], hasher: &mut CanonicalHasher) {
        hasher.update_column(values, |value| [u8::from(value)]);
    }
}

impl Canonical for str {
    fn feed(&self, hasher: &mut CanonicalHasher) {
        (self.len() as u64).feed(hasher);
        hasher.append_bytes(self.as_bytes());
    }
}

impl Canonical for String {
    fn feed(&self, hasher: &mut CanonicalHasher) {
        self.as_str().feed(hasher);
    }
}

impl<T: Canonical> Canonical for [T] {
    fn feed(&self, hasher: &mut CanonicalHasher) {
        (self.len() as u64).feed(hasher);
        T::feed_all(self, hasher);
    }
}

impl<T: Canonical> Canonical for Vec<T> {
    fn feed(&self, hasher: &mut CanonicalHasher) {
        self.as_slice().feed(hasher);
    }
}

impl<T: Canonical, const LENGTH: usize> Canonical for [T; LENGTH] {
    fn feed(&self, hasher: &mut CanonicalHasher) {
        T::feed_all(self, hasher);
    }
}

impl<T: Canonical> Canonical for Option<T> {
    fn feed(&self, hasher: &mut CanonicalHasher) {
        self.is_some().feed(hasher);
        self.iter().for_each(|value| value.feed(hasher));
    }
}

impl<A: Canonical, B: Canonical> Canonical for (A, B) {
    fn feed(&self, hasher: &mut CanonicalHasher) {
        self.0.feed(hasher);
        self.1.feed(hasher);
    }
}

impl<K: Canonical, V: Canonical> Canonical for IndexMap<K, V> {
    fn feed(&self, hasher: &mut CanonicalHasher) {
        (self.len() as u64).feed(hasher);
        for (key, value) in self {
            key.feed(hasher);
            value.feed(hasher);
        }
    }
}

impl Canonical for Group {
    fn feed(&self, hasher: &mut CanonicalHasher) {
        (self.index() as u8).feed(hasher);
    }
}

impl Canonical for Plan {
    #[inline]
    fn feed(&self, hasher: &mut CanonicalHasher) {
        (self.index() as u8).feed(hasher);
    }

    fn feed_all(values: &[Self], hasher: &mut CanonicalHasher) {
        hasher.update_column(values, |plan| [plan.index() as u8]);
    }
}

impl Canonical for Channel {
    fn feed(&self, hasher: &mut CanonicalHasher) {
        (self.index() as u8).feed(hasher);
    }
}

impl<T: Canonical> Canonical for ByGroup<T> {
    fn feed(&self, hasher: &mut CanonicalHasher) {
        self.0.feed(hasher);
    }
}

impl<T: Canonical> Canonical for ByPlan<T> {
    fn feed(&self, hasher: &mut CanonicalHasher) {
        self.0.feed(hasher);
    }
}

impl<T: Canonical> Canonical for ByChannel<T> {
    fn feed(&self, hasher: &mut CanonicalHasher) {
        self.0.feed(hasher);
    }
}

/// Implements [`Canonical`] and [`Restore`] for a struct from the list of all its fields. A field that is missing from
/// the list causes a compile error.
#[macro_export]
macro_rules! canonical {
    ($($name:ident { $($field:ident),* $(,)? })*) => {$(
        impl $crate::canonical::Canonical for $name {
            fn feed(&self, hasher: &mut $crate::canonical::CanonicalHasher) {
                let $name { $($field),* } = self;
                $($crate::canonical::Canonical::feed($field, hasher);)*
            }
        }

        impl $crate::canonical::Restore for $name {
            fn restore(reader: &mut $crate::canonical::CanonicalReader<'_>) -> Option<Self> {
                $(let $field = $crate::canonical::Restore::restore(reader)?;)*
                Some($name { $($field),* })
            }
        }
    )*};
}
pub use canonical;

/// Implements [`Canonical`] and [`Restore`] for a fieldless enum by its discriminant. A variant that is missing from
/// the list causes a compile error.
macro_rules! canonical_codes {
    ($($name:ident { $($value:ident),* $(,)? })*) => {$(
        impl $crate::canonical::Canonical for $name {
            fn feed(&self, hasher: &mut $crate::canonical::CanonicalHasher) {
                match self {
                    $($name::$value)|* => hasher.append_bytes(&[*self as u8]),
                }
            }
        }

        impl $crate::canonical::Restore for $name {
            fn restore(reader: &mut $crate::canonical::CanonicalReader<'_>) -> Option<Self> {
                let code: u8 = reader.read()?;
                [$($name::$value),*].into_iter().find(|value| *value as u8 == code)
            }
        }
    )*};
}
pub(crate) use canonical_codes;

#[cfg(test)]
mod tests {
    use super::*;

    struct Pair {
        first: u32,
        second: Vec<f64>,
    }
    canonical!(Pair { first, second });

    #[test]
    fn canonical_bytes_are_little_endian_with_list_lengths() {
        let mut hasher = CanonicalHasher::default();
        Pair { first: 258, second: vec![1.0] }.feed(&mut hasher);
        assert_eq!(hasher.pending[..4], [2, 1, 0, 0]);
        assert_eq!(hasher.pending[4..12], 1u64.to_le_bytes());
        assert_eq!(hasher.pending[12..], 1.0f64.to_bits().to_le_bytes());
    }

    #[test]
    fn restore_inverts_feed() {
        let pair = Pair { first: 7, second: vec![0.1, f64::MIN_POSITIVE] };
        let read: Pair = restore_all(&canonical_bytes(&pair)).expect("it reads");
        assert_eq!((read.first, read.second), (pair.first, pair.second));
    }

    #[test]
    fn list_boundaries_change_the_hash() {
        let left = (vec![1u32, 2], vec![3u32]);
        let right = (vec![1u32], vec![2u32, 3]);
        assert_ne!(canonical_hash(&left), canonical_hash(&right));
    }

    #[test]
    fn hashing_in_chunks_matches_hashing_at_once() {
        let long: Vec<u8> = (0..200_000u32).map(|value| value as u8).collect();
        let mut piecewise = CanonicalHasher::default();
        long.iter().for_each(|byte| piecewise.append_bytes(&[*byte]));
        assert_eq!(piecewise.finish(), blake3::hash(&long));
    }

    #[test]
    fn feed_all_matches_feeding_each_value() {
        let numbers: Vec<u32> = (0..100_000).map(|value: u32| value.wrapping_mul(2_654_435_761)).collect();
        let floats: Vec<f64> = numbers.iter().map(|value| f64::from(*value) / 7.0).collect();
        let signs: Vec<bool> = numbers.iter().map(|value| value % 3 == 0).collect();
        let plans: Vec<Plan> = numbers.iter().map(|value| Plan::ALL[*value as usize % 3]).collect();
        let (mut columns, mut singly) = (CanonicalHasher::default(), CanonicalHasher::default());
        7u8.feed(&mut columns);
        7u8.feed(&mut singly);
        u32::feed_all(&numbers, &mut columns);
        f64::feed_all(&floats, &mut columns);
        bool::feed_all(&signs, &mut columns);
        Plan::feed_all(&plans, &mut columns);
        numbers.iter().for_each(|value| value.feed(&mut singly));
        floats.iter().for_each(|value| value.feed(&mut singly));
        signs.iter().for_each(|value| value.feed(&mut singly));
        plans.iter().for_each(|value| value.feed(&mut singly));
        assert_eq!(columns.finish(), singly.finish());
    }
}
