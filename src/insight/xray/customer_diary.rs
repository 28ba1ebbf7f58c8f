//! Records the days of one observed individual.

use std::sync::{Mutex, MutexGuard, PoisonError};

use super::weighed::Weighed;
use novamind_world::customers::choice::{Choice, offered};
use novamind_world::customers::columns::Block;
use novamind_world::customers::curve::{Curve, required_quality};
use novamind_world::day::watch::DayWatch;
use novamind_world::events::{EndCause, Facts, Source};
use novamind_world::identifiers::{ByGroup, ByPlan, Group, Plan};
use novamind_world::market::arrivals::{Arrivals, first_look};
use novamind_world::market::leads::LeadFactors;
use novamind_world::params::Params;
use novamind_world::retention::due_today;
use novamind_world::retention::renewal::RenewalContext;
use novamind_world::retention::weighing::weigh;
use novamind_world::state::World;

/// A plan, as a lead evaluates it.
#[derive(Debug, Clone, Copy)]
pub struct FirstTerms {
    /// Price after the discount, and quality with the quota, before noise.
    pub offered: Choice,
    /// Required quality at the price.
    pub required: f64,
}

/// The first decision of an individual.
#[derive(Debug, Clone)]
pub struct FirstDecision {
    /// The day.
    pub day: u32,
    /// Source of the lead.
    pub source: Source,
    /// The plans.
    pub plans: ByPlan<FirstTerms>,
    /// The evaluated plan: the one with the largest surplus before noise, or A if there is none.
    pub plan: Plan,
    /// Noise factor of the perceived quality.
    pub noise: f64,
    /// Participation curve with market expectations.
    pub curve: Curve,
    /// Whether the lead signed up.
    pub signed_up: bool,
}

/// The outcome of a day.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DayOutcome {
    /// Still subscribed.
    Stays,
    /// Switched to another plan.
    Switches(Plan),
    /// Cancelled.
    Leaves(EndCause),
}

/// A day of a subscriber, at the time of the decisions.
#[derive(Debug, Clone)]
pub struct CustomerDay {
    /// The day.
    pub day: u32,
    /// Plan at the start of the day.
    pub plan: Plan,
    /// Price in force, dollars a month.
    pub price: f64,
    /// Satisfaction after the day.
    pub satisfaction: f64,
    /// Relationship, 0..=1.
    pub relationship: f64,
    /// Number of days that an issue has been open.
    pub open_issue_days: u32,
    /// Whether it is a billing day.
    pub is_due: bool,
    /// Probability of a failed payment on a billing day.
    pub payment_failure: f64,
    /// The evaluated decision, also on days that are not billing days.
    pub weighed: Weighed,
    /// Outcome of the day.
    pub outcome: DayOutcome,
}

pub(crate) struct CustomerDiary {
    customer: u32,
    group: Group,
    n: u32,
    arrival_day: u32,
    pages: Mutex<CustomerPages>,
}

#[derive(Default)]
pub(crate) struct CustomerPages {
    pub(crate) first: Option<FirstDecision>,
    pub(crate) days: Vec<CustomerDay>,
    today: Option<CustomerDay>,
    last_bill: Option<ByPlan<f64>>,
}

impl CustomerDiary {
    /// Creates an empty recorder for the n-th customer of a group.
    pub(crate) fn of(customer: u32, (group, n): (Group, u32), arrival_day: u32) -> CustomerDiary {
        CustomerDiary { customer, group, n, arrival_day, pages: Mutex::default() }
    }

    pub(crate) fn take(&self) -> CustomerPages {
        std::mem::take(&mut *self.pages())
    }

    fn pages(&self) -> MutexGuard<'_, CustomerPages> {
        self.pages.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl DayWatch for CustomerDiary {
    fn before_decisions(&self, group: Group, block: &Block, judgement: &RenewalContext<'_>) {
        if group != self.group {
            return;
        }
        let Some(at) = block.position(self.n) else { return };
        let (day, params) = (judgement.day.day(), judgement.day.params);
        let mut pages = self.pages();
        let weighing = weigh(group, block, at, judgement);
        let is_due = due_today(block, day, params).contains(&at);
        pages.today = Some(CustomerDay {
            day,
            plan: block.plan[at],
            price: block.effective_price[at],
            satisfaction: block.satisfaction[at],
            relationship: block.relationship[at],
            open_issue_days: block.open_issue_days[at],
            is_due,
            payment_failure: if is_due { judgement.involuntary[group] } else { 0.0 },
            weighed: Weighed::of(&weighing, pages.last_bill.as_ref(), params),
            outcome: DayOutcome::Stays,
        });
        if is_due {
            pages.last_bill = Some(weighing.prices);
        }
    }

    fn leads_expected(&self, arrivals: &Arrivals<'_>, _: &ByGroup<u32>, factors: &ByGroup<LeadFactors>) {
        if arrivals.day.day() != self.arrival_day {
            return;
        }
        let params = arrivals.day.params;
        let look = first_look(arrivals, factors, self.group, self.n);
        let plans = ByPlan::from_fn(|plan| {
            let offered = offered(&look.offers[plan], plan, look.discount, look.demand, params);
            FirstTerms { offered, required: required_quality(offered.price, &look.curve, params) }
        });
        let mut pages = self.pages();
        pages.last_bill = Some(ByPlan::from_fn(|plan| plans[plan].offered.price));
        pages.first = Some(FirstDecision {
            day: self.arrival_day,
            source: Source::Organic,
            plans,
            plan: look.choice.plan,
            noise: look.noise,
            curve: look.curve,
            signed_up: look.accepts(params),
        });
    }

    fn day_over(&self, world: &World, _: &Params, facts: &Facts) {
        let mut pages = self.pages();
        if let Some(first) = pages.first.as_mut().filter(|first| first.day == world.day) {
            let own = facts.arrivals.iter().find(|arrival| arrival.customer == self.customer);
            first.source = own.map_or(Source::Organic, |arrival| arrival.source);
        }
        let Some(mut today) = pages.today.take() else { return };
        let ended = facts.endings.iter().find(|ending| ending.customer == self.customer);
        let changed = facts.changes.iter().find(|change| change.customer == self.customer);
        today.outcome = match (ended, changed) {
            (Some(ending), _) => DayOutcome::Leaves(ending.cause),
            (None, Some(change)) if change.plan != today.plan => DayOutcome::Switches(change.plan),
            _ => DayOutcome::Stays,
        };
        pages.days.push(today);
    }
}
