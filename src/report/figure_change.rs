//! Rates how unusual the change of a figure is, compared with its changes in earlier weeks.

/// A change of a figure over the last week.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FigureChange {
    /// Value at the end of the previous week.
    pub old: f64,
    /// Value at the end of the last week.
    pub new: f64,
    /// Rating of the change: 0 for a usual change, above 3 for a rare one.
    pub unusualness: f64,
    /// Size of the figure's random variation, in the unit of the figure.
    pub noise: f64,
    /// Number of weeks since a change in this direction was at least as large; `None` if no earlier change was as
    /// large.
    pub weeks_since_larger: Option<usize>,
    /// Number of weekly changes before this one.
    pub earlier_changes: usize,
}

/// Minimum number of earlier changes for a comparison.
const MIN_EARLIER_CHANGES: usize = 4;
/// Ratio of the standard deviation to the median absolute deviation of a normal distribution.
const MAD_TO_STD: f64 = 1.4826;

impl FigureChange {
    /// Returns the size of the change relative to the larger of the two values.
    pub fn relative_size(&self) -> f64 {
        (self.new - self.old).abs() / self.old.abs().max(self.new.abs())
    }

    /// Describes the change if it is the largest one in several weeks, in the unit of the figure and not in percent.
    /// Returns an empty text otherwise.
    pub fn describe_rarity(&self) -> String {
        let what = if self.new > self.old { "rise" } else { "fall" };
        match self.weeks_since_larger {
            _ if self.earlier_changes < MIN_EARLIER_CHANGES
                || (self.new - self.old).abs() <= 2.0 * self.noise =>
            {
                String::new()
            }
            None => format!("largest absolute {what} yet"),
            Some(weeks) if weeks >= MIN_EARLIER_CHANGES => {
                format!("largest absolute {what} in {weeks} weeks")
            }
            Some(_) => String::new(),
        }
    }
}

/// Rates the last change of a series, which starts with the oldest value. Returns `None` if there are fewer than two
/// values or if the last value did not change. If the series is long enough, the distance of the change from the median
/// change is compared with the median of these distances. Otherwise, the rating is based on the relative size of the
/// change. A change of about `noise`, the random variation of the figure, is never unusual.
pub fn last_change(series: &[f64], noise: f64) -> Option<FigureChange> {
    let [.., old, new] = *series else { return None };
    if old == new || !old.is_finite() || !new.is_finite() {
        return None;
    }
    let change = new - old;
    let before: Vec<f64> = series[..series.len() - 1].windows(2).map(|pair| pair[1] - pair[0]).collect();
    let as_large = |earlier: &f64| if change > 0.0 { *earlier >= change } else { *earlier <= change };
    let since = before.iter().rev().position(as_large).map(|at| at + 1);
    let size = change.abs() / old.abs().max(new.abs());
    let unusual = if before.len() < MIN_EARLIER_CHANGES {
        // With this factor, a change by one half is unusual, and a change by one tenth is not.
        size * 6.0
    } else {
        let usual = median(&before);
        let distances: Vec<f64> = before.iter().map(|earlier| (earlier - usual).abs()).collect();
        // Avoids an infinite rating for a figure that never changed.
        let spread = (MAD_TO_STD * median(&distances)).max(0.02 * old.abs().max(new.abs()));
        (change - usual).abs() / spread.max(noise)
    };
    let unusual = unusual.min(change.abs() / noise);
    Some(FigureChange {
        old,
        new,
        unusualness: unusual,
        noise,
        weeks_since_larger: since,
        earlier_changes: before.len(),
    })
}

fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    match sorted.len() {
        0 => 0.0,
        odd if odd % 2 == 1 => sorted[odd / 2],
        even => (sorted[even / 2 - 1] + sorted[even / 2]) / 2.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn last_change_beyond_usual_spread_is_unusual() {
        let steady = [100.0, 110.0, 121.0, 130.0, 141.0, 150.0];
        let ordinary = last_change(&[&steady[..], &[160.0]].concat(), 0.0).expect("it moved");
        assert!(ordinary.unusualness < 1.0, "{ordinary:?}");
        assert_eq!(ordinary.describe_rarity(), "");
        let fall = last_change(&[&steady[..], &[120.0]].concat(), 0.0).expect("it moved");
        assert!(fall.unusualness > 10.0, "{fall:?}");
        assert_eq!(fall.describe_rarity(), "largest absolute fall yet");
        let jump = last_change(&[0.0, 50.0, 60.0, 65.0, 70.0, 72.0, 110.0], 0.0).expect("it moved");
        assert_eq!(
            (jump.weeks_since_larger, jump.describe_rarity().as_str()),
            (Some(5), "largest absolute rise in 5 weeks")
        );
    }

    #[test]
    fn last_change_of_short_series_is_rated_by_size() {
        let half = last_change(&[100.0, 50.0], 0.0).expect("it moved");
        assert_eq!(
            (half.unusualness, half.weeks_since_larger, half.describe_rarity().as_str()),
            (3.0, None, "")
        );
        assert!(last_change(&[100.0, 98.0], 0.0).expect("it moved").unusualness < 0.2);
        assert_eq!(
            [
                last_change(&[1.0], 0.0),
                last_change(&[], 0.0),
                last_change(&[2.0, 2.0], 0.0),
                last_change(&[1.0, f64::NAN], 0.0)
            ],
            [None; 4]
        );
        let first = last_change(&[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 7.0], 0.0).expect("it moved");
        assert!(first.unusualness.is_finite() && first.unusualness > 3.0);
    }

    #[test]
    fn last_change_of_small_counts_is_within_noise() {
        let series = [0.0, 1.0, 0.0, 2.0, 1.0, 1.0, 0.0];
        let one = last_change(&series, 1.0).expect("it moved");
        assert!(one.unusualness <= 1.0, "{one:?}");
        assert_eq!(one.describe_rarity(), "");
        // Slower growth is not an unusual change.
        let stalled =
            last_change(&[0.0, 600.0, 1200.0, 1800.0, 2400.0, 3000.0, 3072.0], 180.0).expect("it moved");
        assert!(stalled.unusualness < 1.0, "{stalled:?}");
        let first_weeks = last_change(&[1.0, 0.0], 1.0).expect("it moved");
        assert!(first_weeks.unusualness <= 1.0, "{first_weeks:?}");
        let many = last_change(&[&series[..], &[40.0]].concat(), 40f64.sqrt()).expect("it moved");
        assert!(many.unusualness > 3.0);
        assert_eq!(many.describe_rarity(), "largest absolute rise yet");
    }
}
