//! Detection of equal runs. Configurations that differ only in their cash floor make the same decisions until
//! cash is between their floors on a decision day. Runs with the same decisions are simulated only once.

use super::grid::GridPoint;
use crate::experiment::RunResult;
use crate::policy::{Policy, RuleBased};

/// Returns the index of each configuration's representative: the configuration with the lowest cash floor
/// among those that differ only in their cash floor.
pub fn representative_configurations(points: &[GridPoint]) -> Vec<usize> {
    let floor = |at: usize| cash_floor(&points[at].policy);
    let representative = |at: usize| {
        let alike = (0..points.len())
            .filter(|other| differ_only_in_floor(&points[at].policy, &points[*other].policy));
        alike.min_by(|one, other| floor(*one).total_cmp(&floor(*other))).unwrap_or(at)
    };
    (0..points.len()).map(representative).collect()
}

/// Returns the cash floor of a policy, or negative infinity if the policy has no routine.
fn cash_floor(policy: &Policy) -> f64 {
    policy.rule_based.as_ref().map_or(f64::NEG_INFINITY, |rules| rules.cash_floor)
}

fn differ_only_in_floor(one: &Policy, other: &Policy) -> bool {
    let rules = |policy: &Policy| {
        policy.rule_based.as_ref().map(|rules| RuleBased { cash_floor: 0.0, ..rules.clone() })
    };
    rules(one) == rules(other)
        && (&one.start, &one.calls, &one.enterprise) == (&other.start, &other.calls, &other.enterprise)
}

/// Returns whether a run of the representative is also valid for a configuration with another cash floor. The run is
/// valid unless cash was between the two floors on a decision day.
pub fn is_shared_run(representative: &Policy, policy: &Policy, start_cash: f64, run: &RunResult) -> bool {
    let (low, high) = (cash_floor(representative), cash_floor(policy));
    let decided = run.weeks.iter().take(run.weeks.len().saturating_sub(1)).map(|week| week.cash);
    std::iter::once(start_cash).chain(decided).all(|cash| (cash > low) == (cash > high))
}
