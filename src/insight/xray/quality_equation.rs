//! What the product delivers to a group on each plan, term by term.

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

/// Where the quality that was gained for everybody comes from.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct SharedGains {
    /// What the run began with.
    pub opening: f64,
    /// Finished R&D projects.
    pub research: f64,
    /// Development, day by day.
    pub development: f64,
    /// Its daily noise, the rest.
    pub noise: f64,
}

/// A plan, as it is delivered.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PlanDelivered {
    /// Model tier, 1..=5.
    pub tier: u8,
    /// Quality multiplier of the tier.
    pub multiplier: f64,
    /// Quality that the world delivered.
    pub delivered: f64,
}

/// What quality is made of on a day, for all groups.
#[derive(Debug, Clone, Default)]
pub(crate) struct QualityDay {
    base: f64,
    shared: f64,
    gains: SharedGains,
    own: ByGroup<f64>,
    shared_bank: f64,
    own_bank: ByGroup<f64>,
    plans: ByGroup<ByPlan<PlanDelivered>>,
    everyone: f64,
    expectations: ByGroup<Expectation>,
    /// Quality lost to the service of the day.
    pub(crate) service_penalty: f64,
}

impl QualityDay {
    /// A morning, after so much development; counts the development of the day.
    pub(crate) fn of(world: &World, morning: &Morning, params: &Params, development: &mut f64) -> QualityDay {
        let World { product, settings, market, .. } = world;
        let gains = shared_gains(product, *development, params);
        *development += gain_of_today(settings, params);
        let plan = |group: Group| {
            ByPlan::from_fn(|plan| PlanDelivered {
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
            own: product.group_bonus,
            shared_bank: product.shared_bank,
            own_bank: product.group_bank,
            plans: ByGroup::from_fn(plan),
            everyone,
            expectations: morning.expectations,
            service_penalty: 0.0,
        }
    }
}

fn gain_of_today(settings: &Settings, params: &Params) -> f64 {
    development_gain(settings.core.development, &params.development)
}

fn shared_gains(product: &Product, development: f64, params: &Params) -> SharedGains {
    let opening = params.initial.q_shared_bonus;
    let finished = product.research.iter().filter(|project| project.completed_day.is_some());
    let research: f64 = finished.map(|project| project.boost).sum();
    let noise = product.shared_bonus - opening - research - development;
    SharedGains { opening, research, development, noise }
}

/// The quality that is delivered to a group: (base + shared + own) times the multiplier of the plan's model tier.
#[derive(Debug, Clone, PartialEq)]
pub struct QualityEquation {
    /// The group.
    pub group: Group,
    /// The day, from 1.
    pub day: u32,
    /// Quality before any improvement.
    pub base: f64,
    /// Gained for everybody.
    pub shared: f64,
    /// Where that comes from.
    pub gains: SharedGains,
    /// Gained for the group by targeted development.
    pub own: f64,
    /// The plans.
    pub plans: ByPlan<PlanDelivered>,
    /// Lost to the service of the day, for those who feel it.
    pub service_penalty: f64,
    /// Shared improvements that no rival had copied in the morning.
    pub shared_bank: f64,
    /// The same of the group's own.
    pub own_bank: f64,
    /// What the market has added to everyone's expectations.
    pub everyone: f64,
    /// What it has added to those of the group, everyone's included.
    pub expectation: Expectation,
}

impl QualityEquation {
    /// The group on a day.
    pub(crate) fn of(group: Group, day: u32, seen: &QualityDay) -> QualityEquation {
        QualityEquation {
            group,
            day,
            base: seen.base,
            shared: seen.shared,
            gains: seen.gains,
            own: seen.own[group],
            plans: seen.plans[group],
            service_penalty: seen.service_penalty,
            shared_bank: seen.shared_bank,
            own_bank: seen.own_bank[group],
            everyone: seen.everyone,
            expectation: seen.expectations[group],
        }
    }

    /// What the terms come to with a multiplier.
    pub fn product(&self, multiplier: f64) -> f64 {
        delivered_quality(self.base, self.shared, self.own, multiplier)
    }
}
