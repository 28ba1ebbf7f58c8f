use std::borrow::Cow;

use indexmap::IndexMap;
use serde::Serialize;
use serde_json::{Map, Value, json};

use super::super::arguments::{Arguments, SentNumber, parse_channel, parse_sent_per_channel_group, to_json};
use super::super::{
    Argument, ArgumentKind, EffectTiming, MapKey, NumberRange, PlannedCall, Rejection, ResultField, Tool,
    ToolContext, ToolId, ToolKind, ToolModule, ToolSpec,
};
use super::BUDGET_RULE;
use novamind_world::identifiers::{Channel, Group};
use novamind_world::settings::{PerGroup, Settings, SettingsChange, TargetedAds};

/// The tool `set_targeted_ad_spend`, which sets the advertising budgets by channel and group.
pub struct SetTargetedAdSpend;

static SPEC: ToolSpec = ToolSpec {
    id: ToolId::SetTargetedAdSpend,
    code: "ADS",
    module: ToolModule::Marketing,
    kind: ToolKind::Setting,
    summary: "Set the advertising budget per channel and group; replaces the whole matrix",
    arguments: &[Argument {
        name: "targeted_spend",
        alias: None,
        kind: ArgumentKind::Matrix(MapKey::Channel, MapKey::Group, NumberRange::AT_LEAST_ZERO),
        required: true,
        unit: "$/day",
        description: "budget by channel (social_media, search_ads, linkedin, content_marketing, referral_program), then \
                  group; other pairs get no budget",
    }],
    has_own_unknown_code: false,
    unnamed_argument: Some("targeted_spend"),
    effect_timing: EffectTiming::NextDay,
    effect: "Brings leads of the group from the next day. The number of leads per channel differs by group and changes \
             every month. ad_channel_leads counts them per pair.",
    cost: "the sum of the matrix on every simulated day, and {leads.lead_acquisition_cost:$} for every lead",
    written_tables: &["config_overrides"],
    rejection_codes: &[
        "unknown_channel",
        "nesting_inverted",
        "not_a_map",
        "unknown_group",
        "amount_invalid",
        "amount_too_large",
    ],
    result_fields: &[
        ResultField {
            name: "targeted_spend",
            kind: "map channel -> map group -> number",
            description: "$/day",
        },
        ResultField { name: "total_per_day", kind: "number", description: "sum of the matrix, $/day" },
    ],
    example: r#"{"targeted_spend": {"linkedin": {"E1": 120}, "search_ads": {"S1": 80, "S3": 40}}}"#,
};

/// Advertising budgets in force after the call.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AdBudgets {
    /// Budgets in dollars per day, by channel and group.
    pub targeted_spend: IndexMap<Channel, IndexMap<Group, SentNumber>>,
    /// Sum of the budgets, in dollars per day.
    pub total_per_day: SentNumber,
}

/// Transposes a map by group and channel to a map by channel and group. Drops inner values that are not maps.
fn transpose(map: &Map<String, Value>) -> Map<String, Value> {
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

/// Returns the matrix with channels as outer keys, for both accepted orders.
fn channels_as_outer_keys<'a>(given: &'a Value, view: &ToolContext<'_>) -> Result<Cow<'a, Value>, Rejection> {
    let Some(map) = given.as_object() else { return Ok(Cow::Borrowed(given)) };
    let first_non_channel =
        |map: &Map<String, Value>| map.keys().find(|key| Channel::parse(key).is_none()).cloned();
    let Some(first) = first_non_channel(map) else { return Ok(Cow::Borrowed(given)) };
    let is_group = |key: &String| Group::parse(key).is_some_and(|group| view.is_known(group));
    if !map.keys().any(is_group) {
        parse_channel(&first, &format!("targeted_spend.{first}"))?;
    }
    let turned = transpose(map);
    match first_non_channel(&turned) {
        Some(key) => {
            let message = "the order is channel, then group";
            Err(Rejection::for_field(format!("targeted_spend.{key}"), "nesting_inverted", message))
        }
        None => Ok(Cow::Owned(Value::Object(turned))),
    }
}

impl Tool for SetTargetedAdSpend {
    type Args = IndexMap<Channel, IndexMap<Group, SentNumber>>;
    type Answer = AdBudgets;

    fn spec(&self) -> &'static ToolSpec {
        &SPEC
    }

    fn current_arguments(&self, settings: &Settings) -> Map<String, Value> {
        Map::from_iter([("targeted_spend".to_owned(), to_json(&settings.targeted_ads.targeted_spend))])
    }

    fn parse_arguments(
        &self,
        view: &ToolContext<'_>,
        arguments: &Arguments,
    ) -> Result<Self::Args, Rejection> {
        let given = arguments.get("targeted_spend").unwrap_or(&Value::Null);
        parse_sent_per_channel_group(
            &*channels_as_outer_keys(given, view)?,
            "targeted_spend",
            BUDGET_RULE,
            view,
        )
    }

    fn plan(&self, _: &ToolContext<'_>, sent: Self::Args) -> Result<PlannedCall<AdBudgets>, Rejection> {
        let row = json!({ "targeted_spend": sent });
        let amounts = |groups: &IndexMap<Group, SentNumber>| -> PerGroup {
            groups.iter().map(|(group, sent)| (*group, sent.value)).collect()
        };
        let ads = TargetedAds {
            targeted_spend: sent.iter().map(|(channel, groups)| (*channel, amounts(groups))).collect(),
        };
        let total_per_day = SentNumber::sum(ads.total(), sent.values().flat_map(IndexMap::values));
        let answer = AdBudgets { targeted_spend: sent, total_per_day };
        Ok(PlannedCall::with_settings_change(SettingsChange::TargetedAds(ads), answer).with_settings_row(row))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn argument_description_names_every_channel() {
        let channels = Channel::ALL.map(|channel| channel.id()).join(", ");
        assert!(SPEC.arguments[0].description.contains(&format!("({channels})")), "{channels}");
    }
}
