//! Configurations that differ only in their cash floor play alike until cash falls between the floors. Such runs are played
//! once.

use super::grid::GridPoint;
use crate::experiment::RunResult;
use crate::policy::{Policy, RuleBased};

/// Returns for each configuration the one with the lowest floor among those that are otherwise equal.
pub fn shared_run_leaders(points: &[GridPoint]) -> Vec<usize> {
    let floor = |at: usize| cash_floor(&points[at].policy);
    let leader = |at: usize| {
        let alike = (0..points.len())
            .filter(|other| differ_only_in_floor(&points[at].policy, &points[*other].policy));
        alike.min_by(|one, other| floor(*one).total_cmp(&floor(*other))).unwrap_or(at)
    };
    (0..points.len()).map(leader).collect()
}

/// Returns the cash floor of the routine, or negative infinity without a routine.
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

/// Returns whether a run of the leader is also valid for a configuration with another floor: on no decision day was cash above
/// one floor and not above the other.
pub fn is_shared_run(leader: &Policy, policy: &Policy, start_cash: f64, run: &RunResult) -> bool {
    let (low, high) = (cash_floor(leader), cash_floor(policy));
    let decided = run.weeks.iter().take(run.weeks.len().saturating_sub(1)).map(|week| week.cash);
    std::iter::once(start_cash).chain(decided).all(|cash| (cash > low) == (cash > high))
}
