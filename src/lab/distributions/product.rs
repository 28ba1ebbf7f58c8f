//! Random draws of the product: service, development, R&D, usage.

use super::distribution::{DrawDistribution, RoundingMode};
use super::world_draw::{DrawFamily, WorldDraw, group_at};
use novamind_world::params::Params;
use novamind_world::product::development::daily_noise;
use novamind_world::product::research::{project_boost, project_duration};
use novamind_world::product::service::{draw_downtime_minutes, error_rate, outage_probability, p95_latency};
use novamind_world::product::usage::usage_rate;
use novamind_world::random::Part;

const SERVICE_FILE: &str = "product/service.rs";
const RESEARCH_FILE: &str = "product/research.rs";

fn example_outage_probability(params: &Params) -> f64 {
    outage_probability(0.0, 0.0, &params.operations)
}

/// Random draws of the product.
pub const PRODUCT_DRAWS: &[WorldDraw] = &[
    WorldDraw {
        name: "outage",
        description: "an outage on a day, without operations and overload",
        part: Part::Service,
        family: DrawFamily::Single,
        parameters: &["operations.base_outage_prob", "operations.ops_outage_min_prob"],
        source_files: &[(SERVICE_FILE, 1)],
        distribution: |params, _| DrawDistribution::Bernoulli(example_outage_probability(params)),
        draw: |context, _, n| {
            let mut stream = context.streams.open(Part::Service, [n]);
            f64::from(u8::from(stream.bernoulli(example_outage_probability(&context.params))))
        },
    },
    WorldDraw {
        name: "downtime",
        description: "length of an outage, minutes",
        part: Part::Service,
        family: DrawFamily::Single,
        parameters: &["operations.downtime_minutes_choices", "operations.downtime_minutes_probabilities"],
        source_files: &[(SERVICE_FILE, 1)],
        distribution: |params, _| {
            let operations = &params.operations;
            let lengths = operations.downtime_minutes_choices.into_iter().map(f64::from);
            DrawDistribution::Discrete(lengths.zip(operations.downtime_minutes_probabilities).collect())
        },
        draw: |context, _, n| {
            f64::from(draw_downtime_minutes(
                &mut context.streams.open(Part::Service, [n]),
                &context.params.operations,
            ))
        },
    },
    WorldDraw {
        name: "p95_latency",
        description: "latency of a day without overload, milliseconds",
        part: Part::Service,
        family: DrawFamily::Single,
        parameters: &["operations.p95_base_ms", "operations.p95_noise_std"],
        source_files: &[(SERVICE_FILE, 1)],
        distribution: |params, _| DrawDistribution::Normal {
            mean: params.operations.p95_base_ms,
            std: params.operations.p95_noise_std,
            min: f64::NEG_INFINITY,
            max: f64::INFINITY,
        },
        draw: |context, _, n| {
            let z = context.streams.open(Part::Service, [n]).standard_normal();
            p95_latency(0.0, z, &context.params.operations)
        },
    },
    WorldDraw {
        name: "error_rate",
        description: "share of failed requests of a day without overload",
        part: Part::Service,
        family: DrawFamily::Single,
        parameters: &[
            "operations.error_rate_base",
            "operations.error_rate_noise_std",
            "operations.error_rate_min",
            "operations.error_rate_max",
        ],
        source_files: &[(SERVICE_FILE, 1)],
        distribution: |params, _| DrawDistribution::Normal {
            mean: params.operations.error_rate_base,
            std: params.operations.error_rate_noise_std,
            min: params.operations.error_rate_min,
            max: params.operations.error_rate_max,
        },
        draw: |context, _, n| {
            let z = context.streams.open(Part::Service, [n]).standard_normal();
            error_rate(0.0, z, &context.params.operations)
        },
    },
    WorldDraw {
        name: "quality_noise",
        description: "daily random change of shared quality",
        part: Part::QualityNoise,
        family: DrawFamily::Single,
        parameters: &["development.quality_shared_noise_scale"],
        source_files: &[("product/development.rs", 1)],
        distribution: |params, _| DrawDistribution::Normal {
            mean: 0.0,
            std: params.development.quality_shared_noise_scale,
            min: f64::NEG_INFINITY,
            max: f64::INFINITY,
        },
        draw: |context, _, n| daily_noise(n as u32, &context.params, &context.streams),
    },
    WorldDraw {
        name: "research_days",
        description: "duration of an R&D project, days",
        part: Part::Research,
        family: DrawFamily::ResearchTiers,
        parameters: &[
            "research_tier.mean_days",
            "research_tier.std_days",
            "development.rd_min_duration_days",
        ],
        source_files: &[(RESEARCH_FILE, 1)],
        distribution: |params, tier| {
            let tier_params = params.research_tier(tier as u8);
            DrawDistribution::RoundedNormal {
                mean: tier_params.mean_days,
                std: tier_params.std_days,
                rounding: RoundingMode::Down,
                min: f64::from(params.development.rd_min_duration_days),
            }
        },
        draw: |context, tier, n| {
            let z = context.streams.open(Part::Research, [tier as u64, n]).standard_normal();
            let tier_params = context.params.research_tier(tier as u8);
            f64::from(project_duration(tier_params, z, &context.params.development))
        },
    },
    WorldDraw {
        name: "research_gain",
        description: "quality gained by an R&D project",
        part: Part::Research,
        family: DrawFamily::ResearchTiers,
        parameters: &[
            "research_tier.mean_quality_boost",
            "research_tier.std_quality_boost",
            "development.rd_min_quality_boost",
        ],
        source_files: &[(RESEARCH_FILE, 1)],
        distribution: |params, tier| {
            let tier_params = params.research_tier(tier as u8);
            DrawDistribution::Normal {
                mean: tier_params.mean_quality_boost,
                std: tier_params.std_quality_boost,
                min: params.development.rd_min_quality_boost,
                max: f64::INFINITY,
            }
        },
        draw: |context, tier, n| {
            let mut stream = context.streams.open(Part::Research, [tier as u64, n]);
            // The first draw of the stream is the duration.
            let (_, z) = (stream.standard_normal(), stream.standard_normal());
            project_boost(context.params.research_tier(tier as u8), z, &context.params.development)
        },
    },
    WorldDraw {
        name: "usage_rate",
        description: "usage of a billing period, units a day, of a customer with its group's mean demand",
        part: Part::UsageRate,
        family: DrawFamily::Groups,
        parameters: &[
            "group.usage_demand_mean",
            "customer_generation.daily_usage_rate_std_fraction",
            "customer_generation.daily_usage_rate_min",
        ],
        source_files: &[("retention/billing.rs", 1), ("enterprise/outcomes.rs", 1)],
        distribution: |params, member| {
            let (group_params, bounds) = (params.group(group_at(member)), &params.customer_generation);
            DrawDistribution::Normal {
                mean: group_params.usage_demand_mean,
                std: bounds.daily_usage_rate_std_fraction * group_params.usage_demand_mean,
                min: bounds.daily_usage_rate_min,
                max: f64::INFINITY,
            }
        },
        draw: |context, member, n| {
            let z = context.streams.open(Part::UsageRate, [member as u64, n, 1]).standard_normal();
            let demand = context.params.group(group_at(member)).usage_demand_mean;
            usage_rate(demand, 1.0, z, &context.params.customer_generation)
        },
    },
];
