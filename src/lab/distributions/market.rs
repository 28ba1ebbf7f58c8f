//! Random draws of the market: competitors, demand surges, economy, channels and market studies.

use super::distribution::DrawDistribution;
use super::world_draw::{DrawContext, DrawFamily, WorldDraw, group_at};
use novamind_session::best_starting_channel;
use novamind_world::identifiers::Group;
use novamind_world::market::competitors::{draw_event, event_probability, magnitude_scale, sampled_boost};
use novamind_world::market::discovery::draw_attempt;
use novamind_world::market::economy::next_pmi;
use novamind_world::market::surges::draw_surge;
use novamind_world::market::yields::yield_after_month;
use novamind_world::params::Params;
use novamind_world::random::Part;

const COMPETITORS_FILE: &str = "market/competitors.rs";
const SURGES_FILE: &str = "market/surges.rs";
const DISCOVERY_FILE: &str = "market/discovery.rs";

/// Day of the competitor examples, in the second half of the run.
const EXAMPLE_DAY: u32 = 300;
const EXAMPLE_RUN_DAYS: u32 = 500;

fn competitor_event_chance(params: &Params) -> f64 {
    event_probability(EXAMPLE_DAY, EXAMPLE_RUN_DAYS, None, params)
}

/// Returns the size before growth and the copied share of a competitor event, whose probability is set to 1.
fn example_competitor_event(context: &DrawContext, n: u64) -> (f64, f64) {
    let mut stream = context.streams.open(Part::CompetitorEvent, [n]);
    let drawn = draw_event(1.0, &context.params.competitor, &mut stream);
    drawn.map_or((f64::NAN, f64::NAN), |event| (event.size, event.u))
}

fn unknown_groups() -> Vec<Group> {
    Group::all().filter(|group| !group.is_initially_known()).collect()
}

/// Returns a figure of a demand surge, whose probability is set to 1.
fn example_surge(context: &DrawContext, n: u64, figure: fn(u32, f64) -> f64) -> f64 {
    let demand_surge =
        novamind_world::params::DemandSurge { probability: 1.0, ..context.params.demand_surge.clone() };
    let day = n as u32;
    draw_surge(day, &demand_surge, &context.streams)
        .map_or(f64::NAN, |surge| figure(surge.end_day - day, surge.multiplier))
}

fn best_yield(params: &Params, member: usize) -> f64 {
    let group = group_at(member);
    params.starting_yields()[best_starting_channel(group, params)][group]
}

