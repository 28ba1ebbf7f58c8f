//! Estimates of a group, computed from true values and an error that decreases with the study level
//! (docs/mechanics/market/discovery.md).

use super::Market;
use super::leads::market_cap;
use crate::customers::drift::DriftTotals;
use crate::events::Snapshot;
use crate::identifiers::Group;
use crate::params::{GroupParams, InsightNoise, Params};
use crate::random::{NumpyStream, Part, Streams};
use novamind_base::formatting::round_to;

impl Snapshot {
    /// Takes a snapshot of a group's true values on a day. The snapshot includes the drift of the group, but not the
    /// drift of individual customers.
    pub fn take_snapshot(group: Group, day: u32, drift: &DriftTotals, params: &Params) -> Snapshot {
        let group_params = params.group(group);
        let moved = drift.expectation(group);
        Snapshot {
            day,
            c_max: group_params.c_max_mean + moved.c_max,
            q_min: group_params.q_min_mean + moved.quality,
            market_cap: market_cap(
                group_params.base_market_cap,
                group_params.annual_cap_growth_rate,
                day,
                &params.leads,
            ),
        }
    }
}

/// A value of a group that is estimated with a separate error.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum EstimatedField {
    /// Mean budget.
    WillingnessToPay,
    /// Mean usage, units per day.
    UsageVolume,
    /// Mean minimum quality.
    QualityFloor,
    /// Size of the group's market.
    MarketCap,
    /// Growth of the group's market.
    GrowthRate,
    /// Mean aversion to long contracts.
    LockinAversion,
    /// Minimum number of seats of an enterprise.
    SeatMinimum,
    /// Maximum number of seats of an enterprise.
    SeatMaximum,
    /// Mean number of turns after which an enterprise stops negotiating.
    DecisionRounds,
    /// Reply delay of an enterprise in days.
    ResponseDays,
    /// Leads that the group brings to another group.
    ReferralTo(Group),
    /// Leads that another group brings to this group.
    ReferralFrom(Group),
    /// Leads that the group brings to itself. The value is never shown. Its error is drawn only because the released
    /// simulator also draws this error.
    ReferralToItself,
    /// Weight of the group's reputation for another group.
    ReputationTo(Group),
    /// Weight of another group's reputation for this group.
    ReputationFrom(Group),
}

impl EstimatedField {
    /// Returns the key of the field in random streams. The keys are fixed because recorded runs depend on them.
    fn key(self) -> u64 {
        let linked = |direction: u64, group: Group| 100 * direction + group.index() as u64;
        match self {
            EstimatedField::WillingnessToPay => 0,
            EstimatedField::UsageVolume => 1,
            EstimatedField::QualityFloor => 2,
            EstimatedField::MarketCap => 3,
            EstimatedField::GrowthRate => 4,
            EstimatedField::LockinAversion => 5,
            EstimatedField::SeatMinimum => 6,
            EstimatedField::SeatMaximum => 7,
            EstimatedField::DecisionRounds => 8,
            EstimatedField::ResponseDays => 9,
            EstimatedField::ReferralToItself => 10,
            EstimatedField::ReferralTo(other) => linked(1, other),
            EstimatedField::ReferralFrom(other) => linked(2, other),
            EstimatedField::ReputationTo(other) => linked(3, other),
            EstimatedField::ReputationFrom(other) => linked(4, other),
        }
    }
}

