//! Causes that continue: settings that act in both weeks, and market changes in the previous week.
//!
//! An unchanged setting can change a figure. Development, for example, raises quality on every day. To evaluate a
//! continuing cause, both weeks are simulated twice, with and without the cause. To remove all other differences
//! between the weeks, the simulations omit the player's calls of the explained week and use the world inputs of the
//! previous week.

use super::CauseProgressFn;
use super::attribution::CauseContribution;
use super::cause::{Cause, CauseDetail};
use super::due_contributions::due_contributions;
use super::inputs::WeekPair;
use super::question::WeekQuantity;
use super::shapley::shapley_values;
use super::week_resimulation::{WeekResimulation, last_simulated_week};
use crate::counterfactual::branch::{BranchOutcome, simulate_branch};
use crate::counterfactual::due_bills::DueByIssue;
use crate::counterfactual::edits::Edits;
use crate::counterfactual::memory_snapshot::MemorySnapshot;
use crate::counterfactual::suspended_setting::SuspendedSetting;
use novamind_record::figures::{SimulatedWeek, WeekFigure};
use novamind_world::customers::drift::is_drift_day;
use novamind_world::fixed_inputs::FixedInputs;
use novamind_world::identifiers::ByGroup;

/// The results of both weeks in a re-simulation.
pub(super) struct TwoWeeks {
    pub weeks: [SimulatedWeek; 2],
    /// Bills that fell due in each week, by group.
    pub due_bills: [ByGroup<DueByIssue>; 2],
}

/// Returns the causes that continue from the previous week: active settings, and the market if it changed that week.
pub(super) fn continued_causes(start: &MemorySnapshot, eve: &MemorySnapshot) -> Vec<Cause> {
    let settings = SuspendedSetting::ALL.into_iter().filter(|setting| setting.is_active(&eve.world.settings));
    let mut causes: Vec<Cause> = settings.map(Cause::Continued).collect();
    let (market, market_before) = (&eve.world.market, &start.world.market);
    let drifted = (start.world.day + 1..=eve.world.day).any(|day| is_drift_day(day, &start.params.drift));
    if drifted || market.competitors.len() != market_before.competitors.len() {
        causes.push(Cause::EarlierMarket);
    }
    causes
}

impl WeekResimulation {
    /// Returns the contributions of the continuing causes and of the due bills to the change in a figure. The causes
    /// that differ between the weeks do not explain these contributions. Returns `None` if `progress` stopped the
    /// simulations.
    pub(super) fn continued_contributions(
        &mut self,
        quantity: WeekQuantity,
        progress: CauseProgressFn<'_>,
    ) -> Option<Vec<CauseContribution>> {
        self.simulate_continued(progress)?;
        // If there is no advertising, the leads are so few and so different that their conversion is mostly due to
        // chance.
        let is_valued = |at: &usize| {
            quantity.figure() != WeekFigure::Conversion
                || self.continued[*at] != Cause::Continued(SuspendedSetting::Advertising)
        };
        let candidates = (0..self.continued.len()).filter(is_valued).collect();
        let change =
            |acting: u32| change_without_purchases(quantity, self.continued_weeks[acting as usize].as_ref());
        let all = (1u32 << self.continued.len()) - 1;
        let valued = causes_with_values(candidates, all, change);
        let amounts = shapley_values(valued.len(), |set| change(included_causes(&valued, all, set)));
        let contribution = |(at, amount): (&usize, f64)| {
            let cause = self.continued[*at];
            CauseContribution { cause, amount, details: vec![self.removed_days(cause)] }
        };
        // The residual is the change in the simulation without any of the valued causes.
        let due = self.continued_weeks[included_causes(&valued, all, 0) as usize]
            .as_ref()
            .map_or(Vec::new(), |weeks| due_contributions(quantity, weeks));
        Some(valued.iter().zip(amounts).map(contribution).chain(due).collect())
    }

    /// Returns the days on which the re-simulations remove a continuing cause.
    fn removed_days(&self, cause: Cause) -> CauseDetail {
        let last = match cause {
            Cause::EarlierMarket => self.start.world.day,
            _ => self.after.final_state.world.day,
        };
        CauseDetail::Removed { first: self.start_before.world.day + 1, last }
    }

    /// Simulates both weeks with every subset of the continuing causes.
    fn simulate_continued(&mut self, progress: CauseProgressFn<'_>) -> Option<()> {
        if self.continued_weeks.is_empty() {
            let sets: Vec<u32> = (0..1u32 << self.continued.len()).collect();
            self.continued_weeks = self.simulate_in_parallel(&sets, progress, |acting, go_on| {
                self.simulate_two_weeks(acting, go_on)
            })?;
        }
        Some(())
    }

