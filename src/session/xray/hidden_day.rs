//! What is kept of a day that was watched.

use std::sync::{Mutex, MutexGuard, PoisonError};

use super::quality_equation::QualityDay;
use super::reputation_equation::ReputationDay;
use super::satisfaction_equation::{MoodSums, MoodsByBlock, SatisfactionDay};
use crate::world::context::DayContext;
use crate::world::customers::columns::Block;
use crate::world::day::watch::{DayWatch, SettledReputation};
use crate::world::events::Facts;
use crate::world::identifiers::{ByGroup, Group};
use crate::world::market::arrivals::{Arrivals, lead_context};
use crate::world::market::drift::DriftTotals;
use crate::world::market::leads::{LeadFactors, word_of_mouth};
use crate::world::market::reputation::ReputationBook;
use crate::world::morning::Morning;
use crate::world::params::Params;
use crate::world::state::World;

/// A day, as far as groups and the market go.
#[derive(Debug, Clone, Default)]
pub(in crate::session) struct HiddenDay {
    /// Which groups were known.
    pub(in crate::session) known: ByGroup<bool>,
    /// Factors of the leads.
    pub(in crate::session) leads: ByGroup<LeadFactors>,
    /// Leads by word of mouth before the factors, by the group whose subscribers bring them.
    pub(in crate::session) word_of_mouth: ByGroup<Vec<(Group, f64)>>,
    /// Leads that came.
    pub(in crate::session) came: ByGroup<u32>,
    /// What quality was made of.
    pub(in crate::session) quality: QualityDay,
    /// What moved satisfaction.
    pub(in crate::session) satisfaction: ByGroup<SatisfactionDay>,
    /// What moved reputations.
    pub(in crate::session) reputation: ReputationDay,
    /// What rivals could copy in the evening.
    pub(in crate::session) banks: Banks,
    /// How much expectations and budgets had moved in the evening.
    pub(in crate::session) drift: DriftTotals,
}

/// Improvements, and how much of them no rival has copied.
#[derive(Debug, Clone, Default)]
pub(in crate::session) struct Banks {
    /// Quality gained for everybody.
    pub(in crate::session) shared_bonus: f64,
    /// What is left of it to be copied.
    pub(in crate::session) shared: f64,
    /// Quality gained for single groups.
    pub(in crate::session) group_bonus: ByGroup<f64>,
    /// What is left of that.
    pub(in crate::session) own: ByGroup<f64>,
}

/// Keeps every day that is simulated.
#[derive(Debug, Default)]
pub(in crate::session) struct Diary {
    pages: Mutex<Pages>,
}

#[derive(Debug, Default)]
struct Pages {
    /// Days that are over, day 1 first.
    days: Vec<HiddenDay>,
    /// The day that is simulated.
    today: HiddenDay,
    /// What satisfaction moved by, block by block.
    moods: MoodsByBlock,
    /// Reputations of the morning.
    morning: Option<ReputationBook>,
    /// What development has gained for everybody so far.
    development: f64,
}

impl Diary {
    /// A day that is over, from 1.
    pub(in crate::session) fn day(&self, day: u32) -> Option<HiddenDay> {
        self.pages().days.get(day.checked_sub(1)? as usize).cloned()
    }

    fn pages(&self) -> MutexGuard<'_, Pages> {
        self.pages.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl DayWatch for Diary {
    fn morning_came(&self, world: &World, morning: &Morning, params: &Params) {
        let pages = &mut *self.pages();
        pages.today.quality = QualityDay::of(world, morning, params, &mut pages.development);
        pages.morning = Some(world.market.reputation.clone());
    }

    fn before_moods(&self, group: Group, block: &Block, day: &DayContext<'_>) {
        let Some(first) = block.n.first() else { return };
        let sums = MoodSums::of(group, block, day);
        self.pages().moods.insert((group, *first), sums);
    }

    fn reputation_settled(&self, settled: &SettledReputation<'_>) {
        let mut pages = self.pages();
        let Some(morning) = pages.morning.take() else { return };
        pages.today.reputation = ReputationDay::of(&morning, settled);
    }

    fn leads_expected(
        &self,
        arrivals: &Arrivals<'_>,
        subscribers: &ByGroup<u32>,
        factors: &ByGroup<LeadFactors>,
    ) {
        let context = lead_context(arrivals, subscribers);
        let known = ByGroup::from_fn(|group| arrivals.market.is_known(group));
        let mut pages = self.pages();
        pages.today.word_of_mouth = ByGroup::from_fn(|group| match known[group] {
            true => word_of_mouth(group, &context).collect(),
            false => Vec::new(),
        });
        (pages.today.known, pages.today.leads) = (known, *factors);
        pages.today.quality.service_penalty = arrivals.day.service_penalty;
    }

    fn day_over(&self, world: &World, params: &Params, facts: &Facts) {
        let mut pages = self.pages();
        facts.arrivals.iter().for_each(|arrival| pages.today.came[arrival.group] += 1);
        let mut left = ByGroup::default();
        facts.endings.iter().for_each(|ending| left[ending.group] += 1);
        let moods = std::mem::take(&mut pages.moods);
        let weight = params.satisfaction.satisfaction_ema_alpha;
        let mut today = std::mem::take(&mut pages.today);
        today.satisfaction = SatisfactionDay::by_group(&moods, &left, &world.customers, weight);
        today.banks = Banks {
            shared_bonus: world.product.shared_bonus,
            shared: world.product.shared_bank,
            group_bonus: world.product.group_bonus,
            own: world.product.group_bank,
        };
        today.drift = world.market.drift.clone();
        pages.days.push(today);
    }
}
