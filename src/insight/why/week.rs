//! The causes of a change, with contributions from simulations without them.

use super::OnProgress;
use super::access::Sight;
use super::cause::{Cause, Detail};
use super::laboratory::{Candidate, Laboratory, Without};
use super::quantity::WeekQuantity;
use super::shapley::shapley;
use novamind_record::figures::SimulatedWeek;
use novamind_tools::Refusal;

/// Maximum number of separate causes, which limits the number of simulations.
const MOST: usize = 6;

/// Why a figure changed in a week.
#[derive(Debug, Clone, PartialEq)]
pub struct Why {
    /// The week.
    pub week: u32,
    /// The figure.
    pub quantity: WeekQuantity,
    /// Number of days of the week before and of the week; the last week of a run can be shorter.
    pub days: [u32; 2],
    /// Value in the week before.
    pub before: f64,
    /// Value in the week.
    pub after: f64,
    /// Contributions of causes, the largest first.
    pub parts: Vec<WhyPart>,
    /// Residual that no cause explains: composition and chance.
    pub rest: f64,
    /// Number of re-simulated weeks.
    pub simulations: usize,
}

impl Why {
    /// Returns the change between the two weeks.
    pub fn change(&self) -> f64 {
        self.after - self.before
    }
}

/// The contribution of a cause.
#[derive(Debug, Clone, PartialEq)]
pub struct WhyPart {
    /// The cause.
    pub cause: Cause,
    /// Contribution to the change, in the unit of the figure.
    pub amount: f64,
    /// Differences of the cause.
    pub details: Vec<Detail>,
}

/// Causes that are evaluated together.
#[derive(Clone)]
struct Group {
    cause: Cause,
    /// Their indices in the laboratory, one bit for each.
    members: u32,
    details: Vec<Detail>,
}

impl Laboratory {
    /// Explains why a figure changed. Returns `None` if stopped.
    ///
    /// # Errors
    /// `no_value` if the figure has no value in one of the two weeks.
    pub(super) fn why(
        &mut self,
        quantity: WeekQuantity,
        progress: OnProgress<'_>,
    ) -> Result<Option<Why>, Refusal> {
        let after = self.without(Without { calls: 0, inputs: 0 });
        let values = (quantity.of(self.week_before()), quantity.of(after));
        if values.0.is_nan() || values.1.is_nan() {
            let message = format!(
                "{} has no value in one of the two weeks, because there was nothing to count",
                quantity.name()
            );
            return Err(Refusal::at("figure", "no_value", message));
        }
        let (mut calls, mut inputs) = (groups(&self.calls), self.groups_of_inputs());
        let joined = self.join_least(quantity, &mut calls, &mut inputs, progress);
        let Some(mut parts) = joined.and_then(|()| self.value(quantity, &calls, &inputs, progress)) else {
            return Ok(None);
        };
        let all_calls = Without { calls: union(&calls), inputs: union(&inputs) };
        // One-time payments of the week before do not recur in this week.
        let earlier = read(quantity, &self.week_before().without_purchases()) - values.0;
        if earlier != 0.0 {
            let cause = Cause::EarlierPurchases;
            parts.push(WhyPart { cause, amount: earlier, details: Vec::new() });
        }
        parts.sort_by(|left, right| right.amount.abs().total_cmp(&left.amount.abs()));
        let rest = read(quantity, self.without(all_calls)) - values.0 - earlier;
        let simulations = self.simulated();
        let (before, after) = values;
        let (week, days) = (self.week(), self.days());
        Ok(Some(Why { week, quantity, days, before, after, parts, rest, simulations }))
    }

    /// Returns the inputs in the permitted level of detail.
    fn groups_of_inputs(&self) -> Vec<Group> {
        let all = groups(&self.inputs);
        if self.sight == Sight::All {
            return all;
        }
        let (service, hidden): (Vec<Group>, Vec<Group>) =
            all.into_iter().partition(|group| group.cause == Cause::Service);
        let market = Group { cause: Cause::Market, members: union(&hidden), details: Vec::new() };
        (!hidden.is_empty()).then_some(market).into_iter().chain(service).collect()
    }

