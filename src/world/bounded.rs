//! Bounds for arithmetic on columns.

/// As `clamp` for bounds that are in order, as those of checked parameters are. `clamp` makes sure of it and may panic,
/// and a loop that may panic goes through its rows one by one instead of side by side.
#[inline]
pub fn bounded(value: f64, least: f64, most: f64) -> f64 {
    let value = if value < least { least } else { value };
    if value > most { most } else { value }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn it_is_what_clamp_is(value in proptest::num::f64::ANY, one: f64, other: f64) {
            let (least, most) = (one.min(other), one.max(other));
            prop_assume!(least <= most);
            prop_assert_eq!(bounded(value, least, most).to_bits(), value.clamp(least, most).to_bits());
        }
    }
}
