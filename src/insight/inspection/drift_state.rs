//! Accumulated drift of expectations and budgets by group, and the next drift.

use super::inspector::Inspector;
use novamind_session::InspectionPermit;
use novamind_tools::Rejection;
use novamind_world::customers::drift::{Expectation, global_drift_step, group_drift_step, next_drift_day};
use novamind_world::identifiers::Group;

/// The state of drift in a group.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GroupDriftState {
    /// The group whose drift is described.
    pub group: Group,
    /// Whether the group had been discovered by the day.
    pub is_known: bool,
    /// Increase in the group's expectations due to drift and competitors, beyond the common increase.
    pub group_expectation: f64,
    /// Total shift of the group's curves: required quality, including the common increase, and budget in $ per month.
    pub expectation: Expectation,
    /// Next drift of the group's curves, beyond the common increase.
    pub next_step: Expectation,
}

/// Drift of expectations and budgets at the end of a day.
#[derive(Debug, Clone, PartialEq)]
pub struct DriftState {
    /// Day of the state, from 1.
    pub day: u32,
    /// Increase in the expectations of all groups due to drift and competitors.
    pub common_expectation: f64,
    /// Next change in [`DriftState::common_expectation`].
    pub next_common_step: f64,
    /// Day of the next drift; `None` if no drift follows before the end of the run.
    pub next_day: Option<u32>,
    /// State of each group, in the fixed order of the groups.
    pub groups: Vec<GroupDriftState>,
}

impl Inspector<'_> {
    /// Returns the drift of expectations and budgets at the end of a day, by default the last day. Records the
    /// inspection in the trajectory.
    ///
    /// # Errors
    /// `not_in_this_mode`, `day_unknown`, `not_possible`, `not_readable`, `not_saved`.
    pub fn drift_state(&mut self, day: Option<u32>) -> Result<DriftState, Rejection> {
        let permit = InspectionPermit::start(self.run, "drift", "", day)?;
        let day = permit.day();
        let seen = self.hidden_day(&permit, day)?;
        let (params, days) = (permit.hidden_state(self.run).params(), self.run.manifest().days);
        let group = |group: Group| GroupDriftState {
            group,
            is_known: seen.known_groups[group],
            group_expectation: seen.market.drift.quality[group],
            expectation: seen.market.drift.expectation(group),
            next_step: group_drift_step(group, params),
        };
        let next = next_drift_day(day, &params.drift);
        Ok(DriftState {
            day,
            common_expectation: seen.market.drift.global_quality,
            next_common_step: global_drift_step(&params.drift),
            next_day: Some(next).filter(|next| *next <= days),
            groups: Group::all().map(group).collect(),
        })
    }
}
