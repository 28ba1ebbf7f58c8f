use indexmap::IndexMap;
use serde::Serialize;
use serde_json::{Map, Value};

use super::super::arguments::{
    Arguments, as_data, per_customer, per_group, per_group_plan, per_plan, replace,
};
use super::super::marketing::BUDGET;
use super::super::{
    Argument, ArgumentKind, Key, Kind, Module, Output, Planned, Range, Refusal, Spec, Tool, ToolId, View,
    When,
};
use novamind_world::identifiers::Group;
use novamind_world::settings::{PerCustomer, PerGroup, PerPlan, Settings, SettingsChange};

/// The tool `set_targeted_ops_spend`.
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
    summary: "Set extra support budgets for groups, plans or customers",
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
    effect: "Every entry resolves open issues of its scope after the general budget: about \
             {issues.individual_ops_scale} per day and dollar for individuals, {issues.enterprise_ops_scale} \
             for enterprises. It does not affect outages. A map replaces its whole scope, {} clears it, and a \
             scope that is left out does not change.",
    cost: "the sum of all entries on every simulated day, even without open issues",
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

/// Scopes that a call sets; the others do not change.
pub struct SupportScopes {
    by_group: Option<PerGroup>,
    by_plan: Option<PerPlan>,
    by_group_plan: Option<IndexMap<Group, PerPlan>>,
    by_customer: Option<PerCustomer>,
}

/// Budgets in force, dollars per day.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SupportBudgets {
    /// By group.
    pub by_group: PerGroup,
    /// By plan.
    pub by_plan: PerPlan,
    /// By group and plan.
    pub by_group_plan: IndexMap<Group, PerPlan>,
    /// By customer.
    pub by_customer: PerCustomer,
    /// Sum of all scopes.
    pub total_extra_per_day: f64,
    /// By group, under the name of the argument.
    pub targeted_spend: PerGroup,
}

impl Tool for SetTargetedOpsSpend {
    type Args = SupportScopes;
    type Answer = SupportBudgets;

    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn current(&self, settings: &Settings) -> Map<String, Value> {
        match as_data(&settings.targeted_operations) {
            Value::Object(map) => map,
            _ => Map::new(),
        }
    }

    fn read(&self, view: &View<'_>, arguments: &Arguments) -> Result<SupportScopes, Refusal> {
        let field = match (arguments.get("by_group"), arguments.get("targeted_spend")) {
            (Some(_), Some(_)) => {
                let message = "give targeted_spend or by_group, not both";
                return Err(Refusal::at("targeted_spend", "both_aliases", message));
            }
            (Some(_), None) => "by_group",
            (None, _) => "targeted_spend",
        };
        Ok(SupportScopes {
            by_group: arguments.read(field, |value, name| per_group(value, name, BUDGET, view))?,
            by_plan: arguments.read("by_plan", |value, name| per_plan(value, name, BUDGET))?,
            by_group_plan: arguments
                .read("by_group_plan", |value, name| per_group_plan(value, name, BUDGET, view))?,
            by_customer: arguments.read("by_customer", |value, name| per_customer(value, name, BUDGET))?,
        })
    }

    fn plan(&self, view: &View<'_>, given: SupportScopes) -> Result<Planned<SupportBudgets>, Refusal> {
        let mut operations = view.settings().targeted_operations.clone();
        replace(&mut operations.by_group, given.by_group);
        replace(&mut operations.by_plan, given.by_plan);
        replace(&mut operations.by_group_plan, given.by_group_plan);
        replace(&mut operations.by_customer, given.by_customer);
        let own = operations.clone();
        let answer = SupportBudgets {
            targeted_spend: own.by_group.clone(),
            by_group: own.by_group,
            by_plan: own.by_plan,
            by_group_plan: own.by_group_plan,
            by_customer: own.by_customer,
            total_extra_per_day: operations.total(),
        };
        Ok(Planned::setting(SettingsChange::TargetedOperations(operations), answer))
    }
}
