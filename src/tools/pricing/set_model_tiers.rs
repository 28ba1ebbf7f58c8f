use serde_json::{Map, Value};

use super::super::arguments::{Arguments, integer};
use super::super::{
    Argument, ArgumentKind, Kind, Module, Output, Range, Refusal, Spec, Tool, ToolId, View, When,
};
use super::{by_plan, core_of, some_plans, updated_and_current};
use crate::world::command::{Command, ResolvedCommand};
use crate::world::identifiers::{ByPlan, Plan};
use crate::world::settings::Settings;
use crate::world::settings::SettingsChange;

/// Chooses the model behind each plan.
pub struct SetModelTiers;

const fn tier(name: &'static str, doc: &'static str) -> Argument {
    let kind = ArgumentKind::Integer(Range::between(1.0, 5.0));
    Argument { name, alias: None, kind, required: false, unit: "tier", doc }
}

static SPEC: Spec = Spec {
    id: ToolId::SetModelTiers,
    code: "TIER",
    module: Module::Pricing,
    kind: Kind::Setting,
    summary: "Choose the model tier that serves each plan",
    arguments: &[
        tier("A", "model tier of plan A"),
        tier("B", "model tier of plan B"),
        tier("C", "model tier of plan C"),
    ],
    own_unknown: true,
    whole: None,
    when: When::NextDay,
    effect: "A higher tier multiplies the quality that the plan delivers and the compute cost of every usage unit; \
             get_cost_info lists both.",
    cost: "nothing in itself; compute is charged per unit used",
    writes: &["config_history"],
    refusals: &["nothing_given", "unknown_plan", "tier_out_of_range"],
    returns: &[
        Output { name: "updated", kind: "map plan -> integer", doc: "what was sent" },
        Output { name: "current", kind: "map plan -> integer", doc: "all three tiers" },
    ],
    example: r#"{"B": 3}"#,
};

impl Tool for SetModelTiers {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn current(&self, settings: &Settings) -> Map<String, Value> {
        by_plan(|plan| Value::from(settings.core.tiers[plan]))
    }

    fn plan(&self, view: &View<'_>, arguments: &Arguments) -> Result<Command, Refusal> {
        some_plans(arguments)?;
        let mut core = view.settings().core;
        for (key, value) in arguments.as_map() {
            let plan = Plan::parse(key).expect("checked above");
            core.tiers[plan] = integer(value).filter(|tier| (1..=5).contains(tier)).ok_or_else(|| {
                let message = format!("model tier of plan {plan} must be 1 to 5");
                Refusal::at(key.clone(), "tier_out_of_range", message)
            })? as u8;
        }
        Ok(Command::Set(SettingsChange::Core(core)))
    }

    fn answer(&self, view: &View<'_>, arguments: &Arguments, resolved: &ResolvedCommand) -> Value {
        let core = core_of(resolved, &view.settings().core);
        updated_and_current(arguments, &ByPlan::from_fn(|plan| Value::from(core.tiers[plan])))
    }
}
