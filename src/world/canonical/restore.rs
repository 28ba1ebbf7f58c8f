//! Restores values from canonical bytes. For invalid bytes, the functions return `None` and never panic.

use indexmap::IndexMap;

use crate::identifiers::{ByChannel, ByGroup, ByPlan, Channel, Group, Plan};

/// A reader of canonical bytes.
pub struct CanonicalReader<'a> {
    remaining_bytes: &'a [u8],
}

impl<'a> CanonicalReader<'a> {
    /// Creates a reader that starts at the first byte.
    pub fn new(bytes: &'a [u8]) -> CanonicalReader<'a> {
        CanonicalReader { remaining_bytes: bytes }
    }

    /// Returns the next `count` bytes, or `None` if fewer remain.
    pub fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let (taken, rest) = self.remaining_bytes.split_at_checked(count)?;
        self.remaining_bytes = rest;
        Some(taken)
    }

    /// Reads the next value, or returns `None` if its bytes are invalid.
    pub fn read<T: Restore>(&mut self) -> Option<T> {
        T::restore(self)
    }

    /// Returns the number of unread bytes.
    pub fn remaining(&self) -> usize {
        self.remaining_bytes.len()
    }
}

/// A value that can be restored from its canonical bytes.
pub trait Restore: Sized {
    /// Reads a value of this type. Returns `None` if the bytes are invalid.
    fn restore(reader: &mut CanonicalReader<'_>) -> Option<Self>;
}

/// Restores a value from all of `bytes`. Returns `None` if the bytes are invalid or some bytes remain.
#[cfg(test)]
pub fn restore_all<T: Restore>(bytes: &[u8]) -> Option<T> {
    let mut reader = CanonicalReader::new(bytes);
    let value = reader.read()?;
    (reader.remaining() == 0).then_some(value)
}

macro_rules! restored_numbers {
    ($($number:ty),*) => {$(
        impl Restore for $number {
            fn restore(reader: &mut CanonicalReader<'_>) -> Option<Self> {
                let bytes = reader.take(size_of::<$number>())?;
                bytes.try_into().ok().map(<$number>::from_le_bytes)
            }
        }
    )*};
}
restored_numbers!(u8, u16, u32, u64, i64);

impl Restore for f64 {
    fn restore(reader: &mut CanonicalReader<'_>) -> Option<Self> {
        reader.read().map(f64::from_bits)
    }
}

impl Restore for bool {
    fn restore(reader: &mut CanonicalReader<'_>) -> Option<Self> {
        match reader.read::<u8>()? {
            0 => Some(false),
            1 => Some(true),
            _ => None,
        }
    }
}

/// Reads the length of a list or text. Each element takes at least one byte, so a length above the number of remaining
/// bytes is invalid.
fn read_length(reader: &mut CanonicalReader<'_>) -> Option<usize> {
    let length = usize::try_from(reader.read::<u64>()?).ok()?;
    (length <= reader.remaining_bytes.len()).then_some(length)
}

impl Restore for String {
    fn restore(reader: &mut CanonicalReader<'_>) -> Option<Self> {
        let length = read_length(reader)?;
        String::from_utf8(reader.take(length)?.to_vec()).ok()
    }
}

impl<T: Restore> Restore for Vec<T> {
    fn restore(reader: &mut CanonicalReader<'_>) -> Option<Self> {
        let length = read_length(reader)?;
        (0..length).map(|_| reader.read()).collect()
    }
}

impl<T: Restore, const LENGTH: usize> Restore for [T; LENGTH] {
    fn restore(reader: &mut CanonicalReader<'_>) -> Option<Self> {
        let values: Vec<T> = (0..LENGTH).map(|_| reader.read()).collect::<Option<_>>()?;
        values.try_into().ok()
    }
}

impl<T: Restore> Restore for Option<T> {
    fn restore(reader: &mut CanonicalReader<'_>) -> Option<Self> {
        if reader.read()? { reader.read().map(Some) } else { Some(None) }
    }
}

impl<A: Restore, B: Restore> Restore for (A, B) {
    fn restore(reader: &mut CanonicalReader<'_>) -> Option<Self> {
        Some((reader.read()?, reader.read()?))
    }
}

impl<K: Restore + std::hash::Hash + Eq, V: Restore> Restore for IndexMap<K, V> {
    fn restore(reader: &mut CanonicalReader<'_>) -> Option<Self> {
        let length = read_length(reader)?;
        (0..length).map(|_| reader.read()).collect()
    }
}

macro_rules! restored_positions {
    ($($name:ident),*) => {$(
        impl Restore for $name {
            fn restore(reader: &mut CanonicalReader<'_>) -> Option<Self> {
                $name::at(usize::from(reader.read::<u8>()?))
            }
        }
    )*};
}
restored_positions!(Group, Plan, Channel);

macro_rules! restored_tables {
    ($($name:ident),*) => {$(
        impl<T: Restore> Restore for $name<T> {
            fn restore(reader: &mut CanonicalReader<'_>) -> Option<Self> {
                reader.read().map($name)
            }
        }
    )*};
}
restored_tables!(ByGroup, ByPlan, ByChannel);

#[cfg(test)]
mod tests {
    use super::super::canonical_bytes;
    use super::*;

    #[test]
    fn restore_reads_every_kind_of_value() {
        let text = "naïve".to_owned();
        let nested = (vec![Some(Plan::B), None], (text, [1.5f64, -0.0]));
        let read: (Vec<Option<Plan>>, (String, [f64; 2])) =
            restore_all(&canonical_bytes(&nested)).expect("it reads");
        assert_eq!(read, nested);
        let map: IndexMap<i64, ByChannel<u16>> = IndexMap::from([(-3, ByChannel([1, 2, 3, 4, 5]))]);
        assert_eq!(restore_all::<IndexMap<i64, ByChannel<u16>>>(&canonical_bytes(&map)), Some(map));
    }

    #[test]
    fn restore_rejects_invalid_bytes() {
        let whole = canonical_bytes(&vec![Group::at(25).expect("a group"); 3]);
        for cut in 0..whole.len() {
            assert!(restore_all::<Vec<Group>>(&whole[..cut]).is_none(), "cut at {cut}");
        }
        assert!(restore_all::<Vec<Group>>(&[whole.as_slice(), &[0]].concat()).is_none(), "a byte too many");
        assert!(restore_all::<Group>(&[26]).is_none());
        assert!(restore_all::<bool>(&[2]).is_none());
        assert!(restore_all::<Vec<u8>>(&u64::MAX.to_le_bytes()).is_none(), "a length beyond the end");
        assert!(restore_all::<String>(&[1, 0, 0, 0, 0, 0, 0, 0, 0xff]).is_none(), "no text");
    }
}
