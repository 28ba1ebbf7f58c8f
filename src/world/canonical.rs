//! The canonical bytes of the state, from which the state hash is made.
//!
//! Little endian, floats by their bits, fields in declaration order, lists preceded by their length
//! (specification, chapter 70 §5). Two worlds with equal bytes behave alike from here on.

use indexmap::IndexMap;

use super::identifiers::{ByChannel, ByGroup, ByPlan, Channel, Group, Plan};

/// Collects canonical bytes and hashes them in large pieces.
pub struct CanonicalHasher {
    hasher: blake3::Hasher,
    pending: Vec<u8>,
}

const PIECE: usize = 1 << 16;

impl Default for CanonicalHasher {
    fn default() -> Self {
        CanonicalHasher { hasher: blake3::Hasher::new(), pending: Vec::with_capacity(PIECE + 16) }
    }
}

impl CanonicalHasher {
    /// Appends bytes.
    pub fn bytes(&mut self, bytes: &[u8]) {
        self.pending.extend_from_slice(bytes);
        if self.pending.len() >= PIECE {
            self.hasher.update(&self.pending);
            self.pending.clear();
        }
    }

    /// The hash of everything fed so far.
    pub fn finish(mut self) -> blake3::Hash {
        self.hasher.update(&self.pending);
        self.hasher.finalize()
    }
}

/// A part of the state that has canonical bytes.
pub trait Canonical {
    /// Feeds the bytes of this value.
    fn feed(&self, hasher: &mut CanonicalHasher);
}

/// Hash of one value.
pub fn hash_of(value: &impl Canonical) -> blake3::Hash {
    let mut hasher = CanonicalHasher::default();
    value.feed(&mut hasher);
    hasher.finish()
}

macro_rules! canonical_numbers {
    ($($number:ty),*) => {$(
        impl Canonical for $number {
            fn feed(&self, hasher: &mut CanonicalHasher) {
                hasher.bytes(&self.to_le_bytes());
            }
        }
    )*};
}
canonical_numbers!(u8, u16, u32, u64, i64);

impl Canonical for f64 {
    fn feed(&self, hasher: &mut CanonicalHasher) {
        hasher.bytes(&self.to_bits().to_le_bytes());
    }
}

impl Canonical for bool {
    fn feed(&self, hasher: &mut CanonicalHasher) {
        hasher.bytes(&[u8::from(*self)]);
    }
}

impl Canonical for str {
    fn feed(&self, hasher: &mut CanonicalHasher) {
        (self.len() as u64).feed(hasher);
        hasher.bytes(self.as_bytes());
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
        self.iter().for_each(|value| value.feed(hasher));
    }
}

impl<T: Canonical> Canonical for Vec<T> {
    fn feed(&self, hasher: &mut CanonicalHasher) {
        self.as_slice().feed(hasher);
    }
}

impl<T: Canonical, const LENGTH: usize> Canonical for [T; LENGTH] {
    fn feed(&self, hasher: &mut CanonicalHasher) {
        self.iter().for_each(|value| value.feed(hasher));
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
    fn feed(&self, hasher: &mut CanonicalHasher) {
        (self.index() as u8).feed(hasher);
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

/// Implements [`Canonical`] for a struct by naming all its fields; forgetting one does not compile.
macro_rules! canonical {
    ($($name:ident { $($field:ident),* $(,)? })*) => {$(
        impl $crate::world::canonical::Canonical for $name {
            fn feed(&self, hasher: &mut $crate::world::canonical::CanonicalHasher) {
                let $name { $($field),* } = self;
                $($crate::world::canonical::Canonical::feed($field, hasher);)*
            }
        }
    )*};
}
pub(crate) use canonical;

/// Implements [`Canonical`] for plain enums by their number.
macro_rules! canonical_codes {
    ($($name:ty),* $(,)?) => {$(
        impl $crate::world::canonical::Canonical for $name {
            fn feed(&self, hasher: &mut $crate::world::canonical::CanonicalHasher) {
                hasher.bytes(&[*self as u8]);
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
    fn bytes_are_little_endian_and_lists_carry_their_length() {
        let mut hasher = CanonicalHasher::default();
        Pair { first: 258, second: vec![1.0] }.feed(&mut hasher);
        assert_eq!(hasher.pending[..4], [2, 1, 0, 0]);
        assert_eq!(hasher.pending[4..12], 1u64.to_le_bytes());
        assert_eq!(hasher.pending[12..], 1.0f64.to_bits().to_le_bytes());
    }

    #[test]
    fn a_moved_boundary_between_lists_changes_the_hash() {
        let left = (vec![1u32, 2], vec![3u32]);
        let right = (vec![1u32], vec![2u32, 3]);
        assert_ne!(hash_of(&left), hash_of(&right));
    }

    #[test]
    fn long_input_is_hashed_in_pieces_like_short_input() {
        let long: Vec<u8> = (0..200_000u32).map(|value| value as u8).collect();
        let mut piecewise = CanonicalHasher::default();
        long.iter().for_each(|byte| piecewise.bytes(&[*byte]));
        assert_eq!(piecewise.finish(), blake3::hash(&long));
    }
}
