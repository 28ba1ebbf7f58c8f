//! Converts JSON arguments to typed values, with the rejections that all tools share
//! (docs/interfaces/tools.md#arguments).

use std::sync::Arc;

use indexmap::IndexMap;
use serde::{Serialize, Serializer};
use serde_json::{Map, Number, Value};

use super::parameter_numbers::ParameterNumbers;
use super::rejection::Rejection;
use super::spec::{ArgumentKind, NumberRange, ToolSpec};
use super::tool_context::ToolContext;
use novamind_base::formatting::normalize_json_numbers;
use novamind_world::identifiers::{Channel, Group, Plan};
use novamind_world::settings::{PerCustomer, PerGroup, PerPlan};

/// The arguments of a call, with valid names and without null values.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Arguments(Map<String, Value>);

impl Arguments {
    /// Checks the names of the arguments in a call. `numbers` fills the placeholders in error messages.
    ///
    /// # Errors
    /// `wrong_type` if the arguments are not an object; `unknown_argument` or `argument_missing` if an argument is
    /// unknown or missing.
    pub fn parse(
        spec: &ToolSpec,
        given: &Value,
        numbers: impl FnOnce() -> Arc<ParameterNumbers>,
    ) -> Result<Arguments, Rejection> {
        let mut map = match given {
            Value::Null => Map::new(),
            Value::Object(map) => map.clone(),
            _ => {
                return Err(Rejection::new(
                    "wrong_type",
                    "the arguments must be an object of names and values",
                ));
            }
        };
        if let Some(whole) = spec.unnamed_argument
            && !map.is_empty()
            && !map.keys().any(|name| is_argument_name(spec, name))
            && is_unnamed_argument(spec, &map)
        {
            map = Map::from_iter([(whole.to_owned(), Value::Object(map))]);
        }
        if !spec.has_own_unknown_code
            && let Some(name) = map.keys().find(|name| !is_argument_name(spec, name))
        {
            let message = format!("{} has no argument {name}; it has {}", spec.name(), argument_names(spec));
            return Err(Rejection::for_field(name.clone(), "unknown_argument", message));
        }
        map.retain(|_, value| !value.is_null());
        for argument in
            spec.arguments.iter().filter(|argument| argument.required && !spec.has_own_missing_code())
        {
            let given = map.contains_key(argument.name)
                || argument.alias.is_some_and(|alias| map.contains_key(alias));
            if !given {
                let message =
                    format!("{} is required: {}", argument.name, numbers().substitute(argument.description));
                return Err(Rejection::for_field(argument.name, "argument_missing", message));
            }
        }
        Ok(Arguments(map))
    }

    /// Returns the arguments as a JSON object.
    pub fn as_map(&self) -> &Map<String, Value> {
        &self.0
    }

    /// Returns the JSON value of an argument, or `None` if the argument was not given.
    pub fn get(&self, name: &str) -> Option<&Value> {
        self.0.get(name)
    }

    /// Parses an argument with `reader`. Returns `None` if the argument was not given.
    ///
    /// # Errors
    /// Returns the errors of `reader`.
    pub fn parse_argument<T>(
        &self,
        name: &'static str,
        reader: impl FnOnce(&Value, &'static str) -> Result<T, Rejection>,
    ) -> Result<Option<T>, Rejection> {
        self.get(name).map(|value| reader(value, name)).transpose()
    }

    /// Returns whether no argument was given.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

fn is_argument_name(spec: &ToolSpec, name: &str) -> bool {
    spec.arguments.iter().any(|argument| argument.name == name || argument.alias == Some(name))
}

/// Returns whether an object can be the value of the tool's unnamed argument. A deal must have the key `customer_id`
/// or `offerings`. A map can have any keys.
fn is_unnamed_argument(spec: &ToolSpec, map: &Map<String, Value>) -> bool {
    let is_deal = spec
        .arguments
        .iter()
        .any(|argument| matches!(argument.kind, ArgumentKind::Structure(_) | ArgumentKind::Deals(_)));
    !is_deal || ["customer_id", "offerings"].iter().any(|key| map.contains_key(*key))
}

fn argument_names(spec: &ToolSpec) -> String {
    let names: Vec<&str> = spec.arguments.iter().map(|argument| argument.name).collect();
    if names.is_empty() { "none".to_owned() } else { names.join(", ") }
}

/// Returns the value of a JSON number, or `None` for other types.
pub fn json_f64(value: &Value) -> Option<f64> {
    value.as_f64()
}

/// Returns the value of a JSON integer or an integral float, or `None` for other values.
pub fn json_i64(value: &Value) -> Option<i64> {
    let exact = |number: &f64| number.fract() == 0.0 && number.abs() < 9.2e18;
    value.as_i64().or_else(|| value.as_f64().filter(exact).map(|number| number as i64))
}

impl NumberRange {
    /// Parses a JSON integer or an integral float. Returns `None` if the number is outside this range.
    pub fn parse_integer<T: TryFrom<i64>>(&self, value: &Value) -> Option<T> {
        let number = json_i64(value).filter(|number| self.contains(*number as f64))?;
        T::try_from(number).ok()
    }
}

/// Replaces a setting if a call contains a new value.
pub fn replace_if_given<T>(now: &mut T, given: Option<T>) {
    if let Some(given) = given {
        *now = given;
    }
}

/// Returns a text argument, or an empty text if the argument was not given.
pub fn text_argument<'a>(arguments: &'a Arguments, name: &str) -> Result<&'a str, Rejection> {
    match arguments.get(name) {
        None => Ok(""),
        Some(value) => value.as_str().ok_or_else(|| wrong_type_rejection(name, "text")),
    }
}

