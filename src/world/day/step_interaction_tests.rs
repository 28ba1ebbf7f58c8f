//! Tests of the values that one step of a day passes to later steps. Outages affect issues, satisfaction, decisions
//! and reputation. The economy affects leads, budgets and seats. The calendar affects leads and usage. The last test
//! checks that every figure is stored in its field.

use super::*;
use crate::customers::columns::Subscriber;
use crate::events::{EndCause, SubscriptionEnded, SubscriptionStatus};
use crate::identifiers::Channel;
use crate::identifiers::Group;
use crate::params::{MacroBeta, ServicePenalty};
use crate::quota::Quota;
use crate::test_kit::subscriber;

/// Applies varied settings under which customers of several groups arrive, stay, open issues and cancel.
pub(super) fn busy_settings(world: &mut World) {
    let core = &mut world.settings.core;
    core.prices = ByPlan([9.0, 16.0, 31.0]);
    core.tiers = ByPlan([2, 3, 4]);
    core.quotas = ByPlan([40_000, 90_000, 700_000].map(Quota::from));
    core.operations = 130.0;
    core.development = 170.0;
    core.capacity_tier = 3;
    let spend = |list: &[(&str, f64)]| {
        list.iter().map(|(id, spend)| (Group::parse(id).expect("a group"), *spend)).collect()
    };
    let targeted = &mut world.settings.targeted_ads.targeted_spend;
    targeted.insert(Channel::ContentMarketing, spend(&[("S1", 2500.0), ("S2", 1400.0)]));
    targeted.insert(Channel::Linkedin, spend(&[("E1", 900.0), ("S3", 800.0)]));
    world.settings.targeted_development.targeted_spend = spend(&[("S1", 3000.0), ("E1", 1500.0)]);
}

struct TestRun {
    world: World,
    params: Params,
    streams: Streams,
    facts: Facts,
}

impl TestRun {
    fn new(params: Params) -> TestRun {
        let mut facts = Facts::default();
        let mut world = World::new(500, 1e7, &params, &mut facts);
        busy_settings(&mut world);
        TestRun { world, params, streams: Streams::new(11), facts }
    }

    fn simulate_day(&mut self) -> (DayFigures, DayTrace) {
        step_day(&mut self.world, &self.params, &self.streams, &mut self.facts)
    }

    /// Simulates `days` days, changes the parameters, and simulates one more day.
    fn simulate_day_with_changed_params(
        days: u32,
        params: &Params,
        change: impl FnOnce(&mut Params),
    ) -> (TestRun, DayFigures, DayTrace) {
        let mut play = TestRun::new(params.clone());
        for _ in 0..days {
            play.simulate_day();
        }
        change(&mut play.params);
        let (figures, trace) = play.simulate_day();
        (play, figures, trace)
    }

    fn individual_rows(&self) -> Vec<Subscriber> {
        let blocks = self.world.customers.blocks().filter(|(group, _)| !group.is_enterprise());
        blocks.flat_map(|(_, block)| (0..block.len()).map(|at| block.row(at)).collect::<Vec<_>>()).collect()
    }
}

fn mean(rows: &[Subscriber], value: impl Fn(&Subscriber) -> f64) -> f64 {
    rows.iter().map(value).sum::<f64>() / rows.len() as f64
}

/// Sets the outage probability to 1 or 0.
fn set_outage_probability(params: &mut Params, certain: bool) {
    let chance = if certain { 1.0 } else { 0.0 };
    params.operations.base_outage_prob = chance;
    params.operations.ops_outage_min_prob = chance;
}

#[test]
fn outage_affects_issues_satisfaction_and_reputation() {
    let params = Params::bundled();
    let with_outage = |certain| {
        TestRun::simulate_day_with_changed_params(40, &params, |params| {
            set_outage_probability(params, certain)
        })
    };
    let ((quiet, otherwise, _), (broken, down, _)) = (with_outage(false), with_outage(true));
    assert!(!otherwise.outage && otherwise.downtime_minutes == 0 && down.outage && down.downtime_minutes > 0);
    assert_eq!(otherwise.total_usage, down.total_usage, "all other conditions are equal");

    // All customers who open an issue without an outage also open an issue with an outage, and so do many others.
    let callers = |play: &TestRun| -> Vec<u32> {
        play.facts.issues_opened.iter().map(|issue| issue.customer).collect()
    };
    let (few, many) = (callers(&quiet), callers(&broken));
    assert!(few.iter().all(|customer| many.contains(customer)) && many.len() > 2 * few.len());

    // Almost all existing subscribers are less satisfied, and none is more satisfied.
    let there = |play: &TestRun| -> Vec<Subscriber> {
        play.individual_rows().into_iter().filter(|row| row.start_day < 41).collect()
    };
    let (before, after) = (there(&quiet), there(&broken));
    assert_eq!(before.len(), after.len());
    let pairs = || before.iter().zip(&after);
    assert!(pairs().all(|(otherwise, down)| down.satisfaction <= otherwise.satisfaction));
    let fell = pairs().filter(|(otherwise, down)| down.satisfaction < otherwise.satisfaction).count();
    assert!(fell * 10 > before.len() * 9, "{fell} of {} are less satisfied", before.len());

    // A resolution on a day with an outage does not raise the relationship.
    let solved = quiet.facts.issues_resolved.clone();
    assert!(!solved.is_empty() && solved == broken.facts.issues_resolved);
    assert!(mean(&before, |row| row.relationship) > mean(&after, |row| row.relationship));

    // The chronicle records the outage.
    let remembered = |play: &TestRun| play.world.market.social.chronicle.today().outage;
    assert!(!remembered(&quiet) && remembered(&broken));
    let s1 = Group::at(0).expect("S1");
    let reputation = |play: &TestRun| play.world.market.reputation.get(s1);
    assert!(reputation(&broken) < reputation(&quiet));
}

