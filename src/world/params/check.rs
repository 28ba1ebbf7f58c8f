//! Ranges of the parameters and the relations between them.

use toml::{Table, Value};

use super::super::identifiers::{Channel, Group};
use super::{Params, Segment};

type Problem = (String, String);

/// Allowed values of a numeric key; `*` stands for every element of a list or every key of a table.
struct Range(&'static str, f64, f64);

const UNBOUNDED: f64 = f64::INFINITY;

const RANGES: &[Range] = &[
    Range("run.total_days", 7.0, 100_000.0),
    Range("run.days_per_week", 7.0, 7.0),
    Range("initial.initial_cash", f64::MIN_POSITIVE, 1e15),
    Range("initial.default_price_*", 0.0, 1e9),
    Range("initial.default_tier_*", 1.0, 5.0),
    Range("initial.default_quota_*", 0.0, 1e15),
    Range("initial.default_capacity_tier", 0.0, 7.0),
    Range("initial.default_spend_*", 0.0, 1e12),
    Range("initial.initial_reputation", 0.0, 1.0),
    Range("initial.*_info_level", 0.0, 5.0),
    Range("initial.customer_relationship", 0.0, 1.0),
    Range("limits.*", 0.0, 1e9),
    Range("limits.prediction_horizons_days.*", 1.0, 100_000.0),
    Range("participation.blend_weight", 0.0, 1.0),
    Range("participation.curve_split", 0.0, 1.0),
    Range("participation.curve_half_divisor", 1.0, 100.0),
    Range("customer_generation.*", 0.0, 1e6),
    Range("quality.base_product_quality", f64::MIN_POSITIVE, 100.0),
    Range("quality.stickiness_days_scale", f64::MIN_POSITIVE, 1e6),
    Range("quality.initial_decision_noise_*", 0.0, 100.0),
    Range("development.quality_shared_noise_scale", 0.0, 10.0),
    Range("development.dev_spend_scale", f64::MIN_POSITIVE, 1e12),
    Range("development.targeted_dev_spend_scale", f64::MIN_POSITIVE, 1e12),
    Range("development.rd_min_duration_days", 1.0, 100_000.0),
    Range("development.rd_report_decimals", 0.0, 12.0),
    Range("operations.base_outage_prob", 0.0, 1.0),
    Range("operations.ops_outage_min_prob", 0.0, 1.0),
    Range("operations.ops_outage_reduction_scale", f64::MIN_POSITIVE, 1e12),
    Range("operations.downtime_minutes_probabilities.*", 0.0, 1.0),
    Range("operations.downtime_minutes_choices.*", 0.0, 100_000.0),
    Range("operations.daily_usage_prune_every_days", 1.0, 100_000.0),
    Range("operations.daily_usage_keep_days", 1.0, 100_000.0),
    Range("ads.log_curve_k", f64::MIN_POSITIVE, 1e6),
    Range("model_tier.*.unit_cost", 0.0, 1e6),
    Range("model_tier.*.quality_multiplier", 0.0, 100.0),
    Range("capacity_tier.*.capacity_units", 1.0, 4e9),
    Range("capacity_tier.*.cost_per_day", 0.0, 4e9),
    Range("research_tier.*.cost", 0.0, 4e9),
    Range("research_tier.*.mean_days", 0.0, 100_000.0),
    Range("research_tier.*.std_days", 0.0, 1e6),
    Range("research_tier.*.std_quality_boost", 0.0, 1e6),
    Range("satisfaction.satisfaction_ema_alpha", 0.0, 1.0),
    Range("issues.issue_probability_*", 0.0, 1.0),
    Range("issues.issue_resolution_base_rate", 0.0, 1e9),
    Range("issues.*_ops_scale", 0.0, 1e6),
    Range("issues.relationship_*", 0.0, 1.0),
    Range("issues.new_issue_open_days", 1.0, 1_000.0),
    Range("billing.billing_period_days", 30.0, 30.0),
    Range("involuntary_churn.month_days", 1.0, 100_000.0),
    Range("involuntary_churn.mu_*", 0.0, 1.0),
    Range("calendar.*.*", 0.0, 1e6),
    Range("demand_surge.probability", 0.0, 1.0),
    Range("demand_surge.duration_days_low", 1.0, 10_000.0),
    Range("demand_surge.duration_days_high_exclusive", 1.0, 10_001.0),
    Range("demand_surge.multiplier_*", 0.0, 1e6),
    Range("leads.lead_acquisition_cost", 0.0, 1e9),
    Range("leads.ad_spend_unit", f64::MIN_POSITIVE, 1e12),
    Range("leads.days_per_year", f64::MIN_POSITIVE, 1e6),
    Range("leads.monthly_channel_noise_fraction", 0.0, 100.0),
    Range("leads.monthly_channel_noise_interval_days", 1.0, 100_000.0),
    Range("reputation.reputation_clamp_*", 0.0, 1.0),
    Range("reputation.reputation_floor", 0.0, 1.0),
    Range("competitor.competitor_event_mean_interval", f64::MIN_POSITIVE, 1e9),
    Range("competitor.competitor_event_min_interval", 0.0, 1e9),
    Range("competitor.competitor_event_boost_sigma", 0.0, 100.0),
    Range("competitor.competitor_event_boost_min", 0.0, 1e6),
    Range("competitor.competitor_event_boost_max", 0.0, 1e6),
    Range("competitor.competitor_event_magnitude_scale_*", 0.0, 1e6),
    Range("competitor.competitor_event_late_cutoff_days", 0.0, 1e9),
    Range("competitor.competitor_feedback_u_*", 0.0, 1.0),
    Range("competitor.competitor_segment_drain_u_*", 0.0, 1.0),
    Range("competitor.first_half_divisor", 1.0, 1e9),
    Range("drift.drift_grace_period_days", 0.0, 1e9),
    Range("drift.interval_days", 1.0, 100_000.0),
    Range("drift.days_per_application", 0.0, 100_000.0),
    Range("macro.macro_pmi_*", 0.0, 100_000.0),
    Range("macro.macro_pmi_update_interval_days", 1.0, 100_000.0),
    Range("macro.pmi_scale", f64::MIN_POSITIVE, 1e6),
    Range("social.max_posts_per_day", 0.0, 1_000.0),
    Range("social.sentiment.*.*", 0.0, 1.0),
    Range("social.*_high_exclusive", 1.0, 1e6),
    Range("social.*_days", 0.0, 100_000.0),
    Range("competitor.post_perspective_count", 1.0, 255.0),
    Range("competitor.competitor_event_post_days", 0.0, 10_000.0),
    Range("competitor.competitor_event_posts_per_day", 0.0, 1_000.0),
    Range("competitor.competitor_post_base_views_*", 0.0, 1e9),
    Range("macro.post_perspective_count", 1.0, 255.0),
    Range("macro.macro_social_post_count_*", 0.0, 1_000.0),
    Range("macro.macro_social_post_interval_*", 1.0, 100_000.0),
    Range("macro.published_pmi_decimals", 0.0, 12.0),
    Range("ceo_posts.viral_threshold", f64::MIN_POSITIVE, 0.999),
    Range("ceo_posts.notification_top_groups", 0.0, 3.0),
    Range("ceo_posts.notification_preview_chars", 0.0, 10_000.0),
    Range("ceo_posts.reply_*_high_exclusive", 1.0, 1e6),
    Range("ceo_posts.multiplier_half_life_days", f64::MIN_POSITIVE, 1e6),
    Range("enterprise.agent_response_timeout_days", 1.0, 100_000.0),
    Range("enterprise.enterprise_max_offerings_per_turn", 1.0, 1_000.0),
    Range("enterprise.contract_month_days", 1.0, 100_000.0),
    Range("enterprise.reply_delay_min_days", 1.0, 100_000.0),
    Range("enterprise.enterprise_negotiation_alpha", 0.0, 1.0),
    Range("enterprise.max_price_search_iterations", 1.0, 1_000.0),
    Range("enterprise.counter_offer_decimals", 0.0, 12.0),
    Range("enterprise.late_reply_free_days", 0.0, 100_000.0),
    Range("enterprise.relationship_*", 0.0, 1.0),
    Range("enterprise.plan_change_probability", 0.0, 1.0),
    Range("enterprise.plan_change_improvement_denominator_min", f64::MIN_POSITIVE, 1e6),
    Range("enterprise.extended_issue_days", 0.0, 100_000.0),
    Range("market_research.discovery_cost_level_1", 0.0, 1e12),
    Range("market_research.market_research_discover_prob", 0.0, 1.0),
    Range("info_level.*.noise", 0.0, 1.0),
    Range("info_level.*.delay_days", 0.0, 100_000.0),
    Range("info_level.*.cost", 0.0, 1e12),
    Range("group_research.*_target_level", 1.0, 5.0),
    Range("group_research.*_display_min", 0.0, 1e6),
    Range("group_research.*_decimals", 0.0, 15.0),
    Range("group.*.*_std", 0.0, 1e9),
    Range("group.*.usage_demand_*", 0.0, 1e6),
    Range("group.*.base_market_cap", 0.0, 1e12),
    Range("group.*.seat_count_min", 1.0, 1e6),
    Range("group.*.seat_count_max", 1.0, 1e6),
    Range("channel.*.leads_per_1000_dollars.*", 0.0, 1e9),
    Range("referral_leads_per_subscriber_day.*.*", 0.0, 1e6),
    Range("reputation_influence.*.*", 0.0, UNBOUNDED),
];

/// Checks every number of the merged tables against its range.
pub(super) fn ranges(tables: &Table) -> Result<(), Problem> {
    tables.iter().try_for_each(|(name, value)| finite(value, name.clone()))?;
    RANGES.iter().try_for_each(|range| {
        let parts: Vec<&str> = range.0.split('.').collect();
        tables
            .iter()
            .filter(|(name, _)| *name == parts[0])
            .try_for_each(|(name, value)| check_value(value, &parts[1..], range, name.clone()))
    })
}

/// Names of bounds: that of the lower one, that of the upper one, and whether the lower one has to be smaller.
const BOUNDS: [(&str, &str, bool); 3] =
    [("_min", "_max", false), ("_low", "_high", false), ("_low", "_high_exclusive", true)];

/// Checks that no lower bound is above the upper bound of the same name, wherever a table has both.
pub(super) fn bounds(tables: &Table) -> Result<(), Problem> {
    tables.iter().try_for_each(|(name, value)| match value {
        Value::Table(table) => bounds_of(table, name),
        _ => Ok(()),
    })
}

fn bounds_of(table: &Table, path: &str) -> Result<(), Problem> {
    table.iter().try_for_each(|(name, value)| {
        let key = format!("{path}.{name}");
        if let Value::Table(inner) = value {
            return bounds_of(inner, &key);
        }
        BOUNDS.iter().try_for_each(|(lower, upper, is_below)| {
            let upper = name.strip_suffix(lower).and_then(|start| table.get(&format!("{start}{upper}")));
            let (Some(low), Some(high)) = (as_number(value), upper.and_then(as_number)) else {
                return Ok(());
            };
            let holds = if *is_below { low < high } else { low <= high };
            require(holds, &key, || format!("the lower bound {low} is above the upper bound {high}"))
        })
    })
}

fn as_number(value: &Value) -> Option<f64> {
    match value {
        Value::Float(number) => Some(*number),
        Value::Integer(number) => Some(*number as f64),
        _ => None,
    }
}

/// No number of the world is without bounds.
fn finite(value: &Value, path: String) -> Result<(), Problem> {
    match value {
        Value::Float(number) if !number.is_finite() => {
            Err((path, format!("is {number}, but must be a finite number")))
        }
        Value::Table(table) => {
            table.iter().try_for_each(|(key, inner)| finite(inner, format!("{path}.{key}")))
        }
        Value::Array(values) => {
            values.iter().enumerate().try_for_each(|(at, inner)| finite(inner, format!("{path}.{at}")))
        }
        _ => Ok(()),
    }
}

fn check_value(value: &Value, rest: &[&str], range: &Range, path: String) -> Result<(), Problem> {
    let Some((pattern, rest)) = rest.split_first() else {
        return check_number(value, range, path);
    };
    match value {
        Value::Table(table) => table
            .iter()
            .filter(|(key, _)| matches(pattern, key))
            .try_for_each(|(key, inner)| check_value(inner, rest, range, format!("{path}.{key}"))),
        Value::Array(values) => values
            .iter()
            .enumerate()
            .try_for_each(|(at, inner)| check_value(inner, rest, range, format!("{path}.{at}"))),
        _ => Ok(()),
    }
}

fn check_number(value: &Value, range: &Range, path: String) -> Result<(), Problem> {
    let Some(number) = as_number(value) else { return Ok(()) };
    let &Range(_, low, high) = range;
    if number >= low && number <= high {
        return Ok(());
    }
    let allowed = match (low, high) {
        (low, UNBOUNDED) => format!("must be at least {low}"),
        (f64::MIN_POSITIVE, high) => format!("must be above 0 and at most {high}"),
        (low, high) if low == high => format!("must be {low}"),
        (low, high) => format!("must be between {low} and {high}"),
    };
    Err((path, format!("is {number}, but {allowed}")))
}

/// Whether a key fits a pattern in which one `*` stands for any letters.
fn matches(pattern: &str, key: &str) -> bool {
    match pattern.split_once('*') {
        None => pattern == key,
        Some((start, end)) => {
            key.len() >= start.len() + end.len() && key.starts_with(start) && key.ends_with(end)
        }
    }
}

/// Checks what single values cannot show: order, sizes of matrices, minima below maxima, sums of chances.
pub(super) fn relations(params: &Params) -> Result<(), Problem> {
    ordered_pairs(params)?;
    ladders(params)?;
    groups(params)?;
    networks(params)?;
    channels(params)?;
    let downtime: f64 = params.operations.downtime_minutes_probabilities.iter().sum();
    require((downtime - 1.0).abs() < 1e-9, "operations.downtime_minutes_probabilities", || {
        format!("add up to {downtime}, but must add up to 1")
    })?;
    let horizons = &params.limits.prediction_horizons_days;
    require(horizons.len() == 4, "limits.prediction_horizons_days", || "must be four horizons".to_owned())
}

fn require(holds: bool, key: &str, problem: impl FnOnce() -> String) -> Result<(), Problem> {
    if holds { Ok(()) } else { Err((key.to_owned(), problem())) }
}

fn ordered_pairs(params: &Params) -> Result<(), Problem> {
    let economy = &params.economy;
    let (low, high) = (economy.macro_pmi_floor, economy.macro_pmi_ceiling);
    require(low <= high, "macro.macro_pmi_floor", || {
        format!("the lower bound {low} is above the upper bound {high}")
    })
}

fn ladders(params: &Params) -> Result<(), Problem> {
    let numbered = |key: &str, numbers: Vec<u8>, first: u8, count: usize| {
        let expected: Vec<u8> = (first..first + count as u8).collect();
        require(numbers == expected, key, || {
            format!("must be numbered {first} to {}", first + count as u8 - 1)
        })
    };
    numbered("model_tier", params.model_tier.iter().map(|tier| tier.tier).collect(), 1, 5)?;
    numbered("capacity_tier", params.capacity_tier.iter().map(|tier| tier.tier).collect(), 0, 8)?;
    numbered("research_tier", params.research_tier.iter().map(|tier| tier.tier).collect(), 1, 20)?;
    numbered("info_level", params.info_level.iter().map(|level| level.level).collect(), 1, 5)
}

fn groups(params: &Params) -> Result<(), Problem> {
    let count = params.group.len();
    require(count == Group::COUNT, "group", || {
        format!("there are {count} groups, but must be {}", Group::COUNT)
    })?;
    let personas = params.personas.group.len();
    require(personas == Group::COUNT, "personas.group", || {
        format!("there are {personas} groups, but must be {}", Group::COUNT)
    })?;
    for group in Group::all() {
        let (own, persona) = (params.group(group), &params.personas.group[group.index()]);
        let key = |name: &str| format!("group.{}.{name}", group.index());
        require(own.id == group.id(), &key("id"), || {
            format!("is {}, but the order asks for {group}", own.id)
        })?;
        require(persona.id == group.id(), &format!("personas.group.{}.id", group.index()), || {
            format!("is {}, but the order asks for {group}", persona.id)
        })?;
        require((own.segment == Segment::Enterprise) == group.is_enterprise(), &key("segment"), || {
            "does not fit the identifier: S is individual, E is enterprise".to_owned()
        })?;
        require(own.initially_known == group.initially_known(), &key("initially_known"), || {
            "does not fit the identifier: D_ groups have to be discovered".to_owned()
        })?;
        if group.is_enterprise() {
            let complete = own.seat_count_min.is_some()
                && own.seat_count_max.is_some()
                && own.reply_delay_mean.is_some()
                && own.reply_delay_std.is_some()
                && own.max_negotiation_turns_mean.is_some()
                && own.max_negotiation_turns_std.is_some();
            require(complete, &key("id"), || {
                "an enterprise group needs seat_count, reply_delay and max_negotiation_turns".to_owned()
            })?;
            require(own.seat_count_min <= own.seat_count_max, &key("seat_count_min"), || {
                "the lower bound is above the upper bound".to_owned()
            })?;
        }
    }
    Ok(())
}

fn networks(params: &Params) -> Result<(), Problem> {
    for (name, matrix) in [
        ("referral_leads_per_subscriber_day", &params.referral_leads_per_subscriber_day),
        ("reputation_influence", &params.reputation_influence),
    ] {
        for group in Group::all() {
            let width = matrix.get(group.id()).map_or(0, Vec::len);
            require(width == Group::COUNT, &format!("{name}.{group}"), || {
                format!("has {width} numbers, but must have {}", Group::COUNT)
            })?;
        }
        require(matrix.len() == Group::COUNT, name, || "names a group that does not exist".to_owned())?;
    }
    Ok(())
}

fn channels(params: &Params) -> Result<(), Problem> {
    let ids: Vec<&str> = params.channel.iter().map(|channel| channel.id.as_str()).collect();
    require(ids == Channel::ALL.map(Channel::id), "channel", || {
        "must be social_media, search_ads, linkedin, content_marketing, referral_program".to_owned()
    })?;
    for (at, channel) in params.channel.iter().enumerate() {
        for id in channel.leads_per_1000_dollars.keys() {
            require(
                Group::parse(id).is_some(),
                &format!("channel.{at}.leads_per_1000_dollars.{id}"),
                || "there is no such group".to_owned(),
            )?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::{Params, shipped_sources};
    use super::*;

    fn near(actual: f64, expected: f64) {
        assert!((actual - expected).abs() < 1e-9 * expected.abs().max(1.0), "{actual} instead of {expected}");
    }

    #[test]
    fn every_range_is_that_of_a_parameter() {
        let tables: Vec<Table> =
            shipped_sources().iter().map(|source| source.text.parse().expect("a table")).collect();
        for Range(key, ..) in RANGES {
            let parts: Vec<&str> = key.split('.').collect();
            // No number is in it: the first that the key names complains.
            let nothing = Range(key, 1.0, 0.0);
            let mut named = tables.iter().flatten().filter(|(name, _)| *name == parts[0]);
            let found =
                named.any(|(name, value)| check_value(value, &parts[1..], &nothing, name.clone()).is_err());
            assert!(found, "no parameter is {key}");
        }
    }

    #[test]
    fn sums_over_groups_and_channels_are_those_of_the_release() {
        let params = Params::shipped();
        let sum = |value: fn(&super::super::GroupParams) -> f64| params.group.iter().map(value).sum::<f64>();
        near(sum(|group| group.c_max_mean), 2495.0);
        near(sum(|group| group.q_min_mean), 11.37);
        near(sum(|group| group.usage_demand_mean), 3780.0);
        near(sum(|group| group.base_market_cap), 1_208_492.0);
        near(sum(|group| group.involuntary_churn_mean), 0.682);
        near(sum(|group| group.competitor_reactivity_q_bias), 2.69);
        let yields = params.starting_yields();
        for (channel, expected) in
            Channel::ALL.into_iter().zip([1542.4206, 1475.0535, 1745.3058, 1567.6017, 2286.498])
        {
            near(yields[channel].iter().sum(), expected);
        }
    }

    #[test]
    fn sums_of_the_networks_are_those_of_the_release() {
        let params = Params::shipped();
        let pairs = || Group::all().flat_map(|source| Group::all().map(move |target| (source, target)));
        near(pairs().map(|(source, target)| params.referral_rate(source, target)).sum(), 0.46369999);
        near(pairs().map(|(source, target)| params.reputation_weight(source, target)).sum(), 75.194);
    }

    #[test]
    fn patterns_match_with_one_star() {
        assert!(matches("default_price_*", "default_price_A"));
        assert!(matches("*", "anything"));
        assert!(!matches("mu_*", "month_days"));
    }
}
