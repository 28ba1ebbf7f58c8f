//! Parsing of arguments from JSON to typed values, with the rejections that all tools share
//! (docs/interfaces/tools.md#arguments).

use std::sync::Arc;

use indexmap::IndexMap;
use serde::{Serialize, Serializer};
use serde_json::{Map, Number, Value};

use super::numbers::Numbers;
use super::refusal::Refusal;
use super::spec::{ArgumentKind, Range, Spec};
use super::view::View;
use novamind_base::notation::plain_numbers;
use novamind_world::identifiers::{Channel, Group, Plan};
use novamind_world::settings::{PerCustomer, PerGroup, PerPlan};

/// Arguments of a call with valid names, without absent and null ones.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Arguments(Map<String, Value>);

impl Arguments {
    /// Checks the names of the arguments of a call. `numbers` fills the placeholders of error messages.
    ///
    /// # Errors
    /// `wrong_type` if they are not an object, `unknown_argument`, `argument_missing`.
    pub fn of(
        spec: &Spec,
        given: &Value,
        numbers: impl FnOnce() -> Arc<Numbers>,
    ) -> Result<Arguments, Refusal> {
        let mut map = match given {
            Value::Null => Map::new(),
            Value::Object(map) => map.clone(),
            _ => {
                return Err(Refusal::new(
                    "wrong_type",
                    "the arguments must be an object of names and values",
                ));
            }
        };
        if let Some(whole) = spec.whole
            && !map.is_empty()
            && !map.keys().any(|name| is_named(spec, name))
            && may_be_whole(spec, &map)
        {
            map = Map::from_iter([(whole.to_owned(), Value::Object(map))]);
        }
        if !spec.own_unknown
            && let Some(name) = map.keys().find(|name| !is_named(spec, name))
        {
            let message = format!("{} has no argument {name}; it has {}", spec.name(), names(spec));
            return Err(Refusal::at(name.clone(), "unknown_argument", message));
        }
        map.retain(|_, value| !value.is_null());
        for argument in spec.arguments.iter().filter(|argument| argument.required && !spec.own_missing()) {
            let given = map.contains_key(argument.name)
                || argument.alias.is_some_and(|alias| map.contains_key(alias));
            if !given {
                let message = format!("{} is required: {}", argument.name, numbers().fill(argument.doc));
                return Err(Refusal::at(argument.name, "argument_missing", message));
            }
        }
        Ok(Arguments(map))
    }

    /// Returns the arguments as a JSON object.
    pub fn as_map(&self) -> &Map<String, Value> {
        &self.0
    }

    /// Returns an argument, if it was given.
    pub fn get(&self, name: &str) -> Option<&Value> {
        self.0.get(name)
    }

    /// Parses an argument, if it was given.
    ///
    /// # Errors
    /// Those of `reader`.
    pub fn read<T>(
        &self,
        name: &'static str,
        reader: impl FnOnce(&Value, &'static str) -> Result<T, Refusal>,
    ) -> Result<Option<T>, Refusal> {
        self.get(name).map(|value| reader(value, name)).transpose()
    }

    /// Returns whether no argument was given.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

fn is_named(spec: &Spec, name: &str) -> bool {
    spec.arguments.iter().any(|argument| argument.name == name || argument.alias == Some(name))
}

/// Returns whether an object without argument names can be the single argument itself. A deal has a customer or offerings; a
/// map can have any key.
fn may_be_whole(spec: &Spec, map: &Map<String, Value>) -> bool {
    let is_deal = spec
        .arguments
        .iter()
        .any(|argument| matches!(argument.kind, ArgumentKind::Structure(_) | ArgumentKind::Deals(_)));
    !is_deal || ["customer_id", "offerings"].iter().any(|key| map.contains_key(*key))
}

fn names(spec: &Spec) -> String {
    let names: Vec<&str> = spec.arguments.iter().map(|argument| argument.name).collect();
    if names.is_empty() { "none".to_owned() } else { names.join(", ") }
}

/// Returns a JSON number, but not a Boolean or a text.
pub fn number(value: &Value) -> Option<f64> {
    value.as_f64()
}

/// Returns a JSON integer, including integral floats, but not a Boolean or a text.
pub fn integer(value: &Value) -> Option<i64> {
    let exact = |number: &f64| number.fract() == 0.0 && number.abs() < 9.2e18;
    value.as_i64().or_else(|| value.as_f64().filter(exact).map(|number| number as i64))
}

impl Range {
    /// Returns a JSON integer in this range, including integral floats.
    pub fn whole<T: TryFrom<i64>>(&self, value: &Value) -> Option<T> {
        let number = integer(value).filter(|number| self.holds(*number as f64))?;
        T::try_from(number).ok()
    }
}

/// Replaces a setting if a call gives it.
pub fn replace<T>(now: &mut T, given: Option<T>) {
    if let Some(given) = given {
        *now = given;
    }
}

/// Returns a text argument, or an empty text if it was not given.
pub fn text<'a>(arguments: &'a Arguments, name: &str) -> Result<&'a str, Refusal> {
    match arguments.get(name) {
        None => Ok(""),
        Some(value) => value.as_str().ok_or_else(|| wrong_type(name, "text")),
    }
}