    /// Joins the causes with the smallest contributions until the maximum number is reached.
    fn join_least(
        &mut self,
        quantity: WeekQuantity,
        calls: &mut Vec<Group>,
        inputs: &mut Vec<Group>,
        progress: OnProgress<'_>,
    ) -> Option<()> {
        if calls.len() + inputs.len() <= MOST {
            return Some(());
        }
        let all_calls = union(calls);
        let of_call = |group: &Group| Without { calls: group.members, inputs: 0 };
        let of_input = |group: &Group| Without { calls: all_calls, inputs: group.members };
        let undone = Without { calls: all_calls, inputs: 0 };
        let wanted: Vec<Without> =
            calls.iter().map(of_call).chain(inputs.iter().map(of_input)).chain([undone]).collect();
        self.find_out(&wanted, progress)?;
        let value = |without| read(quantity, self.without(without));
        let actual = value(Without { calls: 0, inputs: 0 });
        let by_size = |groups: &mut Vec<Group>, size: &dyn Fn(&Group) -> f64| {
            groups.sort_by(|left, right| size(right).abs().total_cmp(&size(left).abs()));
        };
        by_size(calls, &|group| actual - value(of_call(group)));
        by_size(inputs, &|group| value(undone) - value(of_input(group)));
        while calls.len() + inputs.len() > MOST {
            if calls.len() >= inputs.len() {
                join_last_two(calls, Cause::OtherCalls);
            } else {
                join_last_two(inputs, Cause::OtherInputs);
            }
        }
        Some(())
    }

    fn value(
        &mut self,
        quantity: WeekQuantity,
        calls: &[Group],
        inputs: &[Group],
        progress: OnProgress<'_>,
    ) -> Option<Vec<WhyPart>> {
        let all_calls = union(calls);
        // Sets contain the active causes; all others are removed.
        let of_calls = |acting: u32| Without { calls: absent(calls, acting), inputs: 0 };
        let of_inputs = |acting: u32| Without { calls: all_calls, inputs: absent(inputs, acting) };
        let sets = |groups: &[Group]| 0..1u32 << groups.len();
        let wanted: Vec<Without> = sets(calls).map(of_calls).chain(sets(inputs).map(of_inputs)).collect();
        self.find_out(&wanted, progress)?;
        let values_of_calls = shapley(calls.len(), |set| read(quantity, self.without(of_calls(set))));
        let values_of_inputs = shapley(inputs.len(), |set| read(quantity, self.without(of_inputs(set))));
        let groups = calls.iter().zip(values_of_calls).chain(inputs.iter().zip(values_of_inputs));
        let part = |(group, amount): (&Group, f64)| WhyPart {
            cause: group.cause,
            amount,
            details: group.details.clone(),
        };
        Some(groups.map(part).collect())
    }
}

/// Returns a figure of a simulated week; 0 instead of NaN, for example a share of zero.
fn read(quantity: WeekQuantity, week: &SimulatedWeek) -> f64 {
    let value = quantity.of(week);
    if value.is_nan() { 0.0 } else { value }
}

fn groups(candidates: &[Candidate]) -> Vec<Group> {
    let group = |(at, own): (usize, &Candidate)| Group {
        cause: own.cause,
        members: 1 << at,
        details: own.details.clone(),
    };
    candidates.iter().enumerate().map(group).collect()
}

fn union(groups: &[Group]) -> u32 {
    groups.iter().fold(0, |all, group| all | group.members)
}

/// Returns the members of all groups that are not in a set.
fn absent(groups: &[Group], acting: u32) -> u32 {
    let without = groups.iter().enumerate().filter(|(at, _)| acting & (1 << at) == 0);
    without.fold(0, |all, (_, group)| all | group.members)
}

fn join_last_two(groups: &mut Vec<Group>, cause: Cause) {
    let (Some(last), Some(before)) = (groups.pop(), groups.pop()) else { return };
    let details = before.details.into_iter().chain(last.details).collect();
    groups.push(Group { cause, members: before.members | last.members, details });
}
