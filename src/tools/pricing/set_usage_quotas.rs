use indexmap::IndexMap;
use serde::Serialize;
use serde_json::{Map, Value};

use super::super::arguments::{Arguments, Sent, wrong_type};
use super::super::bounds::too_large;
use super::super::spec::MOST_UNITS;
use super::super::{
    Argument, ArgumentKind, Kind, Module, Output, Planned, Range, Refusal, Spec, Tool, ToolId, View, When,
};
use super::plan_map;
use novamind_base::notation::json_number;
use novamind_world::identifiers::{ByPlan, Plan};
use novamind_world::quota::Quota;
use novamind_world::settings::{CoreSettings, Settings, SettingsChange};

/// The tool `set_usage_quotas`.
pub struct SetUsageQuotas;

const fn quota(name: &'static str, doc: &'static str) -> Argument {
    let kind = ArgumentKind::Number(Range::UNITS);
    Argument { name, alias: None, kind, required: true, unit: "units/day", doc }
}

static SPEC: Spec = Spec {
    id: ToolId::SetUsageQuotas,
    code: "QUO",
    module: Module::Pricing,
    kind: Kind::Setting,
    summary: "Limit the daily usage of a customer; all three plans at once",
    arguments: &[
        quota("A", "quota of plan A per customer; an enterprise shares one among all its seats"),
        quota("B", "quota of plan B per customer"),
        quota("C", "quota of plan C per customer"),
    ],
    own_unknown: false,
    whole: None,
    when: When::NextDay,
    effect: "A day's usage is the demand up to the quota. Demand above the quota lowers the quality a \
             customer perceives in the same proportion; a quota of 0 delivers nothing.",
    cost: "nothing directly; compute is charged per used unit",
    writes: &["config_history"],
    refusals: &["quota_missing", "quota_negative", "amount_too_large"],
    returns: &[Output { name: "quotas", kind: "map plan -> number", doc: "all three quotas, units/day" }],
    example: r#"{"A": 150, "B": 400, "C": 900}"#,
};

/// Quotas in force.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct UsageQuotas {
    /// Units per day and customer, by plan.
    pub quotas: IndexMap<Plan, Sent>,
}

fn quota_of(plan: Plan, given: Option<&Value>) -> Result<Sent, Refusal> {
    let Some(value) = given else {
        let message = format!("quota of plan {plan} is missing; give all three");
        return Err(Refusal::at(plan.id(), "quota_missing", message));
    };
    let sent = Sent::of(value).ok_or_else(|| wrong_type(plan.id(), "a number"))?;
    if sent.value < 0.0 {
        let message = format!("quota of plan {plan} must not be negative");
        return Err(Refusal::at(plan.id(), "quota_negative", message));
    }
    Ok(sent)
}

impl Tool for SetUsageQuotas {
    type Args = IndexMap<Plan, (Sent, Quota)>;
    type Answer = UsageQuotas;

    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn current(&self, settings: &Settings) -> Map<String, Value> {
        plan_map(|plan| json_number(settings.core.quotas[plan].units()))
    }

    fn read(&self, _: &View<'_>, arguments: &Arguments) -> Result<Self::Args, Refusal> {
        let given: Vec<Sent> = Plan::ALL
            .into_iter()
            .map(|plan| quota_of(plan, arguments.get(plan.id())))
            .collect::<Result<_, _>>()?;
        let stored = |(plan, sent): (Plan, Sent)| match Quota::of(sent.value) {
            Some(quota) => Ok((plan, (sent, quota))),
            None => Err(too_large(MOST_UNITS, plan.id(), "units/day")),
        };
        Plan::ALL.into_iter().zip(given).map(stored).collect()
    }

    fn plan(&self, view: &View<'_>, given: Self::Args) -> Result<Planned<UsageQuotas>, Refusal> {
        let core = CoreSettings { quotas: ByPlan::from_fn(|plan| given[&plan].1), ..view.settings().core };
        let answer =
            UsageQuotas { quotas: given.into_iter().map(|(plan, (sent, _))| (plan, sent)).collect() };
        Ok(Planned::setting(SettingsChange::Core(core), answer))
    }
}
