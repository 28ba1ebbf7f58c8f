//! Turns the leads of a day into subscribers, enterprise leads or lost leads (docs/mechanics/market/arrivals.md).

use rayon::prelude::*;

use super::leads::{LeadContext, LeadFactors, lead_factors};
use crate::context::DayContext;
use crate::customers::Customers;
use crate::customers::choice::{PlanChoice, PlanOffer, choose_plan, is_accepted, passes_quality_gate};
use crate::customers::columns::Subscriber;
use crate::customers::curve::Curve;
use crate::customers::customer_numbers::ArrivalRun;
use crate::customers::drift::Expectation;
use crate::customers::traits::{Traits, draw_traits_from_stream};
use crate::enterprise::{Enterprise, EnterpriseCustomer, EnterpriseStatus};
use crate::events::{Arrival, ChannelLeads, Facts, Source, SubscriptionOpened, SubscriptionStatus};
use crate::identifiers::{ByGroup, ByPlan, Group, Plan};
use crate::market::Market;
use crate::market::economy::Dimension;
use crate::params::{DriftCounted, Params, ServicePenalty};
use crate::quality::quota_demand;
use crate::random::{Part, Stream, Word};
use crate::retention::renewal::ongoing_discount;
use crate::retention::required_at_price;

/// Number of leads of a day, by outcome.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct LeadCounts {
    /// Number of all leads, including enterprises below the quality gate.
    pub all: u32,
    /// Number of individual leads.
    pub individuals: u32,
    /// Number of enterprise leads that opened a thread.
    pub companies: u32,
    /// Number of individuals who signed up.
    pub subscribed: u32,
}

/// Inputs that all arrivals of a day share.
pub struct ArrivalContext<'a> {
    /// Values that all customer mechanisms of the day share.
    pub day: &'a DayContext<'a>,
    /// The market, including today's changes.
    pub market: &'a Market,
}

struct Lead {
    traits: Traits,
    /// Participation curve of the lead, with today's expectations added once.
    curve: Curve,
    source: Source,
    outcome: LeadOutcome,
}

/// Prices and discount of a new subscription, dollars per month.
#[derive(Clone, Copy)]
struct InitialTerms {
    listed_price: f64,
    promotion: f64,
    effective_price: f64,
}

enum LeadOutcome {
    Subscribes { choice: PlanChoice, terms: InitialTerms, required: f64 },
    Lost { choice: PlanChoice, discount: f64 },
    RequestsOffer,
    BelowQualityGate,
}

/// Returns the factors of today's leads by group. The factors of undiscovered groups are 0.
pub fn expected_leads(arrivals: &ArrivalContext<'_>, subscribers: &ByGroup<u32>) -> ByGroup<LeadFactors> {
    let (market, context) = (arrivals.market, lead_context(arrivals, subscribers));
    ByGroup::from_fn(|group| {
        if market.is_known(group) { lead_factors(group, &context) } else { LeadFactors::default() }
    })
}

/// Returns the inputs from which the day's lead factors are computed.
pub fn lead_context<'a>(arrivals: &ArrivalContext<'a>, subscribers: &'a ByGroup<u32>) -> LeadContext<'a> {
    let &ArrivalContext { day: &DayContext { morning, settings, params, .. }, market } = arrivals;
    LeadContext {
        day: morning.day,
        calendar: morning.weekday * morning.month_day,
        market,
        subscribers,
        ads: &settings.targeted_ads,
        params,
    }
}

/// Draws and evaluates the leads of the day. Subscriptions are numbered in this order: subscribers, lost leads,
/// enterprises, each by customer number.
pub fn process_arrivals(
    arrivals: &ArrivalContext<'_>,
    factors: &ByGroup<LeadFactors>,
    customers: &mut Customers,
    enterprise: &mut Enterprise,
    facts: &mut Facts,
) -> LeadCounts {
    let mut arrival_runs: Vec<ArrivalRun> = Vec::new();
    for group in Group::all() {
        let keys = [u64::from(arrivals.day.day()), group.index() as u64];
        let expected = factors[group].expected();
        let number = arrivals.day.streams.open(Part::LeadCount, keys).poisson(expected) as u32;
        arrival_runs
            .extend(customers.record_arrival(arrivals.day.day(), group, number).split(LEADS_PER_BATCH));
    }
    let leads_by_run: Vec<(ArrivalRun, Vec<Lead>)> = arrival_runs
        .into_par_iter()
        .with_max_len(1)
        .map(|arrival_run| (arrival_run, evaluate_leads(arrivals, factors, &arrival_run)))
        .collect();
    let mut counts = LeadCounts::default();
    let first = customers.next_subscription;
    rayon::join(
        || activate_subscribers(arrivals, &leads_by_run, first, customers),
        || {
            record_arrivals(&leads_by_run, &mut counts, facts);
            record_channels(arrivals, &leads_by_run, facts);
            record_openings(arrivals, &leads_by_run, first, &mut counts, facts);
        },
    );
    customers.next_subscription += counts.individuals;
    open_lead_threads(arrivals, leads_by_run, customers, enterprise, facts, &mut counts);
    counts
}

