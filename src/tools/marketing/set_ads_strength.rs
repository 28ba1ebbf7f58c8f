use serde_json::{Map, Value};

use super::super::arguments::{Amount, Arguments, number, per_customer, per_group};
use super::super::{
    Argument, ArgumentKind, Key, Kind, Module, Output, Range, Refusal, Spec, Tool, ToolId, View, When,
};
use super::super::{as_data, family_of};
use crate::notation::json_number;
use crate::world::command::{Command, ResolvedCommand};
use crate::world::settings::Settings;
use crate::world::settings::SettingsChange;

/// Sets the load of in-app advertising.
pub struct SetAdsStrength;

const STRENGTH: Amount = Amount {
    code: "strength_out_of_range",
    words: "must be an ad load between 0 and 1",
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
    summary: "Set how much advertising the product itself shows; the scopes add up",
    arguments: &[
        level("global_strength", ArgumentKind::Number(Range::SHARE), "for everybody"),
        level("by_group", ArgumentKind::Map(Key::Group, Range::SHARE), "for subscribers of a group"),
        level("by_customer", ArgumentKind::Map(Key::Customer, Range::SHARE), "for single customers"),
    ],
    own_unknown: false,
    whole: None,
    when: When::NextDay,
    effect: "Every subscriber who sees ads earns you a little each day but perceives less quality. The \
             effective load is log10(1 + 9 s) of the summed strength s, so a small load already earns much \
             of what a full one does.",
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

impl Tool for SetAdsStrength {
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

    fn plan(&self, view: &View<'_>, arguments: &Arguments) -> Result<Command, Refusal> {
        let mut ads = view.settings().ads_strength.clone();
        if let Some(value) = arguments.get("global_strength") {
            ads.global = number(value).filter(|strength| Range::SHARE.holds(*strength)).ok_or_else(|| {
                let message = "the global ad load must be between 0 and 1";
                Refusal::at("global_strength", "global_strength_out_of_range", message)
            })?;
        }
        if let Some(value) = arguments.get("by_group") {
            ads.by_group = per_group(value, "by_group", STRENGTH, view)?;
        }
        if let Some(value) = arguments.get("by_customer") {
            ads.by_customer = per_customer(value, "by_customer", STRENGTH)?;
        }
        Ok(Command::Set(SettingsChange::AdsStrength(ads)))
    }

    fn answer(&self, _: &View<'_>, _: &Arguments, resolved: &ResolvedCommand) -> Value {
        family_of(resolved)
    }
}
