//! Branches with several futures, which show the range of outcomes and the certainty of differences.

use super::figure::{BranchFigure, FigureValues};
use novamind_base::statistics::{PairedDifference, quantile_of_sorted};

/// Figures of branches in several futures. All branches have the same futures.
#[derive(Debug, Clone, PartialEq)]
pub struct Futures {
    /// Number of futures per branch.
    pub count: u32,
    /// Last day that uses the random draws of the run.
    pub redrawn_after: u32,
    /// Last day of each week from the start of the branches. Includes weeks after a bankruptcy.
    days: Vec<u32>,
    /// Figures by branch, future and week. A future that ends in bankruptcy has fewer weeks.
    branches: Vec<Vec<Vec<FigureValues>>>,
}

/// The distribution of a figure over several futures.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FutureInterval {
    /// 10th percentile of the values.
    pub low: f64,
    /// Median of the values.
    pub median: f64,
    /// 90th percentile of the values.
    pub high: f64,
}

impl Futures {
    pub(super) fn new(redrawn_after: u32, days: Vec<u32>, branches: Vec<Vec<Vec<FigureValues>>>) -> Futures {
        let count = branches.first().map_or(0, Vec::len) as u32;
        Futures { count, redrawn_after, days, branches }
    }

    /// Returns the distribution of a branch's figure at the end of the week that ends on `day`. Returns `None` if no
    /// future has a value.
    pub fn interval(&self, branch: usize, figure: BranchFigure, day: u32) -> Option<FutureInterval> {
        let mut values: Vec<f64> =
            self.values_by_future(branch, figure, day).into_iter().filter(|value| !value.is_nan()).collect();
        values.sort_by(f64::total_cmp);
        let at = |share: f64| quantile_of_sorted(&values, share);
        Some(FutureInterval { low: at(0.1)?, median: at(0.5)?, high: at(0.9)? })
    }

    /// Returns the distributions of a branch's figure at the end of every week, as pairs of day and distribution.
    pub fn intervals(
        &self,
        branch: usize,
        figure: BranchFigure,
    ) -> impl Iterator<Item = (u32, FutureInterval)> {
        self.days.iter().filter_map(move |day| Some((*day, self.interval(branch, figure, *day)?)))
    }

    /// Returns the paired difference of a figure between a branch and the first branch, at the end of the week that
    /// ends on `day`. Returns `None` if no future has a value in both branches.
    pub fn difference(&self, branch: usize, figure: BranchFigure, day: u32) -> Option<PairedDifference> {
        let pairs =
            self.values_by_future(branch, figure, day).into_iter().zip(self.values_by_future(0, figure, day));
        PairedDifference::from_pairs(pairs)
    }

    /// Returns the number of futures in which a branch ends in bankruptcy.
    pub fn bankruptcy_count(&self, branch: usize) -> u32 {
        let branch_futures = self.branches.get(branch).into_iter().flatten();
        let is_broke = |weeks: &Vec<FigureValues>| {
            weeks.last().is_some_and(|last| last[BranchFigure::Cash as usize] < 0.0)
        };
        branch_futures.filter(|weeks| weeks.len() < self.days.len() || is_broke(weeks)).count() as u32
    }

    /// Returns the value of a figure in each future, or NaN if the figure has no value.
    fn values_by_future(&self, branch: usize, figure: BranchFigure, day: u32) -> Vec<f64> {
        let week = self.days.iter().position(|number| *number == day);
        let value = |weeks: &Vec<FigureValues>| match (week, weeks.last()) {
            (Some(at), _) if at < weeks.len() => weeks[at][figure as usize],
            (Some(_), Some(last)) => value_after_bankruptcy(figure, last),
            _ => f64::NAN,
        };
        self.branches.get(branch).into_iter().flatten().map(value).collect()
    }
}

/// Returns the value of a figure after a bankruptcy: unchanged cash, 0 for counts, NaN for shares and satisfaction.
fn value_after_bankruptcy(figure: BranchFigure, last: &FigureValues) -> f64 {
    match figure {
        BranchFigure::Cash => last[figure as usize],
        BranchFigure::Churn | BranchFigure::Conversion | BranchFigure::Satisfaction => f64::NAN,
        _ => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use novamind_base::statistics::Interval;

    fn sample_futures(cash: &[[f64; 2]]) -> Futures {
        let week = |value: f64| {
            let mut values = [f64::NAN; BranchFigure::ALL.len()];
            values[BranchFigure::Cash as usize] = value;
            vec![values]
        };
        let branch = |at: usize| cash.iter().map(|pair| week(pair[at])).collect();
        Futures::new(0, vec![7], vec![branch(0), branch(1)])
    }

    #[test]
    fn intervals_and_paired_differences_are_computed() {
        let drawn: Vec<[f64; 2]> = (0..11).map(|at| [f64::from(at), f64::from(at) + 2.0]).collect();
        let futures = sample_futures(&drawn);
        let band = futures.interval(0, BranchFigure::Cash, 7);
        assert_eq!(band, Some(FutureInterval { low: 1.0, median: 5.0, high: 9.0 }));
        let difference = futures.difference(1, BranchFigure::Cash, 7).expect("pairs");
        assert_eq!((difference.mean, difference.interval), (2.0, Some(Interval { low: 2.0, high: 2.0 })));
        assert_eq!((difference.first_greater, difference.pair_count), (11, 11));
        assert_eq!(futures.interval(0, BranchFigure::Leads, 7), None);
        assert_eq!(futures.interval(0, BranchFigure::Cash, 14), None);
    }

    #[test]
    fn bankrupt_future_keeps_cash_and_has_no_subscribers() {
        let week = |cash: f64| {
            let mut values = [f64::NAN; BranchFigure::ALL.len()];
            values[BranchFigure::Cash as usize] = cash;
            values[BranchFigure::Subscribers as usize] = 10.0;
            values
        };
        let futures = Futures::new(0, vec![7, 14], vec![vec![vec![week(-5.0)], vec![week(1.0), week(3.0)]]]);
        assert_eq!(futures.bankruptcy_count(0), 1);
        let in_the_last_week = Futures::new(0, vec![7], vec![vec![vec![week(-5.0)], vec![week(1.0)]]]);
        assert_eq!(in_the_last_week.bankruptcy_count(0), 1);
        assert_eq!(futures.values_by_future(0, BranchFigure::Cash, 14), [-5.0, 3.0]);
        assert_eq!(futures.values_by_future(0, BranchFigure::Subscribers, 14), [0.0, 10.0]);
        assert!(futures.values_by_future(0, BranchFigure::Churn, 14)[0].is_nan());
    }
}
