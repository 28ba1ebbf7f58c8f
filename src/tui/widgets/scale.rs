//! Round numbers between two bounds, for chart axes.

/// The unit of the values on an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AxisUnit {
    /// Amounts in dollars.
    Dollars,
    /// Numbers of any other unit.
    Number,
}

impl AxisUnit {
    /// Formats round values with only as many decimals as are necessary to distinguish them: `$500k`, `$1M`, `$1.002M`.
    pub fn labels(self, values: &[f64]) -> Vec<String> {
        let step = values.windows(2).map(|pair| pair[1] - pair[0]).fold(f64::INFINITY, f64::min);
        values.iter().map(|value| self.label(*value, step)).collect()
    }

    fn label(self, value: f64, step: f64) -> String {
        let size = value.abs();
        let (scale, suffix) = match size {
            _ if size >= 1e9 => (1e9, "B"),
            _ if size >= 1e6 => (1e6, "M"),
            _ if size >= 1e3 => (1e3, "k"),
            _ => (1.0, ""),
        };
        let scaled = size / scale;
        let step = if step.is_finite() { step } else { size };
        let near = |decimals: &usize| {
            let power = libm::pow(10.0, *decimals as f64);
            (scaled - (scaled * power).round() / power).abs() * scale <= 1e-3 * step
        };
        let decimals = (0..=15).find(near).unwrap_or(15);
        let (sign, dollar) =
            (if value < 0.0 { "-" } else { "" }, if self == AxisUnit::Dollars { "$" } else { "" });
        format!("{sign}{dollar}{scaled:.decimals$}{suffix}")
    }
}

/// Returns at most `most` round values between two bounds: multiples of 1, 2 or 5 times a power of ten.
pub fn ticks([from, to]: [f64; 2], most: usize) -> Vec<f64> {
    let step = tick_step([from, to], most);
    let (first, last) = ((from / step - 1e-9).ceil(), (to / step + 1e-9).floor());
    if !step.is_finite() || step <= 0.0 || last < first {
        return Vec::new();
    }
    // Adding zero removes the sign of minus zero.
    (0..=(last - first) as usize).map(|at| (first + at as f64) * step + 0.0).collect()
}

/// Returns the distance between ticks if there are at most `most`, or NaN if no ticks are possible.
fn tick_step([from, to]: [f64; 2], most: usize) -> f64 {
    let span = to - from;
    if !span.is_finite() || span <= 0.0 || most == 0 {
        return f64::NAN;
    }
    let mut magnitude = libm::pow(10.0, libm::floor(libm::log10(span / most as f64)));
    loop {
        for factor in [1.0, 2.0, 5.0] {
            let step = factor * magnitude;
            let count = (to / step + 1e-9).floor() - (from / step - 1e-9).ceil() + 1.0;
            if count <= most as f64 {
                return step;
            }
        }
        magnitude *= 10.0;
        if !magnitude.is_finite() {
            return f64::NAN;
        }
    }
}

/// Widens bounds to the next ticks if the ticks are close, so that the axis ends at a label.
pub fn widen_to_ticks([from, to]: [f64; 2], most: usize) -> [f64; 2] {
    let step = tick_step([from, to], most);
    if !step.is_finite() {
        return [from, to];
    }
    let (below, above) = ((from / step + 1e-9).floor() * step, (to / step - 1e-9).ceil() * step);
    let near = |distance: f64| distance <= 0.3 * (to - from);
    let mut wide = [if near(from - below) { below } else { from }, if near(above - to) { above } else { to }];
    // A scale needs at least two labels.
    if ticks(wide, most + 1).len() < 2 {
        wide = [below, above];
    }
    wide
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_within_bounds() {
        assert_eq!(ticks([0.0, 252.0], 6), [0.0, 50.0, 100.0, 150.0, 200.0, 250.0]);
        assert_eq!(ticks([0.0, 252.0], 3), [0.0, 100.0, 200.0]);
        assert_eq!(ticks([25.0, 36.0], 4), [25.0, 30.0, 35.0]);
        assert_eq!(ticks([-0.4, 1.0], 3), [0.0, 0.5, 1.0]);
        assert_eq!(ticks([3.0, 3.0], 4), Vec::<f64>::new());
        assert_eq!(ticks([0.0, f64::INFINITY], 4), Vec::<f64>::new());
        assert_eq!(ticks([0.0, 9.0], 0), Vec::<f64>::new());
        for (to, most) in (1..60).flat_map(|to| (1..9).map(move |most| (f64::from(to), most))) {
            let count = ticks([0.0, to], most).len();
            assert!(count <= most && count > 0, "{count} ticks up to {to}, at most {most}");
        }
    }

    #[test]
    fn labels_are_short_and_distinct() {
        let label = |from: f64, to: f64, most: usize| AxisUnit::Dollars.labels(&ticks([from, to], most));
        assert_eq!(label(0.0, 1e6, 3), ["$0", "$500k", "$1M"]);
        assert_eq!(label(1_000_000.0, 1_002_000.0, 3), ["$1M", "$1.001M", "$1.002M"]);
        assert_eq!(label(-1.5e6, 1.5e6, 3), ["-$1M", "$0", "$1M"]);
        assert_eq!(AxisUnit::Number.labels(&ticks([48.0, 49.5], 4)), ["48", "48.5", "49", "49.5"]);
        for from in [0.0, 0.003, 299_400.0, 999_999.0, 1e9] {
            for span in [1e-3, 0.7, 40.0, 12_345.0, 3e7] {
                for most in 2..8 {
                    let labels = label(from, from + span, most);
                    assert!(labels.windows(2).all(|pair| pair[0] != pair[1]), "{from} + {span}: {labels:?}");
                }
            }
        }
    }

    #[test]
    fn bounds_widen_to_a_near_tick() {
        assert_eq!(widen_to_ticks([0.0, 980.0], 5), [0.0, 1000.0]);
        assert_eq!(widen_to_ticks([300_000.0, 13_500_000.0], 4), [0.0, 15_000_000.0]);
        assert_eq!(widen_to_ticks([48.3, 51.1], 3), [48.0, 51.1], "the next tick above is far");
        let [from, to] = widen_to_ticks([99.0, 101.0], 2);
        assert!(ticks([from, to], 3).len() >= 2, "{from} {to}");
    }
}