#[test]
fn outage_increases_churn_only_if_the_penalty_applies_everywhere() {
    let left = |penalty, certain| -> u32 {
        let mut params = Params::bundled();
        params.fidelity.service_penalty = penalty;
        // Use a penalty that is large enough to affect decisions.
        params.quality.service_outage_weight = 0.5;
        let (play, figures, _) = TestRun::simulate_day_with_changed_params(44, &params, |params| {
            set_outage_probability(params, certain)
        });
        let ended = play.facts.endings.iter().filter(|ending| !ending.group.is_enterprise());
        assert_eq!(ended.count() as u32, figures.cancellations);
        figures.cancellations
    };
    let (otherwise, on_outage_day) =
        (left(ServicePenalty::Everywhere, false), left(ServicePenalty::Everywhere, true));
    assert!(
        on_outage_day > otherwise + 5,
        "{on_outage_day} leave on the day of the outage, {otherwise} otherwise"
    );
    assert_eq!(left(ServicePenalty::Satisfaction, false), left(ServicePenalty::Satisfaction, true));
}

#[test]
fn overload_increases_churn_on_the_same_day() {
    let left = |capacity_units: u32| {
        let mut params = Params::bundled();
        params.fidelity.service_penalty = ServicePenalty::Everywhere;
        // Use a penalty that is large enough to affect decisions.
        params.quality.service_overload_weight = 0.5;
        let (_, figures, _) = TestRun::simulate_day_with_changed_params(44, &params, |params| {
            set_outage_probability(params, false);
            params.capacity_tier.iter_mut().for_each(|tier| tier.capacity_units = capacity_units);
        });
        (figures.overload, figures.cancellations)
    };
    let ((none, otherwise), (much, crowded)) = (left(4_000_000_000), left(1_000));
    assert!(none == 0.0 && much > 1.0, "{none}, {much}");
    assert!(crowded > otherwise + 5, "{crowded} leave on the day of the overload, {otherwise} otherwise");
}

#[test]
fn calendar_factors_apply_by_day() {
    let mut params = Params::bundled();
    for (at, factor) in params.calendar.weekly.iter_mut().enumerate() {
        *factor = 1.0 + 0.1 * at as f64;
    }
    for (at, factor) in params.calendar.monthly.iter_mut().enumerate() {
        *factor = 2.0 + 0.01 * at as f64;
    }
    let calendar = params.calendar.clone();
    let mut play = TestRun::new(params);
    let s1 = Group::at(0).expect("S1");
    for day in 1..=64usize {
        let (_, trace) = play.simulate_day();
        let expected = calendar.weekly[day % 7] * calendar.monthly[day % 30];
        assert_eq!(trace.leads[s1].calendar, expected, "leads of day {day}");
    }
    // Usage depends on the weekday but not on the day of the month.
    let day_65 = |monthly: f64, weekly: f64| {
        let change = |params: &mut Params| {
            params.calendar.monthly[65 % 30] *= monthly;
            params.calendar.weekly[65 % 7] *= weekly;
        };
        TestRun::simulate_day_with_changed_params(64, &Params::bundled(), change).1.total_usage as f64
    };
    assert_eq!(day_65(1.0, 1.0), day_65(3.0, 1.0));
    let half = day_65(1.0, 0.5) / day_65(1.0, 1.0);
    assert!((0.49..0.6).contains(&half), "some are limited by their quota: {half}");
}

/// Returns parameters with a PMI of half the neutral value and only the macroeconomic reactions that `change` sets.
fn params_with_macro_reaction(change: impl Fn(&mut MacroBeta)) -> Params {
    let mut params = Params::bundled();
    let economy = &mut params.economy;
    (economy.macro_pmi_initial, economy.macro_pmi_long_run_mean) = (25.0, 25.0);
    (economy.macro_pmi_cycle_amplitude, economy.macro_pmi_daily_volatility) = (0.0, 0.0);
    economy.macro_pmi_floor = 0.0;
    for group in params.group.iter_mut() {
        group.macro_beta = MacroBeta {
            lead_generation: None,
            willingness_to_pay: None,
            deal_velocity: None,
            seat_count: None,
        };
        change(&mut group.macro_beta);
    }
    params
}

