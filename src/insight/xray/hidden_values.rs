//! What an evening really was, beside which screens show figures and estimates.

use super::hidden_day::HiddenDay;
use super::inspector::Inspector;
use super::rival_state::{NextRivalMove, rival_move_after};
use novamind_session::Look;
use novamind_tools::Refusal;
use novamind_world::customers::drift::next_drift_day;
use novamind_world::identifiers::{ByGroup, Group};

/// A group on an evening.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrueGroup {
    /// Whether it was known: an unknown one brings no leads.
    pub is_known: bool,
    /// Reputation.
    pub reputation: f64,
    /// Mean satisfaction of its subscribers; none without any.
    pub satisfaction: Option<f64>,
    /// Leads that were expected of it on the day.
    pub expected_leads: f64,
    /// Mean budget of customers who come, dollars a month, of companies per seat, with what the market has added.
    pub budget: f64,
    /// Mean quality floor of customers who come, with what the market has added.
    pub quality_floor: f64,
    /// Customers or companies that its market holds; without a size, and so without a limit, at 0.
    pub market_cap: f64,
}

/// The groups and the market on the evening of a day.
#[derive(Debug, Clone, PartialEq)]
pub struct HiddenValues {
    /// The day, from 1.
    pub day: u32,
    /// The groups.
    pub groups: ByGroup<TrueGroup>,
    /// Shared quality that no rival has copied.
    pub shared_bank: f64,
    /// Quality of single groups that no rival has copied; those with any.
    pub own_banks: Vec<(Group, f64)>,
    /// The next move of rivals; none before the end of the run.
    pub next_move: Option<NextRivalMove>,
    /// What rivals and drift have added to everyone's expectations.
    pub everyone: f64,
    /// Day on which drift is applied next; none before the end of the run.
    pub next_drift: Option<u32>,
    /// The index of the economy.
    pub pmi: f64,
}

impl Inspector<'_> {
    /// What the evening of a day really was, the last one if none is named. The look is recorded.
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
