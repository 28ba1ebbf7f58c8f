//! The simulation of one day. [`step_day_observed`] lists the steps of a day in order (`docs/mechanics/day.md`).

pub mod limits;
pub mod observer;

use observer::{DayObserver, NoObserver};

use super::canonical::canonical;
use super::context::DayContext;
use super::customers::Customers;
use super::customers::columns::sum_columns;
use super::enterprise::NegotiationContext;
use super::events::{Category, DayFigures, Facts, LedgerEntry, LedgerNote};
use super::finance::{Finance, pay_running_costs};
use super::fixed_inputs::FixedInputs;
use super::identifiers::{ByGroup, ByPlan, Group};
use super::market::economy::Dimension;
use super::market::leads::LeadFactors;
use super::market::social::author_selection::{self, BlockWeights};
use super::market::social::opinions::OpinionContext;
use super::market::social::press;
use super::market::{arrivals, competitors, economy, studies, surges, yields};
use super::morning::Morning;
use super::params::Params;
use super::product::ads::AdLoad;
use super::product::{ads, development, research, service, usage};
use super::random::Streams;
use super::retention::billing::{self, BlockBills};
use super::retention::issues::{self, IssueBatch, IssueUpdates};
use super::retention::renewal::{self, BlockDecisions, RenewalContext};
use super::retention::{refresh_block, satisfaction};
use super::state::World;
use crate::customers::drift;
use crate::quality::{TenureTable, service_penalty};
use crate::reputation;
use crate::reputation::{ReputationContribution, ReputationWrite};

/// Hidden values of a day. Inspections show the values, and tests compare them with reference figures.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct DayTrace {
    /// Factors from which the leads of each group were computed.
    pub leads: ByGroup<LeadFactors>,
}

canonical! { DayTrace { leads } }

/// Simulates one day and records its events in `facts`.
pub fn step_day(
    world: &mut World,
    params: &Params,
    streams: &Streams,
    facts: &mut Facts,
) -> (DayFigures, DayTrace) {
    step_day_observed(world, params, streams, &FixedInputs::default(), facts, &NoObserver)
}