/// Number of leads whose random streams are opened together: a multiple of the SIMD lanes, and small enough to
/// distribute the work among threads.
const LEADS_PER_BATCH: u32 = 64;

fn evaluate_leads(
    arrivals: &ArrivalContext<'_>,
    factors: &ByGroup<LeadFactors>,
    arrival_run: &ArrivalRun,
) -> Vec<Lead> {
    let &ArrivalContext { day: &DayContext { params, streams, .. }, market } = arrivals;
    let group = arrival_run.group;
    let offers = plan_offers(arrivals, group);
    let velocity = market.economy.multiplier(group, Dimension::DealVelocity, params);
    let keys: Vec<[u64; 2]> = arrival_run.numbers().map(|(n, _)| [group.index() as u64, n.into()]).collect();
    let traits = streams.keys(Part::Traits, &keys);
    let sources = streams.first_words(Part::LeadSource, &keys);
    let noises = streams.first_words(Part::LeadNoise, &keys);
    let draws = arrival_run.numbers().zip(traits).zip(sources.into_iter().zip(noises));
    draws
        .map(|(((_, customer), key), (source, noise))| {
            let traits = draw_traits_from_stream(Stream::from_key(key), group, velocity, params);
            let source = factors[group].pick_source(source.uniform());
            evaluate_lead(arrivals, &offers, (group, customer), traits, source, noise)
        })
        .collect()
}

fn plan_offers(arrivals: &ArrivalContext<'_>, group: Group) -> ByPlan<PlanOffer> {
    let &DayContext { morning, params, .. } = arrivals.day;
    let penalty = match params.fidelity.service_penalty {
        ServicePenalty::Satisfaction => 0.0,
        ServicePenalty::Everywhere => arrivals.day.service_penalty,
    };
    ByPlan::from_fn(|plan| PlanOffer {
        price: morning.core.prices[plan],
        quality: morning.delivered(group, plan) - penalty,
        quota: morning.quotas[plan],
    })
}

/// The decision of an individual lead, with the inputs of the decision.
#[derive(Debug, Clone, Copy)]
pub struct LeadEvaluation {
    /// Price, quality and quota of each plan on the day of arrival.
    pub offers: ByPlan<PlanOffer>,
    /// Discount for the lead's group and channel, dollars per month.
    pub discount: f64,
    /// Demand of the lead, in units per day, which is compared with quotas.
    pub demand: f64,
    /// The lead's curve including today's expectations.
    pub curve: Curve,
    /// The plan that the lead picks.
    pub choice: PlanChoice,
    /// Factor by which the lead misjudges quality.
    pub noise: f64,
}

impl LeadEvaluation {
    /// Evaluates offers for a lead with this curve and demand. The demand is compared with quotas. `promotion` is the
    /// discount for leads, dollars per month.
    #[inline]
    pub fn new(
        offers: &ByPlan<PlanOffer>,
        promotion: f64,
        (curve, demand): (Curve, f64),
        noise: Word,
        params: &Params,
    ) -> LeadEvaluation {
        let quality = &params.quality;
        let discount = promotion.max(params.promotions.lead_promotion_min);
        LeadEvaluation {
            offers: *offers,
            discount,
            demand,
            curve,
            choice: choose_plan(offers, discount, demand, &curve, params),
            noise: noise.between(quality.initial_decision_noise_min, quality.initial_decision_noise_max),
        }
    }

