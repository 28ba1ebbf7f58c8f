use serde_json::{Map, Value, json};

use super::super::arguments::{Arguments, amount_as_sent, per_channel_group};
use super::super::as_data;
use super::super::{
    Argument, ArgumentKind, Key, Kind, Module, Output, Range, Refusal, Spec, Tool, ToolId, View, When,
};
use super::BUDGET;
use crate::notation::json_number;
use crate::world::command::{Command, ResolvedCommand};
use crate::world::identifiers::{Channel, Group};
use crate::world::settings::SettingsChange;
use crate::world::settings::{PerGroup, Settings, TargetedAds};

/// Sets the advertising budgets.
pub struct SetTargetedAdSpend;

static SPEC: Spec = Spec {
    id: ToolId::SetTargetedAdSpend,
    code: "ADS",
    module: Module::Marketing,
    kind: Kind::Setting,
    summary: "Set the advertising budget per channel and group; replaces the whole matrix",
    arguments: &[Argument {
        name: "targeted_spend",
        alias: None,
        kind: ArgumentKind::Matrix(Key::Channel, Key::Group, Range::AT_LEAST_ZERO),
        required: true,
        unit: "$/day",
        doc: "budget by channel, then group; pairs left out get nothing",
    }],
    own_unknown: false,
    whole: Some("targeted_spend"),
    when: When::NextDay,
    effect: "Brings leads of the group from the next day; how many a channel brings differs by group and changes \
             every month. ad_channel_leads counts them per pair.",
    cost: "the sum of the matrix on every simulated day, and {leads.lead_acquisition_cost:$} for every lead",
    writes: &["config_overrides"],
    refusals: &[
        "unknown_channel",
        "nesting_inverted",
        "not_a_map",
        "unknown_group",
        "amount_invalid",
        "amount_too_large",
    ],
    returns: &[
        Output { name: "targeted_spend", kind: "map channel -> map group -> number", doc: "$/day" },
        Output { name: "total_per_day", kind: "number", doc: "sum of the matrix, $/day" },
    ],
    example: r#"{"targeted_spend": {"linkedin": {"E1": 120}, "search_ads": {"S1": 80, "S3": 40}}}"#,
};

/// Turns a map of groups to channels around; inner values that are no maps vanish.
fn transposed(map: &Map<String, Value>) -> Map<String, Value> {
    let mut turned = Map::new();
    for (group, channels) in map {
        for (channel, amount) in channels.as_object().into_iter().flatten() {
            let groups = turned.entry(channel.clone()).or_insert_with(|| Value::Object(Map::new()));
            if let Value::Object(groups) = groups {
                groups.insert(group.clone(), amount.clone());
            }
        }
    }
    turned
}

/// The matrix with channels outside, whichever way it was given.
fn upright(given: &Value, view: &View<'_>) -> Result<Value, Refusal> {
    let Some(map) = given.as_object() else { return Ok(given.clone()) };
    let stray = |map: &Map<String, Value>| map.keys().find(|key| Channel::parse(key).is_none()).cloned();
    let Some(first) = stray(map) else { return Ok(given.clone()) };
    let is_group = |key: &String| Group::parse(key).is_some_and(|group| view.knows(group));
    if !map.keys().any(is_group) {
        return Err(super::super::arguments::channel(&first, &format!("targeted_spend.{first}"))
            .expect_err("no channel"));
    }
    let turned = transposed(map);
    match stray(&turned) {
        Some(key) => {
            let message = "the order is channel, then group";
            Err(Refusal::at(format!("targeted_spend.{key}"), "nesting_inverted", message))
        }
        None => Ok(Value::Object(turned)),
    }
}

impl Tool for SetTargetedAdSpend {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn current(&self, settings: &Settings) -> Map<String, Value> {
        Map::from_iter([("targeted_spend".to_owned(), as_data(&settings.targeted_ads.targeted_spend))])
    }

    fn plan(&self, view: &View<'_>, arguments: &Arguments) -> Result<Command, Refusal> {
        let given = arguments.get("targeted_spend").unwrap_or(&Value::Null);
        let matrix = upright(given, view)?;
        let targeted_spend = per_channel_group(&matrix, "targeted_spend", BUDGET, view)?;
        Ok(Command::Set(SettingsChange::TargetedAds(TargetedAds { targeted_spend })))
    }

    fn row(&self, arguments: &Arguments, resolved: &ResolvedCommand) -> Option<Value> {
        let ResolvedCommand::Set(SettingsChange::TargetedAds(ads)) = resolved else { return None };
        let given = arguments.get("targeted_spend");
        let sent = |channel: Channel, group: Group| {
            let (channel, group) = (channel.id(), group.id());
            let in_order = |outer: &str, inner: &str| given?.get(outer)?.get(inner);
            in_order(channel, group).or_else(|| in_order(group, channel))
        };
        let groups = |channel: Channel, groups: &PerGroup| -> Value {
            let amount = |(group, amount): (&Group, &f64)| {
                (group.id().to_owned(), amount_as_sent(*amount, sent(channel, *group)))
            };
            Value::Object(groups.iter().map(amount).collect())
        };
        let matrix = ads.targeted_spend.iter();
        let matrix: Map<String, Value> =
            matrix.map(|(channel, own)| (channel.id().to_owned(), groups(*channel, own))).collect();
        Some(json!({ "targeted_spend": matrix }))
    }

    fn answer(&self, _: &View<'_>, _: &Arguments, resolved: &ResolvedCommand) -> Value {
        match resolved {
            ResolvedCommand::Set(SettingsChange::TargetedAds(ads)) => json!({
                "targeted_spend": as_data(&ads.targeted_spend),
                "total_per_day": json_number(ads.total()),
            }),
            _ => Value::Null,
        }
    }
}
