//! Branches under luck that is redrawn: what may come, and how sure a difference is.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

use super::figure::{BranchFigure, Values};

/// Resamples behind an interval.
const RESAMPLES: usize = 2_000;

/// Branches under several futures, the same ones for each.
#[derive(Debug, Clone, PartialEq)]
pub struct Futures {
    /// How many futures were drawn.
    pub count: u32,
    /// Luck is the run's own up to this day.
    pub redrawn_after: u32,
    /// Last days of weeks, from the day on which the branches part.
    days: Vec<u32>,
    /// Figures by branch, future and week; a future that ended in bankruptcy has fewer weeks.
    branches: Vec<Vec<Vec<Values>>>,
}

/// A figure over several futures.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FutureBand {
    /// Nine of ten futures have more.
    pub low: f64,
    /// Half of them have more.
    pub median: f64,
    /// One of ten has more.
    pub high: f64,
}

/// How much a branch has more than the run as it was, future by future.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PairedDifference {
    /// Mean of the differences.
    pub mean: f64,
    /// Bootstrap interval of the mean, 95 %.
    pub interval: (f64, f64),
    /// Futures in which the branch has more.
    pub more: u32,
    /// Futures that were compared.
    pub of: u32,
}

impl Futures {
    pub(super) fn of(redrawn_after: u32, days: Vec<u32>, branches: Vec<Vec<Vec<Values>>>) -> Futures {
        let count = branches.first().map_or(0, Vec::len) as u32;
        Futures { count, redrawn_after, days, branches }
    }

    /// A figure of a branch at the end of the week that a day closes; none where no future has a value there.
    pub fn band(&self, branch: usize, figure: BranchFigure, day: u32) -> Option<FutureBand> {
        let mut values: Vec<f64> =
            self.values(branch, figure, day).into_iter().filter(|value| !value.is_nan()).collect();
        values.sort_by(f64::total_cmp);
        let at = |share: f64| quantile(&values, share);
        Some(FutureBand { low: at(0.1)?, median: at(0.5)?, high: at(0.9)? })
    }

    /// The same at the end of every week: its last day and the band.
    pub fn bands(&self, branch: usize, figure: BranchFigure) -> impl Iterator<Item = (u32, FutureBand)> {
        self.days.iter().filter_map(move |day| Some((*day, self.band(branch, figure, *day)?)))
    }

    /// What a branch has more of a figure than the first one at the end of the week that a day closes; none where no future
    /// has a value in both.
    pub fn difference(&self, branch: usize, figure: BranchFigure, day: u32) -> Option<PairedDifference> {
        let pairs = self.values(branch, figure, day).into_iter().zip(self.values(0, figure, day));
        let differences: Vec<f64> =
            pairs.map(|(own, other)| own - other).filter(|own| !own.is_nan()).collect();
        let of = differences.len();
        (of > 0).then(|| PairedDifference {
            mean: mean(differences.iter().copied(), of),
            interval: bootstrap(&differences),
            more: differences.iter().filter(|own| **own > 0.0).count() as u32,
            of: of as u32,
        })
    }

    /// Futures of a branch that end before the last day.
    pub fn ended_early(&self, branch: usize) -> u32 {
        let own = self.branches.get(branch).into_iter().flatten();
        own.filter(|weeks| weeks.len() < self.days.len()).count() as u32
    }

    /// A figure in each future; not a number where it has none.
    fn values(&self, branch: usize, figure: BranchFigure, day: u32) -> Vec<f64> {
        let week = self.days.iter().position(|own| *own == day);
        let value = |weeks: &Vec<Values>| match (week, weeks.last()) {
            (Some(at), _) if at < weeks.len() => weeks[at][figure as usize],
            (Some(_), Some(last)) => after_the_end(figure, last),
            _ => f64::NAN,
        };
        self.branches.get(branch).into_iter().flatten().map(value).collect()
    }
}

