//! When the clock of a machine counts as set back between two lines.

use super::Line;

/// Seconds that a running clock may be corrected by before it counts as set.
pub const CLOCK_CORRECTION: f64 = 2.0;

/// The lines before which the clock went back by more than [`CLOCK_CORRECTION`], each after the one before it, with the
/// seconds it went back.
pub fn clock_went_back(lines: &[Line]) -> impl Iterator<Item = (&Line, &Line, f64)> {
    let pairs = lines.windows(2).map(|pair| (&pair[0], &pair[1], pair[0].moment() - pair[1].moment()));
    pairs.filter(|(_, _, back)| *back > CLOCK_CORRECTION)
}
