//! Decisions of individuals on their billing day: stay, switch, or cancel (`docs/mechanics/retention/renewal.md`).

use crate::context::DayContext;
use crate::customers::columns::{Block, CUSTOMERS_PER_BLOCK};
use crate::events::{EndCause, Facts, SubscriptionEnded, SubscriptionStatus, TermsChanged};
use crate::identifiers::{ByGroup, Group, Plan};
use crate::params::{DriftCounted, InvoluntaryChurn, Params};
use crate::random::{Part, Streams, Word, bernoulli_from_word};
use crate::reputation::{OnReputationWrite, ReputationCause, Reputations, cancel_damage};
use crate::retention::due_today;
use crate::retention::plan_comparison::{compare_plans, drifted_curve};
use crate::settings::Settings;

/// Returns the monthly rate of involuntary churn. `z` is a standard normal draw. The rate is 0 for groups without
/// involuntary churn.
pub fn involuntary_rate(mean: f64, std: f64, z: f64, churn: &InvoluntaryChurn) -> f64 {
    if !churn.enable_involuntary_churn || (mean <= 0.0 && std <= 0.0) {
        return 0.0;
    }
    (mean + std * z).clamp(churn.mu_min, churn.mu_max)
}

/// Returns the monthly rate of involuntary churn of each group in the month of `day`. The rate is 0 for enterprises.
pub fn involuntary_rates(day: u32, params: &Params, streams: &Streams) -> ByGroup<f64> {
    ByGroup::from_fn(|group| {
        if group.is_enterprise() { 0.0 } else { group_involuntary_rate(group, day, params, streams) }
    })
}

/// Returns the monthly rate of involuntary churn of a group in the month of `day`.
pub fn group_involuntary_rate(group: Group, day: u32, params: &Params, streams: &Streams) -> f64 {
    let churn = &params.involuntary_churn;
    let month = day / churn.month_days;
    let given = params.replayed_series().and_then(|series| series.involuntary_rate(group, month));
    if let Some(rate) = given.filter(|_| churn.enable_involuntary_churn) {
        return rate;
    }
    let keys = [group.index() as u64, u64::from(month)];
    let z = streams.open_for_day(month * churn.month_days, Part::InvoluntaryMu, keys).standard_normal();
    let group_params = params.group(group);
    involuntary_rate(group_params.involuntary_churn_mean, group_params.involuntary_churn_std, z, churn)
}

/// An individual who cancelled today because no plan was acceptable.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CancelledIndividual {
    /// Customer number, unique across all groups.
    pub customer: u32,
    /// Group to which the individual belongs.
    pub group: Group,
    /// Sequence number of the individual within the group.
    pub n: u32,
    /// Satisfaction after today's update.
    pub satisfaction: f64,
    /// Days since the subscription started.
    pub days_subscribed: u32,
    /// Plan of the cancelled subscription.
    pub plan: Plan,
    /// Price of the cancelled subscription, dollars per month.
    pub price: f64,
}

/// Results of the billing decisions of a day.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RenewalResults {
    /// Number of cancellations, voluntary and involuntary.
    pub cancellations: u32,
    /// Number of switches to a plan whose list price is higher than the subscriber's stored price.
    pub upgrades: u32,
    /// Number of other switches.
    pub downgrades: u32,
    /// Individuals who cancelled because no plan was acceptable.
    pub cancelled_individuals: Vec<CancelledIndividual>,
}

/// Inputs that all billing decisions of a day share.
pub struct RenewalContext<'a> {
    /// Values that all customer mechanisms of the day share.
    pub day: &'a DayContext<'a>,
    /// Monthly rate of involuntary churn of each group.
    pub involuntary: ByGroup<f64>,
    /// Macroeconomic multiplier of each group's budgets.
    pub willingness_to_pay: ByGroup<f64>,
}

/// Billing decisions of the individuals of a block.
#[derive(Default)]
pub struct BlockDecisions {
    endings: Vec<SubscriptionEnded>,
    /// Individuals who cancelled because no plan was acceptable.
    cancelled_individuals: Vec<CancelledIndividual>,
    /// Reputation damage of each element of `cancelled_individuals`.
    damages: Vec<f64>,
    switches: Vec<(bool, TermsChanged)>,
}