/// A number in its sent notation: 80 and 80.0 are the same amount, but are written differently.
#[derive(Debug, Clone, PartialEq)]
pub struct Sent {
    /// Value.
    pub value: f64,
    written: Number,
}

impl Sent {
    /// Parses a JSON number, but not a Boolean or a text.
    pub fn of(value: &Value) -> Option<Sent> {
        let written = value.as_number()?.clone();
        Some(Sent { value: written.as_f64()?, written })
    }

    /// Returns the notation of a setting: with a decimal point.
    pub fn stored(value: f64) -> Sent {
        Sent { value, written: Number::from_f64(value).unwrap_or_else(|| 0.into()) }
    }

    /// Returns the sum of `parts`, without a decimal point if none of them has one, as in the release.
    pub fn sum<'a>(value: f64, mut parts: impl Iterator<Item = &'a Sent>) -> Sent {
        const EXACT: f64 = 9e15;
        match parts.all(|part| !part.written.is_f64()) && value.abs() < EXACT {
            true => Sent { value, written: Number::from(value as i64) },
            false => Sent::stored(value),
        }
    }
}

impl Serialize for Sent {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.written.serialize(serializer)
    }
}

/// Returns the rejection `wrong_type` for an argument.
pub fn wrong_type(field: &str, expected: &str) -> Refusal {
    Refusal::at(field, "wrong_type", format!("{field} has the wrong type: expected {expected}"))
}

/// The requirement for numbers of a map, with its rejection.
#[derive(Clone, Copy)]
pub struct Amount {
    /// Rejection code.
    pub code: &'static str,
    /// Message after "the value for KEY".
    pub words: &'static str,
    /// Allowed numbers.
    pub range: Range,
}

impl Amount {
    fn read(&self, value: &Value, field: &str) -> Result<Sent, Refusal> {
        match Sent::of(value) {
            Some(sent) if self.range.holds(sent.value) => Ok(sent),
            _ => Err(Refusal::at(field, self.code, format!("the value for {} {}", last(field), self.words))),
        }
    }
}

fn last(field: &str) -> &str {
    field.rsplit('.').next().unwrap_or(field)
}

/// Parses a known group.
pub fn known_group(key: &str, field: &str, view: &View<'_>) -> Result<Group, Refusal> {
    Group::parse(key).filter(|group| view.knows(*group)).ok_or_else(|| {
        let known: Vec<&str> = view.known_groups().map(Group::id).collect();
        Refusal::at(
            field,
            "unknown_group",
            format!("group {key} is not known; the known groups are {}", known.join(", ")),
        )
    })
}

/// Parses a plan.
pub fn plan(key: &str, field: &str) -> Result<Plan, Refusal> {
    Plan::parse(key).ok_or_else(|| {
        Refusal::at(field, "unknown_plan", format!("plan {key} does not exist; the plans are A, B, C"))
    })
}

/// Parses a channel.
pub fn channel(key: &str, field: &str) -> Result<Channel, Refusal> {
    Channel::parse(key).ok_or_else(|| {
        let known = Channel::ALL.map(Channel::id).join(", ");
        Refusal::at(
            field,
            "unknown_channel",
            format!("channel {key} does not exist; the channels are {known}"),
        )
    })
}

/// Parses a customer number, without checking that the customer exists.
pub fn customer(key: &str, field: &str) -> Result<i64, Refusal> {
    key.trim().parse().map_err(|_| {
        Refusal::at(field, "customer_not_integer", format!("customer id {key} is not an integer"))
    })
}

fn amounts<K: std::hash::Hash + Eq>(
    value: &Value,
    field: &str,
    amount: Amount,
    key: impl Fn(&str, &str) -> Result<K, Refusal>,
) -> Result<IndexMap<K, Sent>, Refusal> {
    entries(value, field, key, |value, field| amount.read(value, field))
}

