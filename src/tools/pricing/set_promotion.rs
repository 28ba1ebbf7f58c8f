use indexmap::IndexMap;
use serde_json::{Map, Value};

use super::super::arguments::{Arguments, as_data, per_customer, per_group, per_group_plan, replace};
use super::super::{
    Argument, ArgumentKind, Key, Kind, Module, Output, Planned, Range, Refusal, Spec, Tool, ToolId, View,
    When,
};
use super::{DISCOUNT, global_discount};
use novamind_base::notation::json_number;
use novamind_world::identifiers::Group;
use novamind_world::settings::{PerCustomer, PerGroup, PerPlan, Promotion, Settings, SettingsChange};

/// The tool `set_promotion`.
pub struct SetPromotion;

const fn scope(name: &'static str, kind: ArgumentKind, doc: &'static str) -> Argument {
    Argument { name, alias: None, kind, required: false, unit: "$/month", doc }
}

static SPEC: Spec = Spec {
    id: ToolId::SetPromotion,
    code: "PRO",
    module: Module::Pricing,
    kind: Kind::Setting,
    summary: "Grant lasting discounts to subscribers; the scopes add up",
    arguments: &[
        scope("global_promotion", ArgumentKind::Number(Range::AT_LEAST_ZERO), "for all subscribers"),
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
    effect: "Discounts apply on each customer's billing day, when they also influence the decision to \
             stay, and affect satisfaction from then on. Enterprises judge offers without them. A map replaces its whole \
             scope, {} clears it, and a scope that is left out does not change.",
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

/// Scopes that a call sets; the others do not change.
pub struct Discounts {
    global: Option<f64>,
    by_group: Option<PerGroup>,
    by_customer: Option<PerCustomer>,
    by_group_plan: Option<IndexMap<Group, PerPlan>>,
}

impl Tool for SetPromotion {
    type Args = Discounts;
    type Answer = Promotion;

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

    fn read(&self, view: &View<'_>, arguments: &Arguments) -> Result<Discounts, Refusal> {
        Ok(Discounts {
            global: arguments.read("global_promotion", global_discount)?,
            by_group: arguments.read("by_group", |value, name| per_group(value, name, DISCOUNT, view))?,
            by_customer: arguments.read("by_customer", |value, name| per_customer(value, name, DISCOUNT))?,
            by_group_plan: arguments
                .read("by_group_plan", |value, name| per_group_plan(value, name, DISCOUNT, view))?,
        })
    }

    fn plan(&self, view: &View<'_>, given: Discounts) -> Result<Planned<Promotion>, Refusal> {
        let mut promotion = view.settings().promotion.clone();
        replace(&mut promotion.global, given.global);
        replace(&mut promotion.by_group, given.by_group);
        replace(&mut promotion.by_customer, given.by_customer);
        replace(&mut promotion.by_group_plan, given.by_group_plan);
        Ok(Planned::setting(SettingsChange::Promotion(promotion.clone()), promotion))
    }
}
