//! Accumulated drift of expectations and budgets by group, and the next application of drift.

use super::inspector::Inspector;
use novamind_session::Look;
use novamind_tools::Refusal;
use novamind_world::customers::drift::{Expectation, next_drift_day, step_of_everyone, step_of_group};
use novamind_world::identifiers::Group;

/// The drift of a group.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GroupDrifted {
    /// The group.
    pub group: Group,
    /// Whether the group was discovered.
    pub is_known: bool,
    /// Addition to the group's expectations beyond the common one, by drift and by competitors.
    pub own: f64,
    /// Addition to its curves: quality including the common one, and dollars a month for budgets.
    pub expectation: Expectation,
    /// Next addition beyond the common one.
    pub step: Expectation,
}

/// Expectations and budgets at the end of a day.
#[derive(Debug, Clone, PartialEq)]
pub struct DriftState {
    /// The day, from 1.
    pub day: u32,
    /// Common addition to expectations, by drift and by competitors.
    pub everyone: f64,
    /// Next common addition.
    pub step: f64,
    /// Day of the next application; `None` if there is none before the end of the run.
    pub next_day: Option<u32>,
    /// The groups, in their fixed order.
    pub groups: Vec<GroupDrifted>,
}

impl Inspector<'_> {
    /// Returns expectations and budgets at the end of a day, by default the last one. Records the inspection.
    ///
    /// # Errors
    /// `not_in_this_mode`, `day_unknown`, `not_possible`, `not_readable`, `not_saved`.
    pub fn drift_state(&mut self, day: Option<u32>) -> Result<DriftState, Refusal> {
        let look = Look::begin(self.run, "drift", "", day)?;
        let day = look.day();
        let seen = self.hidden_day(&look, day)?;
        let (params, days) = (look.inside(self.run).params(), self.run.manifest().days);
        let group = |group: Group| GroupDrifted {
            group,
            is_known: seen.known[group],
            own: seen.market.drift.quality[group],
            expectation: seen.market.drift.expectation(group),
            step: step_of_group(group, params),
        };
        let next = next_drift_day(day, &params.drift);
        Ok(DriftState {
            day,
            everyone: seen.market.drift.global_quality,
            step: step_of_everyone(&params.drift),
            next_day: Some(next).filter(|next| *next <= days),
            groups: Group::all().map(group).collect(),
        })
    }
}
