use indexmap::IndexMap;
use serde_json::{Map, Value};

use super::super::arguments::{Arguments, as_data, per_channel, per_channel_group, per_group, replace};
use super::super::pricing::{DISCOUNT, global_discount};
use super::super::{
    Argument, ArgumentKind, Key, Kind, Module, Output, Planned, Range, Refusal, Spec, Tool, ToolId, View,
    When,
};
use novamind_base::notation::json_number;
use novamind_world::identifiers::Channel;
use novamind_world::settings::{LeadPromotion, PerGroup, Settings, SettingsChange};

/// The tool `set_lead_promotion`.
pub struct SetLeadPromotion;

const fn scope(name: &'static str, kind: ArgumentKind, doc: &'static str) -> Argument {
    Argument { name, alias: None, kind, required: false, unit: "$/month", doc }
}

static SPEC: Spec = Spec {
    id: ToolId::SetLeadPromotion,
    code: "LPR",
    module: Module::Marketing,
    kind: Kind::Setting,
    summary: "Grant discounts on the first bill of new individuals; the scopes add up",
    arguments: &[
        scope("global_promotion", ArgumentKind::Number(Range::AT_LEAST_ZERO), "for every lead"),
        scope("by_group", ArgumentKind::Map(Key::Group, Range::AT_LEAST_ZERO), "for leads of a group"),
        scope(
            "by_channel",
            ArgumentKind::Map(Key::Channel, Range::AT_LEAST_ZERO),
            "for leads of an ad channel",
        ),
        scope(
            "by_channel_group",
            ArgumentKind::Matrix(Key::Channel, Key::Group, Range::AT_LEAST_ZERO),
            "for a group's leads of an ad channel",
        ),
    ],
    own_unknown: false,
    whole: None,
    when: When::NextDay,
    effect: "Leads choose their plan at the discounted price and pay it when they sign up; from \
             the second bill on, the discount no longer applies. Channel scopes apply only to leads from \
             ads. Enterprises get no discount.",
    cost: "less revenue from first bills",
    writes: &["config_overrides"],
    refusals: &[
        "global_promotion_negative",
        "not_a_map",
        "unknown_group",
        "unknown_channel",
        "promotion_negative",
        "amount_too_large",
    ],
    returns: &[
        Output { name: "global", kind: "number", doc: "$/month" },
        Output { name: "by_group", kind: "map group -> number", doc: "$/month" },
        Output { name: "by_channel", kind: "map channel -> number", doc: "$/month" },
        Output { name: "by_channel_group", kind: "map channel -> map group -> number", doc: "$/month" },
    ],
    example: r#"{"by_channel": {"social_media": 3}}"#,
};

/// Scopes that a call sets; the others do not change.
pub struct LeadDiscounts {
    global: Option<f64>,
    by_group: Option<PerGroup>,
    by_channel: Option<IndexMap<Channel, f64>>,
    by_channel_group: Option<IndexMap<Channel, PerGroup>>,
}

impl Tool for SetLeadPromotion {
    type Args = LeadDiscounts;
    type Answer = LeadPromotion;

    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn current(&self, settings: &Settings) -> Map<String, Value> {
        let promotion = &settings.lead_promotion;
        Map::from_iter([
            ("global_promotion".to_owned(), json_number(promotion.global)),
            ("by_group".to_owned(), as_data(&promotion.by_group)),
            ("by_channel".to_owned(), as_data(&promotion.by_channel)),
            ("by_channel_group".to_owned(), as_data(&promotion.by_channel_group)),
        ])
    }

    fn read(&self, view: &View<'_>, arguments: &Arguments) -> Result<LeadDiscounts, Refusal> {
        Ok(LeadDiscounts {
            global: arguments.read("global_promotion", global_discount)?,
            by_group: arguments.read("by_group", |value, name| per_group(value, name, DISCOUNT, view))?,
            by_channel: arguments.read("by_channel", |value, name| per_channel(value, name, DISCOUNT))?,
            by_channel_group: arguments
                .read("by_channel_group", |value, name| per_channel_group(value, name, DISCOUNT, view))?,
        })
    }

    fn plan(&self, view: &View<'_>, given: LeadDiscounts) -> Result<Planned<LeadPromotion>, Refusal> {
        let mut promotion = view.settings().lead_promotion.clone();
        replace(&mut promotion.global, given.global);
        replace(&mut promotion.by_group, given.by_group);
        replace(&mut promotion.by_channel, given.by_channel);
        replace(&mut promotion.by_channel_group, given.by_channel_group);
        Ok(Planned::setting(SettingsChange::LeadPromotion(promotion.clone()), promotion))
    }
}
