use serde_json::{Map, Value, json};

use super::super::arguments::{Arguments, integer};
use super::super::pricing::core_of;
use super::super::{
    Argument, ArgumentKind, Kind, Module, Output, Range, Refusal, Spec, Tool, ToolId, View, When,
};
use crate::world::command::{Command, ResolvedCommand};
use crate::world::settings::Settings;
use crate::world::settings::SettingsChange;

/// Rents capacity.
pub struct SetCapacityTier;

static SPEC: Spec = Spec {
    id: ToolId::SetCapacityTier,
    code: "CAP",
    module: Module::Infrastructure,
    kind: Kind::Setting,
    summary: "Rent a capacity tier; usage above it overloads the service",
    arguments: &[Argument {
        name: "tier",
        alias: Some("capacity_tier"),
        kind: ArgumentKind::Integer(Range::between(0.0, 7.0)),
        required: true,
        unit: "tier",
        doc: "capacity tier 0 to 7; any jump is allowed and free",
    }],
    own_unknown: false,
    whole: None,
    when: When::NextDay,
    effect: "Overload is the usage above capacity; it slows the service, makes outages likelier and lowers the \
             quality subscribers feel.",
    cost: "the price of the tier on every simulated day",
    writes: &["config_history"],
    refusals: &["capacity_out_of_range"],
    returns: &[
        Output { name: "tier", kind: "integer", doc: "0 to 7" },
        Output { name: "capacity_units", kind: "integer", doc: "units/day" },
        Output { name: "cost_per_day", kind: "integer", doc: "$/day" },
    ],
    example: r#"{"tier": 2}"#,
};

impl Tool for SetCapacityTier {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn current(&self, settings: &Settings) -> Map<String, Value> {
        Map::from_iter([("tier".to_owned(), Value::from(settings.core.capacity_tier))])
    }

    fn plan(&self, view: &View<'_>, arguments: &Arguments) -> Result<Command, Refusal> {
        let given = arguments.get("tier").or_else(|| arguments.get("capacity_tier")).unwrap_or(&Value::Null);
        let mut core = view.settings().core;
        core.capacity_tier = integer(given)
            .filter(|tier| (0..=7).contains(tier))
            .ok_or_else(|| Refusal::at("tier", "capacity_out_of_range", "the capacity tier must be 0 to 7"))?
            as u8;
        Ok(Command::Set(SettingsChange::Core(core)))
    }

    fn answer(&self, view: &View<'_>, _: &Arguments, resolved: &ResolvedCommand) -> Value {
        let tier = view.params().capacity(core_of(resolved, &view.settings().core).capacity_tier);
        json!({ "tier": tier.tier, "capacity_units": tier.capacity_units, "cost_per_day": tier.cost_per_day })
    }
}