/// Adds up and records the decisions of all blocks. The reputation damage of each individual without an acceptable
/// plan is applied in the order of the individuals. Failed payments do not damage the reputation.
pub fn record_decisions(
    by_block: Vec<BlockDecisions>,
    reputation: &mut Reputations,
    params: &Params,
    facts: &mut Facts,
    on_write: &mut OnReputationWrite<'_>,
) -> RenewalResults {
    let mut renewals = RenewalResults::default();
    for decided in by_block {
        for (upgrade, terms) in decided.switches {
            if upgrade {
                renewals.upgrades += 1
            } else {
                renewals.downgrades += 1
            }
            facts.changes.push(terms);
        }
        renewals.cancellations += decided.endings.len() as u32;
        facts.endings.extend(decided.endings);
        if let Some(person) = decided.cancelled_individuals.first() {
            let write = (person.group, ReputationCause::Cancellations);
            reputation.add_all(write, &decided.damages, params, on_write);
        }
        renewals.cancelled_individuals.extend(decided.cancelled_individuals);
    }
    renewals
}

/// Returns the reputation change that each individual without an acceptable plan causes. The changes are negative.
fn reputation_damages(cancelled: &[CancelledIndividual], day: &DayContext<'_>) -> Vec<f64> {
    let &DayContext { morning, params, streams, .. } = day;
    let keys_of =
        |person: &CancelledIndividual| [morning.day.into(), person.group.index() as u64, person.n.into(), 0];
    let keys: Vec<[u64; 4]> = cancelled.iter().map(keys_of).collect();
    let rolls = streams.first_words(Part::ReputationEvent, &keys);
    let damage = |(person, roll): (&CancelledIndividual, Word)| {
        let subscribers = morning.subscribers[person.group];
        -cancel_damage(person.satisfaction, subscribers, roll.uniform(), &params.reputation)
    };
    cancelled.iter().zip(rolls).map(damage).collect()
}

/// Returns a random word for each position of a block. The word decides whether a payment fails permanently.
pub fn payment_failure_words(
    group: Group,
    number: u32,
    day: u32,
    streams: &Streams,
) -> [u32; CUSTOMERS_PER_BLOCK as usize] {
    let mut words = [0; CUSTOMERS_PER_BLOCK as usize];
    let keys = [u64::from(day), group.index() as u64, u64::from(number)];
    streams.open(Part::InvoluntaryRoll, keys).fill(&mut words);
    words
}

/// Computes the decisions of the block's individuals who are due today. Removes the individuals who cancel.
pub fn decide_block(
    group: Group,
    number: u32,
    block: &mut Block,
    context: &RenewalContext<'_>,
) -> BlockDecisions {
    let mut outcome = BlockDecisions::default();
    if group.is_enterprise() {
        return outcome;
    }
    let (morning, rate) = (context.day.morning, context.involuntary[group]);
    let due = due_today(block, morning.day, context.day.params);
    if due.is_empty() {
        return outcome;
    }
    let words = match rate > 0.0 {
        true => payment_failure_words(group, number, morning.day, context.day.streams),
        false => [0; CUSTOMERS_PER_BLOCK as usize],
    };
    let mut gone = Vec::new();
    for at in due {
        let cause = if rate > 0.0 && bernoulli_from_word(words[block.word_position(at)], rate) {
            Some(EndCause::Involuntary)
        } else {
            match compare_plans(group, block, at, context).choice(context.day.params) {
                None if block.satisfaction[at] < 0.0 => Some(EndCause::Quality),
                None => Some(EndCause::Price),
                Some(plan) if plan != block.plan[at] => {
                    outcome.switches.push(switch_plan(group, block, at, plan, context));
                    None
                }
                Some(_) => None,
            }
        };
        if let Some(cause) = cause {
            gone.push(at);
            outcome.endings.push(subscription_ended(group, block, at, cause, morning.day));
            if cause != EndCause::Involuntary {
                outcome.cancelled_individuals.push(cancelled_individual(group, block, at, morning.day));
            }
        }
    }
    block.remove(&gone);
    outcome.damages = reputation_damages(&outcome.cancelled_individuals, context.day);
    outcome
}

fn subscription_ended(
    group: Group,
    block: &Block,
    at: usize,
    cause: EndCause,
    day: u32,
) -> SubscriptionEnded {
    SubscriptionEnded {
        subscription: block.subscription[at],
        customer: block.customer[at],
        group,
        seats: block.seats[at] as u32,
        day,
        status: SubscriptionStatus::Cancelled,
        cause,
    }
}

fn cancelled_individual(group: Group, block: &Block, at: usize, day: u32) -> CancelledIndividual {
    CancelledIndividual {
        customer: block.customer[at],
        group,
        n: block.n[at],
        satisfaction: block.satisfaction[at],
        days_subscribed: day - block.start_day[at],
        plan: block.plan[at],
        price: block.effective_price[at],
    }
}

/// Returns the ongoing discount of a customer on a plan, at least 0: P(i, g, p).
pub fn ongoing_discount(
    customer: u32,
    group: Group,
    plan: Plan,
    settings: &Settings,
    params: &Params,
) -> f64 {
    settings.promotion.sum(customer, group, plan).max(params.promotions.promotion_min)
}

