//! Random draws of new customers: traits, channel, and misjudgment of quality.

use super::law::{Law, Rounding};
use super::world_draw::{Family, Luck, WorldDraw, group_at};
use novamind_world::customers::choice::Offer;
use novamind_world::customers::traits::{Negotiator, Traits, draw_traits};
use novamind_world::identifiers::{ByPlan, Channel};
use novamind_world::market::arrivals::FirstLook;
use novamind_world::market::leads::LeadFactors;
use novamind_world::params::Params;
use novamind_world::random::Part;

const TRAITS: &str = "customers/traits.rs";
const INFINITE: f64 = f64::INFINITY;

/// Expected leads of the example day.
const EXPECTED_LEADS: f64 = 12.0;

fn traits(luck: &Luck, member: usize, n: u64) -> Traits {
    draw_traits(group_at(member), n as u32, 1.0, &luck.params, &luck.streams)
}

fn negotiator(luck: &Luck, member: usize, n: u64) -> Negotiator {
    traits(luck, member, n).negotiator.expect("the family is enterprises")
}

fn at_least(mean: f64, std: f64, least: f64) -> Law {
    Law::Normal { mean, std, least, most: INFINITE }
}

/// Returns the leads of a day on which every channel has the same budget for a group.
fn equal_budgets(params: &Params, member: usize) -> LeadFactors {
    let yields = params.starting_yields();
    let mut factors = LeadFactors::default();
    for channel in Channel::ALL {
        factors.paid[channel] = yields[channel][group_at(member)];
    }
    factors
}

