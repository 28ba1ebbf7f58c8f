//! Shapley values: the contributions of several causes to one value.

/// Returns the Shapley value of each cause, which is the mean contribution of the cause over all orders of the causes.
/// `value` returns the result of a set of causes, given as a bit mask. The Shapley values add up to the result with
/// all causes minus the result without causes.
pub(super) fn shapley_values(causes: usize, value: impl Fn(u32) -> f64) -> Vec<f64> {
    let sets = 1u32 << causes;
    let values: Vec<f64> = (0..sets).map(value).collect();
    let weights = coalition_weights(causes);
    let share = |cause: usize| {
        let number = 1u32 << cause;
        let without = (0..sets).filter(|set| set & number == 0);
        without
            .map(|set| {
                let added = values[(set | number) as usize] - values[set as usize];
                weights[set.count_ones() as usize] * added
            })
            .sum()
    };
    (0..causes).map(share).collect()
}

/// Returns the weight of each set size `s`: s! (n - s - 1)! / n!. The weight is the share of all orders in which
/// exactly the causes of the set precede a given cause.
fn coalition_weights(causes: usize) -> Vec<f64> {
    let mut weights = Vec::with_capacity(causes);
    let mut choices = 1.0;
    for before in 0..causes {
        // The denominator is `causes` times the number of sets of this size that exclude the cause.
        weights.push(1.0 / (causes as f64 * choices));
        choices = choices * (causes - 1 - before) as f64 / (before + 1) as f64;
    }
    weights
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn additive_causes_receive_their_own_amount() {
        let alone = [3.0, -1.5, 0.0, 7.0];
        let sum =
            |set: u32| (0..4).filter(|cause| set & (1 << cause) != 0).map(|cause| alone[cause]).sum::<f64>();
        for (value, expected) in shapley_values(4, |set| 10.0 + sum(set)).into_iter().zip(alone) {
            assert!((value - expected).abs() < 1e-12, "{value} instead of {expected}");
        }
    }

    #[test]
    fn interaction_is_shared_and_values_sum_to_the_total() {
        assert_eq!(shapley_values(2, |set| if set == 0b11 { 8.0 } else { 0.0 }), [4.0, 4.0]);
        // The glove game: player 0 has a left glove, players 1 and 2 have a right glove.
        let pairs = |set: u32| if set & 1 != 0 && set & 0b110 != 0 { 1.0 } else { 0.0 };
        let shares = shapley_values(3, pairs);
        for (share, value) in shares.iter().zip([4.0 / 6.0, 1.0 / 6.0, 1.0 / 6.0]) {
            assert!((share - value).abs() < 1e-12);
        }
        let odd = |set: u32| f64::from(set * set % 37);
        for causes in 0..=6 {
            let all: f64 = shapley_values(causes, odd).iter().sum();
            assert!((all - (odd((1 << causes) - 1) - odd(0))).abs() < 1e-9);
        }
    }
}
