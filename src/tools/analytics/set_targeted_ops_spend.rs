use indexmap::IndexMap;
use serde::Serialize;
use serde_json::{Map, Value};

use super::super::arguments::{
    Arguments, parse_per_customer, parse_per_group, parse_per_group_plan, parse_per_plan, replace_if_given,
    to_json,
};
use super::super::marketing::BUDGET_RULE;
use super::super::{
    Argument, ArgumentKind, EffectTiming, MapKey, NumberRange, PlannedCall, Rejection, ResultField, Tool,
    ToolContext, ToolId, ToolKind, ToolModule, ToolSpec, limits,
};
use novamind_world::identifiers::Group;
use novamind_world::params::Interface;
use novamind_world::settings::{PerCustomer, PerGroup, PerPlan, Settings, SettingsChange};

/// The tool `set_targeted_ops_spend`, which sets support budgets by group, plan or customer.
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

impl SupportScopes {
    fn is_empty(&self) -> bool {
        self.by_group.is_none()
            && self.by_plan.is_none()
            && self.by_group_plan.is_none()
            && self.by_customer.is_none()
    }
}

/// Targeted support budgets in force after the call, in dollars per day.
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
                .parse_argument(field, |value, name| parse_per_group(value, name, BUDGET_RULE, view))?,
            by_plan: arguments
                .parse_argument("by_plan", |value, name| parse_per_plan(value, name, BUDGET_RULE))?,
            by_group_plan: arguments.parse_argument("by_group_plan", |value, name| {
                parse_per_group_plan(value, name, BUDGET_RULE, view)
            })?,
            by_customer: arguments.parse_argument("by_customer", |value, name| {
                parse_per_customer(value, name, BUDGET_RULE).and_then(|budgets| {
                    if is_release_2(view) {
                        check_customers(&budgets, name)?;
                    }
                    Ok(budgets)
                })
            })?,
        })
    }

    fn plan(
        &self,
        view: &ToolContext<'_>,
        support_scopes: SupportScopes,
    ) -> Result<PlannedCall<SupportBudgets>, Rejection> {
        let has_no_scope = support_scopes.is_empty();
        let mut operations = view.settings().targeted_operations.clone();
        replace_if_given(&mut operations.by_group, support_scopes.by_group);
        replace_if_given(&mut operations.by_plan, support_scopes.by_plan);
        replace_if_given(&mut operations.by_group_plan, support_scopes.by_group_plan);
        replace_if_given(&mut operations.by_customer, support_scopes.by_customer);
        if is_release_2(view) && !operations.total().is_finite() {
            return Err(Rejection::new(
                limits::REJECTION_CODE,
                "Total targeted operations spend must be finite.",
            ));
        }
        let targeted_operations = operations.clone();
        let answer = SupportBudgets {
            targeted_spend: targeted_operations.by_group.clone(),
            by_group: targeted_operations.by_group,
            by_plan: targeted_operations.by_plan,
            by_group_plan: targeted_operations.by_group_plan,
            by_customer: targeted_operations.by_customer,
            total_extra_per_day: operations.total(),
        };
        if is_release_2(view) && has_no_scope {
            return Ok(PlannedCall::read_only(answer));
        }
        Ok(PlannedCall::with_settings_change(SettingsChange::TargetedOperations(operations), answer))
    }
}

fn is_release_2(view: &ToolContext<'_>) -> bool {
    view.params().fidelity.interface == Interface::Release2
}

/// Rejects customer numbers below 1, as release 2 does.
fn check_customers(budgets: &PerCustomer, field: &str) -> Result<(), Rejection> {
    match budgets.keys().find(|customer| **customer < 1) {
        None => Ok(()),
        Some(customer) => Err(Rejection::for_field(
            format!("{field}.{customer}"),
            "customer_not_integer",
            format!("customer id {customer} is below 1"),
        )),
    }
}

/// Returns the rejection of a call in the wording of release 2. Release 2 added fixed texts for
/// `set_targeted_ops_spend` only, so other rejections are returned unchanged.
pub fn with_release_2_text(tool: ToolId, rejection: Rejection, arguments: &Value) -> Rejection {
    if tool != SPEC.id {
        return rejection;
    }
    let path = rejection.field.clone().unwrap_or_default();
    let text = match (rejection.code, path.split('.').collect::<Vec<&str>>().as_slice()) {
        ("wrong_type", [""]) => "Targeted operations arguments must be a dict.".to_owned(),
        ("unknown_argument", _) => {
            format!("Unknown targeted operations arguments: {}", unknown_names(arguments))
        }
        ("amount_invalid", [scope, key @ ..]) => {
            format!("Amount for {} must be a finite non-negative number", describe_target(scope, key))
        }
        ("customer_not_integer", [_, customer @ ..]) => {
            format!("Customer ID '{}' must be a positive integer", customer.join("."))
        }
        _ => return rejection,
    };
    Rejection { message: text, ..rejection }
}

fn unknown_names(arguments: &Value) -> String {
    let is_known = |name: &str| SPEC.arguments.iter().any(|one| one.name == name || one.alias == Some(name));
    let names = arguments.as_object().into_iter().flat_map(Map::keys).map(String::as_str);
    let mut unknown: Vec<&str> = names.filter(|name| !is_known(name)).collect();
    unknown.sort_unstable();
    unknown.join(", ")
}

/// Describes the target of an amount: a group, a plan, a group and a plan, or a customer.
fn describe_target(scope: &str, key: &[&str]) -> String {
    match scope {
        "by_plan" => format!("plan {}", key.join(".")),
        "by_customer" => format!("customer {}", key.join(".")),
        _ => key.join("/"),
    }
}
