use indexmap::IndexMap;
use serde_json::{Map, Value};

use super::super::arguments::{Arguments, Sent, wrong_type};
use super::super::{
    Argument, ArgumentKind, Kind, Module, Output, Planned, Range, Refusal, Spec, Tool, ToolId, View, When,
};
use super::{PlanUpdate, by_plan, per_named_plan, plan_map};
use novamind_base::notation::json_number;
use novamind_world::identifiers::Plan;
use novamind_world::settings::{Settings, SettingsChange};

/// The tool `set_prices`.
pub struct SetPrices;

const fn price(name: &'static str, doc: &'static str) -> Argument {
    let kind = ArgumentKind::Number(Range::ABOVE_ZERO);
    Argument { name, alias: None, kind, required: false, unit: "$/month", doc }
}

static SPEC: Spec = Spec {
    id: ToolId::SetPrices,
    code: "PRC",
    module: Module::Pricing,
    kind: Kind::Setting,
    summary: "Set the monthly list price of one or more plans",
    arguments: &[
        price("A", "list price of plan A"),
        price("B", "list price of plan B"),
        price("C", "list price of plan C"),
    ],
    own_unknown: true,
    whole: None,
    when: When::NextDay,
    effect: "New leads see the prices from the next day. Subscribers get them on their billing day: a lower price applies to \
             all permanently; a higher price is never charged to subscribers who keep their plan, but they reconsider \
             it. Enterprises pay the agreed price.",
    cost: "nothing",
    writes: &["config_history"],
    refusals: &["nothing_given", "unknown_plan", "price_not_positive", "amount_too_large"],
    returns: &[
        Output { name: "updated", kind: "map plan -> number", doc: "sent prices, $/month" },
        Output { name: "current", kind: "map plan -> number", doc: "all three prices, $/month" },
    ],
    example: r#"{"A": 14, "C": 60}"#,
};

impl Tool for SetPrices {
    type Args = IndexMap<Plan, Sent>;
    type Answer = PlanUpdate<Sent>;

    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn current(&self, settings: &Settings) -> Map<String, Value> {
        plan_map(|plan| json_number(settings.core.prices[plan]))
    }

    fn read(&self, _: &View<'_>, arguments: &Arguments) -> Result<IndexMap<Plan, Sent>, Refusal> {
        per_named_plan(arguments, |plan, value| {
            let price = Sent::of(value).ok_or_else(|| wrong_type(plan.id(), "a number"))?;
            if Range::ABOVE_ZERO.holds(price.value) {
                return Ok(price);
            }
            let message = format!("price of plan {plan} must be above zero");
            Err(Refusal::at(plan.id(), "price_not_positive", message))
        })
    }

    fn plan(&self, view: &View<'_>, updated: IndexMap<Plan, Sent>) -> Result<Planned<Self::Answer>, Refusal> {
        let mut core = view.settings().core;
        for (plan, sent) in &updated {
            core.prices[*plan] = sent.value;
        }
        let current =
            by_plan(|plan| updated.get(&plan).cloned().unwrap_or_else(|| Sent::stored(core.prices[plan])));
        Ok(Planned::setting(SettingsChange::Core(core), PlanUpdate { updated, current }))
    }
}
