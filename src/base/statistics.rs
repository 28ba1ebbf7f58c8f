//! Statistics of small samples: mean, spread, quantiles, and their uncertainty.
//!
//! Intervals are percentile bootstraps: the sample is resampled with replacement [`RESAMPLE_COUNT`] times. The random
//! seed depends only on the sample size, so equal samples give equal intervals on every machine.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Number of bootstrap resamples per interval.
pub const RESAMPLE_COUNT: usize = 2_000;

/// Confidence level of the intervals: the share of resamples inside an interval.
pub const CONFIDENCE_LEVEL: f64 = 0.95;

/// Minimum sample size for an interval. With fewer values, the probability that all values have the same sign by chance
/// is above 1 - [`CONFIDENCE_LEVEL`]. With six values, it is 2 in 64.
pub const MIN_SAMPLE_SIZE: usize = 6;

/// Size, mean and standard deviation of a sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SampleStatistics {
    /// Sample size.
    pub count: usize,
    /// Arithmetic mean, or 0 for an empty sample.
    pub mean: f64,
    /// Sample standard deviation with divisor n - 1, or 0 for fewer than two values.
    pub std: f64,
}

impl SampleStatistics {
    /// Computes the statistics of a sample. The values can be in any order.
    pub fn from_values(values: &[f64]) -> SampleStatistics {
        let (count, mean) = (values.len(), mean(values));
        let squares: f64 = values.iter().map(|value| (value - mean) * (value - mean)).sum();
        let std = if count < 2 { 0.0 } else { (squares / (count - 1) as f64).sqrt() };
        SampleStatistics { count, mean, std }
    }
}

/// Returns the mean of the values, or 0 if there are none.
pub fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

/// Returns a linearly interpolated quantile of values in any order, or `None` if there are none.
pub fn quantile(values: &[f64], share: f64) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    quantile_of_sorted(&sorted, share)
}

/// Returns a linearly interpolated quantile of sorted values, or `None` if there are none.
pub fn quantile_of_sorted(sorted: &[f64], share: f64) -> Option<f64> {
    let place = share * sorted.len().checked_sub(1)? as f64;
    let (below, above) = (sorted[place.floor() as usize], sorted[place.ceil() as usize]);
    Some(below + (above - below) * place.fract())
}

/// Returns the median of values in any order, or `None` if there are none.
pub fn median(values: &[f64]) -> Option<f64> {
    quantile(values, 0.5)
}

/// Quartiles of a sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quartiles {
    /// First quartile of the sample.
    pub lower: f64,
    /// Median of the sample.
    pub median: f64,
    /// Third quartile of the sample.
    pub upper: f64,
}

impl Quartiles {
    /// Computes the quartiles of values in any order, or returns `None` if there are none.
    pub fn from_values(values: &[f64]) -> Option<Quartiles> {
        let mut sorted = values.to_vec();
        sorted.sort_by(f64::total_cmp);
        let at = |share| quantile_of_sorted(&sorted, share);
        Some(Quartiles { lower: at(0.25)?, median: at(0.5)?, upper: at(0.75)? })
    }
}

/// A closed interval of values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    /// Lower bound of the interval.
    pub low: f64,
    /// Upper bound of the interval.
    pub high: f64,
}

impl Interval {
    /// Returns the 95 % interval of the mean, or `None` for fewer than [`MIN_SAMPLE_SIZE`] values.
    pub fn for_mean(values: &[f64]) -> Option<Interval> {
        bootstrap_interval(values, |drawn| Some(mean(drawn)))
    }

    /// Returns the 95 % interval of the median, or `None` for fewer than [`MIN_SAMPLE_SIZE`] values.
    pub fn for_median(values: &[f64]) -> Option<Interval> {
        bootstrap_interval(values, |drawn| {
            drawn.sort_by(f64::total_cmp);
            quantile_of_sorted(drawn, 0.5)
        })
    }
}

/// Returns the percentile bootstrap interval of a statistic: the interval that contains a share of [`CONFIDENCE_LEVEL`]
/// of the [`RESAMPLE_COUNT`] resamples. Returns `None` if the statistic has no value or if there are fewer than
/// [`MIN_SAMPLE_SIZE`] values.
///
/// The `statistic` function may reorder the values that it receives.
pub fn bootstrap_interval(values: &[f64], statistic: impl Fn(&mut [f64]) -> Option<f64>) -> Option<Interval> {
    let count = u32::try_from(values.len()).ok().filter(|_| values.len() >= MIN_SAMPLE_SIZE)?;
    let mut rng = ChaCha8Rng::seed_from_u64(u64::from(count));
    let mut drawn = vec![0.0; values.len()];
    let mut resample = |_| {
        drawn.iter_mut().for_each(|place| *place = values[rng.random_range(0..count) as usize]);
        statistic(&mut drawn)
    };
    let mut found: Vec<f64> = (0..RESAMPLE_COUNT).filter_map(&mut resample).collect();
    found.sort_by(f64::total_cmp);
    let at = |share| quantile_of_sorted(&found, share);
    Some(Interval { low: at((1.0 - CONFIDENCE_LEVEL) / 2.0)?, high: at((1.0 + CONFIDENCE_LEVEL) / 2.0)? })
}

