//! Traits of a new customer, drawn from the random stream of the customer's group and sequence number
//! (docs/mechanics/customers/generation.md).
//!
//! The n-th customer of a group has the same traits in every run with the same seed, before drift is added. The
//! position of every draw in the stream is fixed. Attributes that have no effect are not drawn: patience, negotiation
//! rate, and the lock-in penalty (contracts last one month).

use super::curve::Curve;
use super::persona::PersonaPicks;
use crate::identifiers::Group;
use crate::params::{GroupParams, Params};
use crate::random::{Part, Stream, Streams};

/// Traits of a new customer, before any drift.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Traits {
    /// Participation curve of the customer.
    pub curve: Curve,
    /// Mean demand, units per day; for enterprises, per seat.
    pub usage_demand: f64,
    /// Quality loss from in-app advertising at full strength.
    pub ads_quality_sensitivity: f64,
    /// Ad revenue at full strength, dollars per seat per day.
    pub ads_return_sensitivity: f64,
    /// Number of seats; 1 for individuals.
    pub seats: f64,
    /// Negotiation traits of an enterprise; `None` for individuals.
    pub negotiator: Option<Negotiator>,
    /// Profile attributes of the customer.
    pub persona: PersonaPicks,
}

/// Negotiation traits of an enterprise (docs/mechanics/enterprise/company.md).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Negotiator {
    /// Mean reply delay, in days.
    pub reply_delay_mean: f64,
    /// Standard deviation of the reply delay, in days.
    pub reply_delay_std: f64,
    /// First asked price as a share of the highest acceptable price, 0.5..=0.95.
    pub initial_offer_factor: f64,
    /// Maximum number of turns that the enterprise accepts, at least 2.
    pub max_negotiation_turns: u32,
}

/// Draws the traits of the n-th customer of a group. `deal_velocity` is today's macroeconomic multiplier of deal
/// velocity.
pub fn draw_traits(group: Group, n: u32, deal_velocity: f64, params: &Params, streams: &Streams) -> Traits {
    let stream = streams.open(Part::Traits, [group.index() as u64, u64::from(n)]);
    draw_traits_from_stream(stream, group, deal_velocity, params)
}

/// Draws a customer's traits from the customer's random stream.
pub fn draw_traits_from_stream(
    mut stream: Stream,
    group: Group,
    deal_velocity: f64,
    params: &Params,
) -> Traits {
    let (group_params, bounds) = (params.group(group), &params.customer_generation);
    let steepness = |exponential: f64, offset: f64, low, high| (exponential + offset).clamp(low, high);
    let steepness_left = steepness(
        stream.exponential(bounds.steepness_left_exp_scale),
        bounds.steepness_left_offset,
        bounds.steepness_left_min,
        bounds.steepness_left_max,
    );
    let steepness_right = steepness(
        stream.exponential(bounds.steepness_right_exp_scale),
        bounds.steepness_right_offset,
        bounds.steepness_right_min,
        bounds.steepness_right_max,
    );
    let c_max = stream
        .normal(group_params.c_max_mean, bounds.c_max_std_multiplier * group_params.c_max_std)
        .max(bounds.c_max_min);
    let q_min = stream.normal(group_params.q_min_mean, group_params.q_min_std).max(bounds.q_min_min);
    let q_range = stream.normal(group_params.q_range_mean, group_params.q_range_std).max(bounds.q_range_min);
    let usage_demand = stream
        .normal(group_params.usage_demand_mean, group_params.usage_demand_std)
        .max(bounds.usage_demand_min);
    let ads_quality_sensitivity = stream
        .normal(group_params.ads_quality_sensitivity_mean, group_params.ads_quality_sensitivity_std)
        .max(bounds.ads_quality_sensitivity_min);
    let ads_return_sensitivity = stream
        .normal(group_params.ads_return_sensitivity_mean, group_params.ads_return_sensitivity_std)
        .max(bounds.ads_return_sensitivity_min);
    let (seats, negotiator) = if group.is_enterprise() {
        let (seats, negotiator) = draw_enterprise_traits(group_params, deal_velocity, params, &mut stream);
        (seats, Some(negotiator))
    } else {
        (1.0, None)
    };
    let persona = PersonaPicks::draw(group, params, &mut stream);
    let curve = Curve { steepness_left, steepness_right, c_max, q_min, q_max: q_min + q_range };
    Traits {
        curve,
        usage_demand,
        ads_quality_sensitivity,
        ads_return_sensitivity,
        seats,
        negotiator,
        persona,
    }
}

