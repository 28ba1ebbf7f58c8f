use serde_json::{Map, Value};

use super::super::arguments::{
    AmountRule, Arguments, json_f64, parse_per_customer, parse_per_group, replace_if_given, to_json,
};
use super::super::{
    Argument, ArgumentKind, EffectTiming, MapKey, NumberRange, PlannedCall, Rejection, ResultField, Tool,
    ToolContext, ToolId, ToolKind, ToolModule, ToolSpec,
};
use novamind_base::formatting::json_number;
use novamind_world::settings::{AdsStrength, PerCustomer, PerGroup, Settings, SettingsChange};

/// The tool `set_ads_strength`, which sets the strength of in-app advertising.
pub struct SetAdsStrength;

const STRENGTH_RULE: AmountRule = AmountRule {
    code: "strength_out_of_range",
    requirement: "must be an ads strength between 0 and 1",
    range: NumberRange::SHARE,
};

const fn strength_argument(name: &'static str, kind: ArgumentKind, doc: &'static str) -> Argument {
    Argument { name, alias: None, kind, required: false, unit: "0 to 1", description: doc }
}

static SPEC: ToolSpec = ToolSpec {
    id: ToolId::SetAdsStrength,
    code: "INAD",
    module: ToolModule::Marketing,
    kind: ToolKind::Setting,
    summary: "Set the strength of in-app advertising; the scopes add up",
    arguments: &[
        strength_argument("global_strength", ArgumentKind::Number(NumberRange::SHARE), "for all subscribers"),
        strength_argument(
            "by_group",
            ArgumentKind::Map(MapKey::Group, NumberRange::SHARE),
            "for subscribers of a group",
        ),
        strength_argument(
            "by_customer",
            ArgumentKind::Map(MapKey::Customer, NumberRange::SHARE),
            "for single customers",
        ),
    ],
    has_own_unknown_code: false,
    unnamed_argument: None,
    effect_timing: EffectTiming::NextDay,
    effect: "Every subscriber who sees ads brings a small revenue each day but perceives lower quality. The \
             effective load is log{ads.log_curve_k:+1}(1 + {ads.log_curve_k} s) of the summed strength s, so a small strength already brings much \
             of the revenue of full strength.",
    cost: "nothing; perceived quality falls",
    written_tables: &["config_overrides"],
    rejection_codes: &[
        "global_strength_out_of_range",
        "not_a_map",
        "unknown_group",
        "strength_out_of_range",
        "customer_not_integer",
    ],
    result_fields: &[
        ResultField { name: "global", kind: "number", description: "0 to 1" },
        ResultField { name: "by_group", kind: "map group -> number", description: "0 to 1" },
        ResultField { name: "by_customer", kind: "map customer -> number", description: "0 to 1" },
    ],
    example: r#"{"global_strength": 0.05}"#,
};

/// Strengths that a call sets. Omitted scopes do not change.
pub struct AdStrengths {
    global: Option<f64>,
    by_group: Option<PerGroup>,
    by_customer: Option<PerCustomer>,
}

impl Tool for SetAdsStrength {
    type Args = AdStrengths;
    type Answer = AdsStrength;

    fn spec(&self) -> &'static ToolSpec {
        &SPEC
    }

    fn current_arguments(&self, settings: &Settings) -> Map<String, Value> {
        let ads = &settings.ads_strength;
        Map::from_iter([
            ("global_strength".to_owned(), json_number(ads.global)),
            ("by_group".to_owned(), to_json(&ads.by_group)),
            ("by_customer".to_owned(), to_json(&ads.by_customer)),
        ])
    }

    fn parse_arguments(
        &self,
        view: &ToolContext<'_>,
        arguments: &Arguments,
    ) -> Result<AdStrengths, Rejection> {
        Ok(AdStrengths {
            global: arguments.parse_argument("global_strength", |value, name| {
                json_f64(value).filter(|strength| NumberRange::SHARE.contains(*strength)).ok_or_else(|| {
                    let message = "the global ads strength must be between 0 and 1";
                    Rejection::for_field(name, "global_strength_out_of_range", message)
                })
            })?,
            by_group: arguments.parse_argument("by_group", |value, name| {
                parse_per_group(value, name, STRENGTH_RULE, view)
            })?,
            by_customer: arguments.parse_argument("by_customer", |value, name| {
                parse_per_customer(value, name, STRENGTH_RULE)
            })?,
        })
    }

    fn plan(
        &self,
        view: &ToolContext<'_>,
        ad_strengths: AdStrengths,
    ) -> Result<PlannedCall<AdsStrength>, Rejection> {
        let mut ads = view.settings().ads_strength.clone();
        replace_if_given(&mut ads.global, ad_strengths.global);
        replace_if_given(&mut ads.by_group, ad_strengths.by_group);
        replace_if_given(&mut ads.by_customer, ad_strengths.by_customer);
        Ok(PlannedCall::with_settings_change(SettingsChange::AdsStrength(ads.clone()), ads))
    }
}
