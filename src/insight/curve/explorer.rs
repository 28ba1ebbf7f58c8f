//! The curve of a group, the current plans, and the expected decisions of leads about changed plans.

use serde::Serialize;

use std::fmt;
use std::sync::Arc;

use novamind_world::customers::choice::PlanOffer;
use novamind_world::customers::drift::Expectation;
use novamind_world::identifiers::{ByPlan, Group, Plan};
use novamind_world::market::lead_sample::{LeadChoices, LeadSample};
use novamind_world::params::{Params, ServicePenalty};
use novamind_world::random::Streams;

/// Number of simulated leads per market.
pub const LEAD_SAMPLE_SIZE: u32 = 2000;
/// Seed of the simulated leads. The seed is the same in every run and differs from the seed of the run's customers.
const SAMPLE_SEED: u64 = 0x5EED;
const PRICE_STEPS: usize = 60;
const CURVE_QUANTILES: [f64; 3] = [0.1, 0.5, 0.9];

/// The source of a group's curve.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum CurveBasis {
    /// The true traits of the group, including drift up to a day.
    Truth {
        /// Day up to which drift is included.
        day: u32,
    },
    /// The estimates of market studies.
    Estimates {
        /// Study level of the group, 1..=5.
        level: u8,
        /// Largest relative error of the estimates, 0..1.
        noise: f64,
        /// Day on which floor and budget were estimated.
        as_of: u32,
    },
}

/// The terms of a plan that leads evaluate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlanPoint {
    /// List price, $ per month; for enterprises, per seat.
    pub list_price: f64,
    /// Delivered quality of the plan.
    pub quality: f64,
    /// Quota, units per day; infinite if the plan has no quota.
    pub quota: f64,
}

/// Quantiles of the required quality at a price. A quantile is infinite if the price is above the budget of too many
/// leads.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurvePoint {
    /// Price, $ per month; for enterprises, per seat.
    pub price: f64,
    /// Quality that is sufficient for 10 % of the leads.
    pub p10: f64,
    /// Quality that is sufficient for 50 % of the leads.
    pub median: f64,
    /// Quality that is sufficient for 90 % of the leads.
    pub p90: f64,
    /// Lowest and highest median among the groups that match the estimates. If the curve shows true traits, both equal
    /// [`CurvePoint::median`].
    pub median_range: (f64, f64),
}

/// An expected figure, with its range over all groups that match the estimates.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ExpectedRange {
    /// Value of the figure if the estimates are exact.
    pub likely: f64,
    /// Lowest value that is consistent with the estimates.
    pub least: f64,
    /// Highest value that is consistent with the estimates.
    pub most: f64,
}

/// The expected decisions of leads about a set of plans.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurveOutcome {
    /// Share of leads that sign up, or share of enterprise leads that ask for an offer.
    pub conversion: ExpectedRange,
    /// Expected first bill per lead, in dollars; `None` for enterprises, which negotiate prices.
    pub revenue_per_lead: Option<ExpectedRange>,
    /// Share of leads that choose each plan if the estimates are exact; `None` for enterprises.
    pub plan_shares: Option<ByPlan<f64>>,
}

/// Simulated leads of one market, with the parameters of their decisions.
struct Market {
    sample: LeadSample,
    params: Arc<Params>,
}

/// The curve explorer of a group.
pub struct CurveExplorer {
    /// Group whose curve is shown.
    pub group: Group,
    /// Source of the curve: true traits or estimates.
    pub basis: CurveBasis,
    /// Current terms of each plan.
    pub plans: ByPlan<PlanPoint>,
    /// Discount for individual leads from every channel, $ per month.
    pub discount: f64,
    /// Discount for subscribers, $ per month. The discount also reduces the first bill.
    pub ongoing_discounts: ByPlan<f64>,
    /// Points of the curve, in ascending order of price, starting at 0.
    pub points: Vec<CurvePoint>,
    /// The likely market, followed by the two extreme markets that match the estimates.
    markets: Vec<Market>,
}

impl fmt::Debug for CurveExplorer {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "CurveExplorer({} {:?})", self.group, self.basis)
    }
}

impl Market {
    fn draw_leads(group: Group, expectation: Expectation, params: Arc<Params>) -> Market {
        let streams = Streams::new(SAMPLE_SEED);
        let sample = LeadSample::draw(group, LEAD_SAMPLE_SIZE, expectation, &params, &streams);
        Market { sample, params }
    }
}

pub(super) struct CurrentOffer {
    pub(super) plans: ByPlan<PlanPoint>,
    pub(super) discount: f64,
    pub(super) ongoing_discounts: ByPlan<f64>,
}

impl CurveExplorer {
    /// Creates the curve explorer of a group in several markets: the likely market first, then the extreme markets.
    pub(super) fn from_markets(
        group: Group,
        basis: CurveBasis,
        on_offer: CurrentOffer,
        markets: Vec<(Expectation, Arc<Params>)>,
    ) -> CurveExplorer {
        let mut explorer = CurveExplorer::without_points(group, basis, on_offer, markets);
        let most = explorer.max_price();
        let price = |step: usize| most * step as f64 / PRICE_STEPS as f64;
        explorer.points = (0..=PRICE_STEPS).map(|step| explorer.curve_point(price(step))).collect();
        explorer
    }