/// A number that keeps the notation of the caller, so that 80 differs from 80.0.
#[derive(Debug, Clone, PartialEq)]
pub struct SentNumber {
    /// Value of the number.
    pub value: f64,
    number: Number,
}

impl SentNumber {
    /// Converts a JSON number. Returns `None` for other types.
    pub fn from_json(value: &Value) -> Option<SentNumber> {
        let written = value.as_number()?.clone();
        Some(SentNumber { value: written.as_f64()?, number: written })
    }

    /// Converts the value of a setting, which is always written with a decimal point.
    pub fn from_setting(value: f64) -> SentNumber {
        SentNumber { value, number: Number::from_f64(value).unwrap_or_else(|| 0.into()) }
    }

    /// Returns `value`, the sum of `parts`. The sum is written without a decimal point if no part has one, as in the
    /// released simulator.
    pub fn sum<'a>(value: f64, mut parts: impl Iterator<Item = &'a SentNumber>) -> SentNumber {
        const MAX_EXACT_INTEGER: f64 = 9e15;
        match parts.all(|part| !part.number.is_f64()) && value.abs() < MAX_EXACT_INTEGER {
            true => SentNumber { value, number: Number::from(value as i64) },
            false => SentNumber::from_setting(value),
        }
    }
}

impl Serialize for SentNumber {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.number.serialize(serializer)
    }
}

/// Returns the rejection `wrong_type` for an argument.
pub fn wrong_type_rejection(field: &str, expected: &str) -> Rejection {
    Rejection::for_field(field, "wrong_type", format!("{field} has the wrong type: expected {expected}"))
}

/// The requirement for the numbers in a map, and the rejection of other numbers.
#[derive(Clone, Copy)]
pub struct AmountRule {
    /// Code of the rejection.
    pub code: &'static str,
    /// Text that follows "the value for KEY" in the message.
    pub requirement: &'static str,
    /// Range of allowed numbers.
    pub range: NumberRange,
}

impl AmountRule {
    fn parse(&self, value: &Value, field: &str) -> Result<SentNumber, Rejection> {
        match SentNumber::from_json(value) {
            Some(sent) if self.range.contains(sent.value) => Ok(sent),
            _ => Err(Rejection::for_field(
                field,
                self.code,
                format!("the value for {} {}", last_segment(field), self.requirement),
            )),
        }
    }
}

fn last_segment(field: &str) -> &str {
    field.rsplit('.').next().unwrap_or(field)
}

/// Parses the id of a known group.
pub fn parse_known_group(key: &str, field: &str, view: &ToolContext<'_>) -> Result<Group, Rejection> {
    Group::parse(key).filter(|group| view.is_known(*group)).ok_or_else(|| {
        let known: Vec<&str> = view.known_groups().map(Group::id).collect();
        Rejection::for_field(
            field,
            "unknown_group",
            format!("group {key} is not known; the known groups are {}", known.join(", ")),
        )
    })
}

/// Parses the name of a plan.
pub fn parse_plan(key: &str, field: &str) -> Result<Plan, Rejection> {
    Plan::parse(key).ok_or_else(|| {
        Rejection::for_field(
            field,
            "unknown_plan",
            format!("plan {key} does not exist; the plans are A, B, C"),
        )
    })
}

/// Parses the name of an advertising channel.
pub fn parse_channel(key: &str, field: &str) -> Result<Channel, Rejection> {
    Channel::parse(key).ok_or_else(|| {
        let known = Channel::ALL.map(Channel::id).join(", ");
        Rejection::for_field(
            field,
            "unknown_channel",
            format!("channel {key} does not exist; the channels are {known}"),
        )
    })
}

/// Parses a customer number, without checking that the customer exists.
pub fn parse_customer(key: &str, field: &str) -> Result<i64, Rejection> {
    key.trim().parse().map_err(|_| {
        Rejection::for_field(field, "customer_not_integer", format!("customer id {key} is not an integer"))
    })
}

fn parse_amounts<K: std::hash::Hash + Eq>(
    value: &Value,
    field: &str,
    amount: AmountRule,
    key: impl Fn(&str, &str) -> Result<K, Rejection>,
) -> Result<IndexMap<K, SentNumber>, Rejection> {
    parse_entries(value, field, key, |value, field| amount.parse(value, field))
}

