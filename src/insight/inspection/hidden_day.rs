//! The hidden state of a simulated day, and its recorder.

use std::sync::{Mutex, MutexGuard, PoisonError};

use super::enterprise_thread_day::{EnterpriseThreadDay, evaluate_enterprise_thread};
use super::quality_equation::QualityDay;
use super::reputation_equation::ReputationDay;
use super::satisfaction_equation::{SatisfactionDay, SatisfactionSums, SatisfactionSumsByBlock};
use novamind_session::engine::mean_satisfaction;
use novamind_world::context::DayContext;
use novamind_world::customers::Customers;
use novamind_world::customers::columns::Block;
use novamind_world::customers::drift::DriftTotals;
use novamind_world::day::observer::DayObserver;
use novamind_world::enterprise::{Enterprise, NegotiationContext, Thread};
use novamind_world::events::{Facts, Reading, Sender, Snapshot};
use novamind_world::identifiers::{ByGroup, Group};
use novamind_world::market::Market;
use novamind_world::market::arrivals::{ArrivalContext, lead_context};
use novamind_world::market::competitors::{CompetitorEvent, severity};
use novamind_world::market::economy::Dimension;
use novamind_world::market::leads::{LeadFactors, word_of_mouth};
use novamind_world::morning::Morning;
use novamind_world::params::Params;
use novamind_world::reputation::{ReputationContribution, ReputationWrite};
use novamind_world::state::World;

/// The hidden state of the groups and the market on a day.
#[derive(Debug, Clone, Default)]
pub(crate) struct HiddenDay {
    pub(crate) known_groups: ByGroup<bool>,
    pub(crate) lead_factors: ByGroup<LeadFactors>,
    /// Word-of-mouth leads of each group, by source group, before the lead factors apply.
    pub(crate) word_of_mouth: ByGroup<Vec<(Group, f64)>>,
    pub(crate) arrived_leads: ByGroup<u32>,
    pub(crate) quality: QualityDay,
    /// Components of the day's satisfaction change, by group.
    pub(crate) satisfaction: ByGroup<SatisfactionDay>,
    /// Components of the day's reputation changes.
    pub(crate) reputation: ReputationDay,
    /// Quality that competitors could copy at the end of the day.
    pub(crate) banks: QualityBanks,
    /// Threads that await an answer at the start of the day; empty unless threads are recorded.
    pub(crate) threads: Vec<EnterpriseThreadDay>,
    pub(crate) groups: ByGroup<GroupDayEnd>,
    pub(crate) market: MarketDayEnd,
}

/// Quality gains from improvements, and the parts of the gains that competitors have not copied.
#[derive(Debug, Clone, Default)]
pub(crate) struct QualityBanks {
    /// Quality gain for all groups.
    pub(crate) shared_bonus: f64,
    /// Part of `shared_bonus` that competitors have not copied.
    pub(crate) shared: f64,
    /// Quality gain of each group from targeted development.
    pub(crate) group_bonus: ByGroup<f64>,
    /// Part of `group_bonus` that competitors have not copied.
    pub(crate) group_banks: ByGroup<f64>,
}

#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct GroupDayEnd {
    /// Study level of the group; 0 before the group is discovered.
    pub(crate) info_level: u32,
    pub(crate) active: u32,
    pub(crate) reputation: f64,
    /// Mean satisfaction and mean relationship of active subscriptions; `None` if there are no subscriptions.
    pub(crate) mean_satisfaction_and_relationship: Option<(f64, f64)>,
    /// Number of active subscriptions with an open issue.
    pub(crate) open_issues: u32,
    /// Product quality before the multiplier of the model tier.
    pub(crate) product_quality: f64,
    /// Mean budget of new customers, including drift.
    pub(crate) budget: f64,
    /// Mean quality floor of new customers, including the increase due to drift and competitors.
    pub(crate) quality_floor: f64,
    /// Market cap of the group; 0 means no limit.
    pub(crate) market_cap: f64,
    /// Factor by which the economy changes budgets.
    pub(crate) willingness_to_pay: f64,
    /// Factor by which the economy changes the speed of replies.
    pub(crate) deal_velocity: f64,
    /// Factor by which the economy changes the drift of seats.
    pub(crate) seat_count: f64,
}