    /// Creates a curve explorer without the points of the curve, which take much longer to compute than the decisions
    /// of leads.
    pub(super) fn without_points(
        group: Group,
        basis: CurveBasis,
        on_offer: CurrentOffer,
        markets: Vec<(Expectation, Arc<Params>)>,
    ) -> CurveExplorer {
        let CurrentOffer { plans, discount: promotion, ongoing_discounts: ongoing } = on_offer;
        let markets: Vec<Market> = markets
            .into_iter()
            .map(|(expectation, params)| Market::draw_leads(group, expectation, params))
            .collect();
        CurveExplorer {
            group,
            basis,
            plans,
            discount: promotion,
            ongoing_discounts: ongoing,
            points: Vec::new(),
            markets,
        }
    }

    /// Returns the highest price of the curve, $ per month. All plan prices and nearly all budgets are below this
    /// price.
    fn max_price(&self) -> f64 {
        let budget = self.markets[0].sample.budget_quantile(0.9);
        let plans = self.plans.iter().map(|plan_point| 1.2 * plan_point.list_price);
        let most = plans.fold(budget, f64::max);
        (most / 10.0).ceil().max(1.0) * 10.0
    }

    fn curve_point(&self, price: f64) -> CurvePoint {
        let required = |market: &Market, share: &[f64]| {
            market.sample.required_quality_quantiles(price, share, &market.params)
        };
        let values = required(&self.markets[0], &CURVE_QUANTILES);
        let medians: Vec<f64> = self.markets.iter().map(|market| required(market, &[0.5])[0]).collect();
        CurvePoint {
            price,
            p10: values[0],
            median: values[1],
            p90: values[2],
            median_range: (min_value(&medians), max_value(&medians)),
        }
    }

    /// Returns whether the curve shows true traits, in which case figures have no range.
    pub fn shows_true_values(&self) -> bool {
        matches!(self.basis, CurveBasis::Truth { .. })
    }

    /// Returns whether overload and outages affect the decisions of leads. The explorer does not include this effect.
    pub fn omits_service(&self) -> bool {
        self.markets[0].params.fidelity.service_penalty == ServicePenalty::Everywhere
    }

    /// Returns the expected decisions of leads about `plans`, with current discounts.
    pub fn outcome_for_plans(&self, plans: &ByPlan<PlanPoint>) -> CurveOutcome {
        self.evaluate(plans, self.discount, &self.ongoing_discounts)
    }

    /// Returns the expected decisions of leads about a single plan without quota or discounts.
    pub fn outcome_at(&self, price: f64, quality: f64) -> CurveOutcome {
        let point = PlanPoint { list_price: price, quality, quota: f64::INFINITY };
        self.evaluate(&ByPlan([point; 3]), 0.0, &ByPlan([0.0; 3]))
    }

    fn evaluate(&self, plans: &ByPlan<PlanPoint>, promotion: f64, ongoing: &ByPlan<f64>) -> CurveOutcome {
        let offers = ByPlan::from_fn(|plan: Plan| {
            let PlanPoint { list_price: list, quality, quota } = plans[plan];
            PlanOffer { price: list, quality, quota }
        });
        let choose = |market: &Market| market.sample.choose(&offers, promotion, ongoing, &market.params);
        let choices: Vec<LeadChoices> = self.markets.iter().map(choose).collect();
        let expected = |of: fn(&LeadChoices) -> f64| {
            let values: Vec<f64> = choices.iter().map(of).collect();
            ExpectedRange { likely: values[0], least: min_value(&values), most: max_value(&values) }
        };
        let is_individual = !self.group.is_enterprise();
        let likely = &choices[0];
        CurveOutcome {
            conversion: expected(LeadChoices::conversion),
            revenue_per_lead: is_individual.then(|| expected(LeadChoices::revenue_per_lead)),
            plan_shares: is_individual.then(|| {
                ByPlan::from_fn(|plan: Plan| {
                    f64::from(likely.choices_by_plan[plan]) / f64::from(likely.leads)
                })
            }),
        }
    }
}

/// Returns the true curve of a group before any drift, computed from parameters alone.
pub fn true_curve(group: Group, params: &Params) -> Vec<CurvePoint> {
    let nothing = PlanPoint { list_price: 0.0, quality: 0.0, quota: f64::INFINITY };
    let on_offer =
        CurrentOffer { plans: ByPlan([nothing; 3]), discount: 0.0, ongoing_discounts: ByPlan([0.0; 3]) };
    let market = (Expectation::default(), Arc::new(params.clone()));
    CurveExplorer::from_markets(group, CurveBasis::Truth { day: 0 }, on_offer, vec![market]).points
}

fn min_value(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::INFINITY, f64::min)
}

fn max_value(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::NEG_INFINITY, f64::max)
}