    /// Simulates the previous week and the explained week with some of the continuing causes. Omits the player's calls
    /// of the explained week and uses the world inputs of the previous week.
    fn simulate_two_weeks(
        &self,
        acting: u32,
        go_on: &mut dyn FnMut(u32) -> std::ops::ControlFlow<()>,
    ) -> Option<Option<TwoWeeks>> {
        let removed: Vec<Cause> = self
            .continued
            .iter()
            .enumerate()
            .filter(|(at, _)| acting & (1 << at) == 0)
            .map(|(_, cause)| *cause)
            .collect();
        let suspended = |cause: &Cause| match cause {
            Cause::Continued(setting) => Some(*setting),
            _ => None,
        };
        let suspended_settings: Vec<SuspendedSetting> = removed.iter().filter_map(suspended).collect();
        let market = removed.contains(&Cause::EarlierMarket);
        let fixed_inputs = FixedInputs {
            from: self.start_before.world.day + 1,
            competitors: market,
            drift: market,
            ..FixedInputs::default()
        };
        let (eve, end) = (self.start.world.day, self.after.final_state.world.day);
        let edits = Edits {
            suspended_settings: suspended_settings.clone(),
            fixed_inputs,
            counts_due_bills: true,
            ..Edits::default()
        };
        let before = simulate_branch(&self.start_before, &self.steps_before, &edits, eve, go_on)?;
        let dropped_lines = self.calls.iter().flat_map(|call| call.lines.iter().copied()).collect();
        let edits = Edits { suspended_settings, dropped_lines, counts_due_bills: true, ..Edits::default() };
        let free = simulate_branch(&before.final_state, &self.steps, &edits, end, go_on)?;
        let pair = WeekPair { start: &before.final_state, before: &before, after: &free };
        let fixed_inputs = pair.fix_inputs(self.inputs.iter().map(|input| input.cause), &free.days);
        let edits = Edits { fixed_inputs, ..edits };
        let after = simulate_branch(&before.final_state, &self.steps, &edits, end, go_on)?;
        let is_complete = |outcome: &BranchOutcome, day| {
            outcome.lead_overflow.is_none() && outcome.final_state.world.day == day
        };
        let are_complete = is_complete(&before, eve) && is_complete(&after, end);
        let due = |outcome: &BranchOutcome| outcome.due_bills.last().copied().unwrap_or_default();
        Some(are_complete.then(|| TwoWeeks {
            weeks: [
                last_simulated_week(&self.start_before, &before),
                last_simulated_week(&before.final_state, &after),
            ],
            due_bills: [due(&before), due(&after)],
        }))
    }
}

/// Returns the candidates whose removal, alone or together, leaves a change that has a value. If the change has no
/// value without several causes, for example conversion without leads, the causes with the smallest effects are left
/// out. Returns no cause if the change with all causes has no value.
fn causes_with_values(mut candidates: Vec<usize>, all: u32, change: impl Fn(u32) -> f64) -> Vec<usize> {
    let effect = |at: &usize| (change(all) - change(all & !(1 << at))).abs();
    candidates.retain(|at| !effect(at).is_nan());
    candidates.sort_by(|left, right| effect(right).total_cmp(&effect(left)));
    while (1..1u32 << candidates.len()).any(|set| change(included_causes(&candidates, all, !set)).is_nan()) {
        candidates.pop();
    }
    candidates
}

/// Returns all causes except the candidates whose bit is not in `set`.
fn included_causes(candidates: &[usize], all: u32, set: u32) -> u32 {
    let removed = candidates.iter().enumerate().filter(|(bit, _)| set & (1 << bit) == 0);
    all & !removed.fold(0, |mask, (_, at)| mask | 1 << at)
}

/// Returns the change in a figure, apart from one-time purchases of the previous week; NaN if the figure has no value.
fn change_without_purchases(quantity: WeekQuantity, weeks: Option<&TwoWeeks>) -> f64 {
    weeks.map_or(f64::NAN, |TwoWeeks { weeks: [before, after], .. }| {
        quantity.value_in(after) - quantity.value_in(&before.without_purchases())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn causes_without_which_the_change_has_no_value_are_left_out() {
        // Bits of the causes: 0, 1 and 2. The effects are 1, 4 and 2.
        let effects = [1.0, 4.0, 2.0];
        let change =
            |acting: u32| (0..3).filter(|at| acting & (1 << at) != 0).map(|at| effects[at]).sum::<f64>();
        let valued = |change: &dyn Fn(u32) -> f64| causes_with_values(vec![0, 1, 2], 0b111, change);
        assert_eq!(valued(&change), [1, 2, 0], "the largest effect is first");
        let without =
            |causes: u32| move |acting: u32| if acting & causes == 0 { f64::NAN } else { change(acting) };
        assert_eq!(valued(&without(0b010)), [2, 0], "cause 1 cannot be removed");
        assert_eq!(valued(&without(0b101)), [1, 2], "causes 0 and 2 cannot be removed together");
        assert_eq!(valued(&|_| f64::NAN), [0; 0], "the change has no value");
        assert_eq!(included_causes(&[1, 2], 0b111, 0b10), 0b101);
    }
}
