use indexmap::IndexMap;
use serde::Serialize;
use serde_json::{Map, Value, json};

use super::super::arguments::{Arguments, Sent, as_data, sent_per_group};
use super::super::marketing::BUDGET;
use super::super::{
    Argument, ArgumentKind, Key, Kind, Module, Output, Planned, Range, Refusal, Spec, Tool, ToolId, View,
    When,
};
use novamind_world::identifiers::Group;
use novamind_world::settings::{PerGroup, Settings, SettingsChange, TargetedDevelopment};

/// The tool `set_targeted_dev_spend`.
pub struct SetTargetedDevSpend;

static SPEC: Spec = Spec {
    id: ToolId::SetTargetedDevSpend,
    code: "DEV",
    module: Module::Analytics,
    kind: Kind::Setting,
    summary: "Set development budgets of single groups; replaces the whole map",
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
    effect: "Permanently raises the quality for the group by {development.targeted_dev_improvement_coef} ln(1 + spend / \
             {development.targeted_dev_spend_scale}) per day.",
    cost: "the sum of the map on every simulated day",
    writes: &["config_overrides"],
    refusals: &["not_a_map", "unknown_group", "amount_invalid", "amount_too_large"],
    returns: &[
        Output { name: "targeted_spend", kind: "map group -> number", doc: "$/day" },
        Output { name: "total_extra_per_day", kind: "number", doc: "sum of the map, $/day" },
    ],
    example: r#"{"targeted_spend": {"S1": 2500, "E3": 400}}"#,
};

/// Budgets in force.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DevelopmentBudgets {
    /// Dollars per day by group.
    pub targeted_spend: IndexMap<Group, Sent>,
    /// Their sum, dollars per day.
    pub total_extra_per_day: Sent,
}

impl Tool for SetTargetedDevSpend {
    type Args = IndexMap<Group, Sent>;
    type Answer = DevelopmentBudgets;

    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn current(&self, settings: &Settings) -> Map<String, Value> {
        Map::from_iter([(
            "targeted_spend".to_owned(),
            as_data(&settings.targeted_development.targeted_spend),
        )])
    }

    fn read(&self, view: &View<'_>, arguments: &Arguments) -> Result<IndexMap<Group, Sent>, Refusal> {
        let given = arguments.get("targeted_spend").unwrap_or(&Value::Null);
        sent_per_group(given, "targeted_spend", BUDGET, view)
    }

    fn plan(
        &self,
        _: &View<'_>,
        sent: IndexMap<Group, Sent>,
    ) -> Result<Planned<DevelopmentBudgets>, Refusal> {
        let row = json!({ "targeted_spend": sent });
        let targeted_spend: PerGroup = sent.iter().map(|(group, sent)| (*group, sent.value)).collect();
        let development = TargetedDevelopment { targeted_spend };
        let total_extra_per_day = Sent::sum(development.total(), sent.values());
        let answer = DevelopmentBudgets { targeted_spend: sent, total_extra_per_day };
        Ok(Planned::setting(SettingsChange::TargetedDevelopment(development), answer).with_row(row))
    }
}
