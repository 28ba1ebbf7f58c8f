//! Explanations of a change: each cause with its contribution, computed from simulations without the cause.

use super::CauseProgressFn;
use super::cause::{Cause, CauseDetail};
use super::question::WeekQuantity;
use super::shapley::shapley_values;
use super::visibility::InputVisibility;
use super::week_resimulation::{ExcludedCauses, RemovableCause, WeekResimulation};
use novamind_record::figures::SimulatedWeek;
use novamind_tools::Rejection;

/// Maximum number of causes that are evaluated separately. This maximum limits the number of simulations.
const MAX_VALUED_CAUSES: usize = 6;

/// An explanation of the change in a figure from one week to the next.
#[derive(Debug, Clone, PartialEq)]
pub struct ChangeExplanation {
    /// Number of the explained week.
    pub week: u32,
    /// The figure whose change is explained.
    pub quantity: WeekQuantity,
    /// Number of days in the previous week and in the explained week. The last week of a run can be shorter.
    pub days: [u32; 2],
    /// Value of the figure in the previous week.
    pub before: f64,
    /// Value of the figure in the explained week.
    pub after: f64,
    /// Contributions of the causes, in descending order of their absolute value.
    pub contributions: Vec<CauseContribution>,
    /// Part of the change that no cause explains, in the unit of the figure.
    pub residual: f64,
    /// Number of weeks that were re-simulated for the explanation.
    pub simulation_count: usize,
}

impl ChangeExplanation {
    /// Returns the change in the figure between the two weeks.
    pub fn total_change(&self) -> f64 {
        self.after - self.before
    }
}

/// The contribution of one cause to the change in a figure.
#[derive(Debug, Clone, PartialEq)]
pub struct CauseContribution {
    /// Cause that contributed to the change in the figure.
    pub cause: Cause,
    /// Contribution of the cause to the change, in the unit of the figure.
    pub amount: f64,
    /// Settings and inputs that belong to the cause and differ between the two weeks.
    pub details: Vec<CauseDetail>,
}

/// A group of causes that are evaluated together.
#[derive(Clone)]
struct CauseGroup {
    cause: Cause,
    /// Bit mask of the members: a bit's position is the index of a member in the list of calls or in the list of
    /// inputs.
    members: u32,
    details: Vec<CauseDetail>,
}

impl WeekResimulation {
    /// Explains why a figure changed. Returns `None` if `progress` stopped the simulations.
    ///
    /// # Errors
    /// `no_value` if the figure has no value in one of the two weeks.
    pub(super) fn explain(
        &mut self,
        quantity: WeekQuantity,
        progress: CauseProgressFn<'_>,
    ) -> Result<Option<ChangeExplanation>, Rejection> {
        let after = self.week_without(ExcludedCauses { calls: 0, inputs: 0 });
        let values = (quantity.value_in(self.week_before()), quantity.value_in(after));
        if values.0.is_nan() || values.1.is_nan() {
            let message = format!(
                "{} has no value in one of the two weeks, because there was nothing to count",
                quantity.name()
            );
            return Err(Rejection::for_field("figure", "no_value", message));
        }
        let (mut calls, mut inputs) = (singleton_groups(&self.calls), self.input_groups());
        let joined = self.merge_smallest_groups(quantity, &mut calls, &mut inputs, progress);
        let Some(mut parts) =
            joined.and_then(|()| self.compute_contributions(quantity, &calls, &inputs, progress))
        else {
            return Ok(None);
        };
        let all_calls = ExcludedCauses { calls: all_members(&calls), inputs: all_members(&inputs) };
        // One-time purchases of the previous week are not paid for again in the explained week.
        let earlier = value_or_zero(quantity, &self.week_before().without_purchases()) - values.0;
        if earlier != 0.0 {
            let cause = Cause::EarlierPurchases;
            parts.push(CauseContribution { cause, amount: earlier, details: Vec::new() });
        }
        let rest = value_or_zero(quantity, self.week_without(all_calls)) - values.0 - earlier;
        let continued = if rest == 0.0 {
            Vec::new()
        } else {
            let Some(continued) = self.continued_contributions(quantity, progress) else { return Ok(None) };
            continued
        };
        let rest = rest - continued.iter().map(|part| part.amount).sum::<f64>();
        parts.extend(continued);
        parts.sort_by(|left, right| right.amount.abs().total_cmp(&left.amount.abs()));
        let simulations = self.simulation_count();
        let (before, after) = values;
        let (week, days) = (self.week(), self.days());
        Ok(Some(ChangeExplanation {
            week,
            quantity,
            days,
            before,
            after,
            contributions: parts,
            residual: rest,
            simulation_count: simulations,
        }))
    }

    /// Returns the world inputs at the level of detail that the player may see.
    fn input_groups(&self) -> Vec<CauseGroup> {
        let all = singleton_groups(&self.inputs);
        if self.visibility == InputVisibility::EveryInput {
            return all;
        }
        let (service, hidden): (Vec<CauseGroup>, Vec<CauseGroup>) =
            all.into_iter().partition(|group| group.cause == Cause::Service);
        let details = vec![CauseDetail::HiddenInputs];
        let market = CauseGroup { cause: Cause::Market, members: all_members(&hidden), details };
        (!hidden.is_empty()).then_some(market).into_iter().chain(service).collect()
    }

