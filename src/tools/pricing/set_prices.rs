use indexmap::IndexMap;
use serde_json::{Map, Value};

use super::super::arguments::{Arguments, SentNumber, wrong_type_rejection};
use super::super::{
    Argument, ArgumentKind, EffectTiming, NumberRange, PlannedCall, Rejection, ResultField, Tool,
    ToolContext, ToolId, ToolKind, ToolModule, ToolSpec,
};
use super::{PlanUpdate, map_plans, parse_per_plan_arguments, plan_values_json};
use novamind_base::formatting::json_number;
use novamind_world::identifiers::Plan;
use novamind_world::settings::{Settings, SettingsChange};

/// The tool `set_prices`, which sets the list prices of plans.
pub struct SetPrices;

const fn price_argument(name: &'static str, doc: &'static str) -> Argument {
    let kind = ArgumentKind::Number(NumberRange::ABOVE_ZERO);
    Argument { name, alias: None, kind, required: false, unit: "$/month", description: doc }
}

static SPEC: ToolSpec = ToolSpec {
    id: ToolId::SetPrices,
    code: "PRC",
    module: ToolModule::Pricing,
    kind: ToolKind::Setting,
    summary: "Set the monthly list price of one or more plans",
    arguments: &[
        price_argument("A", "list price of plan A"),
        price_argument("B", "list price of plan B"),
        price_argument("C", "list price of plan C"),
    ],
    has_own_unknown_code: true,
    unnamed_argument: None,
    effect_timing: EffectTiming::NextDay,
    effect: "New leads see the prices from the next day. Subscribers get them on their billing day: a lower price applies to \
             all permanently; a higher price is never charged to subscribers who keep their plan, but they reconsider \
             it. Enterprises pay the agreed price.",
    cost: "nothing",
    written_tables: &["config_history"],
    rejection_codes: &["nothing_given", "unknown_plan", "price_not_positive", "amount_too_large"],
    result_fields: &[
        ResultField { name: "updated", kind: "map plan -> number", description: "sent prices, $/month" },
        ResultField { name: "current", kind: "map plan -> number", description: "all three prices, $/month" },
    ],
    example: r#"{"A": 14, "C": 60}"#,
};

impl Tool for SetPrices {
    type Args = IndexMap<Plan, SentNumber>;
    type Answer = PlanUpdate<SentNumber>;

    fn spec(&self) -> &'static ToolSpec {
        &SPEC
    }

    fn current_arguments(&self, settings: &Settings) -> Map<String, Value> {
        plan_values_json(|plan| json_number(settings.core.prices[plan]))
    }

    fn parse_arguments(
        &self,
        _: &ToolContext<'_>,
        arguments: &Arguments,
    ) -> Result<IndexMap<Plan, SentNumber>, Rejection> {
        parse_per_plan_arguments(arguments, |plan, value| {
            let price =
                SentNumber::from_json(value).ok_or_else(|| wrong_type_rejection(plan.id(), "a number"))?;
            if NumberRange::ABOVE_ZERO.contains(price.value) {
                return Ok(price);
            }
            let message = format!("price of plan {plan} must be above zero");
            Err(Rejection::for_field(plan.id(), "price_not_positive", message))
        })
    }

    fn plan(
        &self,
        view: &ToolContext<'_>,
        updated: IndexMap<Plan, SentNumber>,
    ) -> Result<PlannedCall<Self::Answer>, Rejection> {
        let mut core = view.settings().core;
        for (plan, sent) in &updated {
            core.prices[*plan] = sent.value;
        }
        let current = map_plans(|plan| {
            updated.get(&plan).cloned().unwrap_or_else(|| SentNumber::from_setting(core.prices[plan]))
        });
        Ok(PlannedCall::with_settings_change(SettingsChange::Core(core), PlanUpdate { updated, current }))
    }
}
