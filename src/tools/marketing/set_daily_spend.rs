use serde_json::{Map, Value, json};

use super::super::arguments::{Arguments, number, wrong_type};
use super::super::pricing::core_of;
use super::super::{
    Argument, ArgumentKind, Kind, Module, Output, Range, Refusal, Spec, Tool, ToolId, View, When,
};
use crate::notation::{json_number, plain_numbers};
use crate::world::command::{Command, ResolvedCommand};
use crate::world::settings::SettingsChange;
use crate::world::settings::{CoreSettings, Settings};

/// Sets the general daily budgets.
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
        budget("operations", "fewer outages, and support issues solved for everybody"),
        budget("development", "quality for every group"),
    ],
    own_unknown: true,
    whole: None,
    when: When::NextDay,
    effect: "Operations make outages rarer: a day has one with a probability of {operations.base_outage_prob} \
             exp(-spend / {operations.ops_outage_reduction_scale}), at least {operations.ops_outage_min_prob}, and more \
             often above capacity. They solve open issues: {issues.issue_resolution_base_rate} a day without spending, \
             {issues.individual_ops_scale} more per dollar for individuals, {issues.enterprise_ops_scale} for companies. \
             Development raises the quality all groups get, day by day and for good, by \
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
        Output { name: "updated", kind: "map -> number", doc: "what was sent, $/day" },
        Output { name: "current", kind: "map -> number", doc: "both budgets, $/day" },
    ],
    example: r#"{"operations": 350}"#,
};

fn budgets(core: &CoreSettings) -> Map<String, Value> {
    Map::from_iter([
        ("operations".to_owned(), json_number(core.operations)),
        ("development".to_owned(), json_number(core.development)),
    ])
}

impl Tool for SetDailySpend {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn current(&self, settings: &Settings) -> Map<String, Value> {
        budgets(&settings.core)
    }

    fn plan(&self, view: &View<'_>, arguments: &Arguments) -> Result<Command, Refusal> {
        if arguments.is_empty() {
            return Err(Refusal::new(
                "nothing_given",
                "no value was given; give operations, development or both",
            ));
        }
        let unknown: Vec<&String> = arguments
            .as_map()
            .keys()
            .filter(|key| !["operations", "development"].contains(&key.as_str()))
            .collect();
        if unknown.iter().any(|key| *key == "advertising") {
            let message = "set advertising per channel and group with set_targeted_ad_spend";
            return Err(Refusal::at("advertising", "advertising_not_here", message));
        }
        if let Some(key) = unknown.first() {
            let message = format!("category {key} does not exist; use operations or development");
            return Err(Refusal::at((*key).clone(), "unknown_category", message));
        }
        let mut core = view.settings().core;
        for (key, value) in arguments.as_map() {
            let amount = number(value).ok_or_else(|| wrong_type(key, "a number"))?;
            if amount < 0.0 {
                return Err(Refusal::at(
                    key.clone(),
                    "spend_negative",
                    format!("{key} must not be negative"),
                ));
            }
            if key == "operations" { core.operations = amount } else { core.development = amount }
        }
        Ok(Command::Set(SettingsChange::Core(core)))
    }

    fn answer(&self, view: &View<'_>, arguments: &Arguments, resolved: &ResolvedCommand) -> Value {
        let core = core_of(resolved, &view.settings().core);
        json!({
            "updated": plain_numbers(Value::Object(arguments.as_map().clone())),
            "current": budgets(core),
        })
    }
}
