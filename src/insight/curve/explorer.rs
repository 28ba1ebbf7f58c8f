//! A group's curve, the plans as they stand, and what leads would make of other ones.

use serde::Serialize;

use std::fmt;
use std::sync::Arc;

use novamind_world::customers::choice::Offer;
use novamind_world::customers::drift::Expectation;
use novamind_world::identifiers::{ByPlan, Group, Plan};
use novamind_world::market::lead_sample::{FirstChoices, LeadSample};
use novamind_world::params::Params;
use novamind_world::random::Streams;

/// Leads that are asked.
pub const SAMPLED_LEADS: u32 = 2000;
/// The streams that they are drawn from: the same in every run, and not those of its customers.
const SEED_OF_SAMPLE: u64 = 0x5EED;
/// Prices at which the curve is read.
const STEPS: usize = 60;
/// Shares of the leads whose curves are told.
const SHARES: [f64; 3] = [0.1, 0.5, 0.9];

/// What the curve is drawn from.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum CurveBasis {
    /// The traits of the group, with what the market has added to them up to a day.
    Truth {
        /// The day.
        day: u32,
    },
    /// What studies have told.
    Estimates {
        /// Level of knowledge, 1..=5.
        level: u8,
        /// Largest relative error, 0..1.
        noise: f64,
        /// Day that floor and budget are of.
        as_of: u32,
    },
}

/// A plan that leads are asked about.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlanPoint {
    /// List price, dollars a month, of companies per seat.
    pub list: f64,
    /// Delivered quality.
    pub quality: f64,
    /// Units a day; infinite where none is set.
    pub quota: f64,
}

/// How much quality is required at a price. Infinite where the price is above the budget: no quality wins so many.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurvePoint {
    /// Dollars a month, of companies per seat.
    pub price: f64,
    /// A tenth of the leads ask for no more.
    pub tenth: f64,
    /// Half of them.
    pub median: f64,
    /// Nine tenths.
    pub ninetieth: f64,
    /// Least and greatest median of the groups that fit the estimates; the median itself where the truth is known.
    pub median_between: (f64, f64),
}

/// A figure, and its ends over the groups that fit the estimates.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Expected {
    /// If the estimates are right.
    pub likely: f64,
    /// Least.
    pub least: f64,
    /// Greatest.
    pub most: f64,
}

/// What leads would do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurveOutcome {
    /// Share of leads that sign up; of companies, that ask for an offer.
    pub conversion: Expected,
    /// Dollars a lead with its first bill; none of companies, which negotiate theirs.
    pub revenue_per_lead: Option<Expected>,
    /// Share of leads that take each plan if the estimates are right; none of companies.
    pub takers: Option<ByPlan<f64>>,
}

/// Leads of one market, and the parameters that decide for them.
struct Market {
    sample: LeadSample,
    params: Arc<Params>,
}

/// The explorer of a group.
pub struct CurveExplorer {
    /// Group.
    pub group: Group,
    /// What it is drawn from.
    pub basis: CurveBasis,
    /// The plans as they stand.
    pub plans: ByPlan<PlanPoint>,
    /// Promotion for leads that every channel brings, dollars a month; not for companies.
    pub promotion: f64,
    /// Promotion for subscribers, which makes the first bill cheaper, dollars a month.
    pub ongoing: ByPlan<f64>,
    /// The curve, at prices from 0 up.
    pub points: Vec<CurvePoint>,
    /// The market, and the two ends of what fits the estimates.
    markets: Vec<Market>,
}

impl fmt::Debug for CurveExplorer {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "CurveExplorer({} {:?})", self.group, self.basis)
    }
}

impl Market {
    fn draw(group: Group, expectation: Expectation, params: Arc<Params>) -> Market {
        let streams = Streams::new(SEED_OF_SAMPLE);
        let sample = LeadSample::draw(group, SAMPLED_LEADS, expectation, &params, &streams);
        Market { sample, params }
    }
}

/// What is on offer to a group.
pub(super) struct OnOffer {
    pub(super) plans: ByPlan<PlanPoint>,
    pub(super) promotion: f64,
    pub(super) ongoing: ByPlan<f64>,
}