/// Parses a map. All keys are checked before the values.
fn parse_entries<K: std::hash::Hash + Eq, V>(
    value: &Value,
    field: &str,
    key: impl Fn(&str, &str) -> Result<K, Rejection>,
    read: impl Fn(&Value, &str) -> Result<V, Rejection>,
) -> Result<IndexMap<K, V>, Rejection> {
    let object = to_map(value, field)?;
    let path = |name: &String| format!("{field}.{name}");
    let keys: Vec<K> = object.keys().map(|name| key(name, &path(name))).collect::<Result<_, Rejection>>()?;
    let values = object.iter().map(|(name, value)| read(value, &path(name)));
    keys.into_iter().zip(values).map(|(key, value)| Ok((key, value?))).collect()
}

fn to_map<'a>(value: &'a Value, field: &str) -> Result<&'a Map<String, Value>, Rejection> {
    value
        .as_object()
        .ok_or_else(|| Rejection::for_field(field, "not_a_map", format!("{field} must be a map")))
}

fn to_values<K: std::hash::Hash + Eq>(map: IndexMap<K, SentNumber>) -> IndexMap<K, f64> {
    map.into_iter().map(|(key, sent)| (key, sent.value)).collect()
}

/// Parses a map from groups to numbers, and keeps the notation of the numbers.
pub fn parse_sent_per_group(
    value: &Value,
    field: &str,
    amount: AmountRule,
    view: &ToolContext<'_>,
) -> Result<IndexMap<Group, SentNumber>, Rejection> {
    parse_amounts(value, field, amount, |key, field| parse_known_group(key, field, view))
}

/// Parses a map from channels to maps from groups to numbers, and keeps the notation of the numbers.
pub fn parse_sent_per_channel_group(
    value: &Value,
    field: &str,
    amount: AmountRule,
    view: &ToolContext<'_>,
) -> Result<IndexMap<Channel, IndexMap<Group, SentNumber>>, Rejection> {
    parse_entries(value, field, parse_channel, |value, field| {
        parse_sent_per_group(value, field, amount, view)
    })
}

/// Parses a map from groups to numbers.
pub fn parse_per_group(
    value: &Value,
    field: &str,
    amount: AmountRule,
    view: &ToolContext<'_>,
) -> Result<PerGroup, Rejection> {
    parse_sent_per_group(value, field, amount, view).map(to_values)
}

/// Parses a map from plans to numbers.
pub fn parse_per_plan(value: &Value, field: &str, amount: AmountRule) -> Result<PerPlan, Rejection> {
    parse_amounts(value, field, amount, parse_plan).map(to_values)
}

/// Parses a map from channels to numbers.
pub fn parse_per_channel(
    value: &Value,
    field: &str,
    amount: AmountRule,
) -> Result<IndexMap<Channel, f64>, Rejection> {
    parse_amounts(value, field, amount, parse_channel).map(to_values)
}

/// Parses a map from customers to numbers. Key and value of an entry are checked together, because the released
/// simulator does so for this map only.
pub fn parse_per_customer(value: &Value, field: &str, amount: AmountRule) -> Result<PerCustomer, Rejection> {
    let entry = |(name, value): (&String, &Value)| {
        let path = format!("{field}.{name}");
        Ok((parse_customer(name, &path)?, amount.parse(value, &path)?.value))
    };
    to_map(value, field)?.iter().map(entry).collect()
}

/// Parses a map from groups to maps from plans to numbers.
pub fn parse_per_group_plan(
    value: &Value,
    field: &str,
    amount: AmountRule,
    view: &ToolContext<'_>,
) -> Result<IndexMap<Group, PerPlan>, Rejection> {
    let group = |name: &str, field: &str| parse_known_group(name, field, view);
    parse_entries(value, field, group, |value, field| parse_per_plan(value, field, amount))
}

/// Parses a map from channels to maps from groups to numbers.
pub fn parse_per_channel_group(
    value: &Value,
    field: &str,
    amount: AmountRule,
    view: &ToolContext<'_>,
) -> Result<IndexMap<Channel, PerGroup>, Rejection> {
    let matrix = parse_sent_per_channel_group(value, field, amount, view)?;
    Ok(matrix.into_iter().map(|(channel, groups)| (channel, to_values(groups))).collect())
}

/// Serializes whole numbers without a decimal point, for fields that are integers in the released simulator.
///
/// # Errors
/// Returns an error if the serializer fails.
pub(super) fn serialize_whole_as_integer<T: Serialize, S: Serializer>(
    data: &T,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    let value = serde_json::to_value(data).map_err(serde::ser::Error::custom)?;
    normalize_json_numbers(value).serialize(serializer)
}

/// Converts data to JSON in the notation of a tool call.
pub(super) fn to_json(data: &impl Serialize) -> Value {
    serde_json::to_value(data).map_or(Value::Null, normalize_json_numbers)
}
