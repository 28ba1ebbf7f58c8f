//! A recorder of one individual's signup decision and of the individual's state on each later day.

use std::sync::{Mutex, MutexGuard, PoisonError};

use super::weighed_decision::WeighedDecision;
use novamind_world::customers::choice::{PlanChoice, evaluate_offer};
use novamind_world::customers::columns::Block;
use novamind_world::customers::curve::{Curve, required_quality};
use novamind_world::day::observer::DayObserver;
use novamind_world::events::{EndCause, Facts, Source};
use novamind_world::identifiers::{ByGroup, ByPlan, Group, Plan};
use novamind_world::market::arrivals::{ArrivalContext, evaluate_individual};
use novamind_world::market::leads::LeadFactors;
use novamind_world::params::Params;
use novamind_world::retention::due_today;
use novamind_world::retention::plan_comparison::compare_plans;
use novamind_world::retention::renewal::RenewalContext;
use novamind_world::state::World;

/// A lead's evaluation of a plan.
#[derive(Debug, Clone, Copy)]
pub struct LeadPlanTerms {
    /// Price after the discount, and quality after the effect of the quota, before noise.
    pub offered: PlanChoice,
    /// Required quality at the plan's price.
    pub required: f64,
}

/// An individual's decision as a lead.
#[derive(Debug, Clone)]
pub struct SignupDecision {
    /// Day on which the individual decided as a lead.
    pub day: u32,
    /// Source through which the lead arrived.
    pub source: Source,
    /// The lead's evaluation of each plan.
    pub plans: ByPlan<LeadPlanTerms>,
    /// The plan with the largest surplus before noise, or plan A if no plan has a surplus. The lead accepts or rejects
    /// this plan.
    pub plan: Plan,
    /// Random factor of the perceived quality.
    pub quality_noise: f64,
    /// Participation curve of the lead, including market expectations.
    pub curve: Curve,
    /// Whether the lead signed up.
    pub signed_up: bool,
}

/// The outcome of a day for a subscription.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SubscriberOutcome {
    /// The subscription continues on the same plan.
    Stays,
    /// The subscriber switched to the given plan.
    Switches(Plan),
    /// The subscription ended.
    Cancels(EndCause),
}

/// A subscriber's state on a day, at the time of the decisions.
#[derive(Debug, Clone)]
pub struct IndividualDay {
    /// Day of the state.
    pub day: u32,
    /// Plan of the subscriber at the start of the day.
    pub plan: Plan,
    /// Price in force, $ per month.
    pub price: f64,
    /// Satisfaction after the change of the day.
    pub satisfaction: f64,
    /// Relationship to the company, 0..=1.
    pub relationship: f64,
    /// Number of days for which the current issue has been open.
    pub open_issue_days: u32,
    /// Whether the day is a billing day.
    pub is_due: bool,
    /// Probability that the payment fails on a billing day; 0 on other days.
    pub payment_failure: f64,
    /// Evaluated decision, which is also computed on days that are not billing days.
    pub weighed_decision: WeighedDecision,
    /// What happened to the subscription on the day.
    pub outcome: SubscriberOutcome,
}

pub(crate) struct IndividualRecorder {
    customer: u32,
    group: Group,
    number_in_group: u32,
    arrival_day: u32,
    recorded: Mutex<IndividualRecord>,
}

#[derive(Default)]
pub(crate) struct IndividualRecord {
    pub(crate) signup: Option<SignupDecision>,
    pub(crate) days: Vec<IndividualDay>,
    today: Option<IndividualDay>,
    last_bill: Option<ByPlan<f64>>,
}

impl IndividualRecorder {
    /// Creates an empty recorder for customer `n` of a group.
    pub(crate) fn new(customer: u32, (group, n): (Group, u32), arrival_day: u32) -> IndividualRecorder {
        IndividualRecorder { customer, group, number_in_group: n, arrival_day, recorded: Mutex::default() }
    }

    pub(crate) fn take_record(&self) -> IndividualRecord {
        std::mem::take(&mut *self.lock())
    }

    fn lock(&self) -> MutexGuard<'_, IndividualRecord> {
        self.recorded.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl DayObserver for IndividualRecorder {
    fn before_decisions(&self, group: Group, block: &Block, judgement: &RenewalContext<'_>) {
        if group != self.group {
            return;
        }
        let Some(at) = block.position(self.number_in_group) else { return };
        let (day, params) = (judgement.day.day(), judgement.day.params);
        let mut pages = self.lock();
        let weighing = compare_plans(group, block, at, judgement);
        let is_due = due_today(block, day, params).contains(&at);
        pages.today = Some(IndividualDay {
            day,
            plan: block.plan[at],
            price: block.effective_price[at],
            satisfaction: block.satisfaction[at],
            relationship: block.relationship[at],
            open_issue_days: block.open_issue_days[at],
            is_due,
            payment_failure: if is_due { judgement.involuntary[group] } else { 0.0 },
            weighed_decision: WeighedDecision::new(&weighing, pages.last_bill.as_ref(), params),
            outcome: SubscriberOutcome::Stays,
        });
        if is_due {
            pages.last_bill = Some(weighing.prices);
        }
    }

    fn on_expected_leads(
        &self,
        arrivals: &ArrivalContext<'_>,
        _: &ByGroup<u32>,
        factors: &ByGroup<LeadFactors>,
    ) {
        if arrivals.day.day() != self.arrival_day {
            return;
        }
        let params = arrivals.day.params;
        let evaluation = evaluate_individual(arrivals, factors, self.group, self.number_in_group);
        let plans = ByPlan::from_fn(|plan| {
            let offered = evaluate_offer(
                &evaluation.offers[plan],
                plan,
                evaluation.discount,
                evaluation.demand,
                params,
            );
            LeadPlanTerms { offered, required: required_quality(offered.price, &evaluation.curve, params) }
        });
        let mut pages = self.lock();
        pages.last_bill = Some(ByPlan::from_fn(|plan| plans[plan].offered.price));
        pages.signup = Some(SignupDecision {
            day: self.arrival_day,
            source: Source::Organic,
            plans,
            plan: evaluation.choice.plan,
            quality_noise: evaluation.noise,
            curve: evaluation.curve,
            signed_up: evaluation.is_accepted(params),
        });
    }

    fn on_day_end(&self, world: &World, _: &Params, facts: &Facts) {
        let mut pages = self.lock();
        if let Some(first) = pages.signup.as_mut().filter(|first| first.day == world.day) {
            let arrival = facts.arrivals.iter().find(|arrival| arrival.customer == self.customer);
            first.source = arrival.map_or(Source::Organic, |arrival| arrival.source);
        }
        let Some(mut today) = pages.today.take() else { return };
        let ended = facts.endings.iter().find(|ending| ending.customer == self.customer);
        let changed = facts.changes.iter().find(|change| change.customer == self.customer);
        today.outcome = match (ended, changed) {
            (Some(ending), _) => SubscriberOutcome::Cancels(ending.cause),
            (None, Some(change)) if change.plan != today.plan => SubscriberOutcome::Switches(change.plan),
            _ => SubscriberOutcome::Stays,
        };
        pages.days.push(today);
    }
}
