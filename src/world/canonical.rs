//! The canonical bytes of the state, from which the state hash is made and which a snapshot keeps.
//!
//! Little endian, floats by their bits, fields in declaration order, lists preceded by their length
//! (specification, chapter 70 §5). Two worlds with equal bytes behave alike from here on, and a world can be read
//! back from them ([`restore`]).

mod restore;

use indexmap::IndexMap;

pub use restore::{CanonicalReader, Restore, restored};

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

/// Takes canonical bytes.
pub trait Sink {
    /// Appends bytes.
    fn bytes(&mut self, bytes: &[u8]);
}

impl Sink for Vec<u8> {
    fn bytes(&mut self, bytes: &[u8]) {
        self.extend_from_slice(bytes);
    }
}

impl Sink for CanonicalHasher {
    fn bytes(&mut self, bytes: &[u8]) {
        self.pending.extend_from_slice(bytes);
        if self.pending.len() >= PIECE {
            self.hasher.update(&self.pending);
            self.pending.clear();
        }
    }
}

impl CanonicalHasher {
    /// The hash of everything fed so far.
    pub fn finish(mut self) -> blake3::Hash {
        self.hasher.update(&self.pending);
        self.hasher.finalize()
    }
}

/// A part of the state that has canonical bytes.
pub trait Canonical {
    /// Feeds the bytes of this value.
    fn feed(&self, sink: &mut impl Sink);
}

/// Hash of one value.
pub fn hash_of(value: &impl Canonical) -> blake3::Hash {
    let mut hasher = CanonicalHasher::default();
    value.feed(&mut hasher);
    hasher.finish()
}

/// Canonical bytes of one value.
pub fn bytes_of(value: &impl Canonical) -> Vec<u8> {
    let mut bytes = Vec::new();
    value.feed(&mut bytes);
    bytes
}

macro_rules! canonical_numbers {
    ($($number:ty),*) => {$(
        impl Canonical for $number {
            fn feed(&self, sink: &mut impl Sink) {
                sink.bytes(&self.to_le_bytes());
            }
        }
    )*};
}
canonical_numbers!(u8, u16, u32, u64, i64);

impl Canonical for f64 {
    fn feed(&self, sink: &mut impl Sink) {
        sink.bytes(&self.to_bits().to_le_bytes());
    }
}

impl Canonical for bool {
    fn feed(&self, sink: &mut impl Sink) {
        sink.bytes(&[u8::from(*self)]);
    }
}

impl Canonical for str {
    fn feed(&self, sink: &mut impl Sink) {
        (self.len() as u64).feed(sink);
        sink.bytes(self.as_bytes());
    }
}

impl Canonical for String {
    fn feed(&self, sink: &mut impl Sink) {
        self.as_str().feed(sink);
    }
}

impl<T: Canonical> Canonical for [T] {
    fn feed(&self, sink: &mut impl Sink) {
        (self.len() as u64).feed(sink);
        self.iter().for_each(|value| value.feed(sink));
    }
}

impl<T: Canonical> Canonical for Vec<T> {
    fn feed(&self, sink: &mut impl Sink) {
        self.as_slice().feed(sink);
    }
}

impl<T: Canonical, const LENGTH: usize> Canonical for [T; LENGTH] {
    fn feed(&self, sink: &mut impl Sink) {
        self.iter().for_each(|value| value.feed(sink));
    }
}

impl<T: Canonical> Canonical for Option<T> {
    fn feed(&self, sink: &mut impl Sink) {
        self.is_some().feed(sink);
        self.iter().for_each(|value| value.feed(sink));
    }
}

impl<A: Canonical, B: Canonical> Canonical for (A, B) {
    fn feed(&self, sink: &mut impl Sink) {
        self.0.feed(sink);
        self.1.feed(sink);
    }
}

impl<K: Canonical, V: Canonical> Canonical for IndexMap<K, V> {
    fn feed(&self, sink: &mut impl Sink) {
        (self.len() as u64).feed(sink);
        for (key, value) in self {
            key.feed(sink);
            value.feed(sink);
        }
    }
}

impl Canonical for Group {
    fn feed(&self, sink: &mut impl Sink) {
        (self.index() as u8).feed(sink);
    }
}

impl Canonical for Plan {
    fn feed(&self, sink: &mut impl Sink) {
        (self.index() as u8).feed(sink);
    }
}

impl Canonical for Channel {
    fn feed(&self, sink: &mut impl Sink) {
        (self.index() as u8).feed(sink);
    }
}

impl<T: Canonical> Canonical for ByGroup<T> {
    fn feed(&self, sink: &mut impl Sink) {
        self.0.feed(sink);
    }
}

impl<T: Canonical> Canonical for ByPlan<T> {
    fn feed(&self, sink: &mut impl Sink) {
        self.0.feed(sink);
    }
}

impl<T: Canonical> Canonical for ByChannel<T> {
    fn feed(&self, sink: &mut impl Sink) {
        self.0.feed(sink);
    }
}

/// Implements [`Canonical`] and [`Restore`] for a struct by naming all its fields; forgetting one does not compile.
macro_rules! canonical {
    ($($name:ident { $($field:ident),* $(,)? })*) => {$(
        impl $crate::world::canonical::Canonical for $name {
            fn feed(&self, sink: &mut impl $crate::world::canonical::Sink) {
                let $name { $($field),* } = self;
                $($crate::world::canonical::Canonical::feed($field, sink);)*
            }
        }

        impl $crate::world::canonical::Restore for $name {
            fn restore(reader: &mut $crate::world::canonical::CanonicalReader<'_>) -> Option<Self> {
                $(let $field = $crate::world::canonical::Restore::restore(reader)?;)*
                Some($name { $($field),* })
            }
        }
    )*};
}
pub(crate) use canonical;

/// Implements [`Canonical`] and [`Restore`] for plain enums by their number; naming all their values is checked.
macro_rules! canonical_codes {
    ($($name:ident { $($value:ident),* $(,)? })*) => {$(
        impl $crate::world::canonical::Canonical for $name {
            fn feed(&self, sink: &mut impl $crate::world::canonical::Sink) {
                match self {
                    $($name::$value)|* => sink.bytes(&[*self as u8]),
                }
            }
        }

        impl $crate::world::canonical::Restore for $name {
            fn restore(reader: &mut $crate::world::canonical::CanonicalReader<'_>) -> Option<Self> {
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
    fn bytes_are_little_endian_and_lists_carry_their_length() {
        let mut hasher = CanonicalHasher::default();
        Pair { first: 258, second: vec![1.0] }.feed(&mut hasher);
        assert_eq!(hasher.pending[..4], [2, 1, 0, 0]);
        assert_eq!(hasher.pending[4..12], 1u64.to_le_bytes());
        assert_eq!(hasher.pending[12..], 1.0f64.to_bits().to_le_bytes());
    }

    #[test]
    fn what_was_fed_is_read_back() {
        let pair = Pair { first: 7, second: vec![0.1, f64::MIN_POSITIVE] };
        let read: Pair = restored(&bytes_of(&pair)).expect("it reads");
        assert_eq!((read.first, read.second), (pair.first, pair.second));
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
