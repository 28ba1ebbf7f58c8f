use serde_json::{Map, Value};

use super::super::arguments::{Arguments, per_customer, per_group, per_group_plan};
use super::super::{
    Argument, ArgumentKind, Key, Kind, Module, Output, Range, Refusal, Spec, Tool, ToolId, View, When,
};
use super::super::{as_data, family_of};
use super::{DISCOUNT, global_discount};
use crate::notation::json_number;
use crate::world::command::{Command, ResolvedCommand};
use crate::world::settings::Settings;
use crate::world::settings::SettingsChange;

/// Grants standing discounts.
pub struct SetPromotion;

const fn scope(name: &'static str, kind: ArgumentKind, doc: &'static str) -> Argument {
    Argument { name, alias: None, kind, required: false, unit: "$/month", doc }
}

static SPEC: Spec = Spec {
    id: ToolId::SetPromotion,
    code: "PRO",
    module: Module::Pricing,
    kind: Kind::Setting,
    summary: "Grant standing discounts to subscribers; the scopes add up",
    arguments: &[
        scope("global_promotion", ArgumentKind::Number(Range::AT_LEAST_ZERO), "for everybody"),
        scope("by_group", ArgumentKind::Map(Key::Group, Range::AT_LEAST_ZERO), "for subscribers of a group"),
        scope("by_customer", ArgumentKind::Map(Key::Customer, Range::AT_LEAST_ZERO), "for single customers"),
        scope(
            "by_group_plan",
            ArgumentKind::Matrix(Key::Group, Key::Plan, Range::AT_LEAST_ZERO),
            "for a group's subscribers on a plan",
        ),
    ],
    own_unknown: false,
    whole: None,
    when: When::NextBilling,
    effect: "Taken off the price on each customer's billing day, when it also weighs in the decision to \
             stay; it is felt from then on. Companies judge offers without it. A map replaces its whole \
             scope, {} clears it, and a scope left out stays as it is.",
    cost: "less revenue",
    writes: &["config_overrides"],
    refusals: &[
        "global_promotion_negative",
        "not_a_map",
        "unknown_group",
        "promotion_negative",
        "customer_not_integer",
        "unknown_plan",
        "amount_too_large",
    ],
    returns: &[
        Output { name: "global", kind: "number", doc: "$/month and seat" },
        Output { name: "by_group", kind: "map group -> number", doc: "$/month and seat" },
        Output { name: "by_customer", kind: "map customer -> number", doc: "$/month and seat" },
        Output { name: "by_group_plan", kind: "map group -> map plan -> number", doc: "$/month and seat" },
    ],
    example: r#"{"by_group": {"S2": 4}}"#,
};

impl Tool for SetPromotion {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn current(&self, settings: &Settings) -> Map<String, Value> {
        let promotion = &settings.promotion;
        Map::from_iter([
            ("global_promotion".to_owned(), json_number(promotion.global)),
            ("by_group".to_owned(), as_data(&promotion.by_group)),
            ("by_customer".to_owned(), as_data(&promotion.by_customer)),
            ("by_group_plan".to_owned(), as_data(&promotion.by_group_plan)),
        ])
    }

    fn plan(&self, view: &View<'_>, arguments: &Arguments) -> Result<Command, Refusal> {
        let mut promotion = view.settings().promotion.clone();
        promotion.global = global_discount(arguments, promotion.global)?;
        if let Some(value) = arguments.get("by_group") {
            promotion.by_group = per_group(value, "by_group", DISCOUNT, view)?;
        }
        if let Some(value) = arguments.get("by_customer") {
            promotion.by_customer = per_customer(value, "by_customer", DISCOUNT)?;
        }
        if let Some(value) = arguments.get("by_group_plan") {
            promotion.by_group_plan = per_group_plan(value, "by_group_plan", DISCOUNT, view)?;
        }
        Ok(Command::Set(SettingsChange::Promotion(promotion)))
    }

    fn answer(&self, _: &View<'_>, _: &Arguments, resolved: &ResolvedCommand) -> Value {
        family_of(resolved)
    }
}
