use indexmap::IndexMap;
use serde_json::{Map, Value};

use super::super::arguments::{
    Arguments, parse_per_customer, parse_per_group, parse_per_group_plan, replace_if_given, to_json,
};
use super::super::{
    Argument, ArgumentKind, EffectTiming, MapKey, NumberRange, PlannedCall, Rejection, ResultField, Tool,
    ToolContext, ToolId, ToolKind, ToolModule, ToolSpec,
};
use super::{DISCOUNT_RULE, parse_global_discount};
use novamind_base::formatting::json_number;
use novamind_world::identifiers::Group;
use novamind_world::settings::{PerCustomer, PerGroup, PerPlan, Promotion, Settings, SettingsChange};

/// The tool `set_promotion`, which sets the discounts of subscribers.
pub struct SetPromotion;

const fn scope_argument(name: &'static str, kind: ArgumentKind, doc: &'static str) -> Argument {
    Argument { name, alias: None, kind, required: false, unit: "$/month", description: doc }
}

static SPEC: ToolSpec = ToolSpec {
    id: ToolId::SetPromotion,
    code: "PRO",
    module: ToolModule::Pricing,
    kind: ToolKind::Setting,
    summary: "Grant lasting discounts to subscribers; the scopes add up",
    arguments: &[
        scope_argument(
            "global_promotion",
            ArgumentKind::Number(NumberRange::AT_LEAST_ZERO),
            "for all subscribers",
        ),
        scope_argument(
            "by_group",
            ArgumentKind::Map(MapKey::Group, NumberRange::AT_LEAST_ZERO),
            "for subscribers of a group",
        ),
        scope_argument(
            "by_customer",
            ArgumentKind::Map(MapKey::Customer, NumberRange::AT_LEAST_ZERO),
            "for single customers",
        ),
        scope_argument(
            "by_group_plan",
            ArgumentKind::Matrix(MapKey::Group, MapKey::Plan, NumberRange::AT_LEAST_ZERO),
            "for a group's subscribers on a plan",
        ),
    ],
    has_own_unknown_code: false,
    unnamed_argument: None,
    effect_timing: EffectTiming::NextBilling,
    effect: "Discounts apply on each customer's billing day, when they also influence the decision to \
             stay, and affect satisfaction from then on. Enterprises judge offers without them. A map replaces its whole \
             scope, {} clears it, and a scope that is left out does not change.",
    cost: "less revenue",
    written_tables: &["config_overrides"],
    rejection_codes: &[
        "global_promotion_negative",
        "not_a_map",
        "unknown_group",
        "promotion_negative",
        "customer_not_integer",
        "unknown_plan",
        "amount_too_large",
    ],
    result_fields: &[
        ResultField { name: "global", kind: "number", description: "$/month and seat" },
        ResultField { name: "by_group", kind: "map group -> number", description: "$/month and seat" },
        ResultField { name: "by_customer", kind: "map customer -> number", description: "$/month and seat" },
        ResultField {
            name: "by_group_plan",
            kind: "map group -> map plan -> number",
            description: "$/month and seat",
        },
    ],
    example: r#"{"by_group": {"S2": 4}}"#,
};

/// Discounts that a call sets. Omitted scopes do not change.
pub struct Discounts {
    global: Option<f64>,
    by_group: Option<PerGroup>,
    by_customer: Option<PerCustomer>,
    by_group_plan: Option<IndexMap<Group, PerPlan>>,
}

impl Tool for SetPromotion {
    type Args = Discounts;
    type Answer = Promotion;

    fn spec(&self) -> &'static ToolSpec {
        &SPEC
    }

    fn current_arguments(&self, settings: &Settings) -> Map<String, Value> {
        let promotion = &settings.promotion;
        Map::from_iter([
            ("global_promotion".to_owned(), json_number(promotion.global)),
            ("by_group".to_owned(), to_json(&promotion.by_group)),
            ("by_customer".to_owned(), to_json(&promotion.by_customer)),
            ("by_group_plan".to_owned(), to_json(&promotion.by_group_plan)),
        ])
    }

    fn parse_arguments(&self, view: &ToolContext<'_>, arguments: &Arguments) -> Result<Discounts, Rejection> {
        Ok(Discounts {
            global: arguments.parse_argument("global_promotion", parse_global_discount)?,
            by_group: arguments.parse_argument("by_group", |value, name| {
                parse_per_group(value, name, DISCOUNT_RULE, view)
            })?,
            by_customer: arguments.parse_argument("by_customer", |value, name| {
                parse_per_customer(value, name, DISCOUNT_RULE)
            })?,
            by_group_plan: arguments.parse_argument("by_group_plan", |value, name| {
                parse_per_group_plan(value, name, DISCOUNT_RULE, view)
            })?,
        })
    }

    fn plan(
        &self,
        view: &ToolContext<'_>,
        discounts: Discounts,
    ) -> Result<PlannedCall<Promotion>, Rejection> {
        let mut promotion = view.settings().promotion.clone();
        replace_if_given(&mut promotion.global, discounts.global);
        replace_if_given(&mut promotion.by_group, discounts.by_group);
        replace_if_given(&mut promotion.by_customer, discounts.by_customer);
        replace_if_given(&mut promotion.by_group_plan, discounts.by_group_plan);
        Ok(PlannedCall::with_settings_change(SettingsChange::Promotion(promotion.clone()), promotion))
    }
}
