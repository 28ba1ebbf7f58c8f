//! True values at the end of a day. Screens show these values next to figures and estimates.

use super::competitor_state::{NextCompetitorMove, next_competitor_move};
use super::hidden_day::HiddenDay;
use super::inspector::Inspector;
use novamind_session::InspectionPermit;
use novamind_tools::Rejection;
use novamind_world::customers::drift::next_drift_day;
use novamind_world::identifiers::{ByGroup, Group};

/// True values of a group at the end of a day.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrueGroupValues {
    /// Whether the group had been discovered by the day. Undiscovered groups have no leads.
    pub is_known: bool,
    /// Reputation of the company in the group.
    pub reputation: f64,
    /// Mean satisfaction of the group's subscribers; `None` if there are no subscribers.
    pub satisfaction: Option<f64>,
    /// Expected number of leads on the day.
    pub expected_leads: f64,
    /// Mean budget of new customers, including drift, $ per month; for enterprises, per seat.
    pub budget: f64,
    /// Mean quality floor of new customers, including the increase due to drift and competitors.
    pub quality_floor: f64,
    /// Market cap of the group, in customers; 0 means no limit.
    pub market_cap: f64,
}

/// True values of the groups and the market at the end of a day.
#[derive(Debug, Clone, PartialEq)]
pub struct HiddenValues {
    /// Day of the values, from 1.
    pub day: u32,
    /// True values of each group.
    pub groups: ByGroup<TrueGroupValues>,
    /// Quality gain for all groups that competitors have not copied.
    pub shared_bank: f64,
    /// Targeted quality that competitors have not copied, for each group with targeted development.
    pub group_banks: Vec<(Group, f64)>,
    /// Next competitor move; `None` if no move follows before the end of the run.
    pub next_competitor_move: Option<NextCompetitorMove>,
    /// Increase in the expectations of all groups due to competitors and drift.
    pub common_expectation: f64,
    /// Day of the next drift; `None` if no drift follows before the end of the run.
    pub next_drift_day: Option<u32>,
    /// Index of the economy (PMI) at the end of the day.
    pub pmi: f64,
}

impl Inspector<'_> {
    /// Returns the true values at the end of a day, by default the last day. Records the inspection in the trajectory.
    ///
    /// # Errors
    /// `not_in_this_mode`, `day_unknown`, `not_possible`, `not_readable`, `not_saved`.
    pub fn hidden_values(&mut self, day: Option<u32>) -> Result<HiddenValues, Rejection> {
        let permit = InspectionPermit::start(self.run, "values", "", day)?;
        let day = permit.day();
        let seen = self.hidden_day(&permit, day)?;
        let group_banks = seen.banks.group_banks;
        let next_drift = next_drift_day(day, &permit.hidden_state(self.run).params().drift);
        Ok(HiddenValues {
            day,
            groups: ByGroup::from_fn(|group| true_group_values(group, &seen)),
            shared_bank: seen.banks.shared,
            group_banks: Group::all()
                .map(|group| (group, group_banks[group]))
                .filter(|(_, bank)| *bank != 0.0)
                .collect(),
            next_competitor_move: next_competitor_move(permit.hidden_state(self.run), day, &group_banks),
            common_expectation: seen.market.drift.global_quality,
            next_drift_day: Some(next_drift).filter(|next| *next <= self.run.manifest().days),
            pmi: seen.market.pmi,
        })
    }
}

fn true_group_values(group: Group, seen: &HiddenDay) -> TrueGroupValues {
    let day_end = &seen.groups[group];
    TrueGroupValues {
        is_known: seen.known_groups[group],
        reputation: day_end.reputation,
        satisfaction: day_end.mean_satisfaction_and_relationship.map(|(satisfaction, _)| satisfaction),
        expected_leads: seen.lead_factors[group].expected(),
        budget: day_end.budget,
        quality_floor: day_end.quality_floor,
        market_cap: day_end.market_cap,
    }
}
