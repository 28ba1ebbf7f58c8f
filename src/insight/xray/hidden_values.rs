//! True values at the end of a day, which screens show next to figures and estimates.

use super::hidden_day::HiddenDay;
use super::inspector::Inspector;
use super::rival_state::{NextRivalMove, rival_move_after};
use novamind_session::Look;
use novamind_tools::Refusal;
use novamind_world::customers::drift::next_drift_day;
use novamind_world::identifiers::{ByGroup, Group};

/// True values of a group at the end of a day.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrueGroup {
    /// Whether the group was discovered; other groups have no leads.
    pub is_known: bool,
    /// Reputation.
    pub reputation: f64,
    /// Mean satisfaction of its subscribers; `None` without subscribers.
    pub satisfaction: Option<f64>,
    /// Expected leads of the day.
    pub expected_leads: f64,
    /// Mean budget of new customers, dollars a month (for enterprises per seat), including the market's addition.
    pub budget: f64,
    /// Mean quality floor of new customers, including the market's addition.
    pub quality_floor: f64,
    /// Market cap in customers; 0 means no limit.
    pub market_cap: f64,
}

/// True values of groups and market at the end of a day.
#[derive(Debug, Clone, PartialEq)]
pub struct HiddenValues {
    /// The day, from 1.
    pub day: u32,
    /// The groups.
    pub groups: ByGroup<TrueGroup>,
    /// Shared quality that competitors have not copied.
    pub shared_bank: f64,
    /// Targeted quality that competitors have not copied, for groups that have any.
    pub own_banks: Vec<(Group, f64)>,
    /// Next competitor move; `None` if there is none before the end of the run.
    pub next_move: Option<NextRivalMove>,
    /// Common addition to expectations by competitors and drift.
    pub everyone: f64,
    /// Day of the next drift; `None` if there is none before the end of the run.
    pub next_drift: Option<u32>,
    /// Index of the economy.
    pub pmi: f64,
}

impl Inspector<'_> {
    /// Returns the true values at the end of a day, by default the last one. Records the inspection.
    ///
    /// # Errors
    /// `not_in_this_mode`, `day_unknown`, `not_possible`, `not_readable`, `not_saved`.
    pub fn hidden_values(&mut self, day: Option<u32>) -> Result<HiddenValues, Refusal> {
        let look = Look::begin(self.run, "values", "", day)?;
        let day = look.day();
        let seen = self.hidden_day(&look, day)?;
        let own = seen.banks.own;
        let next_drift = next_drift_day(day, &look.inside(self.run).params().drift);
        Ok(HiddenValues {
            day,
            groups: ByGroup::from_fn(|group| true_group(group, &seen)),
            shared_bank: seen.banks.shared,
            own_banks: Group::all()
                .map(|group| (group, own[group]))
                .filter(|(_, bank)| *bank != 0.0)
                .collect(),
            next_move: rival_move_after(look.inside(self.run), day, &own),
            everyone: seen.market.drift.global_quality,
            next_drift: Some(next_drift).filter(|next| *next <= self.run.manifest().days),
            pmi: seen.market.pmi,
        })
    }
}

fn true_group(group: Group, seen: &HiddenDay) -> TrueGroup {
    let evening = &seen.groups[group];
    TrueGroup {
        is_known: seen.known[group],
        reputation: evening.reputation,
        satisfaction: evening.mood.map(|(satisfaction, _)| satisfaction),
        expected_leads: seen.leads[group].expected(),
        budget: evening.budget,
        quality_floor: evening.quality_floor,
        market_cap: evening.market_cap,
    }
}