impl CurveExplorer {
    /// Of a group in markets: the likely one first, then those that fit as well.
    pub(super) fn drawn(
        group: Group,
        basis: CurveBasis,
        on_offer: OnOffer,
        markets: Vec<(Expectation, Arc<Params>)>,
    ) -> CurveExplorer {
        let OnOffer { plans, promotion, ongoing } = on_offer;
        let markets: Vec<Market> = markets
            .into_iter()
            .map(|(expectation, params)| Market::draw(group, expectation, params))
            .collect();
        let mut explorer =
            CurveExplorer { group, basis, plans, promotion, ongoing, points: Vec::new(), markets };
        let most = explorer.greatest_price();
        let price = |step: usize| most * step as f64 / STEPS as f64;
        explorer.points = (0..=STEPS).map(|step| explorer.point(price(step))).collect();
        explorer
    }

    /// The price at the right end of the curve, dollars a month: nearly all budgets lie below it, and so do the plans.
    fn greatest_price(&self) -> f64 {
        let budget = self.markets[0].sample.budget(0.9);
        let plans = self.plans.iter().map(|own| 1.2 * own.list);
        let most = plans.fold(budget, f64::max);
        (most / 10.0).ceil().max(1.0) * 10.0
    }

    /// The curve at a price.
    fn point(&self, price: f64) -> CurvePoint {
        let required = |market: &Market, share: &[f64]| market.sample.required(price, share, &market.params);
        let own = required(&self.markets[0], &SHARES);
        let medians: Vec<f64> = self.markets.iter().map(|market| required(market, &[0.5])[0]).collect();
        CurvePoint {
            price,
            tenth: own[0],
            median: own[1],
            ninetieth: own[2],
            median_between: (least(&medians), greatest(&medians)),
        }
    }

    /// Whether the truth is known, so that figures have no ends.
    pub fn is_truth(&self) -> bool {
        matches!(self.basis, CurveBasis::Truth { .. })
    }

    /// What leads would do with these plans, under the promotions in force.
    pub fn outcome(&self, plans: &ByPlan<PlanPoint>) -> CurveOutcome {
        self.ask(plans, self.promotion, &self.ongoing)
    }

    /// What leads would do with one product of a price and a quality, without quota and promotion.
    pub fn outcome_of(&self, price: f64, quality: f64) -> CurveOutcome {
        let point = PlanPoint { list: price, quality, quota: f64::INFINITY };
        self.ask(&ByPlan([point; 3]), 0.0, &ByPlan([0.0; 3]))
    }

    fn ask(&self, plans: &ByPlan<PlanPoint>, promotion: f64, ongoing: &ByPlan<f64>) -> CurveOutcome {
        let offers = ByPlan::from_fn(|plan: Plan| {
            let PlanPoint { list, quality, quota } = plans[plan];
            Offer { price: list, quality, quota }
        });
        let choose = |market: &Market| market.sample.choose(&offers, promotion, ongoing, &market.params);
        let choices: Vec<FirstChoices> = self.markets.iter().map(choose).collect();
        let expected = |of: fn(&FirstChoices) -> f64| {
            let values: Vec<f64> = choices.iter().map(of).collect();
            Expected { likely: values[0], least: least(&values), most: greatest(&values) }
        };
        let is_individual = !self.group.is_enterprise();
        let likely = &choices[0];
        CurveOutcome {
            conversion: expected(FirstChoices::conversion),
            revenue_per_lead: is_individual.then(|| expected(FirstChoices::revenue_per_lead)),
            takers: is_individual.then(|| {
                ByPlan::from_fn(|plan: Plan| f64::from(likely.takers[plan]) / f64::from(likely.leads))
            }),
        }
    }
}

/// The curve of a group's customers as parameters make them, before anything has moved: of no run.
pub fn true_curve_of(group: Group, params: &Params) -> Vec<CurvePoint> {
    let nothing = PlanPoint { list: 0.0, quality: 0.0, quota: f64::INFINITY };
    let on_offer = OnOffer { plans: ByPlan([nothing; 3]), promotion: 0.0, ongoing: ByPlan([0.0; 3]) };
    let market = (Expectation::default(), Arc::new(params.clone()));
    CurveExplorer::drawn(group, CurveBasis::Truth { day: 0 }, on_offer, vec![market]).points
}

fn least(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::INFINITY, f64::min)
}

fn greatest(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::NEG_INFINITY, f64::max)
}
