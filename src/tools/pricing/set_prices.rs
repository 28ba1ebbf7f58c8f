use serde_json::{Map, Value};

use super::super::arguments::{Arguments, number};
use super::super::{
    Argument, ArgumentKind, Kind, Module, Output, Range, Refusal, Spec, Tool, ToolId, View, When,
};
use super::{by_plan, core_of, some_plans, updated_and_current};
use crate::notation::json_number;
use crate::world::command::{Command, ResolvedCommand};
use crate::world::identifiers::{ByPlan, Plan};
use crate::world::settings::Settings;
use crate::world::settings::SettingsChange;

/// Sets monthly list prices.
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
    effect: "New leads see the prices from the next day. Subscribers meet them on their billing day: a cut reaches \
             everybody and stays, a rise is never charged to those who stay on their plan, but it makes them think \
             again. Companies pay what was agreed.",
    cost: "nothing",
    writes: &["config_history"],
    refusals: &["nothing_given", "unknown_plan", "price_not_positive", "amount_too_large"],
    returns: &[
        Output { name: "updated", kind: "map plan -> number", doc: "what was sent, $/month" },
        Output { name: "current", kind: "map plan -> number", doc: "all three prices, $/month" },
    ],
    example: r#"{"A": 14, "C": 60}"#,
};

impl Tool for SetPrices {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn current(&self, settings: &Settings) -> Map<String, Value> {
        by_plan(|plan| json_number(settings.core.prices[plan]))
    }

    fn plan(&self, view: &View<'_>, arguments: &Arguments) -> Result<Command, Refusal> {
        some_plans(arguments)?;
        let mut core = view.settings().core;
        for (key, value) in arguments.as_map() {
            let plan = Plan::parse(key).expect("checked above");
            let price = number(value).ok_or_else(|| super::super::arguments::wrong_type(key, "a number"))?;
            if !Range::ABOVE_ZERO.holds(price) {
                let message = format!("price of plan {plan} must be above zero");
                return Err(Refusal::at(key.clone(), "price_not_positive", message));
            }
            core.prices[plan] = price;
        }
        Ok(Command::Set(SettingsChange::Core(core)))
    }

    fn answer(&self, view: &View<'_>, arguments: &Arguments, resolved: &ResolvedCommand) -> Value {
        let core = core_of(resolved, &view.settings().core);
        updated_and_current(arguments, &ByPlan::from_fn(|plan| json_number(core.prices[plan])))
    }
}