/// Estimates of a group, rounded for display.
#[derive(Debug, Clone, PartialEq)]
pub struct Insights {
    /// Group to which the estimates apply.
    pub group: Group,
    /// Study level of the estimates, 1..=5.
    pub level: u8,
    /// Maximum relative error at the study level.
    pub noise: f64,
    /// Budget, dollars per month; per seat for enterprises.
    pub willingness_to_pay: f64,
    /// Usage, units per day; per seat for enterprises.
    pub usage_volume: f64,
    /// Mean minimum quality.
    pub quality_floor: f64,
    /// Size of the group's market in individuals or enterprises, at least 1.
    pub market_cap: u64,
    /// Annual growth of the group's market as a share, at least 0.
    pub growth_rate: f64,
    /// Mean aversion to long contracts, at least 0.
    pub lockin_aversion: f64,
    /// Estimates that exist only for groups of enterprises.
    pub enterprise: Option<EnterpriseInsights>,
    /// Leads per subscriber per day that the group brings to other groups, in descending order.
    pub referrals_to: Vec<(Group, f64)>,
    /// Leads per subscriber per day that other groups bring to the group, in descending order.
    pub referrals_from: Vec<(Group, f64)>,
    /// Weights of the group's reputation for other groups, in descending order.
    pub reputation_to: Vec<(Group, f64)>,
    /// Weights of other groups' reputation for the group, in descending order.
    pub reputation_from: Vec<(Group, f64)>,
}

/// Estimates that exist only for groups of enterprises.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EnterpriseInsights {
    /// Minimum number of seats of an enterprise, at least 1.
    pub min_seats: u64,
    /// Maximum number of seats of an enterprise, at least `min_seats`.
    pub max_seats: u64,
    /// Mean number of turns after which an enterprise stops negotiating, at least 1.
    pub decision_rounds: u64,
    /// Reply delay of an enterprise in days, at least 1.
    pub response_days: f64,
}

/// Returns the estimates of a group at its current study level, or `None` for an undiscovered group. The errors are
/// the same for every call and after a refresh.
///
/// With independent errors, the estimates do not depend on other discoveries. In the released simulator, all errors
/// are drawn from one sequence, so each additional known group shifts the draws of the links between groups.
pub fn insights(group: Group, market: &Market, params: &Params, streams: &Streams) -> Option<Insights> {
    match params.fidelity.insight_noise {
        InsightNoise::Independent => {
            let level = u64::from(market.knowledge[group].level);
            insights_with(group, market, params, &mut |field| {
                let keys = [group.index() as u64, level, field.key()];
                streams.open(Part::Insight, keys).between(-1.0, 1.0)
            })
        }
        InsightNoise::Release => {
            let mut sequence = NumpyStream::new(release_seed(group));
            insights_with(group, market, params, &mut |_| 2.0 * sequence.next_f64() - 1.0)
        }
    }
}

/// Returns the seed of a group's errors in the released simulator: the first four characters of `<group>_insights` as
/// a number, modulo 2^31. `D_S01` to `D_S09` have the same seed.
fn release_seed(group: Group) -> u32 {
    let name = format!("{}_insights", group.id());
    let letters = name.bytes().take(4).enumerate();
    letters.fold(0, |seed, (at, letter)| seed | u32::from(letter) << (8 * at)) & 0x7fff_ffff
}

