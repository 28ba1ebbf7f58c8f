//! The quality equation, which splits the delivered quality of a group into terms for each plan.

use serde::Serialize;

use novamind_world::customers::drift::{DriftTotals, Expectation};
use novamind_world::identifiers::{ByGroup, ByPlan, Group};
use novamind_world::morning::Morning;
use novamind_world::params::Params;
use novamind_world::product::Product;
use novamind_world::product::development::development_gain;
use novamind_world::quality::delivered_quality;
use novamind_world::settings::Settings;
use novamind_world::state::World;

/// Sources of the shared quality gain.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct SharedQualityGains {
    /// Quality gain for all groups at the start of the run.
    pub opening: f64,
    /// Quality gain from finished R&D projects.
    pub research: f64,
    /// Sum of the daily quality gains from development.
    pub development: f64,
    /// Sum of the daily noise, computed as the remainder.
    pub noise: f64,
}

/// The delivered quality of a plan.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct DeliveredPlanQuality {
    /// Model tier of the plan, 1..=5.
    pub tier: u8,
    /// Quality multiplier of the model tier.
    pub multiplier: f64,
    /// Delivered quality of the plan.
    pub delivered: f64,
}

/// The components of quality on a day, for all groups.
#[derive(Debug, Clone, Default)]
pub(crate) struct QualityDay {
    base: f64,
    shared: f64,
    gains: SharedQualityGains,
    group_gain: ByGroup<f64>,
    shared_bank: f64,
    group_bank: ByGroup<f64>,
    plans: ByGroup<ByPlan<DeliveredPlanQuality>>,
    common_expectation: f64,
    expectations: ByGroup<Expectation>,
    /// Quality lost to overload and outages of the day.
    pub(crate) service_penalty: f64,
}

impl QualityDay {
    /// Captures quality at the start of a day. Then adds the day's development gain to `development`.
    pub(crate) fn new(
        world: &World,
        morning: &Morning,
        params: &Params,
        development: &mut f64,
    ) -> QualityDay {
        let World { product, settings, market, .. } = world;
        let gains = shared_gains(product, *development, params);
        *development += development_gain_of_day(settings, params);
        let plan = |group: Group| {
            ByPlan::from_fn(|plan| DeliveredPlanQuality {
                tier: morning.core.tiers[plan],
                multiplier: morning.multipliers[plan],
                delivered: morning.delivered(group, plan),
            })
        };
        let DriftTotals { global_quality: everyone, .. } = market.drift;
        QualityDay {
            base: params.quality.base_product_quality,
            shared: product.shared_bonus,
            gains,
            group_gain: product.group_bonus,
            shared_bank: product.shared_bank,
            group_bank: product.group_bank,
            plans: ByGroup::from_fn(plan),
            common_expectation: everyone,
            expectations: morning.expectations,
            service_penalty: 0.0,
        }
    }
}

fn development_gain_of_day(settings: &Settings, params: &Params) -> f64 {
    development_gain(settings.core.development, &params.development)
}

fn shared_gains(product: &Product, development: f64, params: &Params) -> SharedQualityGains {
    let opening = params.initial.q_shared_bonus;
    let finished = product.research.iter().filter(|project| project.completed_day.is_some());
    let research: f64 = finished.map(|project| project.boost).sum();
    let noise = product.shared_bonus - opening - research - development;
    SharedQualityGains { opening, research, development, noise }
}

/// The delivered quality of a group: (base + shared gain + group gain) times the multiplier of the plan's model tier.
#[derive(Debug, Clone, PartialEq)]
pub struct QualityEquation {
    /// The group that receives the quality.
    pub group: Group,
    /// Day of the equation, from 1.
    pub day: u32,
    /// Base quality, before any improvement.
    pub base: f64,
    /// Quality gain for all groups.
    pub shared: f64,
    /// Sources of the shared quality gain.
    pub gains: SharedQualityGains,
    /// Quality gain of the group from targeted development.
    pub group_gain: f64,
    /// Delivered quality of each plan.
    pub plans: ByPlan<DeliveredPlanQuality>,
    /// Quality lost to overload and outages of the day; not every decision includes this loss.
    pub service_penalty: f64,
    /// Shared quality gain that competitors had not copied at the start of the day.
    pub shared_bank: f64,
    /// Quality gain of the group that competitors had not copied at the start of the day.
    pub group_bank: f64,
    /// Increase in the expectations of all groups due to drift and competitors.
    pub common_expectation: f64,
    /// Increase in the group's expectations, including the common increase.
    pub expectation: Expectation,
}

impl QualityEquation {
    pub(crate) fn new(group: Group, day: u32, seen: &QualityDay) -> QualityEquation {
        QualityEquation {
            group,
            day,
            base: seen.base,
            shared: seen.shared,
            gains: seen.gains,
            group_gain: seen.group_gain[group],
            plans: seen.plans[group],
            service_penalty: seen.service_penalty,
            shared_bank: seen.shared_bank,
            group_bank: seen.group_bank[group],
            common_expectation: seen.common_expectation,
            expectation: seen.expectations[group],
        }
    }

    /// Returns the sum of the quality terms, multiplied by `multiplier`.
    pub fn product_quality(&self, multiplier: f64) -> f64 {
        delivered_quality(self.base, self.shared, self.group_gain, multiplier)
    }
}