#[derive(Debug, Clone, Default)]
pub(crate) struct MarketDayEnd {
    /// Accumulated drift of the curves since day 0.
    pub(crate) drift: DriftTotals,
    /// Competitor event of the day, with its severity.
    pub(crate) event: Option<(CompetitorEvent, &'static str)>,
    /// Value of the economy index (PMI).
    pub(crate) pmi: f64,
    /// Newest measurement of the PMI, and whether it has been published.
    pub(crate) measured: Option<(Reading, bool)>,
}

/// A recorder of the hidden state on every simulated day.
#[derive(Debug, Default)]
pub(crate) struct HiddenDayRecorder {
    /// Whether threads are recorded, which requires evaluating every plan for every negotiating enterprise on each day.
    keeps_threads: bool,
    recorded: Mutex<HiddenDayRecords>,
}

#[derive(Debug, Default)]
struct HiddenDayRecords {
    /// Hidden state of completed days, from day 1.
    days: Vec<HiddenDay>,
    today: HiddenDay,
    /// Sums of satisfaction changes by block of customers.
    satisfaction_sums: SatisfactionSumsByBlock,
    /// Shared quality gain that development has accumulated.
    development_gain: f64,
}

impl HiddenDayRecorder {
    /// Creates an empty recorder that records threads.
    pub(crate) fn with_threads() -> HiddenDayRecorder {
        HiddenDayRecorder { keeps_threads: true, ..HiddenDayRecorder::default() }
    }

    /// Returns whether the recorder records threads.
    pub(crate) fn records_threads(&self) -> bool {
        self.keeps_threads
    }

    /// Calls `look` with the hidden state of a completed day. Days are numbered from 1.
    pub(crate) fn with_day<R>(&self, day: u32, look: impl FnOnce(&HiddenDay) -> R) -> Option<R> {
        self.lock().days.get(day.checked_sub(1)? as usize).map(look)
    }

    /// Returns the hidden state of a completed day. Days are numbered from 1.
    pub(crate) fn day(&self, day: u32) -> Option<HiddenDay> {
        self.with_day(day, HiddenDay::clone)
    }

    /// Removes and returns the threads of a day. They are not copied, because they are too large to be stored twice.
    pub(crate) fn take_threads(&self, day: u32) -> Vec<EnterpriseThreadDay> {
        let at = day.checked_sub(1).map(|at| at as usize);
        let mut pages = self.lock();
        at.and_then(|at| pages.days.get_mut(at))
            .map(|day| std::mem::take(&mut day.threads))
            .unwrap_or_default()
    }

