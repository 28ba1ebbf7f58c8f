//! Quotas in units per customer per day, whole or fractional.

use super::canonical::{Canonical, CanonicalHasher, CanonicalReader, Restore};

/// Upper limit of a quota. Above about this value, f64 cannot represent all integers.
const MAX_UNITS_EXCLUSIVE: f64 = 9.0e15;

/// Bit that marks the canonical bytes of a fractional quota. Whole quotas never have this bit, because they are
/// smaller than 2^63.
const FRACTION_BIT: u64 = 1 << 63;

/// A quota in units per customer per day, at least 0.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd, Default)]
pub struct Quota(f64);

impl Quota {
    /// Creates a quota, or returns `None` if `units` is out of range.
    pub fn from_units(units: f64) -> Option<Quota> {
        (0.0..MAX_UNITS_EXCLUSIVE).contains(&units).then_some(Quota(units.abs()))
    }

    /// Returns the quota in units per customer per day.
    pub fn units(self) -> f64 {
        self.0
    }
}

impl From<u32> for Quota {
    fn from(units: u32) -> Quota {
        Quota(f64::from(units))
    }
}

/// The canonical bytes of a whole quota are the bytes of a `u64`.
impl Canonical for Quota {
    fn feed(&self, hasher: &mut CanonicalHasher) {
        let bytes = match self.0.fract() == 0.0 {
            true => self.0 as u64,
            false => self.0.to_bits() | FRACTION_BIT,
        };
        bytes.feed(hasher);
    }
}

impl Restore for Quota {
    fn restore(reader: &mut CanonicalReader<'_>) -> Option<Self> {
        let bytes: u64 = reader.read()?;
        let units = match bytes & FRACTION_BIT {
            0 => bytes as f64,
            _ => f64::from_bits(bytes & !FRACTION_BIT),
        };
        let has_fraction = bytes & FRACTION_BIT != 0;
        Quota::from_units(units).filter(|quota| (quota.0.fract() != 0.0) == has_fraction)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::canonical::{canonical_bytes, restore_all};

    #[test]
    fn quotas_round_trip_through_canonical_bytes() {
        for units in [0u64, 1, 59, 60_000, 1_200_000, 8_999_999_999_999_999] {
            let quota = Quota::from_units(units as f64).expect("a quota");
            assert_eq!(canonical_bytes(&quota), units.to_le_bytes());
            assert_eq!(restore_all(&canonical_bytes(&quota)), Some(quota));
        }
        for units in [0.5, 59.75, 1e-300, f64::from_bits(1), 4_000_000_000_000_000.5] {
            let quota = Quota::from_units(units).expect("a quota");
            assert_eq!(restore_all::<Quota>(&canonical_bytes(&quota)).map(Quota::units), Some(units));
        }
        assert_eq!(
            canonical_bytes(&Quota::from_units(-0.0).expect("a quota")),
            canonical_bytes(&Quota::default())
        );
    }

    #[test]
    fn invalid_quotas_are_rejected() {
        for units in [-1.0, f64::NAN, f64::INFINITY, 9.0e15] {
            assert_eq!(Quota::from_units(units), None);
        }
        for bytes in [u64::MAX, FRACTION_BIT, FRACTION_BIT | 2.0f64.to_bits(), 1 << 60] {
            assert_eq!(restore_all::<Quota>(&bytes.to_le_bytes()), None);
        }
    }
}
