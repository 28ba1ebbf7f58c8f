use serde::Serialize;
use serde_json::{Map, Value};

use super::super::arguments::Arguments;
use super::super::{
    Argument, ArgumentKind, Kind, Module, Output, Planned, Range, Refusal, Spec, Tool, ToolId, View, When,
};
use novamind_world::settings::{CoreSettings, Settings, SettingsChange};

/// The tool `set_capacity_tier`.
pub struct SetCapacityTier;

const TIERS: Range = Range::between(0.0, 7.0);

static SPEC: Spec = Spec {
    id: ToolId::SetCapacityTier,
    code: "CAP",
    module: Module::Infrastructure,
    kind: Kind::Setting,
    summary: "Rent a capacity tier; usage above it overloads the service",
    arguments: &[Argument {
        name: "tier",
        alias: Some("capacity_tier"),
        kind: ArgumentKind::Integer(TIERS),
        required: true,
        unit: "tier",
        doc: "capacity tier 0 to 7; any jump is allowed and free",
    }],
    own_unknown: false,
    whole: None,
    when: When::NextDay,
    effect: "Overload is usage above capacity. It slows the service, makes outages more likely and lowers the \
             quality that subscribers perceive.",
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

/// Rented capacity.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct RentedCapacity {
    /// Tier.
    pub tier: u8,
    /// Capacity, units per day.
    pub capacity_units: u32,
    /// Dollars per day.
    pub cost_per_day: u32,
}

impl Tool for SetCapacityTier {
    type Args = u8;
    type Answer = RentedCapacity;

    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn current(&self, settings: &Settings) -> Map<String, Value> {
        Map::from_iter([("tier".to_owned(), Value::from(settings.core.capacity_tier))])
    }

    fn read(&self, _: &View<'_>, arguments: &Arguments) -> Result<u8, Refusal> {
        let given = arguments.get("tier").or_else(|| arguments.get("capacity_tier")).unwrap_or(&Value::Null);
        TIERS.whole(given).ok_or_else(|| {
            Refusal::at(
                "tier",
                "capacity_out_of_range",
                format!("the capacity tier must be {}", TIERS.words()),
            )
        })
    }

    fn plan(&self, view: &View<'_>, capacity_tier: u8) -> Result<Planned<RentedCapacity>, Refusal> {
        let core = CoreSettings { capacity_tier, ..view.settings().core };
        let tier = view.params().capacity(capacity_tier);
        let answer = RentedCapacity {
            tier: tier.tier,
            capacity_units: tier.capacity_units,
            cost_per_day: tier.cost_per_day,
        };
        Ok(Planned::setting(SettingsChange::Core(core), answer))
    }
}
