use indexmap::IndexMap;
use serde::Serialize;
use serde_json::{Map, Value};

use super::super::arguments::{Arguments, SentNumber, wrong_type_rejection};
use super::super::limits::too_large_rejection;
use super::super::spec::MAX_UNITS_PER_DAY;
use super::super::{
    Argument, ArgumentKind, EffectTiming, NumberRange, PlannedCall, Rejection, ResultField, Tool,
    ToolContext, ToolId, ToolKind, ToolModule, ToolSpec,
};
use super::plan_values_json;
use novamind_base::formatting::json_number;
use novamind_world::identifiers::{ByPlan, Plan};
use novamind_world::quota::Quota;
use novamind_world::settings::{CoreSettings, Settings, SettingsChange};

/// The tool `set_usage_quotas`, which sets the quotas of all plans.
pub struct SetUsageQuotas;

const fn quota_argument(name: &'static str, doc: &'static str) -> Argument {
    let kind = ArgumentKind::Number(NumberRange::UNITS);
    Argument { name, alias: None, kind, required: true, unit: "units/day", description: doc }
}

static SPEC: ToolSpec = ToolSpec {
    id: ToolId::SetUsageQuotas,
    code: "QUO",
    module: ToolModule::Pricing,
    kind: ToolKind::Setting,
    summary: "Limit the daily usage of a customer; all three plans at once",
    arguments: &[
        quota_argument("A", "quota of plan A per customer; an enterprise shares one among all its seats"),
        quota_argument("B", "quota of plan B per customer"),
        quota_argument("C", "quota of plan C per customer"),
    ],
    has_own_unknown_code: false,
    unnamed_argument: None,
    effect_timing: EffectTiming::NextDay,
    effect: "A day's usage is the demand up to the quota. Demand above the quota lowers the quality a \
             customer perceives in the same proportion; a quota of 0 delivers nothing.",
    cost: "nothing directly; compute is charged per used unit",
    written_tables: &["config_history"],
    rejection_codes: &["quota_missing", "quota_negative", "amount_too_large"],
    result_fields: &[ResultField {
        name: "quotas",
        kind: "map plan -> number",
        description: "all three quotas, units/day",
    }],
    example: r#"{"A": 150, "B": 400, "C": 900}"#,
};

/// Quotas in force after a call.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct UsageQuotas {
    /// Quotas in units per customer per day, by plan.
    pub quotas: IndexMap<Plan, SentNumber>,
}

fn parse_quota(plan: Plan, given: Option<&Value>) -> Result<SentNumber, Rejection> {
    let Some(value) = given else {
        let message = format!("quota of plan {plan} is missing; give all three");
        return Err(Rejection::for_field(plan.id(), "quota_missing", message));
    };
    let sent = SentNumber::from_json(value).ok_or_else(|| wrong_type_rejection(plan.id(), "a number"))?;
    if sent.value < 0.0 {
        let message = format!("quota of plan {plan} must not be negative");
        return Err(Rejection::for_field(plan.id(), "quota_negative", message));
    }
    Ok(sent)
}

impl Tool for SetUsageQuotas {
    type Args = IndexMap<Plan, (SentNumber, Quota)>;
    type Answer = UsageQuotas;

    fn spec(&self) -> &'static ToolSpec {
        &SPEC
    }

    fn current_arguments(&self, settings: &Settings) -> Map<String, Value> {
        plan_values_json(|plan| json_number(settings.core.quotas[plan].units()))
    }

    fn parse_arguments(&self, _: &ToolContext<'_>, arguments: &Arguments) -> Result<Self::Args, Rejection> {
        let sent_numbers: Vec<SentNumber> = Plan::ALL
            .into_iter()
            .map(|plan| parse_quota(plan, arguments.get(plan.id())))
            .collect::<Result<_, _>>()?;
        let stored = |(plan, sent): (Plan, SentNumber)| match Quota::from_units(sent.value) {
            Some(quota) => Ok((plan, (sent, quota))),
            None => Err(too_large_rejection(MAX_UNITS_PER_DAY, plan.id(), "units/day")),
        };
        Plan::ALL.into_iter().zip(sent_numbers).map(stored).collect()
    }

    fn plan(&self, view: &ToolContext<'_>, given: Self::Args) -> Result<PlannedCall<UsageQuotas>, Rejection> {
        let core = CoreSettings { quotas: ByPlan::from_fn(|plan| given[&plan].1), ..view.settings().core };
        let answer =
            UsageQuotas { quotas: given.into_iter().map(|(plan, (sent, _))| (plan, sent)).collect() };
        Ok(PlannedCall::with_settings_change(SettingsChange::Core(core), answer))
    }
}