    /// Returns whether the lead signs up.
    pub fn is_accepted(&self, params: &Params) -> bool {
        is_accepted(&self.choice, self.noise, &self.curve, params)
    }
}

/// Evaluates the lead with sequence number `n` of a group of individuals on the day of arrival.
pub fn evaluate_individual(
    arrivals: &ArrivalContext<'_>,
    factors: &ByGroup<LeadFactors>,
    group: Group,
    n: u32,
) -> LeadEvaluation {
    let &DayContext { params, streams, .. } = arrivals.day;
    let velocity = arrivals.market.economy.multiplier(group, Dimension::DealVelocity, params);
    let keys = [group.index() as u64, u64::from(n)];
    let traits = draw_traits_from_stream(streams.open(Part::Traits, keys), group, velocity, params);
    let first_word = |part| streams.first_words(part, &[keys])[0];
    let source = factors[group].pick_source(first_word(Part::LeadSource).uniform());
    let (curve, demand) = curve_and_demand(arrivals, group, &traits);
    evaluate_offers(
        arrivals,
        &plan_offers(arrivals, group),
        group,
        source,
        (curve, demand),
        first_word(Part::LeadNoise),
    )
}

fn evaluate_offers(
    arrivals: &ArrivalContext<'_>,
    offers: &ByPlan<PlanOffer>,
    group: Group,
    source: Source,
    (curve, demand): (Curve, f64),
    noise: Word,
) -> LeadEvaluation {
    let &DayContext { settings, params, .. } = arrivals.day;
    let promotion = settings.lead_promotion.sum(group, source.channel());
    LeadEvaluation::new(offers, promotion, (curve, demand), noise, params)
}

fn curve_and_demand(arrivals: &ArrivalContext<'_>, group: Group, traits: &Traits) -> (Curve, f64) {
    let &DayContext { morning, params, .. } = arrivals.day;
    curve_and_demand_with(morning.expectations[group], traits, params)
}

/// Returns the curve of a lead, including the market's expectations, and the demand that is compared with quotas.
pub fn curve_and_demand_with(expectation: Expectation, traits: &Traits, params: &Params) -> (Curve, f64) {
    let floor = params.customer_generation.c_max_min;
    let curve = traits.curve.with_drift(expectation.quality, expectation.c_max, floor);
    let rate = traits.usage_demand * traits.seats;
    (curve, quota_demand(rate, rate, params))
}

fn evaluate_lead(
    arrivals: &ArrivalContext<'_>,
    offers: &ByPlan<PlanOffer>,
    (group, customer): (Group, u32),
    traits: Traits,
    source: Source,
    noise: Word,
) -> Lead {
    let &DayContext { morning, params, .. } = arrivals.day;
    let (curve, demand) = curve_and_demand(arrivals, group, &traits);
    let outcome = if group.is_enterprise() {
        if passes_quality_gate(offers, demand, &curve, params) {
            LeadOutcome::RequestsOffer
        } else {
            LeadOutcome::BelowQualityGate
        }
    } else {
        let evaluation = evaluate_offers(arrivals, offers, group, source, (curve, demand), noise);
        let LeadEvaluation { choice, discount, .. } = evaluation;
        if evaluation.is_accepted(params) {
            let terms = initial_terms(arrivals, group, customer, choice, discount);
            let stored = stored_curve(&traits, &curve, params);
            let c_drift = morning.expectations[group].c_max;
            let required = required_at_price(&stored, stored.c_max, terms.effective_price, c_drift, params);
            LeadOutcome::Subscribes { choice, terms, required }
        } else {
            LeadOutcome::Lost { choice, discount }
        }
    };
    Lead { traits, curve, source, outcome }
}

fn record_arrivals(leads_by_run: &[(ArrivalRun, Vec<Lead>)], counts: &mut LeadCounts, facts: &mut Facts) {
    for (run, leads) in leads_by_run {
        counts.all += run.count;
        for ((n, customer), lead) in run.numbers().zip(leads) {
            facts.arrivals.push(Arrival {
                customer,
                group: run.group,
                n,
                source: lead.source,
                persona: lead.traits.persona,
                usage_demand: lead.traits.usage_demand,
                c_max: lead.curve.c_max,
                seats: lead.traits.seats as u32,
            });
        }
    }
}

