//! Random draws of the product: service, development, R&D, usage.

use super::law::{Law, Rounding};
use super::world_draw::{Family, WorldDraw, group_at};
use novamind_world::params::Params;
use novamind_world::product::development::daily_noise;
use novamind_world::product::research::{project_boost, project_duration};
use novamind_world::product::service::{downtime, error_rate, outage_probability, p95_latency};
use novamind_world::product::usage::usage_rate;
use novamind_world::random::Part;

const SERVICE: &str = "product/service.rs";
const RESEARCH: &str = "product/research.rs";

fn chance_of_outage(params: &Params) -> f64 {
    outage_probability(0.0, 0.0, &params.operations)
}

/// Returns the draws.
pub const DRAWS: &[WorldDraw] = &[
    WorldDraw {
        name: "outage",
        what: "an outage on a day, without operations and overload",
        part: Part::Service,
        family: Family::One,
        keys: &["operations.base_outage_prob", "operations.ops_outage_min_prob"],
        sites: &[(SERVICE, 1)],
        law: |params, _| Law::Chance(chance_of_outage(params)),
        draw: |luck, _, n| {
            let mut stream = luck.streams.open(Part::Service, [n]);
            f64::from(u8::from(stream.bernoulli(chance_of_outage(&luck.params))))
        },
    },
    WorldDraw {
        name: "downtime",
        what: "length of an outage, minutes",
        part: Part::Service,
        family: Family::One,
        keys: &["operations.downtime_minutes_choices", "operations.downtime_minutes_probabilities"],
        sites: &[(SERVICE, 1)],
        law: |params, _| {
            let own = &params.operations;
            let lengths = own.downtime_minutes_choices.into_iter().map(f64::from);
            Law::Among(lengths.zip(own.downtime_minutes_probabilities).collect())
        },
        draw: |luck, _, n| {
            f64::from(downtime(&mut luck.streams.open(Part::Service, [n]), &luck.params.operations))
        },
    },
    WorldDraw {
        name: "p95_latency",
        what: "latency of a day without overload, milliseconds",
        part: Part::Service,
        family: Family::One,
        keys: &["operations.p95_base_ms", "operations.p95_noise_std"],
        sites: &[(SERVICE, 1)],
        law: |params, _| Law::Normal {
            mean: params.operations.p95_base_ms,
            std: params.operations.p95_noise_std,
            least: f64::NEG_INFINITY,
            most: f64::INFINITY,
        },
        draw: |luck, _, n| {
            let z = luck.streams.open(Part::Service, [n]).standard_normal();
            p95_latency(0.0, z, &luck.params.operations)
        },
    },
    WorldDraw {
        name: "error_rate",
        what: "share of failed requests of a day without overload",
        part: Part::Service,
        family: Family::One,
        keys: &[
            "operations.error_rate_base",
            "operations.error_rate_noise_std",
            "operations.error_rate_min",
            "operations.error_rate_max",
        ],
        sites: &[(SERVICE, 1)],
        law: |params, _| Law::Normal {
            mean: params.operations.error_rate_base,
            std: params.operations.error_rate_noise_std,
            least: params.operations.error_rate_min,
            most: params.operations.error_rate_max,
        },
        draw: |luck, _, n| {
            let z = luck.streams.open(Part::Service, [n]).standard_normal();
            error_rate(0.0, z, &luck.params.operations)
        },
    },
    WorldDraw {
        name: "quality_noise",
        what: "daily random change of shared quality",
        part: Part::QualityNoise,
        family: Family::One,
        keys: &["development.quality_shared_noise_scale"],
        sites: &[("product/development.rs", 1)],
        law: |params, _| Law::Normal {
            mean: 0.0,
            std: params.development.quality_shared_noise_scale,
            least: f64::NEG_INFINITY,
            most: f64::INFINITY,
        },
        draw: |luck, _, n| daily_noise(n as u32, &luck.params, &luck.streams),
    },
    WorldDraw {
        name: "research_days",
        what: "duration of an R&D project, days",
        part: Part::Research,
        family: Family::ResearchTiers,
        keys: &["research_tier.mean_days", "research_tier.std_days", "development.rd_min_duration_days"],
        sites: &[(RESEARCH, 1)],
        law: |params, tier| {
            let own = params.research(tier as u8);
            Law::WholeNormal {
                mean: own.mean_days,
                std: own.std_days,
                rounding: Rounding::Down,
                least: f64::from(params.development.rd_min_duration_days),
            }
        },
        draw: |luck, tier, n| {
            let z = luck.streams.open(Part::Research, [tier as u64, n]).standard_normal();
            let own = luck.params.research(tier as u8);
            f64::from(project_duration(own, z, &luck.params.development))
        },
    },
    WorldDraw {
        name: "research_gain",
        what: "quality gained by an R&D project",
        part: Part::Research,
        family: Family::ResearchTiers,
        keys: &[
            "research_tier.mean_quality_boost",
            "research_tier.std_quality_boost",
            "development.rd_min_quality_boost",
        ],
        sites: &[(RESEARCH, 1)],
        law: |params, tier| {
            let own = params.research(tier as u8);
            Law::Normal {
                mean: own.mean_quality_boost,
                std: own.std_quality_boost,
                least: params.development.rd_min_quality_boost,
                most: f64::INFINITY,
            }
        },
        draw: |luck, tier, n| {
            let mut stream = luck.streams.open(Part::Research, [tier as u64, n]);
            // The duration is drawn first.
            let (_, z) = (stream.standard_normal(), stream.standard_normal());
            project_boost(luck.params.research(tier as u8), z, &luck.params.development)
        },
    },
    WorldDraw {
        name: "usage_rate",
        what: "usage of a billing period, units a day, of a customer with its group's mean demand",
        part: Part::UsageRate,
        family: Family::Groups,
        keys: &[
            "group.usage_demand_mean",
            "customer_generation.daily_usage_rate_std_fraction",
            "customer_generation.daily_usage_rate_min",
        ],
        sites: &[("retention/billing.rs", 1), ("enterprise/outcomes.rs", 1)],
        law: |params, member| {
            let (own, bounds) = (params.group(group_at(member)), &params.customer_generation);
            Law::Normal {
                mean: own.usage_demand_mean,
                std: bounds.daily_usage_rate_std_fraction * own.usage_demand_mean,
                least: bounds.daily_usage_rate_min,
                most: f64::INFINITY,
            }
        },
        draw: |luck, member, n| {
            let z = luck.streams.open(Part::UsageRate, [member as u64, n, 1]).standard_normal();
            let demand = luck.params.group(group_at(member)).usage_demand_mean;
            usage_rate(demand, 1.0, z, &luck.params.customer_generation)
        },
    },
];
