use serde_json::{Map, Value, json};

use super::super::arguments::{Arguments, number, wrong_type};
use super::super::bounds::{MOST_UNITS, too_large};
use super::super::{
    Argument, ArgumentKind, Kind, Module, Output, Range, Refusal, Spec, Tool, ToolId, View, When,
};
use super::{by_plan, core_of};
use crate::notation::json_number;
use crate::world::command::{Command, ResolvedCommand};
use crate::world::identifiers::Plan;
use crate::world::quota::Quota;
use crate::world::settings::Settings;
use crate::world::settings::SettingsChange;

/// Caps usage.
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
    summary: "Cap the daily usage of a customer; all three plans at once",
    arguments: &[
        quota("A", "quota of plan A per customer; a company shares one over all its seats"),
        quota("B", "quota of plan B per customer"),
        quota("C", "quota of plan C per customer"),
    ],
    own_unknown: false,
    whole: None,
    when: When::NextDay,
    effect: "A day's usage is the demand up to the quota. Demand above the quota lowers the quality a \
             customer perceives in the same proportion; a quota of 0 delivers nothing.",
    cost: "nothing in itself; compute is charged per unit used",
    writes: &["config_history"],
    refusals: &["quota_missing", "quota_negative", "amount_too_large"],
    returns: &[Output { name: "quotas", kind: "map plan -> number", doc: "all three quotas, units/day" }],
    example: r#"{"A": 50000, "B": 200000, "C": 900000}"#,
};

impl Tool for SetUsageQuotas {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn current(&self, settings: &Settings) -> Map<String, Value> {
        by_plan(|plan| json_number(settings.core.quotas[plan].units()))
    }

    fn plan(&self, view: &View<'_>, arguments: &Arguments) -> Result<Command, Refusal> {
        let mut core = view.settings().core;
        for plan in Plan::ALL {
            let Some(value) = arguments.get(plan.id()) else {
                let message = format!("quota of plan {plan} is missing; give all three");
                return Err(Refusal::at(plan.id(), "quota_missing", message));
            };
            if number(value).is_some_and(|quota| quota < 0.0) {
                let message = format!("quota of plan {plan} must not be negative");
                return Err(Refusal::at(plan.id(), "quota_negative", message));
            }
            let units = number(value).ok_or_else(|| wrong_type(plan.id(), "a number"))?;
            core.quotas[plan] = match Quota::of(units) {
                Some(quota) => quota,
                None => return Err(too_large(MOST_UNITS, plan.id(), "units/day")),
            };
        }
        Ok(Command::Set(SettingsChange::Core(core)))
    }

    fn answer(&self, view: &View<'_>, _: &Arguments, resolved: &ResolvedCommand) -> Value {
        let core = core_of(resolved, &view.settings().core);
        json!({ "quotas": by_plan(|plan| json_number(core.quotas[plan].units())) })
    }
}