    /// Merges the causes with the smallest contributions until [`MAX_VALUED_CAUSES`] remain.
    fn merge_smallest_groups(
        &mut self,
        quantity: WeekQuantity,
        calls: &mut Vec<CauseGroup>,
        inputs: &mut Vec<CauseGroup>,
        progress: CauseProgressFn<'_>,
    ) -> Option<()> {
        if calls.len() + inputs.len() <= MAX_VALUED_CAUSES {
            return Some(());
        }
        let all_calls = all_members(calls);
        let exclusion_for_call = |group: &CauseGroup| ExcludedCauses { calls: group.members, inputs: 0 };
        let exclusion_for_input =
            |group: &CauseGroup| ExcludedCauses { calls: all_calls, inputs: group.members };
        let undone = ExcludedCauses { calls: all_calls, inputs: 0 };
        let wanted: Vec<ExcludedCauses> = calls
            .iter()
            .map(exclusion_for_call)
            .chain(inputs.iter().map(exclusion_for_input))
            .chain([undone])
            .collect();
        self.simulate_missing(&wanted, progress)?;
        let value = |without| value_or_zero(quantity, self.week_without(without));
        let actual = value(ExcludedCauses { calls: 0, inputs: 0 });
        let by_size = |groups: &mut Vec<CauseGroup>, size: &dyn Fn(&CauseGroup) -> f64| {
            groups.sort_by(|left, right| size(right).abs().total_cmp(&size(left).abs()));
        };
        by_size(calls, &|group| actual - value(exclusion_for_call(group)));
        by_size(inputs, &|group| value(undone) - value(exclusion_for_input(group)));
        while calls.len() + inputs.len() > MAX_VALUED_CAUSES {
            if calls.len() >= inputs.len() {
                merge_last_two(calls, Cause::OtherCalls);
            } else {
                merge_last_two(inputs, Cause::OtherInputs);
            }
        }
        Some(())
    }

    fn compute_contributions(
        &mut self,
        quantity: WeekQuantity,
        calls: &[CauseGroup],
        inputs: &[CauseGroup],
        progress: CauseProgressFn<'_>,
    ) -> Option<Vec<CauseContribution>> {
        let all_calls = all_members(calls);
        // In `acting`, the bit of each active cause is set. All other causes are removed.
        let exclusions_for_calls =
            |acting: u32| ExcludedCauses { calls: excluded_members(calls, acting), inputs: 0 };
        let exclusions_for_inputs =
            |acting: u32| ExcludedCauses { calls: all_calls, inputs: excluded_members(inputs, acting) };
        let sets = |groups: &[CauseGroup]| 0..1u32 << groups.len();
        let wanted: Vec<ExcludedCauses> =
            sets(calls).map(exclusions_for_calls).chain(sets(inputs).map(exclusions_for_inputs)).collect();
        self.simulate_missing(&wanted, progress)?;
        let values_of_calls = shapley_values(calls.len(), |set| {
            value_or_zero(quantity, self.week_without(exclusions_for_calls(set)))
        });
        let values_of_inputs = shapley_values(inputs.len(), |set| {
            value_or_zero(quantity, self.week_without(exclusions_for_inputs(set)))
        });
        let groups = calls.iter().zip(values_of_calls).chain(inputs.iter().zip(values_of_inputs));
        let part = |(group, amount): (&CauseGroup, f64)| CauseContribution {
            cause: group.cause,
            amount,
            details: group.details.clone(),
        };
        Some(groups.map(part).collect())
    }
}

/// Returns the value of a figure in a simulated week, or 0 if the figure has no value.
fn value_or_zero(quantity: WeekQuantity, week: &SimulatedWeek) -> f64 {
    let value = quantity.value_in(week);
    if value.is_nan() { 0.0 } else { value }
}

fn singleton_groups(candidates: &[RemovableCause]) -> Vec<CauseGroup> {
    let group = |(at, candidate): (usize, &RemovableCause)| CauseGroup {
        cause: candidate.cause,
        members: 1 << at,
        details: candidate.details.clone(),
    };
    candidates.iter().enumerate().map(group).collect()
}

fn all_members(groups: &[CauseGroup]) -> u32 {
    groups.iter().fold(0, |all, group| all | group.members)
}

/// Returns the members of all groups whose bit in `acting` is not set.
fn excluded_members(groups: &[CauseGroup], acting: u32) -> u32 {
    let without = groups.iter().enumerate().filter(|(at, _)| acting & (1 << at) == 0);
    without.fold(0, |all, (_, group)| all | group.members)
}

fn merge_last_two(groups: &mut Vec<CauseGroup>, cause: Cause) {
    let (Some(last), Some(before)) = (groups.pop(), groups.pop()) else { return };
    let details = before.details.into_iter().chain(last.details).collect();
    groups.push(CauseGroup { cause, members: before.members | last.members, details });
}