/// Parses a map: first all keys, then the values.
fn entries<K: std::hash::Hash + Eq, V>(
    value: &Value,
    field: &str,
    key: impl Fn(&str, &str) -> Result<K, Refusal>,
    read: impl Fn(&Value, &str) -> Result<V, Refusal>,
) -> Result<IndexMap<K, V>, Refusal> {
    let object = as_map(value, field)?;
    let path = |name: &String| format!("{field}.{name}");
    let keys: Vec<K> = object.keys().map(|name| key(name, &path(name))).collect::<Result<_, Refusal>>()?;
    let values = object.iter().map(|(name, value)| read(value, &path(name)));
    keys.into_iter().zip(values).map(|(key, value)| Ok((key, value?))).collect()
}

fn as_map<'a>(value: &'a Value, field: &str) -> Result<&'a Map<String, Value>, Refusal> {
    value.as_object().ok_or_else(|| Refusal::at(field, "not_a_map", format!("{field} must be a map")))
}

fn values<K: std::hash::Hash + Eq>(map: IndexMap<K, Sent>) -> IndexMap<K, f64> {
    map.into_iter().map(|(key, sent)| (key, sent.value)).collect()
}

/// Parses a map of groups, keeping the sent notation of numbers.
pub fn sent_per_group(
    value: &Value,
    field: &str,
    amount: Amount,
    view: &View<'_>,
) -> Result<IndexMap<Group, Sent>, Refusal> {
    amounts(value, field, amount, |key, field| known_group(key, field, view))
}

/// Parses a map of channels to maps of groups, keeping the sent notation of numbers.
pub fn sent_per_channel_group(
    value: &Value,
    field: &str,
    amount: Amount,
    view: &View<'_>,
) -> Result<IndexMap<Channel, IndexMap<Group, Sent>>, Refusal> {
    entries(value, field, channel, |value, field| sent_per_group(value, field, amount, view))
}

/// Parses a map of groups.
pub fn per_group(value: &Value, field: &str, amount: Amount, view: &View<'_>) -> Result<PerGroup, Refusal> {
    sent_per_group(value, field, amount, view).map(values)
}

/// Parses a map of plans.
pub fn per_plan(value: &Value, field: &str, amount: Amount) -> Result<PerPlan, Refusal> {
    amounts(value, field, amount, plan).map(values)
}

/// Parses a map of channels.
pub fn per_channel(value: &Value, field: &str, amount: Amount) -> Result<IndexMap<Channel, f64>, Refusal> {
    amounts(value, field, amount, channel).map(values)
}

/// Parses a map of customers entry by entry, which the release does for this map only.
pub fn per_customer(value: &Value, field: &str, amount: Amount) -> Result<PerCustomer, Refusal> {
    let entry = |(name, value): (&String, &Value)| {
        let path = format!("{field}.{name}");
        Ok((customer(name, &path)?, amount.read(value, &path)?.value))
    };
    as_map(value, field)?.iter().map(entry).collect()
}

/// Parses a map of groups to maps of plans.
pub fn per_group_plan(
    value: &Value,
    field: &str,
    amount: Amount,
    view: &View<'_>,
) -> Result<IndexMap<Group, PerPlan>, Refusal> {
    let group = |name: &str, field: &str| known_group(name, field, view);
    entries(value, field, group, |value, field| per_plan(value, field, amount))
}

/// Parses a map of channels to maps of groups.
pub fn per_channel_group(
    value: &Value,
    field: &str,
    amount: Amount,
    view: &View<'_>,
) -> Result<IndexMap<Channel, PerGroup>, Refusal> {
    let matrix = sent_per_channel_group(value, field, amount, view)?;
    Ok(matrix.into_iter().map(|(channel, groups)| (channel, values(groups))).collect())
}

/// Serializes whole numbers without a decimal point, for fields that are integers in the release.
///
/// # Errors
/// Those of the serializer.
pub(super) fn plain<T: Serialize, S: Serializer>(data: &T, serializer: S) -> Result<S::Ok, S::Error> {
    let value = serde_json::to_value(data).map_err(serde::ser::Error::custom)?;
    plain_numbers(value).serialize(serializer)
}

/// Returns data as the JSON of a call.
pub(super) fn as_data(data: &impl Serialize) -> Value {
    serde_json::to_value(data).map_or(Value::Null, plain_numbers)
}
