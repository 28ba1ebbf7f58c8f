//! The simulation of one day: read [`step_day`] from top to bottom (`docs/mechanics/day.md`).

pub mod room;
pub mod watch;

use watch::{DayWatch, Unwatched};

use super::canonical::canonical;
use super::context::DayContext;
use super::customers::Customers;
use super::customers::columns::sums;
use super::enterprise::Negotiation;
use super::events::{Category, DayFigures, Facts, LedgerEntry, LedgerNote};
use super::finance::{Finance, pay_running_costs};
use super::held::Held;
use super::identifiers::{ByGroup, ByPlan, Group};
use super::market::economy::Dimension;
use super::market::leads::LeadFactors;
use super::market::social::crowd::{self, Voices};
use super::market::social::opinions::Scene;
use super::market::social::press;
use super::market::{arrivals, competitors, economy, studies, surges, yields};
use super::morning::Morning;
use super::params::Params;
use super::product::ads::AdLoad;
use super::product::{ads, development, research, service, usage};
use super::random::Streams;
use super::retention::billing::{self, Bills};
use super::retention::issues::{self, IssueBatch, Settled};
use super::retention::renewal::{self, Decisions, RenewalContext};
use super::retention::{refresh_block, satisfaction};
use super::state::World;
use crate::customers::drift;
use crate::quality::{TenureTable, service_penalty};
use crate::reputation;
use crate::reputation::{Mood, ReputationWrite};

/// Hidden values of a day for inspections and for comparison with reference figures.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct DayTrace {
    /// Factors of today's leads.
    pub leads: ByGroup<LeadFactors>,
}

canonical! { DayTrace { leads } }

/// Simulates one day and stores what happened in `facts`.
pub fn step_day(
    world: &mut World,
    params: &Params,
    streams: &Streams,
    facts: &mut Facts,
) -> (DayFigures, DayTrace) {
    step_day_watched(world, params, streams, &Held::default(), facts, &Unwatched)
}