/// Simulates one day like [`step_day`], with fixed inputs and an observer that is notified of each step.
pub fn step_day_observed(
    world: &mut World,
    params: &Params,
    streams: &Streams,
    fixed_inputs: &FixedInputs,
    facts: &mut Facts,
    watch: &dyn DayObserver,
) -> (DayFigures, DayTrace) {
    world.day += 1;
    let (day, total_days) = (world.day, world.total_days);
    facts.start_day(day);

    // Compute values that stay constant during the day.
    surges::draw_week_surges(day, world.last_day(params), &mut world.market.surges, params, streams);
    let morning = compute_morning(world, params);
    watch.on_morning(world, &morning, params);
    let World { settings, finance, product, customers, issue_counter, market, enterprise, .. } = world;
    if drift::is_drift_day(day - 1, &params.drift) && !fixed_inputs.fixes_drift(day - 1) {
        refresh_requirements(customers, &morning, params);
    }

    // Measure usage, then compute the service health at this usage.
    let metered = usage::measure_usage(customers, &morning, params, facts);
    let service = service::compute_service(
        metered.total,
        &morning,
        fixed_inputs.fixed_service_on(day),
        params,
        streams,
        facts,
    );
    research::complete_due_projects(day, product, facts);
    studies::complete_due_studies(day, market, params, facts);

    // Update the market.
    let seats = ByGroup::from_fn(|group| market.economy.multiplier(group, Dimension::SeatCount, params));
    if !fixed_inputs.fixes_drift(day) && drift::apply_drift(day, &mut market.drift, customers, &seats, params)
    {
        refresh_requirements(customers, &morning, params);
    }
    if !fixed_inputs.yields {
        yields::vary_yields(day, &mut market.yields, params, streams);
    }
    economy::step(day, &mut market.economy, fixed_inputs.economy, params, streams, facts);
    if !fixed_inputs.competitors {
        let (events, drift) = (&mut market.competitors, &mut market.drift);
        competitors::apply_move(day, total_days, events, product, drift, params, streams);
    }
    press::write_competitor_posts(day, &market.competitors, &mut market.social, params, streams, facts);
    development::apply_development(day, product, settings, params, streams);

    let today = DayContext {
        morning: &morning,
        settings,
        service: &service,
        service_penalty: service_penalty(service.overload, service.outage, &params.quality),
        ads: &AdLoad::new(&settings.ads_strength, params),
        tenure: &TenureTable::up_to(day, params),
        params,
        streams,
    };

    // Subscribers open issues, update satisfaction, decide and pay; enterprises negotiate.
    let opinion_context = OpinionContext { day: &today, chronicle: &market.social.chronicle };
    let mut updated = update_satisfaction(customers, &today, &opinion_context, watch);
    let selected_authors = updated.post_weights.map(|block_weights| {
        author_selection::from_subscribers(block_weights, customers, &opinion_context, streams)
    });
    issues::allocate_resolutions(&mut updated.calls, settings, customers, issue_counter, &today);
    let renewal_context = RenewalContext {
        day: &today,
        involuntary: renewal::involuntary_rates(day, params, streams),
        willingness_to_pay: ByGroup::from_fn(|group| {
            market.economy.multiplier(group, Dimension::WillingnessToPay, params)
        }),
    };
    let decided = update_issues_and_decide(customers, updated.calls, &renewal_context, watch);
    issues::record_issues(decided.settled, facts);
    let mut on_write = |write: &ReputationWrite<'_>| watch.on_reputation_change(write);
    let renewals =
        renewal::record_decisions(decided.decisions, &mut market.reputation, params, facts, &mut on_write);
    let negotiation_context = NegotiationContext { day: &today, product, drift: &market.drift };
    watch.before_negotiations(enterprise, customers, &negotiation_context);
    let negotiated =
        enterprise.step(customers, &mut market.reputation, &negotiation_context, facts, &mut on_write);
    let knowledge = market.knowledge;
    let contributions = satisfaction::sum_by_group(updated.contributions);
    let is_known = |group: Group| knowledge[group].level >= 1;
    reputation::apply_contributions(&mut market.reputation, &contributions, is_known, params, &mut on_write);
    watch.after_reputation_changes(&contributions, market, params);

    // Publish posts of customers and the press.
    if let Some(mut selected_authors) = selected_authors {
        selected_authors.add_departed(&renewals.cancelled_individuals, &negotiated.lost, params);
        selected_authors.publish(&mut market.social, params, streams, facts);
    }
    press::write_economy_posts(day, &market.economy, &mut market.social, params, streams, facts);

    // Process new leads.
    let arrival_context = arrivals::ArrivalContext { day: &today, market };
    let subscribers = customers.active_by_group();
    let mut factors = arrivals::expected_leads(&arrival_context, &subscribers);
    fixed_inputs.apply_to_leads(day, morning.weekday, &mut factors);
    watch.on_expected_leads(&arrival_context, &subscribers, &factors);
    let leads = arrivals::process_arrivals(&arrival_context, &factors, customers, enterprise, facts);
    finance.cash -= f64::from(leads.all) * params.leads.lead_acquisition_cost;

    // Collect payments and pay costs.
    let received = billing::collect_payments(customers, decided.billed, &today, &negotiated.suspended, facts);
    finance.cash += received;
    let costs = pay_running_costs(finance, &metered, &morning, settings, params, facts);
    book_ad_revenue(customers, today.ads, finance, facts);
    market.social.chronicle.append_day(day, &service, settings, product);

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
    watch.on_day_figures(&figures);
    watch.on_day_end(world, params, facts);
    (figures, DayTrace { leads: factors })
}

/// Results of the first sweep over subscribers, one element per block.
struct SatisfactionRound {
    calls: Vec<IssueBatch>,
    contributions: Vec<(Group, ReputationContribution)>,
    /// Post weights by block; `None` unless customers post today.
    post_weights: Option<Vec<BlockWeights>>,
}

/// Finds new issues, updates satisfaction and, on posting days, computes the weights of potential authors.
fn update_satisfaction(
    customers: &mut Customers,
    day: &DayContext<'_>,
    opinion_context: &OpinionContext<'_>,
    watch: &dyn DayObserver,
) -> SatisfactionRound {
    let customers_post_today = author_selection::is_posting_day(day.day(), day.params);
    let updated = customers.sweep(|group, number, block| {
        let calls = issues::find_issues(group, number, block, day);
        let before = customers_post_today.then(|| block.satisfaction.clone());
        watch.before_satisfaction(group, block, day);
        let contribution = satisfaction::update_block(group, block, day);
        let block_weights =
            before.map(|before| author_selection::weigh_block(group, block, before, opinion_context));
        (calls, (group, contribution), block_weights)
    });
    let (calls, contributions, block_weights): (Vec<_>, Vec<_>, Vec<_>) = updated.into_iter().collect();
    SatisfactionRound {
        calls,
        contributions,
        post_weights: customers_post_today.then(|| block_weights.into_iter().flatten().collect()),
    }
}

