use indexmap::IndexMap;
use serde::Serialize;
use serde_json::{Map, Value};

use super::super::arguments::{
    Arguments, parse_per_customer, parse_per_group, parse_per_group_plan, parse_per_plan, replace_if_given,
    to_json,
};
use super::super::marketing::BUDGET;
use super::super::{
    Argument, ArgumentKind, EffectTiming, MapKey, NumberRange, PlannedCall, Rejection, ResultField, Tool,
    ToolContext, ToolId, ToolKind, ToolModule, ToolSpec,
};
use novamind_world::identifiers::Group;
use novamind_world::settings::{PerCustomer, PerGroup, PerPlan, Settings, SettingsChange};

/// The tool `set_targeted_ops_spend`.
pub struct SetTargetedOpsSpend;

const fn scope_argument(
    name: &'static str,
    alias: Option<&'static str>,
    kind: ArgumentKind,
    doc: &'static str,
) -> Argument {
    Argument { name, alias, kind, required: false, unit: "$/day", description: doc }
}

static SPEC: ToolSpec = ToolSpec {
    id: ToolId::SetTargetedOpsSpend,
    code: "TOPS",
    module: ToolModule::Analytics,
    kind: ToolKind::Setting,
    summary: "Set extra support budgets for groups, plans or customers",
    arguments: &[
        scope_argument(
            "by_group",
            Some("targeted_spend"),
            ArgumentKind::Map(MapKey::Group, NumberRange::AT_LEAST_ZERO),
            "issues of a group",
        ),
        scope_argument(
            "by_plan",
            None,
            ArgumentKind::Map(MapKey::Plan, NumberRange::AT_LEAST_ZERO),
            "issues on a plan",
        ),
        scope_argument(
            "by_group_plan",
            None,
            ArgumentKind::Matrix(MapKey::Group, MapKey::Plan, NumberRange::AT_LEAST_ZERO),
            "issues of a group on a plan",
        ),
        scope_argument(
            "by_customer",
            None,
            ArgumentKind::Map(MapKey::Customer, NumberRange::AT_LEAST_ZERO),
            "the issue of one customer",
        ),
    ],
    has_own_unknown_code: false,
    unnamed_argument: Some("targeted_spend"),
    effect_timing: EffectTiming::NextDay,
    effect: "Every entry resolves open issues of its scope after the general budget: about \
             {issues.individual_ops_scale} per day and dollar for individuals, {issues.enterprise_ops_scale} \
             for enterprises. It does not affect outages. A map replaces its whole scope, {} clears it, and a \
             scope that is left out does not change.",
    cost: "the sum of all entries on every simulated day, even without open issues",
    written_tables: &["config_overrides"],
    rejection_codes: &[
        "both_aliases",
        "not_a_map",
        "unknown_group",
        "unknown_plan",
        "amount_invalid",
        "customer_not_integer",
        "amount_too_large",
    ],
    result_fields: &[
        ResultField { name: "by_group", kind: "map group -> number", description: "$/day" },
        ResultField { name: "by_plan", kind: "map plan -> number", description: "$/day" },
        ResultField { name: "by_group_plan", kind: "map group -> map plan -> number", description: "$/day" },
        ResultField { name: "by_customer", kind: "map customer -> number", description: "$/day" },
        ResultField { name: "total_extra_per_day", kind: "number", description: "sum of all scopes, $/day" },
        ResultField {
            name: "targeted_spend",
            kind: "map group -> number",
            description: "the same as by_group",
        },
    ],
    example: r#"{"by_group": {"E2": 90}}"#,
};

/// Support budgets that a call sets. Omitted scopes do not change.
pub struct SupportScopes {
    by_group: Option<PerGroup>,
    by_plan: Option<PerPlan>,
    by_group_plan: Option<IndexMap<Group, PerPlan>>,
    by_customer: Option<PerCustomer>,
}

/// Targeted support budgets in force, in dollars per day.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SupportBudgets {
    /// Budgets by group.
    pub by_group: PerGroup,
    /// Budgets by plan.
    pub by_plan: PerPlan,
    /// Budgets by group and plan.
    pub by_group_plan: IndexMap<Group, PerPlan>,
    /// Budgets by customer.
    pub by_customer: PerCustomer,
    /// Sum of the budgets of all scopes.
    pub total_extra_per_day: f64,
    /// Budgets by group, repeated under the name of the argument.
    pub targeted_spend: PerGroup,
}

impl Tool for SetTargetedOpsSpend {
    type Args = SupportScopes;
    type Answer = SupportBudgets;

    fn spec(&self) -> &'static ToolSpec {
        &SPEC
    }

    fn current_arguments(&self, settings: &Settings) -> Map<String, Value> {
        match to_json(&settings.targeted_operations) {
            Value::Object(map) => map,
            _ => Map::new(),
        }
    }

    fn parse_arguments(
        &self,
        view: &ToolContext<'_>,
        arguments: &Arguments,
    ) -> Result<SupportScopes, Rejection> {
        let field = match (arguments.get("by_group"), arguments.get("targeted_spend")) {
            (Some(_), Some(_)) => {
                let message = "give targeted_spend or by_group, not both";
                return Err(Rejection::for_field("targeted_spend", "both_aliases", message));
            }
            (Some(_), None) => "by_group",
            (None, _) => "targeted_spend",
        };
        Ok(SupportScopes {
            by_group: arguments
                .parse_argument(field, |value, name| parse_per_group(value, name, BUDGET, view))?,
            by_plan: arguments
                .parse_argument("by_plan", |value, name| parse_per_plan(value, name, BUDGET))?,
            by_group_plan: arguments.parse_argument("by_group_plan", |value, name| {
                parse_per_group_plan(value, name, BUDGET, view)
            })?,
            by_customer: arguments
                .parse_argument("by_customer", |value, name| parse_per_customer(value, name, BUDGET))?,
        })
    }

    fn plan(
        &self,
        view: &ToolContext<'_>,
        support_scopes: SupportScopes,
    ) -> Result<PlannedCall<SupportBudgets>, Rejection> {
        let mut operations = view.settings().targeted_operations.clone();
        replace_if_given(&mut operations.by_group, support_scopes.by_group);
        replace_if_given(&mut operations.by_plan, support_scopes.by_plan);
        replace_if_given(&mut operations.by_group_plan, support_scopes.by_group_plan);
        replace_if_given(&mut operations.by_customer, support_scopes.by_customer);
        let targeted_operations = operations.clone();
        let answer = SupportBudgets {
            targeted_spend: targeted_operations.by_group.clone(),
            by_group: targeted_operations.by_group,
            by_plan: targeted_operations.by_plan,
            by_group_plan: targeted_operations.by_group_plan,
            by_customer: targeted_operations.by_customer,
            total_extra_per_day: operations.total(),
        };
        Ok(PlannedCall::with_settings_change(SettingsChange::TargetedOperations(operations), answer))
    }
}
