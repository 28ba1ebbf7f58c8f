use indexmap::IndexMap;
use serde::Serialize;
use serde_json::{Map, Value};
use strum::{EnumString, IntoStaticStr};

use super::super::arguments::{Arguments, Sent, wrong_type};
use super::super::{
    Argument, ArgumentKind, Kind, Module, Output, Planned, Range, Refusal, Spec, Tool, ToolId, View, When,
};
use novamind_base::notation::json_number;
use novamind_world::settings::{Settings, SettingsChange};

/// The tool `set_daily_spend`.
pub struct SetDailySpend;

const fn budget(name: &'static str, doc: &'static str) -> Argument {
    let kind = ArgumentKind::Number(Range::AT_LEAST_ZERO);
    Argument { name, alias: None, kind, required: false, unit: "$/day", doc }
}

static SPEC: Spec = Spec {
    id: ToolId::SetDailySpend,
    code: "OPS",
    module: Module::Marketing,
    kind: Kind::Setting,
    summary: "Set the daily budgets of operations and development",
    arguments: &[
        budget("operations", "fewer outages, and resolved issues of all customers"),
        budget("development", "quality for all groups"),
    ],
    own_unknown: true,
    whole: None,
    when: When::NextDay,
    effect: "Operations reduce outages: the probability of one on a day is {operations.base_outage_prob} \
             exp(-spend / {operations.ops_outage_reduction_scale}), at least {operations.ops_outage_min_prob}, and more \
             often above capacity. They resolve open issues: {issues.issue_resolution_base_rate} per day without spending, plus \
             {issues.individual_ops_scale} per dollar for individuals, {issues.enterprise_ops_scale} for enterprises. \
             Development permanently raises the quality for all groups every day, by \
             {development.dev_improvement_coef} ln(1 + spend / {development.dev_spend_scale}).",
    cost: "both amounts on every simulated day",
    writes: &["config_history"],
    refusals: &[
        "nothing_given",
        "unknown_category",
        "advertising_not_here",
        "spend_negative",
        "amount_too_large",
    ],
    returns: &[
        Output { name: "updated", kind: "map -> number", doc: "sent budgets, $/day" },
        Output { name: "current", kind: "map -> number", doc: "both budgets, $/day" },
    ],
    example: r#"{"operations": 350}"#,
};

/// A general daily budget.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, EnumString, IntoStaticStr, Serialize)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum DailyBudget {
    /// Budget against outages and issues.
    Operations,
    /// Budget for quality.
    Development,
}

/// Sent budgets and budgets in force.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DailySpend {
    /// Sent budgets, dollars per day.
    pub updated: IndexMap<DailyBudget, Sent>,
    /// Budgets in force.
    pub current: DailyBudgets,
}

/// Budgets in force, dollars per day.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DailyBudgets {
    /// Operations.
    pub operations: Sent,
    /// Development.
    pub development: Sent,
}

impl Tool for SetDailySpend {
    type Args = IndexMap<DailyBudget, Sent>;
    type Answer = DailySpend;

    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn current(&self, settings: &Settings) -> Map<String, Value> {
        Map::from_iter([
            ("operations".to_owned(), json_number(settings.core.operations)),
            ("development".to_owned(), json_number(settings.core.development)),
        ])
    }

    fn read(&self, _: &View<'_>, arguments: &Arguments) -> Result<IndexMap<DailyBudget, Sent>, Refusal> {
        if arguments.is_empty() {
            return Err(Refusal::new(
                "nothing_given",
                "no value was given; give operations, development or both",
            ));
        }
        let unknown = |key: &&String| key.parse::<DailyBudget>().is_err();
        if arguments.get("advertising").is_some() {
            let message = "set advertising per channel and group with set_targeted_ad_spend";
            return Err(Refusal::at("advertising", "advertising_not_here", message));
        }
        if let Some(key) = arguments.as_map().keys().find(unknown) {
            let message = format!("category {key} does not exist; use operations or development");
            return Err(Refusal::at(key.clone(), "unknown_category", message));
        }
        let entry = |(key, value): (&String, &Value)| {
            let amount = Sent::of(value).ok_or_else(|| wrong_type(key, "a number"))?;
            if amount.value < 0.0 {
                return Err(Refusal::at(
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
        view: &View<'_>,
        updated: IndexMap<DailyBudget, Sent>,
    ) -> Result<Planned<DailySpend>, Refusal> {
        let mut core = view.settings().core;
        for (budget, sent) in &updated {
            match budget {
                DailyBudget::Operations => core.operations = sent.value,
                DailyBudget::Development => core.development = sent.value,
            }
        }
        let current = |budget: DailyBudget, stored: f64| {
            updated.get(&budget).cloned().unwrap_or_else(|| Sent::stored(stored))
        };
        let current = DailyBudgets {
            operations: current(DailyBudget::Operations, core.operations),
            development: current(DailyBudget::Development, core.development),
        };
        Ok(Planned::setting(SettingsChange::Core(core), DailySpend { updated, current }))
    }
}