/// Paired difference between two samples that were measured on the same seeds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PairedDifference {
    /// Mean of the paired differences.
    pub mean: f64,
    /// Interval of the mean, or `None` for fewer than [`MIN_SAMPLE_SIZE`] pairs.
    pub interval: Option<Interval>,
    /// Number of pairs in which the first value is larger than the second.
    pub first_greater: u32,
    /// Number of pairs that were compared.
    pub pair_count: u32,
}

impl PairedDifference {
    /// Computes the statistics of the differences. Skips pairs with a NaN, and returns `None` if no pair remains.
    pub fn from_pairs(pairs: impl IntoIterator<Item = (f64, f64)>) -> Option<PairedDifference> {
        let differences = pairs.into_iter().map(|(value, other)| value - other);
        let differences: Vec<f64> = differences.filter(|difference| !difference.is_nan()).collect();
        (!differences.is_empty()).then(|| PairedDifference {
            mean: mean(&differences),
            interval: Interval::for_mean(&differences),
            first_greater: differences.iter().filter(|difference| **difference > 0.0).count() as u32,
            pair_count: differences.len() as u32,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn statistics_match_known_values() {
        let sample = SampleStatistics::from_values(&[1.0, 2.0, 3.0, 4.0]);
        assert_eq!((sample.mean, sample.count), (2.5, 4));
        assert!((sample.std - (5.0f64 / 3.0).sqrt()).abs() < 1e-12);
        assert_eq!(SampleStatistics::from_values(&[7.0]).std, 0.0);
        assert_eq!(median(&[3.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(quantile(&[1.0, 2.0, 3.0, 4.0], 0.25), Some(1.75));
        assert_eq!(median(&[]), None);
        let middle = Quartiles { lower: 2.0, median: 3.0, upper: 4.0 };
        assert_eq!(Quartiles::from_values(&[5.0, 1.0, 4.0, 2.0, 3.0]), Some(middle));
        assert_eq!(Quartiles::from_values(&[]), None);
    }

    #[test]
    fn mean_interval_matches_the_standard_error() {
        // With standard deviation 1 and twenty values, the interval extends about 1.96 / sqrt(20) = 0.44 on each side
        // of the mean.
        let values: Vec<f64> = (0..20).map(|at| if at % 2 == 0 { 1.0 } else { -1.0 }).collect();
        let interval = Interval::for_mean(&values).expect("values");
        assert!(
            (-0.5..-0.35).contains(&interval.low) && (0.35..0.5).contains(&interval.high),
            "{interval:?}"
        );
        assert_eq!(Interval::for_mean(&values), Some(interval), "the same numbers, the same interval");
        assert_eq!(Interval::for_mean(&[]), None);
        assert_eq!(Interval::for_mean(&[3.0; MIN_SAMPLE_SIZE - 1]), None, "too few values for an interval");
        assert_eq!(Interval::for_mean(&[3.0; MIN_SAMPLE_SIZE]), Some(Interval { low: 3.0, high: 3.0 }));
    }

    #[test]
    fn median_interval_contains_the_median_and_narrows() {
        let spread = |count: u32| -> Vec<f64> { (0..count).map(|at| f64::from((at * 37) % count)).collect() };
        let few = Interval::for_median(&spread(11)).expect("values");
        assert!(few.low < 5.0 && few.high > 5.0, "{few:?}");
        let many = Interval::for_median(&spread(401)).expect("values");
        assert!(many.low < 200.0 && many.high > 200.0, "{many:?}");
        assert!((many.high - many.low) / 401.0 < (few.high - few.low) / 11.0, "{many:?} {few:?}");
    }

    #[test]
    fn paired_difference_compares_pairs() {
        let paired_difference =
            PairedDifference::from_pairs([(3.0, 1.0), (12.0, 10.0), (f64::NAN, 1.0)]).expect("pairs");
        assert_eq!(
            paired_difference,
            PairedDifference { mean: 2.0, interval: None, first_greater: 2, pair_count: 2 }
        );
        let difference = PairedDifference::from_pairs([(3.0, 1.0); MIN_SAMPLE_SIZE]).expect("pairs");
        assert_eq!(difference.interval, Some(Interval { low: 2.0, high: 2.0 }));
        assert_eq!(PairedDifference::from_pairs([(f64::NAN, 1.0)]), None);
    }
}
