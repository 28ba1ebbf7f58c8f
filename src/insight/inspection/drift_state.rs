//! Accumulated drift of expectations and budgets by group, and the next application of drift.

use super::inspector::Inspector;
use novamind_session::InspectionPermit;
use novamind_tools::Rejection;
use novamind_world::customers::drift::{Expectation, global_drift_step, group_drift_step, next_drift_day};
use novamind_world::identifiers::Group;

/// The drift of a group.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GroupDriftState {
    /// The group.
    pub group: Group,
    /// Whether the group was discovered.
    pub is_known: bool,
    /// Addition to the group's expectations beyond the common one, by drift and by competitors.
    pub group_expectation: f64,
    /// Addition to its curves: quality including the common one, and dollars a month for budgets.
    pub expectation: Expectation,
    /// Next change of the group's addition beyond the common one.
    pub next_step: Expectation,
}

/// Expectations and budgets at the end of a day.
#[derive(Debug, Clone, PartialEq)]
pub struct DriftState {
    /// The day, from 1.
    pub day: u32,
    /// Common addition to expectations, by drift and by competitors.
    pub common_expectation: f64,
    /// Next change of the common addition.
    pub next_common_step: f64,
    /// Day of the next application; `None` if there is none before the end of the run.
    pub next_day: Option<u32>,
    /// The groups, in their fixed order.
    pub groups: Vec<GroupDriftState>,
}

impl Inspector<'_> {
    /// Returns expectations and budgets at the end of a day, by default the last one. Records the inspection.
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