    fn lock(&self) -> MutexGuard<'_, HiddenDayRecords> {
        self.recorded.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl DayObserver for HiddenDayRecorder {
    fn on_morning(&self, world: &World, morning: &Morning, params: &Params) {
        let pages = &mut *self.lock();
        pages.today.quality = QualityDay::new(world, morning, params, &mut pages.development_gain);
        pages.today.reputation = ReputationDay::at_start_of_day(&world.market.reputation);
    }

    fn before_satisfaction(&self, group: Group, block: &Block, day: &DayContext<'_>) {
        let Some(first) = block.n.first() else { return };
        let sums = SatisfactionSums::from_block(group, block, day);
        self.lock().satisfaction_sums.insert((group, *first), sums);
    }

    fn on_reputation_change(&self, write: &ReputationWrite<'_>) {
        self.lock().today.reputation.add_change(write);
    }

    fn after_reputation_changes(
        &self,
        contributions: &ByGroup<ReputationContribution>,
        market: &Market,
        params: &Params,
    ) {
        self.lock().today.reputation.add_subscriber_contributions(contributions, market, params);
    }

    fn before_negotiations(
        &self,
        enterprise: &Enterprise,
        customers: &Customers,
        talks: &NegotiationContext<'_>,
    ) {
        if !self.keeps_threads {
            return;
        }
        let reappearing = talks.day.params.fidelity.reappearing_threads;
        let threads = enterprise.threads.iter().filter(|thread| is_reply_pending(thread, reappearing));
        let seen =
            threads.filter_map(|thread| evaluate_enterprise_thread(thread, enterprise, customers, talks));
        self.lock().today.threads = seen.collect();
    }

    fn on_expected_leads(
        &self,
        arrivals: &ArrivalContext<'_>,
        subscribers: &ByGroup<u32>,
        factors: &ByGroup<LeadFactors>,
    ) {
        let context = lead_context(arrivals, subscribers);
        let known = ByGroup::from_fn(|group| arrivals.market.is_known(group));
        let mut pages = self.lock();
        pages.today.word_of_mouth = ByGroup::from_fn(|group| match known[group] {
            true => word_of_mouth(group, &context).collect(),
            false => Vec::new(),
        });
        (pages.today.known_groups, pages.today.lead_factors) = (known, *factors);
        pages.today.quality.service_penalty = arrivals.day.service_penalty;
    }

    fn on_day_end(&self, world: &World, params: &Params, facts: &Facts) {
        let mut pages = self.lock();
        facts.arrivals.iter().for_each(|arrival| pages.today.arrived_leads[arrival.group] += 1);
        let mut left = ByGroup::default();
        facts.endings.iter().for_each(|ending| left[ending.group] += 1);
        let satisfaction_sums = std::mem::take(&mut pages.satisfaction_sums);
        let weight = params.satisfaction.satisfaction_ema_alpha;
        let mut today = std::mem::take(&mut pages.today);
        today.satisfaction = SatisfactionDay::by_group(&satisfaction_sums, &left, weight);
        today.banks = QualityBanks {
            shared_bonus: world.product.shared_bonus,
            shared: world.product.shared_bank,
            group_bonus: world.product.group_bonus,
            group_banks: world.product.group_bank,
        };
        today.groups = ByGroup::from_fn(|group| group_day_end(group, world, params));
        today.market = market_day_end(world, params);
        pages.days.push(today);
    }
}

/// Returns whether the enterprise's answer in a thread can still have an effect. True if the thread is open, or if the
/// thread has ended and an answer is pending.
fn is_reply_pending(thread: &Thread, reappearing: bool) -> bool {
    thread.is_open() || thread.active_turn(reappearing).is_some_and(|turn| turn.sender == Sender::Agent)
}

fn group_day_end(group: Group, world: &World, params: &Params) -> GroupDayEnd {
    let (market, product) = (&world.market, &world.product);
    let blocks = || world.customers.groups[group].blocks.iter();
    let snapshot = Snapshot::take_snapshot(group, world.day, &market.drift, params);
    let multiplier = |dimension| market.economy.multiplier(group, dimension, params);
    GroupDayEnd {
        info_level: market.knowledge[group].level.into(),
        active: world.customers.groups[group].active_count(),
        reputation: market.reputation.get(group),
        mean_satisfaction_and_relationship: mean_satisfaction(world, group),
        open_issues: blocks().map(Block::open_issues).sum(),
        product_quality: product.quality(group, params),
        budget: snapshot.c_max,
        quality_floor: snapshot.q_min,
        market_cap: snapshot.market_cap,
        willingness_to_pay: multiplier(Dimension::WillingnessToPay),
        deal_velocity: multiplier(Dimension::DealVelocity),
        seat_count: multiplier(Dimension::SeatCount),
    }
}

fn market_day_end(world: &World, params: &Params) -> MarketDayEnd {
    let market = &world.market;
    let newest = market.competitors.last().filter(|event| event.day == world.day);
    let measured = market.economy.latest_measurement().map(|reading| {
        let published = market.economy.published.as_ref();
        (*reading, published.is_some_and(|published| published.measured_day == reading.measured_day))
    });
    MarketDayEnd {
        drift: market.drift.clone(),
        event: newest.map(|event| (*event, severity(event.boost, &params.competitor).id())),
        pmi: market.economy.pmi,
        measured,
    }
}