/// Returns estimates with given errors. `draw` returns z in [-1, 1) for each field, in the order of the released
/// simulator.
fn insights_with(
    group: Group,
    market: &Market,
    params: &Params,
    draw: &mut dyn FnMut(EstimatedField) -> f64,
) -> Option<Insights> {
    let known = &market.knowledge[group];
    let snapshot = known.snapshot.filter(|_| known.level >= 1)?;
    let (group_params, research) = (params.group(group), &params.group_research);
    let noise = params.study_level(known.level).noise;
    let mut estimate = |field: EstimatedField, truth: f64| truth * (1.0 + noise * draw(field));
    let willingness_to_pay = round_to(
        estimate(EstimatedField::WillingnessToPay, snapshot.c_max),
        research.willingness_to_pay_decimals,
    );
    let usage_volume = round_to(
        estimate(EstimatedField::UsageVolume, group_params.usage_demand_mean),
        research.usage_volume_decimals,
    );
    let quality_floor =
        round_to(estimate(EstimatedField::QualityFloor, snapshot.q_min), research.quality_floor_decimals);
    let market_cap = truncate_to_at_least_one(estimate(EstimatedField::MarketCap, snapshot.market_cap));
    let growth = estimate(EstimatedField::GrowthRate, group_params.annual_cap_growth_rate).max(0.0);
    let lockin = estimate(EstimatedField::LockinAversion, group_params.lockin_penalty_mean).max(0.0);
    let company = enterprise_insights(group_params, research.response_days_decimals, &mut estimate);
    let links = |estimate: &mut dyn FnMut(EstimatedField, f64) -> f64,
                 field: fn(Group) -> EstimatedField,
                 least: f64,
                 truth: &dyn Fn(Group) -> f64| {
        let others = Group::all().filter(|other| *other != group && market.is_known(*other));
        let mut others: Vec<Group> = others.filter(|other| truth(*other) > least).collect();
        others.sort_by_key(|other| other.id());
        let shown = |other: &Group| {
            let value = estimate(field(*other), truth(*other)).max(0.0);
            (*other, round_to(value, research.influence_decimals))
        };
        let mut values: Vec<(Group, f64)> = others.iter().map(shown).collect();
        values.sort_by(|left, right| right.1.total_cmp(&left.1));
        values
    };
    let (network, reputation) = (research.network_display_min, research.reputation_display_min);
    let referrals_to = links(&mut estimate, EstimatedField::ReferralTo, network, &|other| {
        params.referral_rate(group, other)
    });
    let referrals_from = links(&mut estimate, EstimatedField::ReferralFrom, network, &|other| {
        params.referral_rate(other, group)
    });
    if params.referral_rate(group, group) > 0.0 {
        estimate(EstimatedField::ReferralToItself, 0.0);
    }
    let reputation_to = links(&mut estimate, EstimatedField::ReputationTo, reputation, &|other| {
        params.reputation_weight(group, other)
    });
    let reputation_from = links(&mut estimate, EstimatedField::ReputationFrom, reputation, &|other| {
        params.reputation_weight(other, group)
    });
    Some(Insights {
        group,
        level: known.level,
        noise,
        willingness_to_pay,
        usage_volume,
        quality_floor,
        market_cap,
        growth_rate: round_to(growth, research.growth_rate_decimals),
        lockin_aversion: round_to(lockin, research.lockin_decimals),
        enterprise: company,
        referrals_to,
        referrals_from,
        reputation_to,
        reputation_from,
    })
}

fn enterprise_insights(
    group_params: &GroupParams,
    decimals: u32,
    estimate: &mut dyn FnMut(EstimatedField, f64) -> f64,
) -> Option<EnterpriseInsights> {
    let (least, most) = (f64::from(group_params.seat_count_min?), f64::from(group_params.seat_count_max?));
    let (rounds, delay) = (group_params.max_negotiation_turns_mean?, group_params.reply_delay_mean?);
    let min_seats = truncate_to_at_least_one(estimate(EstimatedField::SeatMinimum, least));
    let max_seats = truncate_to_at_least_one(estimate(EstimatedField::SeatMaximum, most)).max(min_seats);
    let decision_rounds = truncate_to_at_least_one(estimate(EstimatedField::DecisionRounds, rounds));
    let response_days = round_to(estimate(EstimatedField::ResponseDays, delay).max(1.0), decimals);
    Some(EnterpriseInsights { min_seats, max_seats, decision_rounds, response_days })
}

