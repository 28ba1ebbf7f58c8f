//! Histograms of draws.

/// A histogram: counts of draws in bins of equal width.
#[derive(Debug, Clone, PartialEq)]
pub struct Histogram {
    /// Lower bound of the first bin.
    pub from: f64,
    /// Width of each bin.
    pub width: f64,
    /// Number of draws in each bin. The outer bins include all draws beyond the histogram.
    pub counts: Vec<u64>,
}

/// Share of the draws at each end that are counted in the outer bins, so that outliers do not widen all bins.
const TAIL_SHARE: f64 = 0.001;

impl Histogram {
    /// Creates a histogram with at most `bins` bins. If the draws have few distinct values, each value has one bin.
    pub fn from_draws(draws: &[f64], bins: usize) -> Histogram {
        let mut sorted: Vec<f64> = draws.iter().copied().filter(|draw| draw.is_finite()).collect();
        sorted.sort_by(f64::total_cmp);
        let (Some(&least), Some(&most)) = (sorted.first(), sorted.last()) else {
            return Histogram { from: 0.0, width: 1.0, counts: vec![0] };
        };
        let whole = sorted.iter().all(|draw| draw.fract() == 0.0);
        if whole && most - least < bins as f64 {
            return Histogram::count_into_bins(&sorted, least - 0.5, 1.0, (most - least) as usize + 1);
        }
        let beyond = (TAIL_SHARE * sorted.len() as f64) as usize;
        let (low, high) = (sorted[beyond], sorted[sorted.len() - 1 - beyond]);
        let span = if high > low { high - low } else { 1.0 };
        Histogram::count_into_bins(&sorted, low, span / bins as f64, bins)
    }

    fn count_into_bins(draws: &[f64], from: f64, width: f64, bins: usize) -> Histogram {
        let mut counts = vec![0; bins];
        for draw in draws {
            let bin = ((draw - from) / width).floor().clamp(0.0, (bins - 1) as f64);
            counts[bin as usize] += 1;
        }
        Histogram { from, width, counts }
    }

    /// Returns the center of a bin.
    pub fn bin_center(&self, bin: usize) -> f64 {
        self.from + (bin as f64 + 0.5) * self.width
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn histogram_has_one_bin_for_each_of_few_integers() {
        let histogram = Histogram::from_draws(&[10.0, 12.0, 12.0, 11.0], 20);
        assert_eq!((histogram.from, histogram.width, histogram.counts.clone()), (9.5, 1.0, vec![1, 1, 2]));
        assert_eq!(histogram.bin_center(2), 12.0);
    }

    #[test]
    fn outliers_count_in_the_outer_bins() {
        let mut draws: Vec<f64> = (0..2000).map(|n| f64::from(n) / 2000.0).collect();
        draws.push(1e9);
        let histogram = Histogram::from_draws(&draws, 10);
        assert_eq!(histogram.counts.iter().sum::<u64>(), 2001);
        assert!(
            histogram.width < 0.2 && histogram.counts.iter().all(|count| (190..215).contains(count)),
            "{histogram:?}"
        );
        assert_eq!(Histogram::from_draws(&[], 5).counts, [0]);
        assert_eq!(Histogram::from_draws(&[0.25; 4], 3).counts, [4, 0, 0]);
    }
}