/// Simulates one day like [`step_day`], with fixed inputs, and notifies an observer of each step.
pub fn step_day_watched(
    world: &mut World,
    params: &Params,
    streams: &Streams,
    held: &Held,
    facts: &mut Facts,
    watch: &dyn DayWatch,
) -> (DayFigures, DayTrace) {
    world.day += 1;
    let (day, total_days) = (world.day, world.total_days);
    facts.begin(day);

    // Values that stay constant during the day.
    surges::draw_week(day, total_days, &mut world.market.surges, params, streams);
    let morning = morning_of(world, params);
    watch.morning_came(world, &morning, params);
    let World { settings, finance, product, customers, issue_desk, market, enterprise, .. } = world;
    if drift::is_drift_day(day - 1, &params.drift) && !held.holds_drift(day - 1) {
        refresh_requirements(customers, &morning, params);
    }

    // Usage, and the service under that load.
    let metered = usage::meter(customers, &morning, params, facts);
    let service = service::observe(metered.total, &morning, held.service_on(day), params, streams, facts);
    research::complete(day, product, facts);
    studies::complete(day, market, params, facts);

    // The market changes.
    let seats = ByGroup::from_fn(|group| market.economy.multiplier(group, Dimension::SeatCount, params));
    if !held.holds_drift(day) && drift::apply(day, &mut market.drift, customers, &seats, params) {
        refresh_requirements(customers, &morning, params);
    }
    if !held.yields {
        yields::vary(day, &mut market.yields, params, streams);
    }
    economy::step(day, &mut market.economy, held.economy, params, streams, facts);
    if !held.rivals {
        let (events, drift) = (&mut market.competitors, &mut market.drift);
        competitors::react(day, total_days, events, product, drift, params, streams);
    }
    press::write_about_rivals(day, &market.competitors, &mut market.social, params, streams, facts);
    development::improve(day, product, settings, params, streams);

    let today = DayContext {
        morning: &morning,
        settings,
        service: &service,
        service_penalty: service_penalty(service.overload, service.outage, &params.quality),
        ads: &AdLoad::of(&settings.ads_strength, params),
        tenure: &TenureTable::up_to(day, params),
        params,
        streams,
    };

    // Subscribers open issues, update satisfaction, decide and pay; enterprises negotiate.
    let scene = Scene { day: &today, chronicle: &market.social.chronicle };
    let mut felt = feel(customers, &today, &scene, watch);
    let crowd = felt.voices.map(|voices| crowd::listen(voices, customers, &scene, streams));
    issues::allot(&mut felt.calls, settings, customers, issue_desk, &today);
    let judgement = RenewalContext {
        day: &today,
        involuntary: renewal::involuntary_rates(day, params, streams),
        willingness_to_pay: ByGroup::from_fn(|group| {
            market.economy.multiplier(group, Dimension::WillingnessToPay, params)
        }),
    };
    let decided = decide(customers, felt.calls, &judgement, watch);
    issues::record(decided.settled, facts);
    let mut told = |write: &ReputationWrite<'_>| watch.reputation_moved(write);
    let renewals = renewal::conclude(decided.decisions, &mut market.reputation, params, facts, &mut told);
    let talks = Negotiation { day: &today, product, drift: &market.drift };
    watch.before_negotiations(enterprise, customers, &talks);
    let negotiated = enterprise.step(customers, &mut market.reputation, &talks, facts, &mut told);
    let knowledge = market.knowledge;
    let moods = satisfaction::by_group(felt.moods);
    let is_known = |group: Group| knowledge[group].level >= 1;
    reputation::contribute(&mut market.reputation, &moods, is_known, params, &mut told);
    watch.reputation_settled(&moods, market, params);

    // Customers and the press write posts.
    if let Some(mut crowd) = crowd {
        crowd.join(&renewals.gave_up, &negotiated.lost, params);
        crowd.publish(&mut market.social, params, streams, facts);
    }
    press::write_about_the_economy(day, &market.economy, &mut market.social, params, streams, facts);

    // New customers arrive.
    let coming = arrivals::Arrivals { day: &today, market };
    let subscribers = customers.active();
    let mut factors = arrivals::expect(&coming, &subscribers);
    held.hold_leads(day, morning.weekday, &mut factors);
    watch.leads_expected(&coming, &subscribers, &factors);
    let leads = arrivals::arrive(&coming, &factors, customers, enterprise, facts);
    finance.cash -= f64::from(leads.all) * params.leads.lead_acquisition_cost;

    // Payments and costs.
    let received = billing::collect(customers, decided.billed, &today, &negotiated.suspended, facts);
    finance.cash += received;
    let costs = pay_running_costs(finance, &metered, &morning, settings, params, facts);
    earn_from_ads(customers, today.ads, finance, facts);
    market.social.chronicle.write(day, &service, settings, product);

    let figures = DayFigures {
        day,
        total_usage: service.total_usage,
        usage: metered.by_group,
        overload: service.overload,
        outage: service.outage,
        downtime_minutes: service.downtime_minutes,
        p95_ms: service.p95_ms,
        error_rate: service.error_rate,
        new_leads: leads.all,
        new_individual_leads: leads.individuals,
        new_enterprise_leads: leads.companies,
        new_individual_subscribers: leads.subscribed,
        new_enterprise_seats: negotiated.new_seats,
        cancellations: renewals.cancellations,
        upgrades: renewals.upgrades,
        downgrades: renewals.downgrades,
        payments_received: received,
        total_costs: costs,
        ..closing_figures(world)
    };
    watch.day_counted(&figures);
    watch.day_over(world, params, facts);
    (figures, DayTrace { leads: factors })
}

/// Results of the first sweep over subscribers, by block.
struct Felt {
    calls: Vec<IssueBatch>,
    moods: Vec<(Group, Mood)>,
    /// `None` unless customers post today.
    voices: Option<Vec<Voices>>,
}

