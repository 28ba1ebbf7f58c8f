use serde::Serialize;
use serde_json::{Map, Value};

use super::super::arguments::Arguments;
use super::super::{
    Argument, ArgumentKind, EffectTiming, NumberRange, PlannedCall, Rejection, ResultField, Tool,
    ToolContext, ToolId, ToolKind, ToolModule, ToolSpec,
};
use novamind_world::settings::{CoreSettings, Settings, SettingsChange};

/// The tool `set_capacity_tier`, which sets the rented capacity tier.
pub struct SetCapacityTier;

const TIER_RANGE: NumberRange = NumberRange::between(0.0, 7.0);

static SPEC: ToolSpec = ToolSpec {
    id: ToolId::SetCapacityTier,
    code: "CAP",
    module: ToolModule::Infrastructure,
    kind: ToolKind::Setting,
    summary: "Rent a capacity tier; usage above it overloads the service",
    arguments: &[Argument {
        name: "tier",
        alias: Some("capacity_tier"),
        kind: ArgumentKind::Integer(TIER_RANGE),
        required: true,
        unit: "tier",
        description: "capacity tier 0 to 7; any jump is allowed and free",
    }],
    has_own_unknown_code: false,
    unnamed_argument: None,
    effect_timing: EffectTiming::NextDay,
    effect: "Overload is usage above capacity. It slows the service, makes outages more likely and lowers the \
             quality that subscribers perceive.",
    cost: "the price of the tier on every simulated day",
    written_tables: &["config_history"],
    rejection_codes: &["capacity_out_of_range"],
    result_fields: &[
        ResultField { name: "tier", kind: "integer", description: "0 to 7" },
        ResultField { name: "capacity_units", kind: "integer", description: "units/day" },
        ResultField { name: "cost_per_day", kind: "integer", description: "$/day" },
    ],
    example: r#"{"tier": 2}"#,
};

/// Rented capacity after a call.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct RentedCapacity {
    /// Rented capacity tier, 0 to 7.
    pub tier: u8,
    /// Capacity in units per day.
    pub capacity_units: u32,
    /// Rent in dollars per day.
    pub cost_per_day: u32,
}

impl Tool for SetCapacityTier {
    type Args = u8;
    type Answer = RentedCapacity;

    fn spec(&self) -> &'static ToolSpec {
        &SPEC
    }

    fn current_arguments(&self, settings: &Settings) -> Map<String, Value> {
        Map::from_iter([("tier".to_owned(), Value::from(settings.core.capacity_tier))])
    }

    fn parse_arguments(&self, _: &ToolContext<'_>, arguments: &Arguments) -> Result<u8, Rejection> {
        let given = arguments.get("tier").or_else(|| arguments.get("capacity_tier")).unwrap_or(&Value::Null);
        TIER_RANGE.parse_integer(given).ok_or_else(|| {
            Rejection::for_field(
                "tier",
                "capacity_out_of_range",
                format!("the capacity tier must be {}", TIER_RANGE.describe()),
            )
        })
    }

    fn plan(
        &self,
        view: &ToolContext<'_>,
        capacity_tier: u8,
    ) -> Result<PlannedCall<RentedCapacity>, Rejection> {
        let core = CoreSettings { capacity_tier, ..view.settings().core };
        let tier = view.params().capacity_tier(capacity_tier);
        let answer = RentedCapacity {
            tier: tier.tier,
            capacity_units: tier.capacity_units,
            cost_per_day: tier.cost_per_day,
        };
        Ok(PlannedCall::with_settings_change(SettingsChange::Core(core), answer))
    }
}
