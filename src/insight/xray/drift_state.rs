//! How far expectations and budgets have moved, group by group, and what the next application of drift adds.

use super::inspector::Inspector;
use novamind_session::Look;
use novamind_tools::Refusal;
use novamind_world::customers::drift::{Expectation, next_drift_day, step_of_everyone, step_of_group};
use novamind_world::identifiers::Group;

/// A group.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GroupDrifted {
    /// The group.
    pub group: Group,
    /// Whether it was known.
    pub is_known: bool,
    /// Added to its expectations beside those of everyone, by drift and by rivals.
    pub own: f64,
    /// Added to its curves: quality with everyone's, dollars a month to budgets.
    pub expectation: Expectation,
    /// What the next application adds beside everyone's.
    pub step: Expectation,
}

/// Expectations and budgets on the evening of a day.
#[derive(Debug, Clone, PartialEq)]
pub struct DriftState {
    /// The day, from 1.
    pub day: u32,
    /// Added to everyone's expectations, by drift and by rivals.
    pub everyone: f64,
    /// What the next application adds to that.
    pub step: f64,
    /// Day of the next application; none before the end of the run.
    pub next_day: Option<u32>,
    /// The groups, in their order.
    pub groups: Vec<GroupDrifted>,
}

impl Inspector<'_> {
    /// Expectations and budgets on the evening of a day, the last one if none is named. The look is recorded.
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