/// Finds new issues, updates satisfaction, and weighs potential authors on posting days.
fn feel(customers: &mut Customers, day: &DayContext<'_>, scene: &Scene<'_>, watch: &dyn DayWatch) -> Felt {
    let listening = crowd::is_posting_day(day.day(), day.params);
    let felt = customers.sweep(|group, number, block| {
        let calls = issues::read_calls(group, number, block, day);
        let before = listening.then(|| block.satisfaction.clone());
        watch.before_moods(group, block, day);
        let mood = satisfaction::update(group, block, day);
        let voices = before.map(|before| crowd::hear(group, block, before, scene));
        (calls, (group, mood), voices)
    });
    let (calls, moods, voices): (Vec<_>, Vec<_>, Vec<_>) = felt.into_iter().collect();
    Felt { calls, moods, voices: listening.then(|| voices.into_iter().flatten().collect()) }
}

/// Results of the second sweep, by block.
struct Decided {
    settled: Vec<Settled>,
    decisions: Vec<Decisions>,
    billed: Vec<Bills>,
}

/// Settles issues, then lets customers who are due decide; those who stay are billed.
fn decide(
    customers: &mut Customers,
    calls: Vec<IssueBatch>,
    judgement: &RenewalContext<'_>,
    watch: &dyn DayWatch,
) -> Decided {
    let day = judgement.day;
    let decided = customers.sweep_with(calls, |group, number, block, calls| {
        let settled = issues::settle(block, &calls, day);
        watch.before_decisions(group, block, judgement);
        let decisions = renewal::decide(group, number, block, judgement);
        (settled, decisions, billing::bill_regulars(group, number, block, day))
    });
    let (settled, decisions, billed) = decided.into_iter().collect();
    Decided { settled, decisions, billed }
}

/// Returns the values at the start of the world's current day.
pub fn morning_of(world: &World, params: &Params) -> Morning {
    let core = world.settings.core;
    Morning {
        day: world.day,
        core,
        weekday: params.calendar.weekly[(world.day % 7) as usize],
        month_day: params.calendar.monthly[(world.day % 30) as usize],
        quotas: ByPlan::from_fn(|plan| core.quotas[plan].units()),
        multipliers: ByPlan::from_fn(|plan| params.model(core.tiers[plan]).quality_multiplier),
        product: ByGroup::from_fn(|group| world.product.quality(group, params)),
        shared_quality: params.quality.base_product_quality + world.product.shared_bonus,
        expectations: ByGroup::from_fn(|group| world.market.drift.expectation(group)),
        subscribers: world.customers.active(),
    }
}

/// Recomputes the required quality of all subscribers after a change of their curves or their group's budget drift.
fn refresh_requirements(customers: &mut Customers, morning: &Morning, params: &Params) {
    customers.sweep(|group, _, block| refresh_block(group, block, morning, params));
}

fn earn_from_ads(customers: &Customers, ads: &AdLoad<'_>, finance: &mut Finance, facts: &mut Facts) {
    let revenue = ads::earn(customers, ads, facts);
    if revenue > 0.0 {
        let note = LedgerNote::Subscribers(customers.active().iter().sum());
        finance.book(LedgerEntry { category: Category::AdRevenue, amount: revenue, note }, facts);
    }
}

/// Returns cash, recurring revenue, subscribers and seats at the end of the day.
pub fn closing_figures(world: &World) -> DayFigures {
    let (mut mrr, mut individual_subscribers, mut enterprise_seats) = (0.0, 0, 0);
    let blocks: Vec<_> = world.customers.blocks().collect();
    for several in blocks.chunks(4) {
        let prices: [&[f64]; 4] =
            std::array::from_fn(|at| several.get(at).map_or(&[][..], |(_, block)| &block.effective_price));
        for ((group, block), paid) in several.iter().zip(sums(prices)) {
            if group.is_enterprise() {
                let seats = || block.seats.iter().map(|seats| seats.trunc());
                let deals = block.effective_price.iter().zip(seats());
                mrr += deals.map(|(price, seats)| price * seats).sum::<f64>();
                enterprise_seats += seats().sum::<f64>() as u32;
            } else {
                mrr += paid;
                individual_subscribers += block.len() as u32;
            }
        }
    }
    DayFigures {
        day: world.day,
        cash: world.finance.cash,
        mrr,
        individual_subscribers,
        enterprise_seats,
        ..DayFigures::default()
    }
}

