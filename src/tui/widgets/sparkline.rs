//! Sparklines and bars in one row of characters.

const LEVELS: [char; 8] = ['▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];

/// Formats the last values as a sparkline. If all values are equal, draws them at half height, or at the bottom if they
/// are zero.
pub fn sparkline(values: &[f64], width: usize) -> String {
    let shown = &values[values.len().saturating_sub(width)..];
    let finite = || shown.iter().copied().filter(|value| value.is_finite());
    let (least, most) = (finite().fold(f64::INFINITY, f64::min), finite().fold(f64::NEG_INFINITY, f64::max));
    let level = |value: &f64| match value.is_finite() {
        false => ' ',
        true if most <= least && most == 0.0 => LEVELS[0],
        true if most <= least => LEVELS[3],
        true => LEVELS[(((value - least) / (most - least)) * 7.0).round() as usize],
    };
    shown.iter().map(level).collect()
}

/// Returns a bar that fills a share (0 to 1) of a width.
pub fn bar(share: f64, width: usize) -> String {
    let filled = (share.clamp(0.0, 1.0) * width as f64).round() as usize;
    "█".repeat(filled) + &"░".repeat(width - filled)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sparkline_scales_between_minimum_and_maximum() {
        assert_eq!(sparkline(&[0.0, 7.0, 3.0], 8), "▁█▄");
        assert_eq!(sparkline(&[5.0, 5.0], 8), "▄▄");
        assert_eq!(sparkline(&[0.0, 0.0, 0.0], 8), "▁▁▁");
        assert_eq!(sparkline(&[1.0, 2.0, 3.0], 2), "▁█");
        assert_eq!(sparkline(&[f64::NAN, 1.0], 2), " ▄");
        assert_eq!(sparkline(&[], 3), "");
        assert_eq!(bar(0.5, 4), "██░░");
        assert_eq!(bar(7.0, 2), "██");
    }
}
