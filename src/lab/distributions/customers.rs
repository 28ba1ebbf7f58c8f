//! Random draws of new customers: traits, channel and judgment error.

use super::distribution::{DrawDistribution, RoundingMode};
use super::world_draw::{DrawContext, DrawFamily, WorldDraw, group_at};
use novamind_world::customers::choice::PlanOffer;
use novamind_world::customers::traits::{Negotiator, Traits, draw_traits};
use novamind_world::identifiers::{ByPlan, Channel};
use novamind_world::market::arrivals::LeadEvaluation;
use novamind_world::market::leads::LeadFactors;
use novamind_world::params::Params;
use novamind_world::random::Part;

const TRAITS_FILE: &str = "customers/traits.rs";
const INFINITE: f64 = f64::INFINITY;

/// Expected number of leads on the example day.
const EXPECTED_LEADS: f64 = 12.0;

fn example_traits(context: &DrawContext, member: usize, n: u64) -> Traits {
    draw_traits(group_at(member), n as u32, 1.0, &context.params, &context.streams)
}

fn example_negotiator(context: &DrawContext, member: usize, n: u64) -> Negotiator {
    example_traits(context, member, n).negotiator.expect("the family is enterprises")
}

fn normal_at_least(mean: f64, std: f64, least: f64) -> DrawDistribution {
    DrawDistribution::Normal { mean, std, min: least, max: INFINITE }
}

/// Returns the lead factors of a day on which every channel has the same budget for a group.
fn lead_factors_for_equal_budgets(params: &Params, member: usize) -> LeadFactors {
    let yields = params.starting_yields();
    let mut factors = LeadFactors::default();
    for channel in Channel::ALL {
        factors.paid[channel] = yields[channel][group_at(member)];
    }
    factors
}

