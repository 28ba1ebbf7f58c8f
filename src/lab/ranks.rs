//! Ranks, rank correlation and concordance.

/// Returns the ranks of the values. The greatest value has rank 1, and equal values share their mean rank.
pub fn mean_ranks(values: &[f64]) -> Vec<f64> {
    let place = |value: &f64| {
        let better = values.iter().filter(|other| other.total_cmp(value).is_gt()).count() as f64;
        let equal = values.iter().filter(|other| other.total_cmp(value).is_eq()).count() as f64;
        better + (equal + 1.0) / 2.0
    };
    values.iter().map(place).collect()
}

/// Returns Spearman's rank correlation of the pairs, with mean ranks for ties. Returns `None` if there are
/// fewer than three pairs or if one of the variables does not vary.
pub fn rank_correlation(pairs: &[(f64, f64)]) -> Option<f64> {
    if pairs.len() < 3 {
        return None;
    }
    let left = mean_ranks(&pairs.iter().map(|pair| pair.0).collect::<Vec<f64>>());
    let right = mean_ranks(&pairs.iter().map(|pair| pair.1).collect::<Vec<f64>>());
    let middle = (pairs.len() as f64 + 1.0) / 2.0;
    let product = |one: &[f64], other: &[f64]| -> f64 {
        one.iter().zip(other).map(|(one, other)| (one - middle) * (other - middle)).sum()
    };
    let spread = (product(&left, &left) * product(&right, &right)).sqrt();
    (spread > 0.0).then(|| product(&left, &right) / spread)
}

/// Returns Kendall's coefficient of concordance W of several rankings, corrected for ties. W is 1 for equal
/// rankings and about 1 / (number of rankings) for unrelated rankings. Returns `None` if there are fewer than
/// two rankings, if there are fewer than two items, or if all items are tied in every ranking.
pub fn concordance(rankings: &[Vec<f64>]) -> Option<f64> {
    let (judges, things) = (rankings.len() as f64, rankings.first()?.len() as f64);
    if judges < 2.0 || things < 2.0 {
        return None;
    }
    let sums: Vec<f64> =
        (0..things as usize).map(|at| rankings.iter().map(|values| values[at]).sum::<f64>()).collect();
    let squares: f64 = sums.iter().map(|sum| sum * sum).sum();
    let ties: f64 = rankings.iter().map(|ranking| tie_correction(ranking)).sum();
    let spread = judges * judges * things * (things * things - 1.0) - judges * ties;
    let above = 12.0 * squares - 3.0 * judges * judges * things * (things + 1.0) * (things + 1.0);
    (spread > 0.0).then(|| above / spread)
}

/// Returns the sum of t^3 - t over all groups of t tied items.
fn tie_correction(places: &[f64]) -> f64 {
    let shared = |place: &f64| places.iter().filter(|other| **other == *place).count() as f64;
    // Each of the t tied items adds t^2 - 1, so the group adds t^3 - t.
    places.iter().map(shared).map(|count| count * count - 1.0).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranks_start_at_the_largest_value_and_ties_share_a_mean_rank() {
        assert_eq!(mean_ranks(&[5.0, 9.0, 5.0, -1.0]), [2.5, 1.0, 2.5, 4.0]);
    }

    #[test]
    fn concordance_is_1_for_equal_and_0_for_opposite_rankings() {
        let up = vec![1.0, 2.0, 3.0];
        let down = vec![3.0, 2.0, 1.0];
        assert_eq!(concordance(&[up.clone(), up.clone(), up.clone()]), Some(1.0));
        assert_eq!(concordance(&[up.clone(), down]), Some(0.0));
        let tied = vec![1.5, 1.5, 3.0];
        assert_eq!(concordance(&[tied.clone(), tied]), Some(1.0));
        assert_eq!(concordance(&[up]), None);
        // Three judges rank four items (Kendall 1948). The rank sums are R = 6, 5, 9, 10.
        let judges = [[2.0, 1.0, 3.0, 4.0], [1.0, 3.0, 2.0, 4.0], [3.0, 1.0, 4.0, 2.0]].map(Vec::from);
        let value = concordance(&judges).expect("rankings");
        let sums = [6.0, 5.0, 9.0, 10.0];
        let spread: f64 = sums.iter().map(|sum: &f64| (sum - 7.5) * (sum - 7.5)).sum();
        assert!((value - 12.0 * spread / (9.0 * 60.0)).abs() < 1e-12, "{value}");
    }
    #[test]
    fn concordance_ignores_magnitudes() {
        assert_eq!(rank_correlation(&[(1.0, 9.0), (2.0, 5.0), (300.0, 1.0)]), Some(-1.0));
        assert_eq!(rank_correlation(&[(1.0, 1.0), (2.0, 2.0), (3.0, 900.0)]), Some(1.0));
        // The ranks are 1, 2.5, 2.5, 4 and 1, 3, 2, 4.
        let tied = rank_correlation(&[(1.0, 1.0), (2.0, 3.0), (2.0, 2.0), (5.0, 4.0)]).expect("it varies");
        assert!((tied - 0.948_683_298_050_513_8).abs() < 1e-12, "{tied}");
    }

    #[test]
    fn rank_correlation_needs_three_varying_pairs() {
        assert_eq!(rank_correlation(&[(1.0, 1.0), (2.0, 2.0)]), None);
        assert_eq!(rank_correlation(&[(1.0, 5.0), (2.0, 5.0), (3.0, 5.0)]), None);
    }
}
