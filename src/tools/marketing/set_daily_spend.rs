use indexmap::IndexMap;
use serde::Serialize;
use serde_json::{Map, Value};
use strum::{EnumString, IntoStaticStr};

use super::super::arguments::{Arguments, SentNumber, wrong_type_rejection};
use super::super::{
    Argument, ArgumentKind, EffectTiming, NumberRange, PlannedCall, Rejection, ResultField, Tool,
    ToolContext, ToolId, ToolKind, ToolModule, ToolSpec,
};
use novamind_base::formatting::json_number;
use novamind_world::settings::{Settings, SettingsChange};

/// The tool `set_daily_spend`, which sets the daily budgets of operations and development.
pub struct SetDailySpend;

const fn budget_argument(name: &'static str, doc: &'static str) -> Argument {
    let kind = ArgumentKind::Number(NumberRange::AT_LEAST_ZERO);
    Argument { name, alias: None, kind, required: false, unit: "$/day", description: doc }
}

static SPEC: ToolSpec = ToolSpec {
    id: ToolId::SetDailySpend,
    code: "OPS",
    module: ToolModule::Marketing,
    kind: ToolKind::Setting,
    summary: "Set the daily budgets of operations and development",
    arguments: &[
        budget_argument("operations", "fewer outages, and resolved issues of all customers"),
        budget_argument("development", "quality for all groups"),
    ],
    has_own_unknown_code: true,
    unnamed_argument: None,
    effect_timing: EffectTiming::NextDay,
    effect: "Operations reduce outages: the probability of one on a day is {operations.base_outage_prob} \
             exp(-spend / {operations.ops_outage_reduction_scale}), at least {operations.ops_outage_min_prob}, and more \
             often above capacity. They resolve open issues: {issues.issue_resolution_base_rate} per day without spending, plus \
             {issues.individual_ops_scale} per dollar for individuals, {issues.enterprise_ops_scale} for enterprises. \
             Every day, development adds {development.dev_improvement_coef} ln(1 + spend / \
             {development.dev_spend_scale}) to the quality for all groups. The addition is permanent, but it can be smaller \
             than the random change of a day.",
    cost: "both amounts on every simulated day",
    written_tables: &["config_history"],
    rejection_codes: &[
        "nothing_given",
        "unknown_category",
        "advertising_not_here",
        "spend_negative",
        "amount_too_large",
    ],
    result_fields: &[
        ResultField { name: "updated", kind: "map -> number", description: "sent budgets, $/day" },
        ResultField { name: "current", kind: "map -> number", description: "both budgets, $/day" },
    ],
    example: r#"{"operations": 350}"#,
};

/// A daily budget that applies to all customers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, EnumString, IntoStaticStr, Serialize)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum DailyBudget {
    /// Budget that reduces outages and resolves issues.
    Operations,
    /// Budget that raises quality.
    Development,
}

/// Daily budgets that the call set, and all daily budgets in force.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DailySpend {
    /// Budgets that the call set, in dollars per day.
    pub updated: IndexMap<DailyBudget, SentNumber>,
    /// All daily budgets in force.
    pub current: DailyBudgets,
}

/// Daily budgets in force, in dollars per day.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DailyBudgets {
    /// Budget for operations.
    pub operations: SentNumber,
    /// Budget for development.
    pub development: SentNumber,
}

impl Tool for SetDailySpend {
    type Args = IndexMap<DailyBudget, SentNumber>;
    type Answer = DailySpend;

    fn spec(&self) -> &'static ToolSpec {
        &SPEC
    }

    fn current_arguments(&self, settings: &Settings) -> Map<String, Value> {
        Map::from_iter([
            ("operations".to_owned(), json_number(settings.core.operations)),
            ("development".to_owned(), json_number(settings.core.development)),
        ])
    }

    fn parse_arguments(
        &self,
        _: &ToolContext<'_>,
        arguments: &Arguments,
    ) -> Result<IndexMap<DailyBudget, SentNumber>, Rejection> {
        if arguments.is_empty() {
            return Err(Rejection::new(
                "nothing_given",
                "no value was given; give operations, development or both",
            ));
        }
        let unknown = |key: &&String| key.parse::<DailyBudget>().is_err();
        if arguments.get("advertising").is_some() {
            let message = "set advertising per channel and group with set_targeted_ad_spend";
            return Err(Rejection::for_field("advertising", "advertising_not_here", message));
        }
        if let Some(key) = arguments.as_map().keys().find(unknown) {
            let message = format!("category {key} does not exist; use operations or development");
            return Err(Rejection::for_field(key.clone(), "unknown_category", message));
        }
        let entry = |(key, value): (&String, &Value)| {
            let amount = SentNumber::from_json(value).ok_or_else(|| wrong_type_rejection(key, "a number"))?;
            if amount.value < 0.0 {
                return Err(Rejection::for_field(
                    key.clone(),
                    "spend_negative",
                    format!("{key} must not be negative"),
                ));
            }
            Ok(key.parse().ok().map(|budget| (budget, amount)))
        };
        arguments.as_map().iter().filter_map(|given| entry(given).transpose()).collect()
    }

    fn plan(
        &self,
        view: &ToolContext<'_>,
        updated: IndexMap<DailyBudget, SentNumber>,
    ) -> Result<PlannedCall<DailySpend>, Rejection> {
        let mut core = view.settings().core;
        for (budget, sent) in &updated {
            match budget {
                DailyBudget::Operations => core.operations = sent.value,
                DailyBudget::Development => core.development = sent.value,
            }
        }
        let current = |budget: DailyBudget, stored: f64| {
            updated.get(&budget).cloned().unwrap_or_else(|| SentNumber::from_setting(stored))
        };
        let current = DailyBudgets {
            operations: current(DailyBudget::Operations, core.operations),
            development: current(DailyBudget::Development, core.development),
        };
        Ok(PlannedCall::with_settings_change(SettingsChange::Core(core), DailySpend { updated, current }))
    }
}
