use serde_json::{Map, Value};

use super::super::arguments::{Arguments, per_customer, per_group, per_group_plan, per_plan};
use super::super::as_data;
use super::super::marketing::BUDGET;
use super::super::{
    Argument, ArgumentKind, Key, Kind, Module, Output, Range, Refusal, Spec, Tool, ToolId, View, When,
};
use crate::notation::json_number;
use crate::world::command::{Command, ResolvedCommand};
use crate::world::settings::Settings;
use crate::world::settings::SettingsChange;

/// Aims support budgets.
pub struct SetTargetedOpsSpend;

const fn scope(
    name: &'static str,
    alias: Option<&'static str>,
    kind: ArgumentKind,
    doc: &'static str,
) -> Argument {
    Argument { name, alias, kind, required: false, unit: "$/day", doc }
}

static SPEC: Spec = Spec {
    id: ToolId::SetTargetedOpsSpend,
    code: "TOPS",
    module: Module::Analytics,
    kind: Kind::Setting,
    summary: "Aim extra support budgets at groups, plans or customers",
    arguments: &[
        scope(
            "by_group",
            Some("targeted_spend"),
            ArgumentKind::Map(Key::Group, Range::AT_LEAST_ZERO),
            "issues of a group",
        ),
        scope("by_plan", None, ArgumentKind::Map(Key::Plan, Range::AT_LEAST_ZERO), "issues on a plan"),
        scope(
            "by_group_plan",
            None,
            ArgumentKind::Matrix(Key::Group, Key::Plan, Range::AT_LEAST_ZERO),
            "issues of a group on a plan",
        ),
        scope(
            "by_customer",
            None,
            ArgumentKind::Map(Key::Customer, Range::AT_LEAST_ZERO),
            "the issue of one customer",
        ),
    ],
    own_unknown: false,
    whole: Some("targeted_spend"),
    when: When::NextDay,
    effect: "Every entry solves open issues of its own after the general pool has: about \
             {issues.individual_ops_scale} a day per dollar for individuals, {issues.enterprise_ops_scale} \
             for companies. It does not touch outages. A map replaces its whole scope, {} clears it, and a \
             scope left out stays as it is.",
    cost: "the sum of all entries on every simulated day, whether or not anybody has an issue",
    writes: &["config_overrides"],
    refusals: &[
        "both_aliases",
        "not_a_map",
        "unknown_group",
        "unknown_plan",
        "amount_invalid",
        "customer_not_integer",
        "amount_too_large",
    ],
    returns: &[
        Output { name: "by_group", kind: "map group -> number", doc: "$/day" },
        Output { name: "by_plan", kind: "map plan -> number", doc: "$/day" },
        Output { name: "by_group_plan", kind: "map group -> map plan -> number", doc: "$/day" },
        Output { name: "by_customer", kind: "map customer -> number", doc: "$/day" },
        Output { name: "total_extra_per_day", kind: "number", doc: "sum of all scopes, $/day" },
        Output { name: "targeted_spend", kind: "map group -> number", doc: "the same as by_group" },
    ],
    example: r#"{"by_group": {"E2": 90}}"#,
};

impl Tool for SetTargetedOpsSpend {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn current(&self, settings: &Settings) -> Map<String, Value> {
        match as_data(&settings.targeted_operations) {
            Value::Object(map) => map,
            _ => Map::new(),
        }
    }

    fn plan(&self, view: &View<'_>, arguments: &Arguments) -> Result<Command, Refusal> {
        let mut operations = view.settings().targeted_operations.clone();
        let by_group = match (arguments.get("by_group"), arguments.get("targeted_spend")) {
            (Some(_), Some(_)) => {
                let message = "give targeted_spend or by_group, not both";
                return Err(Refusal::at("targeted_spend", "both_aliases", message));
            }
            (Some(value), None) => Some(("by_group", value)),
            (None, value) => value.map(|value| ("targeted_spend", value)),
        };
        if let Some((field, value)) = by_group {
            operations.by_group = per_group(value, field, BUDGET, view)?;
        }
        if let Some(value) = arguments.get("by_plan") {
            operations.by_plan = per_plan(value, "by_plan", BUDGET)?;
        }
        if let Some(value) = arguments.get("by_group_plan") {
            operations.by_group_plan = per_group_plan(value, "by_group_plan", BUDGET, view)?;
        }
        if let Some(value) = arguments.get("by_customer") {
            operations.by_customer = per_customer(value, "by_customer", BUDGET)?;
        }
        Ok(Command::Set(SettingsChange::TargetedOperations(operations)))
    }

    fn answer(&self, _: &View<'_>, _: &Arguments, resolved: &ResolvedCommand) -> Value {
        let ResolvedCommand::Set(SettingsChange::TargetedOperations(operations)) = resolved else {
            return Value::Null;
        };
        let mut data = as_data(operations);
        if let Value::Object(map) = &mut data {
            map.insert("total_extra_per_day".to_owned(), json_number(operations.total()));
            map.insert("targeted_spend".to_owned(), as_data(&operations.by_group));
        }
        data
    }
}