/// Adds an enterprise subscriber with 500 seats and no thread. Returns its group.
fn add_subscriber_with_500_seats(world: &mut World) -> Group {
    let group = Group::parse("E1").expect("a group");
    let customer = world.customers.next_customer;
    world.customers.next_customer += 1;
    world.customers.groups[group].created += 1;
    let row = Subscriber { customer, seats: 500.0, ..subscriber(1) };
    world.customers.groups[group].activate(row);
    group
}

/// Returns the economy's lead factor, the number of cancellations for price or quality, and the number of seats.
fn measure_effects(params: Params) -> (f64, usize, f64) {
    let mut play = TestRun::new(params);
    let group = add_subscriber_with_500_seats(&mut play.world);
    let (mut factor, mut gave_up) = (0.0, 0);
    // On day 90, seats drift with the economy of day 89.
    for _ in 0..90 {
        factor = play.simulate_day().1.leads[Group::at(0).expect("S1")].economy;
        let price = |ending: &&SubscriptionEnded| matches!(ending.cause, EndCause::Price | EndCause::Quality);
        gave_up += play.facts.endings.iter().filter(price).count();
    }
    let row = play.world.customers.groups[group].subscriber(1);
    (factor, gave_up, row.expect("the subscription is active").seats)
}

#[test]
fn each_macro_dimension_affects_its_own_figure() {
    let (factor, few, seats) = measure_effects(params_with_macro_reaction(|_| {}));
    assert_eq!(factor, 1.0);
    let leads = measure_effects(params_with_macro_reaction(|beta| beta.lead_generation = Some(1.0)));
    assert_eq!((leads.0, leads.2), (0.5, seats), "half of neutral, a sensitivity of one");
    let budgets = measure_effects(params_with_macro_reaction(|beta| beta.willingness_to_pay = Some(1.0)));
    assert_eq!((budgets.0, budgets.2), (1.0, seats));
    assert!(budgets.1 > few + 20, "{} give up with half the budget, {few} otherwise", budgets.1);
    let offices = measure_effects(params_with_macro_reaction(|beta| beta.seat_count = Some(1.0)));
    assert_eq!((offices.0, offices.1), (1.0, few));
    assert!(offices.2 != seats, "{seats} seats in either economy");
}

#[test]
fn day_figures_match_the_facts() {
    let mut play = TestRun::new(Params::bundled());
    let mut sums = DayFigures::default();
    for day in 1..=95 {
        if day == 50 {
            // With the new prices, some subscribers prefer a different plan.
            play.world.settings.core.prices = ByPlan([15.0, 13.0, 22.0]);
        }
        if day == 70 {
            play.world.settings.core.prices = ByPlan([5.0, 20.0, 45.0]);
        }
        let cash = play.world.finance.cash;
        let (figures, _) = play.simulate_day();
        let facts = &play.facts;
        let service = facts.service.expect("a day of service");
        assert_eq!(figures.day, day);
        assert_eq!((figures.total_usage, figures.overload), (service.total_usage, service.overload));
        assert_eq!((figures.outage, figures.downtime_minutes), (service.outage, service.downtime_minutes));
        assert_eq!((figures.p95_ms, figures.error_rate), (service.p95_ms, service.error_rate));
        assert_eq!(figures.usage.iter().flat_map(|plans| plans.0).sum::<u64>(), figures.total_usage);
        let company = |group: Group| group.is_enterprise();
        assert_eq!(figures.new_leads as usize, facts.arrivals.len());
        let people = facts.arrivals.iter().filter(|arrival| !company(arrival.group)).count();
        assert_eq!(figures.new_individual_leads as usize, people);
        let opened = |status| facts.openings.iter().filter(move |opened| opened.status == status).count();
        assert_eq!(figures.new_individual_subscribers as usize, opened(SubscriptionStatus::Subscribed));
        assert_eq!(figures.new_enterprise_leads as usize, opened(SubscriptionStatus::Lead));
        let left = facts.endings.iter().filter(|ending| !company(ending.group)).count();
        assert_eq!(figures.cancellations as usize, left);
        let paid: f64 = facts.payments.iter().map(|payment| payment.amount).sum();
        assert!((figures.payments_received - paid).abs() < 1e-6);
        let costs: f64 = facts.ledger.iter().map(|entry| entry.amount).filter(|amount| *amount < 0.0).sum();
        assert!((figures.total_costs + costs).abs() < 1e-6);
        let leads = play.params.leads.lead_acquisition_cost * f64::from(figures.new_leads);
        assert!((figures.cash - (cash + paid + costs - leads)).abs() < 1e-6, "nothing else changes cash");
        let people = play.individual_rows();
        assert_eq!(figures.individual_subscribers as usize, people.len());
        sums.new_enterprise_leads += figures.new_enterprise_leads;
        sums.cancellations += figures.cancellations;
        (sums.upgrades, sums.downgrades) =
            (sums.upgrades + figures.upgrades, sums.downgrades + figures.downgrades);
    }
    let numbers = [sums.new_enterprise_leads, sums.cancellations, sums.upgrades, sums.downgrades];
    assert!(numbers.iter().all(|sum| *sum > 3), "too few events to distinguish the fields: {numbers:?}");
}
