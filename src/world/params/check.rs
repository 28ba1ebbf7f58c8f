//! Checks the ranges of parameters and the relations between parameters.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use toml::{Table, Value};

use super::super::fault::Fault;
use super::super::identifiers::{Channel, Group};
use super::{
    Fidelity, GroupDrift, HorizonRule, IndividualDrift, MacroBeta, Params, Personas, Segment, SeriesChoice,
};

/// Key of an invalid parameter, and the reason why the value is invalid.
type Problem = (String, String);
pub(super) type Checked = Result<(), Problem>;

/// The smallest and the largest allowed value of a parameter.
pub(super) type Range = RangeInclusive<f64>;

/// Lower bound for ranges of positive numbers.
pub(super) const POSITIVE: f64 = f64::MIN_POSITIVE;
pub(super) const ANY: Range = f64::NEG_INFINITY..=f64::INFINITY;

/// Defines structs for tables of parameters. `where LOW..=HIGH` after the type of a field is the range of its numbers,
/// which also applies to the numbers of a list. `as "key"` after the name of a field is its key, if key and name
/// differ.
macro_rules! parameters {
    ($($(#[$meta:meta])* pub struct $name:ident {
        $($(#[$field_meta:meta])* pub $field:ident $(as $key:literal)?: $type:ty $(where $range:expr)?,)*
    })*) => {$(
        $(#[$meta])*
        #[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
        #[serde(deny_unknown_fields)]
        pub struct $name {
            $($(#[$field_meta])* $(#[serde(rename = $key)])? pub $field: $type,)*
        }

        impl $crate::params::check::Ranged for $name {
            fn check(
                table: &toml::Value,
                path: &str,
                _: &$crate::params::check::Range,
            ) -> $crate::params::check::Checked {
                use $crate::params::check::*;
                $(field::<$type>(table, path, [$($key,)? stringify!($field)][0], &[$($range,)? ANY][0])?;)*
                Ok(())
            }
        }
    )*};
}
pub(super) use parameters;

/// A parameter type whose numbers can have an allowed range.
pub(super) trait Ranged {
    /// Checks the numbers of a TOML value that will be parsed as this type. The default implementation checks a single
    /// number.
    fn check(value: &Value, path: &str, range: &Range) -> Checked {
        match as_number(value) {
            Some(number) if !range.contains(&number) => {
                Err((path.to_owned(), format!("is {number}, but {}", describe_range(range))))
            }
            _ => Ok(()),
        }
    }
}

macro_rules! single {
    ($($type:ty),*) => {
        $(impl Ranged for $type {})*
    };
}
single!(f64, u8, u32, u64, bool, String, Segment);
// Types whose numbers have no allowed range.
single!(Fault, Fidelity, GroupDrift, HorizonRule, IndividualDrift, MacroBeta, Personas, SeriesChoice);

impl<T: Ranged> Ranged for Option<T> {
    fn check(value: &Value, path: &str, range: &Range) -> Checked {
        T::check(value, path, range)
    }
}

impl<T: Ranged> Ranged for Vec<T> {
    fn check(value: &Value, path: &str, range: &Range) -> Checked {
        let mut elements = value.as_array().into_iter().flatten().enumerate();
        elements.try_for_each(|(at, inner)| T::check(inner, &format!("{path}.{at}"), range))
    }
}

impl<T: Ranged, const COUNT: usize> Ranged for [T; COUNT] {
    fn check(value: &Value, path: &str, range: &Range) -> Checked {
        Vec::<T>::check(value, path, range)
    }
}

impl<T: Ranged> Ranged for BTreeMap<String, T> {
    fn check(value: &Value, path: &str, range: &Range) -> Checked {
        let mut entries = value.as_table().into_iter().flatten();
        entries.try_for_each(|(key, inner)| T::check(inner, &format!("{path}.{key}"), range))
    }
}

/// Checks the value of a key, if the table contains the key.
pub(super) fn field<T: Ranged>(table: &Value, path: &str, key: &str, range: &Range) -> Checked {
    let Some(value) = table.get(key) else { return Ok(()) };
    let path = if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") };
    T::check(value, &path, range)
}

fn describe_range(range: &Range) -> String {
    match (*range.start(), *range.end()) {
        (low, f64::INFINITY) => format!("must be at least {low}"),
        (POSITIVE, high) => format!("must be above 0 and at most {high}"),
        (low, high) if low == high => format!("must be {low}"),
        (low, high) => format!("must be between {low} and {high}"),
    }
}

/// Checks every number of the merged tables against its range.
pub(super) fn check_ranges(tables: &Value) -> Checked {
    let mut named = tables.as_table().into_iter().flatten();
    named.try_for_each(|(name, value)| check_finite(value, name.clone()))?;
    Params::check(tables, "", &ANY)
}

/// Suffix of lower bounds, suffix of the corresponding upper bounds, and whether the lower bound must be strictly
/// smaller.
const BOUND_SUFFIXES: [(&str, &str, bool); 3] =
    [("_min", "_max", false), ("_low", "_high", false), ("_low", "_high_exclusive", true)];

/// Checks that no lower bound exceeds its upper bound in the same table.
pub(super) fn check_bounds(tables: &Table) -> Checked {
    tables.iter().try_for_each(|(name, value)| match value {
        Value::Table(table) => check_table_bounds(table, name),
        _ => Ok(()),
    })
}

fn check_table_bounds(table: &Table, path: &str) -> Checked {
    table.iter().try_for_each(|(name, value)| {
        let key = format!("{path}.{name}");
        if let Value::Table(inner) = value {
            return check_table_bounds(inner, &key);
        }
        BOUND_SUFFIXES.iter().try_for_each(|(lower, upper, is_below)| {
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

fn check_finite(value: &Value, path: String) -> Checked {
    match value {
        Value::Float(number) if !number.is_finite() => {
            Err((path, format!("is {number}, but must be a finite number")))
        }
        Value::Table(table) => {
            table.iter().try_for_each(|(key, inner)| check_finite(inner, format!("{path}.{key}")))
        }
        Value::Array(values) => {
            values.iter().enumerate().try_for_each(|(at, inner)| check_finite(inner, format!("{path}.{at}")))
        }
        _ => Ok(()),
    }
}

/// Checks relations between parameters: order, sizes of matrices, bounds, and sums of probabilities.
pub(super) fn check_relations(params: &Params) -> Checked {
    check_ordered_pairs(params)?;
    check_tiers(params)?;
    check_groups(params)?;
    check_networks(params)?;
    check_channels(params)?;
    let downtime: f64 = params.operations.downtime_minutes_probabilities.iter().sum();
    require((downtime - 1.0).abs() < 1e-9, "operations.downtime_minutes_probabilities", || {
        format!("add up to {downtime}, but must add up to 1")
    })?;
    let horizons = &params.limits.prediction_horizons_days;
    require(horizons.len() == 4, "limits.prediction_horizons_days", || "must have four horizons".to_owned())
}

fn require(holds: bool, key: &str, problem: impl FnOnce() -> String) -> Checked {
    if holds { Ok(()) } else { Err((key.to_owned(), problem())) }
}

fn check_ordered_pairs(params: &Params) -> Checked {
    let economy = &params.economy;
    let (low, high) = (economy.macro_pmi_floor, economy.macro_pmi_ceiling);
    require(low <= high, "macro.macro_pmi_floor", || {
        format!("the lower bound {low} is above the upper bound {high}")
    })
}

fn check_tiers(params: &Params) -> Checked {
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

fn check_groups(params: &Params) -> Checked {
    let count = params.group.len();
    require(count == Group::COUNT, "group", || {
        format!("has {count} groups, but must have {}", Group::COUNT)
    })?;
    let personas = params.personas.group.len();
    require(personas == Group::COUNT, "personas.group", || {
        format!("has {personas} groups, but must have {}", Group::COUNT)
    })?;
    for group in Group::all() {
        let (group_params, persona) = (params.group(group), &params.personas.group[group.index()]);
        let key = |name: &str| format!("group.{}.{name}", group.index());
        require(group_params.id == group.id(), &key("id"), || {
            format!("is {}, but must be {group} at this position", group_params.id)
        })?;
        require(persona.id == group.id(), &format!("personas.group.{}.id", group.index()), || {
            format!("is {}, but must be {group} at this position", persona.id)
        })?;
        require(
            (group_params.segment == Segment::Enterprise) == group.is_enterprise(),
            &key("segment"),
            || "does not match the identifier: S groups are individuals, E groups are enterprises".to_owned(),
        )?;
        require(group_params.initially_known == group.is_initially_known(), &key("initially_known"), || {
            "does not match the identifier: D_ groups have to be discovered".to_owned()
        })?;
        if group.is_enterprise() {
            let complete = group_params.seat_count_min.is_some()
                && group_params.seat_count_max.is_some()
                && group_params.reply_delay_mean.is_some()
                && group_params.reply_delay_std.is_some()
                && group_params.max_negotiation_turns_mean.is_some()
                && group_params.max_negotiation_turns_std.is_some();
            require(complete, &key("id"), || {
                "an enterprise group needs seat_count, reply_delay and max_negotiation_turns".to_owned()
            })?;
            require(
                group_params.seat_count_min <= group_params.seat_count_max,
                &key("seat_count_min"),
                || "the lower bound is above the upper bound".to_owned(),
            )?;
        }
    }
    Ok(())
}

fn check_networks(params: &Params) -> Checked {
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
        require(matrix.len() == Group::COUNT, name, || "contains a group that does not exist".to_owned())?;
    }
    Ok(())
}

fn check_channels(params: &Params) -> Checked {
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
    use super::*;

    fn assert_near(actual: f64, expected: f64) {
        assert!(
            (actual - expected).abs() < 1e-9 * expected.abs().max(1.0),
            "got {actual}, expected {expected}"
        );
    }

    #[test]
    fn sums_over_groups_and_channels_match_the_release() {
        let params = Params::bundled();
        let sum = |value: fn(&super::super::GroupParams) -> f64| params.group.iter().map(value).sum::<f64>();
        assert_near(sum(|group| group.c_max_mean), 2495.0);
        assert_near(sum(|group| group.q_min_mean), 11.37);
        assert_near(sum(|group| group.usage_demand_mean), 3780.0);
        assert_near(sum(|group| group.base_market_cap), 1_208_492.0);
        assert_near(sum(|group| group.involuntary_churn_mean), 0.682);
        assert_near(sum(|group| group.competitor_reactivity_q_bias), 2.69);
        let yields = params.starting_yields();
        for (channel, expected) in
            Channel::ALL.into_iter().zip([1542.4206, 1475.0535, 1745.3058, 1567.6017, 2286.498])
        {
            assert_near(yields[channel].iter().sum(), expected);
        }
    }

    #[test]
    fn network_sums_match_the_release() {
        let params = Params::bundled();
        let pairs = || Group::all().flat_map(|source| Group::all().map(move |target| (source, target)));
        assert_near(pairs().map(|(source, target)| params.referral_rate(source, target)).sum(), 0.46369999);
        assert_near(pairs().map(|(source, target)| params.reputation_weight(source, target)).sum(), 75.194);
    }
}
