//! When the clock of a machine counts as set back between two lines.

use super::Line;

/// Seconds that a running clock may be corrected by before it counts as set.
pub const CLOCK_CORRECTION: f64 = 2.0;

/// The lines before which the clock went back by more than [`CLOCK_CORRECTION`], each after the one before it, with the
/// seconds it went back.
pub fn clock_went_back<'a>(
    lines: impl IntoIterator<Item = &'a Line>,
) -> impl Iterator<Item = (&'a Line, &'a Line, f64)> {
    let pairs = lines.into_iter().scan(None::<&Line>, |before, line| Some((before.replace(line), line)));
    pairs.filter_map(|(before, line)| {
        let before = before?;
        let back = before.moment() - line.moment();
        (back > CLOCK_CORRECTION).then_some((before, line, back))
    })
}
