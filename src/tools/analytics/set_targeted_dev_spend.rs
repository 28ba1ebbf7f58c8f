use serde_json::{Map, Value, json};

use super::super::arguments::{Arguments, amount_as_sent, per_group};
use super::super::as_data;
use super::super::marketing::BUDGET;
use super::super::{
    Argument, ArgumentKind, Key, Kind, Module, Output, Range, Refusal, Spec, Tool, ToolId, View, When,
};
use crate::notation::json_number;
use crate::world::command::{Command, ResolvedCommand};
use crate::world::identifiers::Group;
use crate::world::settings::SettingsChange;
use crate::world::settings::{Settings, TargetedDevelopment};

/// Aims development.
pub struct SetTargetedDevSpend;

static SPEC: Spec = Spec {
    id: ToolId::SetTargetedDevSpend,
    code: "DEV",
    module: Module::Analytics,
    kind: Kind::Setting,
    summary: "Set development budgets for single groups; replaces the whole map",
    arguments: &[Argument {
        name: "targeted_spend",
        alias: None,
        kind: ArgumentKind::Map(Key::Group, Range::AT_LEAST_ZERO),
        required: true,
        unit: "$/day",
        doc: "budget by group; {} clears it",
    }],
    own_unknown: false,
    whole: Some("targeted_spend"),
    when: When::NextDay,
    effect: "Raises the quality the group gets by {development.targeted_dev_improvement_coef} ln(1 + spend / \
             {development.targeted_dev_spend_scale}) a day, for good.",
    cost: "the sum of the map on every simulated day",
    writes: &["config_overrides"],
    refusals: &["not_a_map", "unknown_group", "amount_invalid", "amount_too_large"],
    returns: &[
        Output { name: "targeted_spend", kind: "map group -> number", doc: "$/day" },
        Output { name: "total_extra_per_day", kind: "number", doc: "sum of the map, $/day" },
    ],
    example: r#"{"targeted_spend": {"S1": 2500, "E3": 400}}"#,
};

impl Tool for SetTargetedDevSpend {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn current(&self, settings: &Settings) -> Map<String, Value> {
        Map::from_iter([(
            "targeted_spend".to_owned(),
            as_data(&settings.targeted_development.targeted_spend),
        )])
    }

    fn plan(&self, view: &View<'_>, arguments: &Arguments) -> Result<Command, Refusal> {
        let given = arguments.get("targeted_spend").unwrap_or(&Value::Null);
        let targeted_spend = per_group(given, "targeted_spend", BUDGET, view)?;
        Ok(Command::Set(SettingsChange::TargetedDevelopment(TargetedDevelopment { targeted_spend })))
    }

    fn row(&self, arguments: &Arguments, resolved: &ResolvedCommand) -> Option<Value> {
        let ResolvedCommand::Set(SettingsChange::TargetedDevelopment(development)) = resolved else {
            return None;
        };
        let sent = |group: &Group| arguments.get("targeted_spend").and_then(|map| map.get(group.id()));
        let amount =
            |(group, amount): (&Group, &f64)| (group.id().to_owned(), amount_as_sent(*amount, sent(group)));
        let amounts: Map<String, Value> = development.targeted_spend.iter().map(amount).collect();
        Some(json!({ "targeted_spend": amounts }))
    }

    fn answer(&self, _: &View<'_>, _: &Arguments, resolved: &ResolvedCommand) -> Value {
        match resolved {
            ResolvedCommand::Set(SettingsChange::TargetedDevelopment(development)) => json!({
                "targeted_spend": as_data(&development.targeted_spend),
                "total_extra_per_day": json_number(development.total()),
            }),
            _ => Value::Null,
        }
    }
}
