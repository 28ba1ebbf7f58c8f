use indexmap::IndexMap;
use serde_json::{Map, Value};

use super::super::arguments::Arguments;
use super::super::{
    Argument, ArgumentKind, EffectTiming, NumberRange, PlannedCall, Rejection, ResultField, Tool,
    ToolContext, ToolId, ToolKind, ToolModule, ToolSpec,
};
use super::{PlanUpdate, map_plans, parse_per_plan_arguments, plan_values_json};
use novamind_world::identifiers::Plan;
use novamind_world::settings::{Settings, SettingsChange};

/// The tool `set_model_tiers`, which sets the model tiers of plans.
pub struct SetModelTiers;

const TIER_RANGE: NumberRange = NumberRange::between(1.0, 5.0);

const fn tier_argument(name: &'static str, doc: &'static str) -> Argument {
    let kind = ArgumentKind::Integer(TIER_RANGE);
    Argument { name, alias: None, kind, required: false, unit: "tier", description: doc }
}

static SPEC: ToolSpec = ToolSpec {
    id: ToolId::SetModelTiers,
    code: "TIER",
    module: ToolModule::Pricing,
    kind: ToolKind::Setting,
    summary: "Choose the model tier that serves each plan",
    arguments: &[
        tier_argument("A", "model tier of plan A"),
        tier_argument("B", "model tier of plan B"),
        tier_argument("C", "model tier of plan C"),
    ],
    has_own_unknown_code: true,
    unnamed_argument: None,
    effect_timing: EffectTiming::NextDay,
    effect: "A higher tier multiplies the quality that the plan delivers and the compute cost of every usage unit; \
             get_cost_info lists both.",
    cost: "nothing directly; compute is charged per used unit",
    written_tables: &["config_history"],
    rejection_codes: &["nothing_given", "unknown_plan", "tier_out_of_range"],
    result_fields: &[
        ResultField { name: "updated", kind: "map plan -> integer", description: "sent tiers" },
        ResultField { name: "current", kind: "map plan -> integer", description: "all three tiers" },
    ],
    example: r#"{"B": 3}"#,
};

impl Tool for SetModelTiers {
    type Args = IndexMap<Plan, u8>;
    type Answer = PlanUpdate<u8>;

    fn spec(&self) -> &'static ToolSpec {
        &SPEC
    }

    fn current_arguments(&self, settings: &Settings) -> Map<String, Value> {
        plan_values_json(|plan| Value::from(settings.core.tiers[plan]))
    }

    fn parse_arguments(
        &self,
        _: &ToolContext<'_>,
        arguments: &Arguments,
    ) -> Result<IndexMap<Plan, u8>, Rejection> {
        parse_per_plan_arguments(arguments, |plan, value| {
            TIER_RANGE.parse_integer(value).ok_or_else(|| {
                let message = format!("model tier of plan {plan} must be {}", TIER_RANGE.describe());
                Rejection::for_field(plan.id(), "tier_out_of_range", message)
            })
        })
    }

    fn plan(
        &self,
        view: &ToolContext<'_>,
        updated: IndexMap<Plan, u8>,
    ) -> Result<PlannedCall<Self::Answer>, Rejection> {
        let mut core = view.settings().core;
        for (plan, tier) in &updated {
            core.tiers[*plan] = *tier;
        }
        let current = map_plans(|plan| core.tiers[plan]);
        Ok(PlannedCall::with_settings_change(SettingsChange::Core(core), PlanUpdate { updated, current }))
    }
}