/// Returns the draws.
pub const DRAWS: &[WorldDraw] = &[
    WorldDraw {
        name: "steepness_left",
        what: "steepness of the lower half of a customer's curve",
        part: Part::Traits,
        family: Family::One,
        keys: &[
            "customer_generation.steepness_left_exp_scale",
            "customer_generation.steepness_left_offset",
            "customer_generation.steepness_left_min",
            "customer_generation.steepness_left_max",
        ],
        sites: &[(TRAITS, 1)],
        law: |params, _| {
            let own = &params.customer_generation;
            Law::Exponential {
                mean: own.steepness_left_exp_scale,
                offset: own.steepness_left_offset,
                least: own.steepness_left_min,
                most: own.steepness_left_max,
            }
        },
        draw: |luck, member, n| traits(luck, member, n).curve.steepness_left,
    },
    WorldDraw {
        name: "steepness_right",
        what: "steepness of the upper half of a customer's curve",
        part: Part::Traits,
        family: Family::One,
        keys: &[
            "customer_generation.steepness_right_exp_scale",
            "customer_generation.steepness_right_offset",
            "customer_generation.steepness_right_min",
            "customer_generation.steepness_right_max",
        ],
        sites: &[(TRAITS, 1)],
        law: |params, _| {
            let own = &params.customer_generation;
            Law::Exponential {
                mean: own.steepness_right_exp_scale,
                offset: own.steepness_right_offset,
                least: own.steepness_right_min,
                most: own.steepness_right_max,
            }
        },
        draw: |luck, member, n| traits(luck, member, n).curve.steepness_right,
    },
    WorldDraw {
        name: "c_max",
        what: "budget of a customer, dollars a month and seat",
        part: Part::Traits,
        family: Family::Groups,
        keys: &[
            "group.c_max_mean",
            "group.c_max_std",
            "customer_generation.c_max_std_multiplier",
            "customer_generation.c_max_min",
        ],
        sites: &[(TRAITS, 1)],
        law: |params, member| {
            let (own, bounds) = (params.group(group_at(member)), &params.customer_generation);
            at_least(own.c_max_mean, bounds.c_max_std_multiplier * own.c_max_std, bounds.c_max_min)
        },
        draw: |luck, member, n| traits(luck, member, n).curve.c_max,
    },
    WorldDraw {
        name: "q_min",
        what: "lowest quality that a customer accepts at any price",
        part: Part::Traits,
        family: Family::Groups,
        keys: &["group.q_min_mean", "group.q_min_std", "customer_generation.q_min_min"],
        sites: &[(TRAITS, 1)],
        law: |params, member| {
            let own = params.group(group_at(member));
            at_least(own.q_min_mean, own.q_min_std, params.customer_generation.q_min_min)
        },
        draw: |luck, member, n| traits(luck, member, n).curve.q_min,
    },
    WorldDraw {
        name: "q_range",
        what: "additional quality that a customer requires at its budget",
        part: Part::Traits,
        family: Family::Groups,
        keys: &["group.q_range_mean", "group.q_range_std", "customer_generation.q_range_min"],
        sites: &[(TRAITS, 1)],
        law: |params, member| {
            let own = params.group(group_at(member));
            at_least(own.q_range_mean, own.q_range_std, params.customer_generation.q_range_min)
        },
        draw: |luck, member, n| {
            let own = traits(luck, member, n).curve;
            own.q_max - own.q_min
        },
    },
    WorldDraw {
        name: "usage_demand",
        what: "demand of a customer, units a day and seat",
        part: Part::Traits,
        family: Family::Groups,
        keys: &["group.usage_demand_mean", "group.usage_demand_std", "customer_generation.usage_demand_min"],
        sites: &[(TRAITS, 1)],
        law: |params, member| {
            let own = params.group(group_at(member));
            at_least(own.usage_demand_mean, own.usage_demand_std, params.customer_generation.usage_demand_min)
        },
        draw: |luck, member, n| traits(luck, member, n).usage_demand,
    },
    WorldDraw {
        name: "ads_quality_sensitivity",
        what: "quality loss of a customer at full ad strength",
        part: Part::Traits,
        family: Family::Groups,
        keys: &[
            "group.ads_quality_sensitivity_mean",
            "group.ads_quality_sensitivity_std",
            "customer_generation.ads_quality_sensitivity_min",
        ],
        sites: &[(TRAITS, 1)],
        law: |params, member| {
            let own = params.group(group_at(member));
            at_least(
                own.ads_quality_sensitivity_mean,
                own.ads_quality_sensitivity_std,
                params.customer_generation.ads_quality_sensitivity_min,
            )
        },
        draw: |luck, member, n| traits(luck, member, n).ads_quality_sensitivity,
    },
    WorldDraw {
        name: "ads_return_sensitivity",
        what: "ad revenue at full strength, dollars a day and seat",
        part: Part::Traits,
        family: Family::Groups,
        keys: &[
            "group.ads_return_sensitivity_mean",
            "group.ads_return_sensitivity_std",
            "customer_generation.ads_return_sensitivity_min",
        ],
        sites: &[(TRAITS, 1)],
        law: |params, member| {
            let own = params.group(group_at(member));
            at_least(
                own.ads_return_sensitivity_mean,
                own.ads_return_sensitivity_std,
                params.customer_generation.ads_return_sensitivity_min,
            )
        },
        draw: |luck, member, n| traits(luck, member, n).ads_return_sensitivity,
    },
    WorldDraw {
        name: "seats",
        what: "seats of an enterprise",
        part: Part::Traits,
        family: Family::Companies,
        keys: &["group.seat_count_min", "group.seat_count_max"],
        sites: &[(TRAITS, 1)],
        law: |params, member| {
            let own = params.group(group_at(member));
            Law::Whole { low: own.seat_count_min.unwrap_or(1), high: own.seat_count_max.unwrap_or(1) }
        },
        draw: |luck, member, n| traits(luck, member, n).seats,
    },
    WorldDraw {
        name: "reply_delay_mean",
        what: "mean response time of an enterprise in a neutral economy, days",
        part: Part::Traits,
        family: Family::Companies,
        keys: &[
            "group.reply_delay_mean",
            "group.reply_delay_std",
            "customer_generation.reply_delay_mean_noise_std_factor",
            "customer_generation.reply_delay_mean_min",
        ],
        sites: &[(TRAITS, 1)],
        law: |params, member| {
            let (own, bounds) = (params.group(group_at(member)), &params.customer_generation);
            let spread = bounds.reply_delay_mean_noise_std_factor * own.reply_delay_std.unwrap_or(0.0);
            at_least(own.reply_delay_mean.unwrap_or(0.0), spread, bounds.reply_delay_mean_min)
        },
        draw: |luck, member, n| negotiator(luck, member, n).reply_delay_mean,
    },
    WorldDraw {
        name: "reply_delay_std",
        what: "spread of an enterprise's response time, days",
        part: Part::Traits,
        family: Family::Companies,
        keys: &[
            "group.reply_delay_std",
            "customer_generation.reply_delay_std_noise_std_factor",
            "customer_generation.reply_delay_std_min",
        ],
        sites: &[(TRAITS, 1)],
        law: |params, member| {
            let (own, bounds) = (params.group(group_at(member)), &params.customer_generation);
            let spread = own.reply_delay_std.unwrap_or(0.0);
            at_least(spread, bounds.reply_delay_std_noise_std_factor * spread, bounds.reply_delay_std_min)
        },
        draw: |luck, member, n| negotiator(luck, member, n).reply_delay_std,
    },
    WorldDraw {
        name: "initial_offer_factor",
        what: "first bid of an enterprise as a share of its maximum price",
        part: Part::Traits,
        family: Family::Companies,
        keys: &[
            "enterprise.enterprise_initial_offer_factor_mean",
            "enterprise.enterprise_initial_offer_factor_std",
            "customer_generation.initial_offer_factor_min",
            "customer_generation.initial_offer_factor_max",
        ],
        sites: &[(TRAITS, 1)],
        law: |params, _| Law::Normal {
            mean: params.enterprise.enterprise_initial_offer_factor_mean,
            std: params.enterprise.enterprise_initial_offer_factor_std,
            least: params.customer_generation.initial_offer_factor_min,
            most: params.customer_generation.initial_offer_factor_max,
        },
        draw: |luck, member, n| negotiator(luck, member, n).initial_offer_factor,
    },
    WorldDraw {
        name: "max_negotiation_turns",
        what: "patience of an enterprise, turns",
        part: Part::Traits,
        family: Family::Companies,
        keys: &[
            "group.max_negotiation_turns_mean",
            "group.max_negotiation_turns_std",
            "customer_generation.max_negotiation_turns_min",
        ],
        sites: &[(TRAITS, 1)],
        law: |params, member| {
            let own = params.group(group_at(member));
            Law::WholeNormal {
                mean: own.max_negotiation_turns_mean.unwrap_or(0.0),
                std: own.max_negotiation_turns_std.unwrap_or(0.0),
                rounding: Rounding::Nearest,
                least: f64::from(params.customer_generation.max_negotiation_turns_min),
            }
        },
        draw: |luck, member, n| f64::from(negotiator(luck, member, n).max_negotiation_turns),
    },
    WorldDraw {
        name: "persona_pick",
        what: "index into the list of a group's industries; the other profile lists are drawn equally",
        part: Part::Traits,
        family: Family::Groups,
        keys: &[],
        sites: &[("customers/persona.rs", 1)],
        law: |params, member| {
            let own = &params.personas.group[member];
            Law::Whole { low: 0, high: own.industry.len().saturating_sub(1) as u32 }
        },
        draw: |luck, member, n| f64::from(traits(luck, member, n).persona.0[0]),
    },
    WorldDraw {
        name: "lead_count",
        what: "leads of a group on a day; the example's mean is 12",
        part: Part::LeadCount,
        family: Family::One,
        keys: &[],
        sites: &[("market/arrivals.rs", 1)],
        law: |_, _| Law::Poisson(EXPECTED_LEADS),
        draw: |luck, member, n| {
            luck.streams.open(Part::LeadCount, [n, member as u64]).poisson(EXPECTED_LEADS) as f64
        },
    },
    WorldDraw {
        name: "lead_source",
        what: "channel of a lead, by index; the example spends the same on each",
        part: Part::LeadSource,
        family: Family::Groups,
        keys: &["channel.leads_per_1000_dollars"],
        sites: &[("market/arrivals.rs", 2)],
        law: |params, member| {
            let factors = equal_budgets(params, member);
            Law::Among(
                Channel::ALL
                    .into_iter()
                    .map(|channel| (channel.index() as f64, factors.paid[channel]))
                    .collect(),
            )
        },
        draw: |luck, member, n| {
            let u = luck.streams.open(Part::LeadSource, [member as u64, n]).uniform();
            let source = equal_budgets(&luck.params, member).source(u);
            source.channel().map_or(f64::NAN, |channel| channel.index() as f64)
        },
    },
    WorldDraw {
        name: "lead_noise",
        what: "factor by which an individual misjudges quality at its first decision",
        part: Part::LeadNoise,
        family: Family::One,
        keys: &["quality.initial_decision_noise_min", "quality.initial_decision_noise_max"],
        sites: &[("market/arrivals.rs", 1)],
        law: |params, _| Law::Uniform {
            low: params.quality.initial_decision_noise_min,
            high: params.quality.initial_decision_noise_max,
        },
        draw: |luck, member, n| {
            let offers = ByPlan([Offer { price: 10.0, quality: 0.3, quota: 1e6 }; 3]);
            let own = traits(luck, member, 1);
            let word = luck.streams.open(Part::LeadNoise, [member as u64, n]).word();
            FirstLook::of(&offers, 0.0, (own.curve, own.usage_demand), word, &luck.params).noise
        },
    },
];