/// Random draws of the market.
pub const MARKET_DRAWS: &[WorldDraw] = &[
    WorldDraw {
        name: "rival_event",
        description: "a competitor event on day 300 of 500",
        part: Part::CompetitorEvent,
        family: DrawFamily::Single,
        parameters: &[
            "competitor.competitor_event_mean_interval",
            "competitor.first_half_interval_multiplier",
        ],
        source_files: &[(COMPETITORS_FILE, 1)],
        distribution: |params, _| DrawDistribution::Bernoulli(competitor_event_chance(params)),
        draw: |context, _, n| {
            let mut stream = context.streams.open(Part::CompetitorEvent, [n]);
            let drawn =
                draw_event(competitor_event_chance(&context.params), &context.params.competitor, &mut stream);
            f64::from(u8::from(drawn.is_some()))
        },
    },
    WorldDraw {
        name: "rival_size",
        description: "quality that an event on day 300 of 500 adds to expectations, unless competitors copy more",
        part: Part::CompetitorEvent,
        family: DrawFamily::Single,
        parameters: &[
            "competitor.competitor_event_boost_mu",
            "competitor.competitor_event_boost_sigma",
            "competitor.competitor_event_boost_min",
            "competitor.competitor_event_boost_max",
            "competitor.competitor_event_magnitude_scale_min",
            "competitor.competitor_event_magnitude_scale_max",
        ],
        source_files: &[(COMPETITORS_FILE, 1)],
        distribution: |params, _| {
            let competitor = &params.competitor;
            DrawDistribution::LogNormal {
                mu: competitor.competitor_event_boost_mu,
                sigma: competitor.competitor_event_boost_sigma,
                min: competitor.competitor_event_boost_min,
                max: competitor.competitor_event_boost_max,
                factor: magnitude_scale(EXAMPLE_DAY, EXAMPLE_RUN_DAYS, competitor),
            }
        },
        draw: |context, _, n| {
            sampled_boost(
                example_competitor_event(context, n).0,
                EXAMPLE_DAY,
                EXAMPLE_RUN_DAYS,
                &context.params.competitor,
            )
        },
    },
    WorldDraw {
        name: "rival_copy",
        description: "share of the shared bank that competitors can copy at an event",
        part: Part::CompetitorEvent,
        family: DrawFamily::Single,
        parameters: &["competitor.competitor_feedback_u_min", "competitor.competitor_feedback_u_max"],
        source_files: &[(COMPETITORS_FILE, 1)],
        distribution: |params, _| DrawDistribution::Uniform {
            low: params.competitor.competitor_feedback_u_min,
            high: params.competitor.competitor_feedback_u_max,
        },
        draw: |context, _, n| example_competitor_event(context, n).1,
    },
    WorldDraw {
        name: "rival_drain",
        description: "share of a group's targeted bank that competitors copy at an event",
        part: Part::CompetitorEvent,
        family: DrawFamily::Single,
        parameters: &[
            "competitor.competitor_segment_drain_u_min",
            "competitor.competitor_segment_drain_u_max",
        ],
        source_files: &[(COMPETITORS_FILE, 1)],
        distribution: |params, _| DrawDistribution::Uniform {
            low: params.competitor.competitor_segment_drain_u_min,
            high: params.competitor.competitor_segment_drain_u_max,
        },
        draw: |context, _, n| {
            let law = &context.params.competitor;
            context
                .streams
                .open(Part::CompetitorEvent, [n])
                .between(law.competitor_segment_drain_u_min, law.competitor_segment_drain_u_max)
        },
    },
    WorldDraw {
        name: "surge",
        description: "a demand surge on a day",
        part: Part::Surge,
        family: DrawFamily::Single,
        parameters: &["demand_surge.probability"],
        source_files: &[(SURGES_FILE, 1)],
        distribution: |params, _| DrawDistribution::Bernoulli(params.demand_surge.probability),
        draw: |context, _, n| {
            let drawn = draw_surge(n as u32, &context.params.demand_surge, &context.streams);
            f64::from(u8::from(drawn.is_some()))
        },
    },
    WorldDraw {
        name: "surge_days",
        description: "length of a surge, days",
        part: Part::Surge,
        family: DrawFamily::Single,
        parameters: &["demand_surge.duration_days_low", "demand_surge.duration_days_high_exclusive"],
        source_files: &[(SURGES_FILE, 1)],
        distribution: |params, _| DrawDistribution::UniformInteger {
            low: params.demand_surge.duration_days_low,
            high: params.demand_surge.duration_days_high_exclusive - 1,
        },
        draw: |context, _, n| example_surge(context, n, |days, _| f64::from(days)),
    },
    WorldDraw {
        name: "surge_multiplier",
        description: "factor of a surge on leads",
        part: Part::Surge,
        family: DrawFamily::Single,
        parameters: &["demand_surge.multiplier_base", "demand_surge.multiplier_range"],
        source_files: &[(SURGES_FILE, 1)],
        distribution: |params, _| {
            let demand_surge = &params.demand_surge;
            DrawDistribution::Uniform {
                low: demand_surge.multiplier_base,
                high: demand_surge.multiplier_base + demand_surge.multiplier_range,
            }
        },
        draw: |context, _, n| example_surge(context, n, |_, multiplier| multiplier),
    },
    WorldDraw {
        name: "group_found",
        description: "success of an attempt of market research",
        part: Part::MarketResearch,
        family: DrawFamily::Single,
        parameters: &["market_research.market_research_discover_prob"],
        source_files: &[(DISCOVERY_FILE, 1)],
        distribution: |params, _| {
            DrawDistribution::Bernoulli(params.market_research.market_research_discover_prob)
        },
        draw: |context, _, n| {
            let mut stream = context.streams.open(Part::MarketResearch, [n]);
            let chance = context.params.market_research.market_research_discover_prob;
            f64::from(u8::from(draw_attempt(&unknown_groups(), chance, &mut stream).is_some()))
        },
    },
    WorldDraw {
        name: "found_group",
        description: "group that an attempt finds, by index into the unknown groups",
        part: Part::MarketResearch,
        family: DrawFamily::Single,
        parameters: &[],
        source_files: &[(DISCOVERY_FILE, 1)],
        distribution: |_, _| DrawDistribution::UniformInteger {
            low: 0,
            high: unknown_groups().len().saturating_sub(1) as u32,
        },
        draw: |context, _, n| {
            let (all, mut stream) = (unknown_groups(), context.streams.open(Part::MarketResearch, [n]));
            let found = draw_attempt(&all, 1.0, &mut stream);
            found
                .and_then(|found| all.iter().position(|group| *group == found))
                .map_or(f64::NAN, |at| at as f64)
        },
    },
    WorldDraw {
        name: "index_phase",
        description: "phase of the economic cycle on day 0, if the scenario does not set it",
        part: Part::Macro,
        family: DrawFamily::Single,
        parameters: &["macro.macro_pmi_random_phase"],
        source_files: &[("market/economy.rs", 1)],
        distribution: |_, _| DrawDistribution::Uniform { low: 0.0, high: 2.0 * std::f64::consts::PI },
        draw: |context, _, n| context.streams.open(Part::Macro, [n]).between(0.0, 2.0 * std::f64::consts::PI),
    },
    WorldDraw {
        name: "index_step",
        description: "hidden index of the economy, one day after it equals its cycle's target",
        part: Part::Macro,
        family: DrawFamily::Single,
        parameters: &[
            "macro.macro_pmi_initial",
            "macro.macro_pmi_daily_volatility",
            "macro.macro_pmi_floor",
            "macro.macro_pmi_ceiling",
        ],
        source_files: &[("market/economy.rs", 1)],
        distribution: |params, _| DrawDistribution::Normal {
            mean: params.economy.macro_pmi_initial,
            std: params.economy.macro_pmi_daily_volatility,
            min: params.economy.macro_pmi_floor,
            max: params.economy.macro_pmi_ceiling,
        },
        draw: |context, _, n| {
            let law = &context.params.economy;
            let z = context.streams.open(Part::Macro, [n]).standard_normal();
            next_pmi(law.macro_pmi_initial, law.macro_pmi_initial, z, law)
        },
    },
    WorldDraw {
        name: "yield_change",
        description: "leads per $1,000 on a group's best channel after its first month",
        part: Part::LeadRateDrift,
        family: DrawFamily::Groups,
        parameters: &[
            "channel.leads_per_1000_dollars",
            "leads.monthly_channel_noise_fraction",
            "leads.monthly_channel_value_min",
        ],
        source_files: &[("market/yields.rs", 1)],
        distribution: |params, member| {
            let start = best_yield(params, member);
            DrawDistribution::Normal {
                mean: start,
                std: params.leads.monthly_channel_noise_fraction * start,
                min: params.leads.monthly_channel_value_min,
                max: f64::INFINITY,
            }
        },
        draw: |context, member, n| {
            let z = context.streams.open(Part::LeadRateDrift, [member as u64, n]).standard_normal();
            yield_after_month(best_yield(&context.params, member), z, &context.params.leads)
        },
    },
    WorldDraw {
        name: "study_error",
        description: "error of an estimate as a share of the maximum error of its study level",
        part: Part::Insight,
        family: DrawFamily::Single,
        parameters: &["info_level.noise"],
        source_files: &[("market/insights.rs", 1)],
        distribution: |_, _| DrawDistribution::Uniform { low: -1.0, high: 1.0 },
        draw: |context, member, n| {
            context.streams.open(Part::Insight, [member as u64, 1, n]).between(-1.0, 1.0)
        },
    },
];
