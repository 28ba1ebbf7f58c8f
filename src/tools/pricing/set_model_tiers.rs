use indexmap::IndexMap;
use serde_json::{Map, Value};

use super::super::arguments::Arguments;
use super::super::{
    Argument, ArgumentKind, Kind, Module, Output, Planned, Range, Refusal, Spec, Tool, ToolId, View, When,
};
use super::{PlanUpdate, by_plan, per_named_plan, plan_map};
use novamind_world::identifiers::Plan;
use novamind_world::settings::{Settings, SettingsChange};

/// The tool `set_model_tiers`.
pub struct SetModelTiers;

const TIERS: Range = Range::between(1.0, 5.0);

const fn tier(name: &'static str, doc: &'static str) -> Argument {
    let kind = ArgumentKind::Integer(TIERS);
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
    cost: "nothing directly; compute is charged per used unit",
    writes: &["config_history"],
    refusals: &["nothing_given", "unknown_plan", "tier_out_of_range"],
    returns: &[
        Output { name: "updated", kind: "map plan -> integer", doc: "sent tiers" },
        Output { name: "current", kind: "map plan -> integer", doc: "all three tiers" },
    ],
    example: r#"{"B": 3}"#,
};

impl Tool for SetModelTiers {
    type Args = IndexMap<Plan, u8>;
    type Answer = PlanUpdate<u8>;

    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn current(&self, settings: &Settings) -> Map<String, Value> {
        plan_map(|plan| Value::from(settings.core.tiers[plan]))
    }

    fn read(&self, _: &View<'_>, arguments: &Arguments) -> Result<IndexMap<Plan, u8>, Refusal> {
        per_named_plan(arguments, |plan, value| {
            TIERS.whole(value).ok_or_else(|| {
                let message = format!("model tier of plan {plan} must be {}", TIERS.words());
                Refusal::at(plan.id(), "tier_out_of_range", message)
            })
        })
    }

    fn plan(&self, view: &View<'_>, updated: IndexMap<Plan, u8>) -> Result<Planned<Self::Answer>, Refusal> {
        let mut core = view.settings().core;
        for (plan, tier) in &updated {
            core.tiers[*plan] = *tier;
        }
        let current = by_plan(|plan| core.tiers[plan]);
        Ok(Planned::setting(SettingsChange::Core(core), PlanUpdate { updated, current }))
    }
}
