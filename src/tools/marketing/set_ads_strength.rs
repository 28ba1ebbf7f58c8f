use serde_json::{Map, Value};

use super::super::arguments::{Amount, Arguments, as_data, number, per_customer, per_group, replace};
use super::super::{
    Argument, ArgumentKind, Key, Kind, Module, Output, Planned, Range, Refusal, Spec, Tool, ToolId, View,
    When,
};
use novamind_base::notation::json_number;
use novamind_world::settings::{AdsStrength, PerCustomer, PerGroup, Settings, SettingsChange};

/// The tool `set_ads_strength`.
pub struct SetAdsStrength;

const STRENGTH: Amount = Amount {
    code: "strength_out_of_range",
    words: "must be an ads strength between 0 and 1",
    range: Range::SHARE,
};

const fn level(name: &'static str, kind: ArgumentKind, doc: &'static str) -> Argument {
    Argument { name, alias: None, kind, required: false, unit: "0 to 1", doc }
}

static SPEC: Spec = Spec {
    id: ToolId::SetAdsStrength,
    code: "INAD",
    module: Module::Marketing,
    kind: Kind::Setting,
    summary: "Set the strength of in-app advertising; the scopes add up",
    arguments: &[
        level("global_strength", ArgumentKind::Number(Range::SHARE), "for all subscribers"),
        level("by_group", ArgumentKind::Map(Key::Group, Range::SHARE), "for subscribers of a group"),
        level("by_customer", ArgumentKind::Map(Key::Customer, Range::SHARE), "for single customers"),
    ],
    own_unknown: false,
    whole: None,
    when: When::NextDay,
    effect: "Every subscriber who sees ads brings a small revenue each day but perceives lower quality. The \
             effective load is log{ads.log_curve_k:+1}(1 + {ads.log_curve_k} s) of the summed strength s, so a small strength already brings much \
             of the revenue of full strength.",
    cost: "nothing; perceived quality falls",
    writes: &["config_overrides"],
    refusals: &[
        "global_strength_out_of_range",
        "not_a_map",
        "unknown_group",
        "strength_out_of_range",
        "customer_not_integer",
    ],
    returns: &[
        Output { name: "global", kind: "number", doc: "0 to 1" },
        Output { name: "by_group", kind: "map group -> number", doc: "0 to 1" },
        Output { name: "by_customer", kind: "map customer -> number", doc: "0 to 1" },
    ],
    example: r#"{"global_strength": 0.05}"#,
};

/// Scopes that a call sets; the others do not change.
pub struct AdStrengths {
    global: Option<f64>,
    by_group: Option<PerGroup>,
    by_customer: Option<PerCustomer>,
}

impl Tool for SetAdsStrength {
    type Args = AdStrengths;
    type Answer = AdsStrength;

    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn current(&self, settings: &Settings) -> Map<String, Value> {
        let ads = &settings.ads_strength;
        Map::from_iter([
            ("global_strength".to_owned(), json_number(ads.global)),
            ("by_group".to_owned(), as_data(&ads.by_group)),
            ("by_customer".to_owned(), as_data(&ads.by_customer)),
        ])
    }

    fn read(&self, view: &View<'_>, arguments: &Arguments) -> Result<AdStrengths, Refusal> {
        Ok(AdStrengths {
            global: arguments.read("global_strength", |value, name| {
                number(value).filter(|strength| Range::SHARE.holds(*strength)).ok_or_else(|| {
                    let message = "the global ads strength must be between 0 and 1";
                    Refusal::at(name, "global_strength_out_of_range", message)
                })
            })?,
            by_group: arguments.read("by_group", |value, name| per_group(value, name, STRENGTH, view))?,
            by_customer: arguments.read("by_customer", |value, name| per_customer(value, name, STRENGTH))?,
        })
    }

    fn plan(&self, view: &View<'_>, given: AdStrengths) -> Result<Planned<AdsStrength>, Refusal> {
        let mut ads = view.settings().ads_strength.clone();
        replace(&mut ads.global, given.global);
        replace(&mut ads.by_group, given.by_group);
        replace(&mut ads.by_customer, given.by_customer);
        Ok(Planned::setting(SettingsChange::AdsStrength(ads.clone()), ads))
    }
}