/// Records the leads of every pair of a known group and a channel whose budget and yield are above 0. Channels are in
/// channel order; groups are in the order in which the player listed them.
fn record_channels(
    arrivals: &ArrivalContext<'_>,
    leads_by_run: &[(ArrivalRun, Vec<Lead>)],
    facts: &mut Facts,
) {
    let &ArrivalContext { day: &DayContext { settings, .. }, market } = arrivals;
    for channel in crate::identifiers::Channel::ALL {
        let Some(groups) = settings.targeted_ads.targeted_spend.get(&channel) else { continue };
        for (&group, &spend) in groups {
            if spend > 0.0 && market.is_known(group) && market.yields[channel][group] > 0.0 {
                let group_leads =
                    leads_by_run.iter().filter(|(run, _)| run.group == group).flat_map(|(_, leads)| leads);
                let leads = group_leads.filter(|lead| lead.source.channel() == Some(channel)).count() as u32;
                facts.channel_leads.push(ChannelLeads { channel, group, leads, spend });
            }
        }
    }
}

/// Returns the individual leads, each with its customer number.
fn individual_leads(leads_by_run: &[(ArrivalRun, Vec<Lead>)]) -> impl Iterator<Item = (u32, &Lead)> {
    leads_by_run
        .iter()
        .filter(|(run, _)| !run.group.is_enterprise())
        .flat_map(|(run, leads)| run.numbers().map(|(_, customer)| customer).zip(leads))
}

/// Activates the individuals who sign up. Subscription numbers start at `first`.
fn activate_subscribers(
    arrivals: &ArrivalContext<'_>,
    leads_by_run: &[(ArrivalRun, Vec<Lead>)],
    first: u32,
    customers: &mut Customers,
) {
    let mut subscription = first;
    for (run, leads) in leads_by_run.iter().filter(|(run, _)| !run.group.is_enterprise()) {
        let mut rows = Vec::with_capacity(leads.len());
        for ((n, customer), lead) in run.numbers().zip(leads) {
            if let LeadOutcome::Subscribes { choice, terms, required } = lead.outcome {
                let InitialTerms { listed_price, promotion, effective_price } = terms;
                rows.push(Subscriber {
                    plan: choice.plan,
                    listed_price,
                    promotion,
                    effective_price,
                    required,
                    ..new_subscriber_row(arrivals, n, customer, subscription, lead)
                });
                subscription += 1;
            }
        }
        customers.groups[run.group].append_subscribers(&rows);
    }
}

/// Records the subscription rows of individuals: subscribers, then lost leads. Subscription numbers start at `first`.
fn record_openings(
    arrivals: &ArrivalContext<'_>,
    leads_by_run: &[(ArrivalRun, Vec<Lead>)],
    first: u32,
    counts: &mut LeadCounts,
    facts: &mut Facts,
) {
    let mut open = |customer, plan, status, InitialTerms { listed_price, promotion, effective_price }| {
        facts.openings.push(SubscriptionOpened {
            subscription: first + counts.individuals,
            customer,
            plan: Some(plan),
            status,
            listed_price,
            promotion,
            effective_price,
            seats: 1,
        });
        counts.individuals += 1;
    };
    for (customer, lead) in individual_leads(leads_by_run) {
        if let LeadOutcome::Subscribes { choice, terms, .. } = lead.outcome {
            open(customer, choice.plan, SubscriptionStatus::Subscribed, terms);
            counts.subscribed += 1;
        }
    }
    for (customer, lead) in individual_leads(leads_by_run) {
        if let LeadOutcome::Lost { choice, discount } = lead.outcome {
            let listed_price = arrivals.day.morning.core.prices[choice.plan];
            let terms = InitialTerms { listed_price, promotion: discount, effective_price: choice.price };
            open(customer, choice.plan, SubscriptionStatus::Lost, terms);
        }
    }
}

fn initial_terms(
    arrivals: &ArrivalContext<'_>,
    group: Group,
    customer: u32,
    choice: PlanChoice,
    discount: f64,
) -> InitialTerms {
    let &DayContext { morning, settings, params, .. } = arrivals.day;
    let listed_price = morning.core.prices[choice.plan];
    let promotion = discount + ongoing_discount(customer, group, choice.plan, settings, params);
    let effective_price = (listed_price - promotion).max(params.billing.effective_price_min);
    InitialTerms { listed_price, promotion, effective_price }
}