/// Random draws of new customers.
pub const CUSTOMER_DRAWS: &[WorldDraw] = &[
    WorldDraw {
        name: "steepness_left",
        description: "steepness of the lower half of a customer's curve",
        part: Part::Traits,
        family: DrawFamily::Single,
        parameters: &[
            "customer_generation.steepness_left_exp_scale",
            "customer_generation.steepness_left_offset",
            "customer_generation.steepness_left_min",
            "customer_generation.steepness_left_max",
        ],
        source_files: &[(TRAITS_FILE, 1)],
        distribution: |params, _| {
            let generation = &params.customer_generation;
            DrawDistribution::Exponential {
                mean: generation.steepness_left_exp_scale,
                offset: generation.steepness_left_offset,
                min: generation.steepness_left_min,
                max: generation.steepness_left_max,
            }
        },
        draw: |context, member, n| example_traits(context, member, n).curve.steepness_left,
    },
    WorldDraw {
        name: "steepness_right",
        description: "steepness of the upper half of a customer's curve",
        part: Part::Traits,
        family: DrawFamily::Single,
        parameters: &[
            "customer_generation.steepness_right_exp_scale",
            "customer_generation.steepness_right_offset",
            "customer_generation.steepness_right_min",
            "customer_generation.steepness_right_max",
        ],
        source_files: &[(TRAITS_FILE, 1)],
        distribution: |params, _| {
            let generation = &params.customer_generation;
            DrawDistribution::Exponential {
                mean: generation.steepness_right_exp_scale,
                offset: generation.steepness_right_offset,
                min: generation.steepness_right_min,
                max: generation.steepness_right_max,
            }
        },
        draw: |context, member, n| example_traits(context, member, n).curve.steepness_right,
    },
    WorldDraw {
        name: "c_max",
        description: "budget of a customer, dollars per seat per month",
        part: Part::Traits,
        family: DrawFamily::Groups,
        parameters: &[
            "group.c_max_mean",
            "group.c_max_std",
            "customer_generation.c_max_std_multiplier",
            "customer_generation.c_max_min",
        ],
        source_files: &[(TRAITS_FILE, 1)],
        distribution: |params, member| {
            let (group_params, bounds) = (params.group(group_at(member)), &params.customer_generation);
            normal_at_least(
                group_params.c_max_mean,
                bounds.c_max_std_multiplier * group_params.c_max_std,
                bounds.c_max_min,
            )
        },
        draw: |context, member, n| example_traits(context, member, n).curve.c_max,
    },
    WorldDraw {
        name: "q_min",
        description: "lowest quality that a customer accepts at any price",
        part: Part::Traits,
        family: DrawFamily::Groups,
        parameters: &["group.q_min_mean", "group.q_min_std", "customer_generation.q_min_min"],
        source_files: &[(TRAITS_FILE, 1)],
        distribution: |params, member| {
            let group_params = params.group(group_at(member));
            normal_at_least(
                group_params.q_min_mean,
                group_params.q_min_std,
                params.customer_generation.q_min_min,
            )
        },
        draw: |context, member, n| example_traits(context, member, n).curve.q_min,
    },
    WorldDraw {
        name: "q_range",
        description: "additional quality that a customer requires at its budget",
        part: Part::Traits,
        family: DrawFamily::Groups,
        parameters: &["group.q_range_mean", "group.q_range_std", "customer_generation.q_range_min"],
        source_files: &[(TRAITS_FILE, 1)],
        distribution: |params, member| {
            let group_params = params.group(group_at(member));
            normal_at_least(
                group_params.q_range_mean,
                group_params.q_range_std,
                params.customer_generation.q_range_min,
            )
        },
        draw: |context, member, n| {
            let curve = example_traits(context, member, n).curve;
            curve.q_max - curve.q_min
        },
    },
    WorldDraw {
        name: "usage_demand",
        description: "demand of a customer, units per seat per day",
        part: Part::Traits,
        family: DrawFamily::Groups,
        parameters: &[
            "group.usage_demand_mean",
            "group.usage_demand_std",
            "customer_generation.usage_demand_min",
        ],
        source_files: &[(TRAITS_FILE, 1)],
        distribution: |params, member| {
            let group_params = params.group(group_at(member));
            normal_at_least(
                group_params.usage_demand_mean,
                group_params.usage_demand_std,
                params.customer_generation.usage_demand_min,
            )
        },
        draw: |context, member, n| example_traits(context, member, n).usage_demand,
    },
    WorldDraw {
        name: "ads_quality_sensitivity",
        description: "quality loss of a customer at full ad strength",
        part: Part::Traits,
        family: DrawFamily::Groups,
        parameters: &[
            "group.ads_quality_sensitivity_mean",
            "group.ads_quality_sensitivity_std",
            "customer_generation.ads_quality_sensitivity_min",
        ],
        source_files: &[(TRAITS_FILE, 1)],
        distribution: |params, member| {
            let group_params = params.group(group_at(member));
            normal_at_least(
                group_params.ads_quality_sensitivity_mean,
                group_params.ads_quality_sensitivity_std,
                params.customer_generation.ads_quality_sensitivity_min,
            )
        },
        draw: |context, member, n| example_traits(context, member, n).ads_quality_sensitivity,
    },
    WorldDraw {
        name: "ads_return_sensitivity",
        description: "ad revenue at full strength, dollars per seat per day",
        part: Part::Traits,
        family: DrawFamily::Groups,
        parameters: &[
            "group.ads_return_sensitivity_mean",
            "group.ads_return_sensitivity_std",
            "customer_generation.ads_return_sensitivity_min",
        ],
        source_files: &[(TRAITS_FILE, 1)],
        distribution: |params, member| {
            let group_params = params.group(group_at(member));
            normal_at_least(
                group_params.ads_return_sensitivity_mean,
                group_params.ads_return_sensitivity_std,
                params.customer_generation.ads_return_sensitivity_min,
            )
        },
        draw: |context, member, n| example_traits(context, member, n).ads_return_sensitivity,
    },
    WorldDraw {
        name: "seats",
        description: "seats of an enterprise",
        part: Part::Traits,
        family: DrawFamily::Enterprises,
        parameters: &["group.seat_count_min", "group.seat_count_max"],
        source_files: &[(TRAITS_FILE, 1)],
        distribution: |params, member| {
            let group_params = params.group(group_at(member));
            DrawDistribution::UniformInteger {
                low: group_params.seat_count_min.unwrap_or(1),
                high: group_params.seat_count_max.unwrap_or(1),
            }
        },
        draw: |context, member, n| example_traits(context, member, n).seats,
    },
    WorldDraw {
        name: "reply_delay_mean",
        description: "mean response time of an enterprise in a neutral economy, days",
        part: Part::Traits,
        family: DrawFamily::Enterprises,
        parameters: &[
            "group.reply_delay_mean",
            "group.reply_delay_std",
            "customer_generation.reply_delay_mean_noise_std_factor",
            "customer_generation.reply_delay_mean_min",
        ],
        source_files: &[(TRAITS_FILE, 1)],
        distribution: |params, member| {
            let (group_params, bounds) = (params.group(group_at(member)), &params.customer_generation);
            let spread =
                bounds.reply_delay_mean_noise_std_factor * group_params.reply_delay_std.unwrap_or(0.0);
            normal_at_least(group_params.reply_delay_mean.unwrap_or(0.0), spread, bounds.reply_delay_mean_min)
        },
        draw: |context, member, n| example_negotiator(context, member, n).reply_delay_mean,
    },
    WorldDraw {
        name: "reply_delay_std",
        description: "spread of an enterprise's response time, days",
        part: Part::Traits,
        family: DrawFamily::Enterprises,
        parameters: &[
            "group.reply_delay_std",
            "customer_generation.reply_delay_std_noise_std_factor",
            "customer_generation.reply_delay_std_min",
        ],
        source_files: &[(TRAITS_FILE, 1)],
        distribution: |params, member| {
            let (group_params, bounds) = (params.group(group_at(member)), &params.customer_generation);
            let spread = group_params.reply_delay_std.unwrap_or(0.0);
            normal_at_least(
                spread,
                bounds.reply_delay_std_noise_std_factor * spread,
                bounds.reply_delay_std_min,
            )
        },
        draw: |context, member, n| example_negotiator(context, member, n).reply_delay_std,
    },
    WorldDraw {
        name: "initial_offer_factor",
        description: "first bid of an enterprise as a share of its maximum price",
        part: Part::Traits,
        family: DrawFamily::Enterprises,
        parameters: &[
            "enterprise.enterprise_initial_offer_factor_mean",
            "enterprise.enterprise_initial_offer_factor_std",
            "customer_generation.initial_offer_factor_min",
            "customer_generation.initial_offer_factor_max",
        ],
        source_files: &[(TRAITS_FILE, 1)],
        distribution: |params, _| DrawDistribution::Normal {
            mean: params.enterprise.enterprise_initial_offer_factor_mean,
            std: params.enterprise.enterprise_initial_offer_factor_std,
            min: params.customer_generation.initial_offer_factor_min,
            max: params.customer_generation.initial_offer_factor_max,
        },
        draw: |context, member, n| example_negotiator(context, member, n).initial_offer_factor,
    },
    WorldDraw {
        name: "max_negotiation_turns",
        description: "patience of an enterprise, turns",
        part: Part::Traits,
        family: DrawFamily::Enterprises,
        parameters: &[
            "group.max_negotiation_turns_mean",
            "group.max_negotiation_turns_std",
            "customer_generation.max_negotiation_turns_min",
        ],
        source_files: &[(TRAITS_FILE, 1)],
        distribution: |params, member| {
            let group_params = params.group(group_at(member));
            DrawDistribution::RoundedNormal {
                mean: group_params.max_negotiation_turns_mean.unwrap_or(0.0),
                std: group_params.max_negotiation_turns_std.unwrap_or(0.0),
                rounding: RoundingMode::Nearest,
                min: f64::from(params.customer_generation.max_negotiation_turns_min),
            }
        },
        draw: |context, member, n| f64::from(example_negotiator(context, member, n).max_negotiation_turns),
    },
    WorldDraw {
        name: "persona_pick",
        description: "index into the list of a group's industries; the other profile lists are drawn equally",
        part: Part::Traits,
        family: DrawFamily::Groups,
        parameters: &[],
        source_files: &[("customers/persona.rs", 1)],
        distribution: |params, member| {
            let group_personas = &params.personas.group[member];
            DrawDistribution::UniformInteger {
                low: 0,
                high: group_personas.industry.len().saturating_sub(1) as u32,
            }
        },
        draw: |context, member, n| f64::from(example_traits(context, member, n).persona.0[0]),
    },
    WorldDraw {
        name: "lead_count",
        description: "leads of a group on a day; the example's mean is 12",
        part: Part::LeadCount,
        family: DrawFamily::Single,
        parameters: &[],
        source_files: &[("market/arrivals.rs", 1)],
        distribution: |_, _| DrawDistribution::Poisson(EXPECTED_LEADS),
        draw: |context, member, n| {
            context.streams.open(Part::LeadCount, [n, member as u64]).poisson(EXPECTED_LEADS) as f64
        },
    },
    WorldDraw {
        name: "lead_source",
        description: "channel of a lead, by index; the example spends the same on each",
        part: Part::LeadSource,
        family: DrawFamily::Groups,
        parameters: &["channel.leads_per_1000_dollars"],
        source_files: &[("market/arrivals.rs", 2)],
        distribution: |params, member| {
            let factors = lead_factors_for_equal_budgets(params, member);
            DrawDistribution::Discrete(
                Channel::ALL
                    .into_iter()
                    .map(|channel| (channel.index() as f64, factors.paid[channel]))
                    .collect(),
            )
        },
        draw: |context, member, n| {
            let u = context.streams.open(Part::LeadSource, [member as u64, n]).uniform();
            let source = lead_factors_for_equal_budgets(&context.params, member).pick_source(u);
            source.channel().map_or(f64::NAN, |channel| channel.index() as f64)
        },
    },
    WorldDraw {
        name: "lead_noise",
        description: "factor by which an individual misjudges quality at its first decision",
        part: Part::LeadNoise,
        family: DrawFamily::Single,
        parameters: &["quality.initial_decision_noise_min", "quality.initial_decision_noise_max"],
        source_files: &[("market/arrivals.rs", 1)],
        distribution: |params, _| DrawDistribution::Uniform {
            low: params.quality.initial_decision_noise_min,
            high: params.quality.initial_decision_noise_max,
        },
        draw: |context, member, n| {
            let offers = ByPlan([PlanOffer { price: 10.0, quality: 0.3, quota: 1e6 }; 3]);
            let traits = example_traits(context, member, 1);
            let word = context.streams.open(Part::LeadNoise, [member as u64, n]).word();
            LeadEvaluation::new(&offers, 0.0, (traits.curve, traits.usage_demand), word, &context.params)
                .noise
        },
    },
];