/// Returns the integer part of an estimate, at least 1.
fn truncate_to_at_least_one(value: f64) -> u64 {
    value.trunc().max(1.0) as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns estimates with the errors of the released simulator.
    fn estimates(id: &str, level: u8, day: u32) -> Insights {
        let mut params = Params::bundled();
        params.fidelity.insight_noise = InsightNoise::Release;
        let mut market = Market::initial(&params);
        let group = Group::parse(id).expect("a group");
        market.knowledge[group].level = level;
        market.knowledge[group].snapshot = Some(Snapshot::take_snapshot(group, day, &market.drift, &params));
        insights(group, &market, &params, &Streams::new(u64::from(day))).expect("a known group")
    }

    fn group_ids_and_values(list: &[(Group, f64)]) -> Vec<(&'static str, f64)> {
        list.iter().map(|(group, value)| (group.id(), *value)).collect()
    }

    #[test]
    fn individual_estimates_are_true_values_times_noise() {
        for (id, level, values, cap) in [
            ("S1", 1, [25.87, 91.1, 0.081, 0.0962, 0.1906], 272_812),
            ("S1", 5, [48.14, 80.9, 0.099, 0.192, 0.16235], 272_062),
            ("D_S01", 1, [58.18, 86.4, 0.097, 0.1781, 0.09051], 37_155),
        ] {
            let insights = estimates(id, level, 0);
            let shown = [
                insights.willingness_to_pay,
                insights.usage_volume,
                insights.quality_floor,
                insights.growth_rate,
                insights.lockin_aversion,
            ];
            assert_eq!((shown, insights.market_cap), (values, cap), "{id} at level {level}");
            assert_eq!(insights.enterprise, None);
        }
    }

    #[test]
    fn enterprise_estimates_include_seats_rounds_and_days() {
        let company = |least, most, rounds, days| {
            Some(EnterpriseInsights {
                min_seats: least,
                max_seats: most,
                decision_rounds: rounds,
                response_days: days,
            })
        };
        for (id, level, values, cap, expected_enterprise) in [
            ("E1", 1, [19.62, 52.1, 0.736, 0.0516, 0.07558], 1471, company(25, 740, 6, 5.2)),
            ("E3", 3, [101.61, 114.4, 0.719, 0.0801, 0.03472], 116, company(247, 1963, 15, 22.1)),
        ] {
            let insights = estimates(id, level, 0);
            let shown = [
                insights.willingness_to_pay,
                insights.usage_volume,
                insights.quality_floor,
                insights.growth_rate,
                insights.lockin_aversion,
            ];
            assert_eq!((shown, insights.market_cap), (values, cap), "{id} at level {level}");
            assert_eq!(insights.enterprise, expected_enterprise, "{id}");
        }
        let ten = estimates("D_E10", 1, 0);
        assert_eq!((ten.willingness_to_pay, ten.usage_volume, ten.quality_floor), (53.07, 98.7, 0.55));
        assert_eq!(ten.market_cap, 188);
    }

    #[test]
    fn links_to_known_groups_are_sorted_by_shown_value() {
        let e1 = estimates("E1", 1, 0);
        assert_eq!(group_ids_and_values(&e1.referrals_from), [("S3", 0.0073), ("E3", 0.0004)]);
        let weights = [("E2", 0.0502), ("S3", 0.0488), ("E3", 0.0228), ("S1", 0.0209), ("S2", 0.0167)];
        assert_eq!(group_ids_and_values(&e1.reputation_to), weights);
        let s1 = estimates("S1", 1, 0);
        assert_eq!(group_ids_and_values(&s1.referrals_to), [("S3", 0.0023), ("S2", 0.0013)]);
        assert_eq!(group_ids_and_values(&s1.referrals_from), [("S3", 0.0053), ("S2", 0.0006)]);
        let out = [("S3", 0.1676), ("S2", 0.0342), ("E1", 0.0124), ("E3", 0.0069), ("E2", 0.0042)];
        assert_eq!(group_ids_and_values(&s1.reputation_to), out);
        let into = [("S3", 0.3762), ("S2", 0.0656), ("E3", 0.0333), ("E1", 0.0193), ("E2", 0.0133)];
        assert_eq!(group_ids_and_values(&s1.reputation_from), into);
    }

    #[test]
    fn higher_levels_are_more_accurate() {
        for (level, day, pay, usage, cap, growth) in [
            (2, 3, 35.15, 86.8, 272_948, 0.1361),
            (3, 19, 40.72, 84.3, 275_147, 0.1601),
            (4, 35, 44.43, 82.6, 277_407, 0.1760),
            (5, 52, 48.14, 80.9, 279_814, 0.1920),
        ] {
            let insights = estimates("S1", level, day);
            assert_eq!(
                (
                    insights.willingness_to_pay,
                    insights.usage_volume,
                    insights.market_cap,
                    insights.growth_rate
                ),
                (pay, usage, cap, growth),
                "level {level}"
            );
        }
    }

    #[test]
    fn release_errors_depend_only_on_the_group() {
        let params = Params::bundled();
        let z = |id: &str, level: u8, day: u32| {
            let truth = params.group(Group::parse(id).expect("a group")).usage_demand_mean;
            (estimates(id, level, day).usage_volume / truth - 1.0) / params.study_level(level).noise
        };
        assert!((z("S1", 1, 0) - z("S1", 5, 52)).abs() < 0.02, "errors of two levels have the same sign");
        let pay = |id: &str| {
            let truth = params.group(Group::parse(id).expect("a group")).c_max_mean;
            (estimates(id, 1, 0).willingness_to_pay / truth - 1.0) / params.study_level(1).noise
        };
        assert!((pay("S1") + 0.742).abs() < 5e-4, "{}", pay("S1"));
        assert!(
            (pay("D_S01") - pay("D_S09")).abs() < 5e-4,
            "groups with the same first four letters share their errors"
        );
        assert!((pay("D_S01") - pay("D_S10")).abs() > 0.1);
    }

    #[test]
    fn noise_is_fixed_per_level() {
        let params = Params::bundled();
        let mut market = Market::initial(&params);
        let streams = Streams::new(42);
        let s1 = Group::at(0).expect("S1");
        let estimates = |market: &Market| insights(s1, market, &params, &streams).expect("S1 is known");
        let first = estimates(&market);
        assert_eq!(first, estimates(&market));
        assert_ne!(first, insights(s1, &market, &params, &Streams::new(43)).expect("S1 is known"));
        // The discovery of another group does not change earlier estimates.
        let found = Group::parse("D_S05").expect("a group");
        market.knowledge[found].level = 1;
        let more = estimates(&market);
        assert_eq!(more.willingness_to_pay, first.willingness_to_pay);
        assert!(first.reputation_to.iter().all(|link| more.reputation_to.contains(link)));
        // Estimates at two levels do not reveal the true value, because their draws are not proportional.
        market.knowledge[s1].level = 2;
        let truth = params.group(s1).c_max_mean;
        let z = |value: f64, noise: f64| (value / truth - 1.0) / noise;
        let better = estimates(&market);
        let (one, two) = (z(first.willingness_to_pay, 0.65), z(better.willingness_to_pay, 0.40));
        assert!((one - two).abs() > 0.01, "{one} and {two}");
        assert_eq!(insights(Group::parse("D_E01").expect("a group"), &market, &params, &streams), None);
    }

    #[test]
    fn errors_span_the_noise_range_of_the_level() {
        let params = Params::bundled();
        let mut market = Market::initial(&params);
        let s1 = Group::at(0).expect("S1");
        let truth = params.group(s1).c_max_mean;
        for level in 1..=5 {
            market.knowledge[s1].level = level;
            let noise = params.study_level(level).noise;
            let errors: Vec<f64> = (0..500)
                .map(|seed| insights(s1, &market, &params, &Streams::new(seed)).expect("S1 is known"))
                .map(|estimates| (estimates.willingness_to_pay / truth - 1.0) / noise)
                .collect();
            assert!(errors.iter().all(|error| error.abs() < 1.01), "level {level}");
            assert!(errors.iter().any(|error| *error < -0.97) && errors.iter().any(|error| *error > 0.97));
            assert!(errors.iter().sum::<f64>().abs() / 500.0 < 0.1, "level {level}");
        }
    }
}