/// Switches a subscriber to a different plan at today's terms. Tenure continues. Returns whether the switch is an
/// upgrade.
fn switch_plan(
    group: Group,
    block: &mut Block,
    at: usize,
    plan: Plan,
    context: &RenewalContext<'_>,
) -> (bool, TermsChanged) {
    let &DayContext { morning, settings, params, .. } = context.day;
    let listed_price = morning.core.prices[plan];
    let upgrade = listed_price > block.listed_price[at];
    let promotion = ongoing_discount(block.customer[at], group, plan, settings, params);
    block.plan[at] = plan;
    block.listed_price[at] = listed_price;
    block.promotion[at] = promotion;
    block.effective_price[at] = (listed_price - promotion).max(params.billing.effective_price_min);
    block.effective_c_max[at] = match params.fidelity.drift_counted {
        DriftCounted::EveryRead => drifted_curve(block.curve(at), morning.expectations[group], params).c_max,
        DriftCounted::Once => block.c_max[at],
    };
    (upgrade, row_terms(block, at))
}

/// Returns the current subscription terms of a row.
pub fn row_terms(block: &Block, at: usize) -> TermsChanged {
    TermsChanged {
        subscription: block.subscription[at],
        customer: block.customer[at],
        plan: block.plan[at],
        listed_price: block.listed_price[at],
        promotion: block.promotion[at],
        effective_price: block.effective_price[at],
        seats: block.seats[at] as u32,
        billed_once: block.billed_once[at],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::context::tests::with_day_context;
    use crate::customers::Customers;
    use crate::customers::columns::Subscriber;
    use crate::events::ServiceDay;
    use crate::identifiers::ByPlan;
    use crate::morning::Morning;
    use crate::morning::tests::morning;
    use crate::params::Params;
    use crate::random::Streams;
    use crate::settings::AdsStrength;
    use crate::settings::Settings;
    use crate::test_kit::subscriber;

    fn group() -> Group {
        Group::at(0).expect("S1")
    }

    /// Runs `check` with the decision context of the given day and settings.
    fn with_renewal_context<R>(
        day: &Morning,
        settings: &Settings,
        willingness: f64,
        check: impl FnOnce(&RenewalContext<'_>) -> R,
    ) -> R {
        with_renewal_context_and_params(&Params::bundled(), day, settings, willingness, check)
    }

    fn with_renewal_context_and_params<R>(
        params: &Params,
        day: &Morning,
        settings: &Settings,
        willingness: f64,
        check: impl FnOnce(&RenewalContext<'_>) -> R,
    ) -> R {
        with_day_context(day, settings, &ServiceDay::without_load(), (params, &Streams::new(1)), |day| {
            check(&RenewalContext {
                day,
                involuntary: ByGroup::default(),
                willingness_to_pay: ByGroup::from_fn(|_| willingness),
            })
        })
    }

    #[test]
    fn involuntary_rate_follows_its_draw_within_bounds() {
        let churn = Params::bundled().involuntary_churn;
        for (z, rate) in [(-5.0, 0.0), (1.0, 0.07), (80.0, 1.0)] {
            assert!((involuntary_rate(0.055, 0.015, z, &churn) - rate).abs() < 1e-12);
        }
        assert_eq!(involuntary_rate(0.0, 0.0, 3.0, &churn), 0.0);
        let off = InvoluntaryChurn { enable_involuntary_churn: false, ..churn };
        assert_eq!(involuntary_rate(0.055, 0.015, 1.0, &off), 0.0);
    }

    #[test]
    fn subscriber_compares_plans_by_delivered_quality() {
        let mut day = morning(31);
        day.product[group()] = 0.4;
        day.multipliers = ByPlan([0.6, 0.9, 1.1]);
        day.quotas = ByPlan([60.0, 70.0, 1200.0]);
        day.core.prices = ByPlan([12.0, 25.0, 55.0]);
        let mut settings = Settings::initial(&Params::bundled());
        settings.ads_strength = AdsStrength {
            global: 0.2,
            by_group: [(group(), 0.1)].into_iter().collect(),
            ..AdsStrength::default()
        };
        let mut block = Block::default();
        block.push(Subscriber { plan: Plan::B, relationship: 0.7, open_issue_days: 3, ..subscriber(1) });
        with_renewal_context(&day, &settings, 1.0, |context| {
            let qualities = compare_plans(group(), &block, 0, context).qualities(context.day.params);
            for (plan, expected) in Plan::ALL.into_iter().zip([0.151809447, 0.298929601, 0.496473152]) {
                assert!((qualities[plan] - expected).abs() < 1e-9, "{plan}: {}", qualities[plan]);
            }
            assert_eq!(compare_plans(group(), &block, 0, context).choice(context.day.params), None);
        });
    }

    /// Tests only the decision. Module `billing` tests the bill.
    #[test]
    fn price_increase_is_evaluated_at_the_list_price() {
        for (list, willingness, promotion, stays) in [
            (20.0, 1.0, 0.0, true),
            (30.0, 1.0, 0.0, true),
            (45.0, 1.0, 0.0, false),
            (45.0, 1.0, 8.0, true),
            (51.0, 1.0, 0.0, false),
            (30.0, 0.7, 0.0, false),
        ] {
            let mut day = morning(31);
            day.product[group()] = 0.2 + 0.3;
            day.multipliers = ByPlan([0.0, 0.9, 0.0]);
            day.quotas = ByPlan([1e9; 3]);
            day.core.prices = ByPlan([list; 3]);
            let mut settings = Settings::initial(&Params::bundled());
            settings.promotion.global = promotion;
            let mut block = Block::default();
            block.push(Subscriber { plan: Plan::B, start_day: 1, ..subscriber(1) });
            with_renewal_context(&day, &settings, willingness, |context| {
                let comparison = compare_plans(group(), &block, 0, context);
                let quality = comparison.qualities(context.day.params)[Plan::B];
                assert!((quality - 0.484657359).abs() < 1e-9);
                let choice = comparison.choice(context.day.params);
                assert_eq!(choice.is_some(), stays, "list price {list}");
            });
        }
    }

    #[test]
    fn current_plan_is_evaluated_at_the_lower_of_list_and_stored_price() {
        use crate::params::RenewalPrice::{List, LowerOfListAndStored};
        for (rule, list, promotion, prices, stays) in [
            (List, 45.0, 0.0, [45.0, 45.0, 45.0], false),
            (LowerOfListAndStored, 45.0, 0.0, [45.0, 20.0, 45.0], true),
            (LowerOfListAndStored, 45.0, 8.0, [37.0, 12.0, 37.0], true),
            (LowerOfListAndStored, 15.0, 0.0, [15.0, 15.0, 15.0], true),
        ] {
            let mut params = Params::bundled();
            params.fidelity.renewal_price = rule;
            let mut day = morning(31);
            day.product[group()] = 0.2 + 0.3;
            day.multipliers = ByPlan([0.0, 0.9, 0.0]);
            day.quotas = ByPlan([1e9; 3]);
            day.core.prices = ByPlan([list; 3]);
            let mut settings = Settings::initial(&params);
            settings.promotion.global = promotion;
            let mut block = Block::default();
            block.push(Subscriber { plan: Plan::B, listed_price: 20.0, start_day: 1, ..subscriber(1) });
            with_renewal_context_and_params(&params, &day, &settings, 1.0, |context| {
                let comparison = compare_plans(group(), &block, 0, context);
                assert_eq!(comparison.prices.0, prices, "{rule:?}, list price {list}");
                let expected = stays.then_some(Plan::B);
                assert_eq!(comparison.choice(&params), expected, "{rule:?}, list price {list}");
            });
        }
    }

    #[test]
    fn cancellation_and_switch_update_the_columns() {
        let mut day = morning(31);
        day.product[group()] = 0.9;
        day.multipliers = ByPlan([0.6, 0.9, 1.1]);
        day.quotas = ByPlan([1e9; 3]);
        day.core.prices = ByPlan([12.0, 13.0, 14.0]);
        let settings = Settings::initial(&Params::bundled());
        let mut customers = Customers::default();
        let picky = Subscriber { q_min: 5.0, q_max: 6.0, satisfaction: -0.2, ..subscriber(1) };
        for row in [picky, subscriber(2), Subscriber { billing_day: 9, ..subscriber(3) }] {
            customers.groups[group()].activate(row);
        }
        let (mut reputation, mut facts) = (Reputations::initial(&Params::bundled()), Facts::default());
        let renewals = with_renewal_context(&day, &settings, 1.0, |context| {
            let decided = customers.sweep(|group, number, block| decide_block(group, number, block, context));
            record_decisions(decided, &mut reputation, context.day.params, &mut facts, &mut |_| {})
        });
        assert_eq!((renewals.cancellations, renewals.upgrades, renewals.downgrades), (1, 1, 0));
        assert_eq!((renewals.cancelled_individuals.len(), renewals.cancelled_individuals[0].n), (1, 1));
        assert_eq!(facts.endings[0].cause, EndCause::Quality);
        assert!(reputation.get(group()) < 0.5);
        let block = &customers.groups[group()].blocks[0];
        assert_eq!(block.n, [2, 3]);
        assert_eq!((block.plan[0], block.listed_price[0], block.start_day[0]), (Plan::C, 14.0, 1));
        assert_eq!(block.plan[1], Plan::A);
    }
}