/// Returns the curve that the subscriber's row stores. If drift is counted once, the curve is stored without drift.
fn stored_curve(traits: &Traits, drifted: &Curve, params: &Params) -> Curve {
    match params.fidelity.drift_counted {
        DriftCounted::EveryRead => *drifted,
        DriftCounted::Once => traits.curve,
    }
}

/// Returns the initial subscriber row of a lead. All prices are 0 until the lead accepts one.
fn new_subscriber_row(
    arrivals: &ArrivalContext<'_>,
    n: u32,
    customer: u32,
    subscription: u32,
    lead: &Lead,
) -> Subscriber {
    let &DayContext { morning, params, .. } = arrivals.day;
    let stored = stored_curve(&lead.traits, &lead.curve, params);
    Subscriber {
        n,
        customer,
        subscription,
        plan: Plan::A,
        billing_day: (morning.day % params.billing.billing_period_days) as u8,
        billed_once: false,
        start_day: morning.day,
        steepness_left: stored.steepness_left,
        steepness_right: stored.steepness_right,
        c_max: stored.c_max,
        q_min: stored.q_min,
        q_max: stored.q_max,
        usage_demand: lead.traits.usage_demand,
        ads_quality_sensitivity: lead.traits.ads_quality_sensitivity,
        ads_return_sensitivity: lead.traits.ads_return_sensitivity,
        seats: lead.traits.seats,
        listed_price: 0.0,
        promotion: 0.0,
        effective_price: 0.0,
        effective_c_max: stored.c_max,
        // The usage rate is drawn with the first bill or deal.
        usage_rate: 0.0,
        period_usage: 0,
        satisfaction: params.initial.customer_satisfaction,
        relationship: params.initial.customer_relationship,
        open_issue_days: 0,
        issue: 0,
        required: 0.0,
    }
}

fn open_lead_threads(
    arrivals: &ArrivalContext<'_>,
    leads_by_run: Vec<(ArrivalRun, Vec<Lead>)>,
    customers: &mut Customers,
    enterprise: &mut Enterprise,
    facts: &mut Facts,
    counts: &mut LeadCounts,
) {
    for (run, leads) in leads_by_run {
        for ((n, customer), lead) in run.numbers().zip(leads) {
            if !matches!(lead.outcome, LeadOutcome::RequestsOffer) {
                continue;
            }
            counts.companies += 1;
            let subscription = customers.next_subscription;
            customers.next_subscription += 1;
            facts.openings.push(SubscriptionOpened {
                subscription,
                customer,
                plan: None,
                status: SubscriptionStatus::Lead,
                listed_price: 0.0,
                promotion: 0.0,
                effective_price: 0.0,
                seats: lead.traits.seats as u32,
            });
            let row = new_subscriber_row(arrivals, n, customer, subscription, &lead);
            if let Some(negotiator) = lead.traits.negotiator {
                let company = EnterpriseCustomer {
                    customer,
                    group: run.group,
                    n,
                    subscription,
                    negotiator,
                    persona: lead.traits.persona,
                    contract_end_day: 0,
                    status: EnterpriseStatus::Lead(row),
                };
                enterprise.open_lead_thread(arrivals.day.day(), company, facts);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::customers::traits::draw_traits;
    use crate::random::Streams;

    #[test]
    fn stored_curve_contains_drift_only_if_drift_is_counted_at_every_read() {
        let mut params = Params::bundled();
        let group = Group::at(0).expect("S1");
        let mut traits = draw_traits(group, 1, 1.0, &params, &Streams::new(1));
        (traits.curve.q_min, traits.curve.q_max, traits.curve.c_max) = (0.1, 0.55, 50.0);
        let expectation = Expectation { quality: 0.25, c_max: 2.0 };
        let (drifted, _) = curve_and_demand_with(expectation, &traits, &params);
        let values = |curve: Curve| (curve.q_min, curve.q_max, curve.c_max);
        assert_eq!(values(drifted), (0.35, 0.8, 52.0), "the curve that the lead uses to decide");
        assert_eq!(values(stored_curve(&traits, &drifted, &params)), (0.35, 0.8, 52.0));
        params.fidelity.drift_counted = DriftCounted::Once;
        assert_eq!(values(stored_curve(&traits, &drifted, &params)), (0.1, 0.55, 50.0));
    }
}