/// Results of the second sweep over subscribers, one element per block.
struct DecisionRound {
    settled: Vec<IssueUpdates>,
    decisions: Vec<BlockDecisions>,
    billed: Vec<BlockBills>,
}

/// Updates issues, computes the decisions of due customers, and bills the customers who stay.
fn update_issues_and_decide(
    customers: &mut Customers,
    calls: Vec<IssueBatch>,
    renewal_context: &RenewalContext<'_>,
    watch: &dyn DayObserver,
) -> DecisionRound {
    let day = renewal_context.day;
    let decided = customers.sweep_with(calls, |group, number, block, calls| {
        let settled = issues::update_issues(block, &calls, day);
        watch.before_decisions(group, block, renewal_context);
        let decisions = renewal::decide_block(group, number, block, renewal_context);
        (settled, decisions, billing::bill_block(group, number, block, day))
    });
    let (settled, decisions, billed) = decided.into_iter().collect();
    DecisionRound { settled, decisions, billed }
}

/// Computes the values that are fixed at the start of the current day.
pub fn compute_morning(world: &World, params: &Params) -> Morning {
    let core = world.settings.core;
    Morning {
        day: world.day,
        core,
        weekday: params.calendar.weekly[(world.day % 7) as usize],
        month_day: params.calendar.monthly[(world.day % 30) as usize],
        quotas: ByPlan::from_fn(|plan| core.quotas[plan].units()),
        multipliers: ByPlan::from_fn(|plan| params.model_tier(core.tiers[plan]).quality_multiplier),
        product: ByGroup::from_fn(|group| world.product.quality(group, params)),
        shared_quality: params.quality.base_product_quality + world.product.shared_bonus,
        expectations: ByGroup::from_fn(|group| world.market.drift.expectation(group)),
        subscribers: world.customers.active_by_group(),
    }
}

/// Recomputes the required quality of all subscribers after their curves or the budget drift of their group changed.
fn refresh_requirements(customers: &mut Customers, morning: &Morning, params: &Params) {
    customers.sweep(|group, _, block| refresh_block(group, block, morning, params));
}

fn book_ad_revenue(customers: &Customers, ads: &AdLoad<'_>, finance: &mut Finance, facts: &mut Facts) {
    let revenue = ads::record_ad_revenue(customers, ads, facts);
    if revenue > 0.0 {
        let note = LedgerNote::Subscribers(customers.active_by_group().iter().sum());
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
        for ((group, block), paid) in several.iter().zip(sum_columns(prices)) {
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
mod step_interaction_tests;

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::morning::tests::morning;
    use crate::test_kit::apply_policy_p;

    fn run(cash: f64, days: u32, prepare: impl Fn(&mut World)) -> Vec<DayFigures> {
        let (params, streams) = (Params::bundled(), Streams::new(42));
        let mut facts = Facts::default();
        let mut world = World::new(500, cash, &params, &mut facts);
        prepare(&mut world);
        (0..days).map(|_| step_day(&mut world, &params, &streams, &mut facts).0).collect()
    }

    #[test]
    fn company_without_actions_pays_85_dollars_per_day() {
        let days = run(1_000_000.0, 3, |_| {});
        assert_eq!((days[0].total_costs, days[0].cash), (85.0, 999_915.0));
        assert_eq!(days[2].cash, 999_745.0);
        assert_eq!(run(100.0, 2, |_| {})[1].cash, -70.0);
        assert_eq!(run(85.0, 1, |_| {})[0].cash, 0.0);
    }

    #[test]
    fn morning_has_weekday_and_month_day_factors() {
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
    fn policy_p_pays_fixed_costs_every_day() {
        let (params, streams) = (Params::bundled(), Streams::new(42));
        let mut facts = Facts::default();
        let mut world = World::new(500, 1_000_000.0, &params, &mut facts);
        apply_policy_p(&mut world);
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
    fn cash_matches_the_ledger_and_counts_match_the_columns() {
        let (params, streams) = (Params::bundled(), Streams::new(7));
        let mut facts = Facts::default();
        let mut world = World::new(500, 1_000_000.0, &params, &mut facts);
        apply_policy_p(&mut world);
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
                    - individual_cancellations(&facts),
                opened - ended
            );
        }
        assert!(opened > 1000 && ended > 100);
    }

    fn individual_cancellations(facts: &Facts) -> usize {
        facts.endings.iter().filter(|ending| !ending.group.is_enterprise()).count()
    }
}