#[cfg(test)]
mod extreme_tests;
#[cfg(test)]
mod wiring_tests;

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::morning::tests::morning;
    use crate::test_kit::policy_p;

    fn run(cash: f64, days: u32, prepare: impl Fn(&mut World)) -> Vec<DayFigures> {
        let (params, streams) = (Params::shipped(), Streams::new(42));
        let mut facts = Facts::default();
        let mut world = World::open(500, cash, &params, &mut facts);
        prepare(&mut world);
        (0..days).map(|_| step_day(&mut world, &params, &streams, &mut facts).0).collect()
    }

    #[test]
    fn an_idle_company_pays_85_a_day() {
        let days = run(1_000_000.0, 3, |_| {});
        assert_eq!((days[0].total_costs, days[0].cash), (85.0, 999_915.0));
        assert_eq!(days[2].cash, 999_745.0);
        assert_eq!(run(100.0, 2, |_| {})[1].cash, -70.0);
        assert_eq!(run(85.0, 1, |_| {})[0].cash, 0.0);
    }

    #[test]
    fn a_day_has_the_factors_of_its_weekday_and_of_its_day_of_the_month() {
        for (day, weekday, month_day) in [
            (1, 1.1, 1.15),
            (2, 1.15, 1.15),
            (5, 0.6, 1.0),
            (7, 1.0, 1.0),
            (27, 0.6, 1.1),
            (29, 1.1, 1.1),
            (30, 1.15, 1.15),
            (60, 1.0, 1.15),
        ] {
            let morning = morning(day);
            assert_eq!((morning.weekday, morning.month_day), (weekday, month_day), "day {day}");
        }
    }

    #[test]
    fn a_week_of_policy_p_books_its_fixed_costs() {
        let (params, streams) = (Params::shipped(), Streams::new(42));
        let mut facts = Facts::default();
        let mut world = World::open(500, 1_000_000.0, &params, &mut facts);
        policy_p(&mut world);
        let mut booked = std::collections::BTreeMap::new();
        for _ in 0..7 {
            step_day(&mut world, &params, &streams, &mut facts);
            for entry in &facts.ledger {
                let sum = booked.entry(entry.category.id()).or_insert((0, 0.0));
                *sum = (sum.0 + 1, sum.1 + entry.amount);
            }
        }
        assert_eq!(booked["advertising"], (7, -14_000.0));
        assert_eq!(booked["capacity"], (7, -595.0));
        assert_eq!(booked["development"], (14, -33_600.0));
        assert_eq!(booked["operations"], (7, -2_100.0));
        assert_eq!(booked["compute"].0, 7);
    }

    #[test]
    fn cash_is_the_sum_of_the_ledger_and_counts_agree_with_the_columns() {
        let (params, streams) = (Params::shipped(), Streams::new(7));
        let mut facts = Facts::default();
        let mut world = World::open(500, 1_000_000.0, &params, &mut facts);
        policy_p(&mut world);
        let (mut ledger, mut opened, mut ended) = (1_000_000.0, 0, 0);
        for _ in 0..120 {
            let (figures, _) = step_day(&mut world, &params, &streams, &mut facts);
            ledger -= params.leads.lead_acquisition_cost * facts.arrivals.len() as f64;
            ledger += facts.payments.iter().map(|payment| payment.amount).sum::<f64>();
            ledger += facts.ledger.iter().map(|entry| entry.amount).sum::<f64>();
            opened += facts
                .openings
                .iter()
                .filter(|o| o.status == crate::events::SubscriptionStatus::Subscribed)
                .count();
            ended += facts.endings.iter().filter(|e| !e.group.is_enterprise()).count();
            assert!((figures.cash - ledger).abs() < 1e-6);
            assert_eq!(figures.individual_subscribers as usize, opened - ended);
            assert_eq!(
                facts.usage.iter().map(|rows| rows.units.len()).sum::<usize>()
                    + facts
                        .openings
                        .iter()
                        .filter(|o| o.status == crate::events::SubscriptionStatus::Subscribed)
                        .count()
                    - ended_today(&facts),
                opened - ended
            );
        }
        assert!(opened > 1000 && ended > 100);
    }

    fn ended_today(facts: &Facts) -> usize {
        facts.endings.iter().filter(|ending| !ending.group.is_enterprise()).count()
    }
}
