use indexmap::IndexMap;
use serde::Serialize;
use serde_json::{Map, Value, json};

use super::super::arguments::{Arguments, SentNumber, parse_sent_per_group, to_json};
use super::super::marketing::BUDGET_RULE;
use super::super::{
    Argument, ArgumentKind, EffectTiming, MapKey, NumberRange, PlannedCall, Rejection, ResultField, Tool,
    ToolContext, ToolId, ToolKind, ToolModule, ToolSpec,
};
use novamind_world::identifiers::Group;
use novamind_world::settings::{PerGroup, Settings, SettingsChange, TargetedDevelopment};

/// The tool `set_targeted_dev_spend`, which sets the development budgets of single groups.
pub struct SetTargetedDevSpend;

static SPEC: ToolSpec = ToolSpec {
    id: ToolId::SetTargetedDevSpend,
    code: "DEV",
    module: ToolModule::Analytics,
    kind: ToolKind::Setting,
    summary: "Set development budgets of single groups; replaces the whole map",
    arguments: &[Argument {
        name: "targeted_spend",
        alias: None,
        kind: ArgumentKind::Map(MapKey::Group, NumberRange::AT_LEAST_ZERO),
        required: true,
        unit: "$/day",
        description: "budget by group; {} clears it",
    }],
    has_own_unknown_code: false,
    unnamed_argument: Some("targeted_spend"),
    effect_timing: EffectTiming::NextDay,
    effect: "Permanently raises the quality for the group by {development.targeted_dev_improvement_coef} ln(1 + spend / \
             {development.targeted_dev_spend_scale}) per day.",
    cost: "the sum of the map on every simulated day",
    written_tables: &["config_overrides"],
    rejection_codes: &["not_a_map", "unknown_group", "amount_invalid", "amount_too_large"],
    result_fields: &[
        ResultField { name: "targeted_spend", kind: "map group -> number", description: "$/day" },
        ResultField { name: "total_extra_per_day", kind: "number", description: "sum of the map, $/day" },
    ],
    example: r#"{"targeted_spend": {"S1": 2500, "E3": 400}}"#,
};

/// Targeted development budgets in force after the call.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DevelopmentBudgets {
    /// Budgets in dollars per day, by group.
    pub targeted_spend: IndexMap<Group, SentNumber>,
    /// Sum of the budgets, in dollars per day.
    pub total_extra_per_day: SentNumber,
}

impl Tool for SetTargetedDevSpend {
    type Args = IndexMap<Group, SentNumber>;
    type Answer = DevelopmentBudgets;

    fn spec(&self) -> &'static ToolSpec {
        &SPEC
    }

    fn current_arguments(&self, settings: &Settings) -> Map<String, Value> {
        Map::from_iter([(
            "targeted_spend".to_owned(),
            to_json(&settings.targeted_development.targeted_spend),
        )])
    }

    fn parse_arguments(
        &self,
        view: &ToolContext<'_>,
        arguments: &Arguments,
    ) -> Result<IndexMap<Group, SentNumber>, Rejection> {
        let given = arguments.get("targeted_spend").unwrap_or(&Value::Null);
        parse_sent_per_group(given, "targeted_spend", BUDGET_RULE, view)
    }

    fn plan(
        &self,
        _: &ToolContext<'_>,
        sent: IndexMap<Group, SentNumber>,
    ) -> Result<PlannedCall<DevelopmentBudgets>, Rejection> {
        let row = json!({ "targeted_spend": sent });
        let targeted_spend: PerGroup = sent.iter().map(|(group, sent)| (*group, sent.value)).collect();
        let development = TargetedDevelopment { targeted_spend };
        let total_extra_per_day = SentNumber::sum(development.total(), sent.values());
        let answer = DevelopmentBudgets { targeted_spend: sent, total_extra_per_day };
        Ok(PlannedCall::with_settings_change(SettingsChange::TargetedDevelopment(development), answer)
            .with_settings_row(row))
    }
}
