use indexmap::IndexMap;
use serde_json::{Map, Value};

use super::super::arguments::{
    Arguments, parse_per_channel, parse_per_channel_group, parse_per_group, replace_if_given, to_json,
};
use super::super::pricing::{DISCOUNT_RULE, parse_global_discount};
use super::super::{
    Argument, ArgumentKind, EffectTiming, MapKey, NumberRange, PlannedCall, Rejection, ResultField, Tool,
    ToolContext, ToolId, ToolKind, ToolModule, ToolSpec,
};
use novamind_base::formatting::json_number;
use novamind_world::identifiers::Channel;
use novamind_world::settings::{LeadPromotion, PerGroup, Settings, SettingsChange};

/// The tool `set_lead_promotion`, which sets the first-bill discounts.
pub struct SetLeadPromotion;

const fn scope_argument(name: &'static str, kind: ArgumentKind, doc: &'static str) -> Argument {
    Argument { name, alias: None, kind, required: false, unit: "$/month", description: doc }
}

static SPEC: ToolSpec = ToolSpec {
    id: ToolId::SetLeadPromotion,
    code: "LPR",
    module: ToolModule::Marketing,
    kind: ToolKind::Setting,
    summary: "Grant discounts on the first bill of new individuals; the scopes add up",
    arguments: &[
        scope_argument(
            "global_promotion",
            ArgumentKind::Number(NumberRange::AT_LEAST_ZERO),
            "for every lead",
        ),
        scope_argument(
            "by_group",
            ArgumentKind::Map(MapKey::Group, NumberRange::AT_LEAST_ZERO),
            "for leads of a group",
        ),
        scope_argument(
            "by_channel",
            ArgumentKind::Map(MapKey::Channel, NumberRange::AT_LEAST_ZERO),
            "for leads of an ad channel",
        ),
        scope_argument(
            "by_channel_group",
            ArgumentKind::Matrix(MapKey::Channel, MapKey::Group, NumberRange::AT_LEAST_ZERO),
            "for a group's leads of an ad channel",
        ),
    ],
    has_own_unknown_code: false,
    unnamed_argument: None,
    effect_timing: EffectTiming::NextDay,
    effect: "Leads choose their plan at the discounted price and pay it when they sign up; from \
             the second bill on, the discount no longer applies. Channel scopes apply only to leads from \
             ads. Enterprises get no discount.",
    cost: "less revenue from first bills",
    written_tables: &["config_overrides"],
    rejection_codes: &[
        "global_promotion_negative",
        "not_a_map",
        "unknown_group",
        "unknown_channel",
        "promotion_negative",
        "amount_too_large",
    ],
    result_fields: &[
        ResultField { name: "global", kind: "number", description: "$/month" },
        ResultField { name: "by_group", kind: "map group -> number", description: "$/month" },
        ResultField { name: "by_channel", kind: "map channel -> number", description: "$/month" },
        ResultField {
            name: "by_channel_group",
            kind: "map channel -> map group -> number",
            description: "$/month",
        },
    ],
    example: r#"{"by_channel": {"social_media": 3}}"#,
};

/// First-bill discounts that a call sets. Omitted scopes do not change.
pub struct LeadDiscounts {
    global: Option<f64>,
    by_group: Option<PerGroup>,
    by_channel: Option<IndexMap<Channel, f64>>,
    by_channel_group: Option<IndexMap<Channel, PerGroup>>,
}

impl Tool for SetLeadPromotion {
    type Args = LeadDiscounts;
    type Answer = LeadPromotion;

    fn spec(&self) -> &'static ToolSpec {
        &SPEC
    }

    fn current_arguments(&self, settings: &Settings) -> Map<String, Value> {
        let promotion = &settings.lead_promotion;
        Map::from_iter([
            ("global_promotion".to_owned(), json_number(promotion.global)),
            ("by_group".to_owned(), to_json(&promotion.by_group)),
            ("by_channel".to_owned(), to_json(&promotion.by_channel)),
            ("by_channel_group".to_owned(), to_json(&promotion.by_channel_group)),
        ])
    }

    fn parse_arguments(
        &self,
        view: &ToolContext<'_>,
        arguments: &Arguments,
    ) -> Result<LeadDiscounts, Rejection> {
        Ok(LeadDiscounts {
            global: arguments.parse_argument("global_promotion", parse_global_discount)?,
            by_group: arguments.parse_argument("by_group", |value, name| {
                parse_per_group(value, name, DISCOUNT_RULE, view)
            })?,
            by_channel: arguments
                .parse_argument("by_channel", |value, name| parse_per_channel(value, name, DISCOUNT_RULE))?,
            by_channel_group: arguments.parse_argument("by_channel_group", |value, name| {
                parse_per_channel_group(value, name, DISCOUNT_RULE, view)
            })?,
        })
    }

    fn plan(
        &self,
        view: &ToolContext<'_>,
        lead_discounts: LeadDiscounts,
    ) -> Result<PlannedCall<LeadPromotion>, Rejection> {
        let mut promotion = view.settings().lead_promotion.clone();
        replace_if_given(&mut promotion.global, lead_discounts.global);
        replace_if_given(&mut promotion.by_group, lead_discounts.by_group);
        replace_if_given(&mut promotion.by_channel, lead_discounts.by_channel);
        replace_if_given(&mut promotion.by_channel_group, lead_discounts.by_channel_group);
        Ok(PlannedCall::with_settings_change(SettingsChange::LeadPromotion(promotion.clone()), promotion))
    }
}