fn draw_enterprise_traits(
    group_params: &GroupParams,
    deal_velocity: f64,
    params: &Params,
    stream: &mut Stream,
) -> (f64, Negotiator) {
    let (bounds, sales) = (&params.customer_generation, &params.enterprise);
    let expected = "enterprise groups are complete, checked by Params::load";
    let (fewest, most) =
        (group_params.seat_count_min.expect(expected), group_params.seat_count_max.expect(expected));
    let (delay_mean, delay_std) =
        (group_params.reply_delay_mean.expect(expected), group_params.reply_delay_std.expect(expected));
    let turns_mean = group_params.max_negotiation_turns_mean.expect(expected);
    let turns_std = group_params.max_negotiation_turns_std.expect(expected);
    let velocity = if deal_velocity > 0.0 { deal_velocity } else { 1.0 };
    let seats = f64::from(stream.integer(fewest, most));
    let reply_delay_mean = stream
        .normal(delay_mean / velocity, bounds.reply_delay_mean_noise_std_factor * delay_std)
        .max(bounds.reply_delay_mean_min);
    let reply_delay_std = stream
        .normal(delay_std, bounds.reply_delay_std_noise_std_factor * delay_std)
        .max(bounds.reply_delay_std_min);
    let initial_offer_factor = stream
        .normal(sales.enterprise_initial_offer_factor_mean, sales.enterprise_initial_offer_factor_std)
        .clamp(bounds.initial_offer_factor_min, bounds.initial_offer_factor_max);
    let turns = stream.normal(turns_mean, turns_std).round_ties_even();
    let max_negotiation_turns = turns.max(f64::from(bounds.max_negotiation_turns_min)) as u32;
    (seats, Negotiator { reply_delay_mean, reply_delay_std, initial_offer_factor, max_negotiation_turns })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(id: &str, count: u32, deal_velocity: f64) -> Vec<Traits> {
        let (params, streams) = (Params::bundled(), Streams::new(7));
        let group = Group::parse(id).expect("a group");
        (1..=count).map(|n| draw_traits(group, n, deal_velocity, &params, &streams)).collect()
    }

    fn assert_moments(name: &str, values: impl Iterator<Item = f64> + Clone, mean: f64, std: f64) {
        let count = values.clone().count() as f64;
        let own_mean = values.clone().sum::<f64>() / count;
        let own_std =
            (values.map(|value| (value - own_mean) * (value - own_mean)).sum::<f64>() / count).sqrt();
        assert!((own_mean - mean).abs() < 4.0 * std / count.sqrt() + 0.002 * mean, "{name}: mean {own_mean}");
        assert!((own_std / std - 1.0).abs() < 0.02, "{name}: standard deviation {own_std}");
    }

    fn share(values: &[Traits], holds: impl Fn(&Traits) -> bool) -> f64 {
        values.iter().filter(|traits| holds(traits)).count() as f64 / values.len() as f64
    }

    #[test]
    fn individual_traits_match_measured_moments() {
        let drawn = sample("S1", 60_000, 1.0);
        assert_moments("steepness_left", drawn.iter().map(|t| t.curve.steepness_left), 1.202, 0.991);
        assert_moments("steepness_right", drawn.iter().map(|t| t.curve.steepness_right), 2.713, 1.695);
        assert_moments("c_max", drawn.iter().map(|t| t.curve.c_max), 52.19, 28.46);
        assert_moments("usage_demand", drawn.iter().map(|t| t.usage_demand), 81.41, 47.72);
        assert!((share(&drawn, |t| t.curve.c_max == 15.0) - 0.140).abs() < 0.005);
        assert!((share(&drawn, |t| t.usage_demand == 1.0) - 0.057).abs() < 0.004);
        assert!(drawn.iter().all(|t| t.seats == 1.0 && t.negotiator.is_none()));
    }

    #[test]
    fn enterprise_traits_match_measured_moments() {
        let drawn = sample("E1", 40_000, 0.9);
        assert_moments("c_max", drawn.iter().map(|t| t.curve.c_max), 55.87, 25.87);
        assert_moments("seats", drawn.iter().map(|t| t.seats), 275.7, 130.6);
        assert!((share(&drawn, |t| t.curve.c_max == 15.0) - 0.074).abs() < 0.005);
        let negotiators = || drawn.iter().filter_map(|t| t.negotiator);
        assert_moments("turns", negotiators().map(|n| f64::from(n.max_negotiation_turns)), 6.01, 1.99);
        assert_moments("delay", negotiators().map(|n| n.reply_delay_mean), 5.558, 0.999);
        assert!(drawn.iter().all(|t| (50.0..=500.0).contains(&t.seats)));
    }

    #[test]
    fn traits_do_not_depend_on_other_customers() {
        let ten = sample("E2", 10, 1.0);
        let (params, streams) = (Params::bundled(), Streams::new(7));
        let group = Group::parse("E2").expect("a group");
        assert_eq!(draw_traits(group, 7, 1.0, &params, &streams), ten[6]);
    }
}