/// A figure of a future that has ended: cash stays what it was, and there is nobody left to be counted.
fn after_the_end(figure: BranchFigure, last: &Values) -> f64 {
    match figure {
        BranchFigure::Cash => last[figure as usize],
        BranchFigure::Churn | BranchFigure::Satisfaction => f64::NAN,
        _ => 0.0,
    }
}

fn mean(values: impl Iterator<Item = f64>, count: usize) -> f64 {
    values.sum::<f64>() / count as f64
}

/// The value below which a share of some sorted values lies, between two of them where it falls between.
fn quantile(sorted: &[f64], share: f64) -> Option<f64> {
    let place = share * sorted.len().checked_sub(1)? as f64;
    let (below, above) = (sorted[place.floor() as usize], sorted[place.ceil() as usize]);
    Some(below + (above - below) * place.fract())
}

/// 95 % interval of a mean: its spread over samples drawn from the values with replacement. Equal values give equal intervals.
fn bootstrap(values: &[f64]) -> (f64, f64) {
    let mut rng = ChaCha8Rng::seed_from_u64(values.len() as u64);
    let count = values.len() as u64;
    let mut resample = |_| {
        let mut drawn = || values[((u64::from(rng.next_u32()) * count) >> 32) as usize];
        mean((0..count).map(|_| drawn()), values.len())
    };
    let mut means: Vec<f64> = (0..RESAMPLES).map(&mut resample).collect();
    means.sort_by(f64::total_cmp);
    let at = |share| quantile(&means, share).unwrap_or(f64::NAN);
    (at(0.025), at(0.975))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn futures(cash: &[[f64; 2]]) -> Futures {
        let week = |value: f64| {
            let mut values = [f64::NAN; BranchFigure::ALL.len()];
            values[BranchFigure::Cash as usize] = value;
            vec![values]
        };
        let branch = |at: usize| cash.iter().map(|pair| week(pair[at])).collect();
        Futures::of(0, vec![7], vec![branch(0), branch(1)])
    }

    #[test]
    fn bands_and_paired_differences_have_their_values() {
        let drawn: Vec<[f64; 2]> = (0..11).map(|at| [f64::from(at), f64::from(at) + 2.0]).collect();
        let futures = futures(&drawn);
        let band = futures.band(0, BranchFigure::Cash, 7);
        assert_eq!(band, Some(FutureBand { low: 1.0, median: 5.0, high: 9.0 }));
        let difference = futures.difference(1, BranchFigure::Cash, 7).expect("pairs");
        assert_eq!((difference.mean, difference.interval), (2.0, (2.0, 2.0)));
        assert_eq!((difference.more, difference.of), (11, 11));
        assert_eq!(futures.band(0, BranchFigure::Leads, 7), None);
        assert_eq!(futures.band(0, BranchFigure::Cash, 14), None);
    }

    #[test]
    fn a_future_that_ended_counts_with_the_cash_it_had_and_with_nobody() {
        let week = |cash: f64| {
            let mut values = [f64::NAN; BranchFigure::ALL.len()];
            values[BranchFigure::Cash as usize] = cash;
            values[BranchFigure::Subscribers as usize] = 10.0;
            values
        };
        let futures = Futures::of(0, vec![7, 14], vec![vec![vec![week(-5.0)], vec![week(1.0), week(3.0)]]]);
        assert_eq!(futures.ended_early(0), 1);
        assert_eq!(futures.values(0, BranchFigure::Cash, 14), [-5.0, 3.0]);
        assert_eq!(futures.values(0, BranchFigure::Subscribers, 14), [0.0, 10.0]);
        assert!(futures.values(0, BranchFigure::Churn, 14)[0].is_nan());
    }

    #[test]
    fn the_interval_of_a_mean_has_the_width_of_its_error() {
        // Spread 1, twenty values: the mean is known to 1.96 / sqrt(20) = 0.44 on both sides.
        let values: Vec<f64> = (0..20).map(|at| if at % 2 == 0 { 1.0 } else { -1.0 }).collect();
        let (low, high) = bootstrap(&values);
        assert!((-0.5..-0.35).contains(&low) && (0.35..0.5).contains(&high), "{low} to {high}");
    }
}
