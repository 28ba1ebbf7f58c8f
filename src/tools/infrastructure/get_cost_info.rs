use serde_json::{Map, Value, json};

use super::super::arguments::Arguments;
use super::super::{Kind, Module, Output, Refusal, Spec, Tool, ToolId, View, When};
use crate::world::command::{Command, ResolvedCommand};

/// Shows the price list.
pub struct GetCostInfo;

static SPEC: Spec = Spec {
    id: ToolId::GetCostInfo,
    code: "COST",
    module: Module::Infrastructure,
    kind: Kind::Read,
    summary: "Show unit cost and quality of the model tiers, and the capacity prices",
    arguments: &[],
    own_unknown: false,
    whole: None,
    when: When::Never,
    effect: "",
    cost: "nothing",
    writes: &[],
    refusals: &[],
    returns: &[
        Output {
            name: "model_tiers",
            kind: "map tier -> {cost_per_usage_unit, quality_multiplier, class}",
            doc: "$ per unit; exact",
        },
        Output {
            name: "capacity_tiers",
            kind: "map tier -> {capacity_units, cost_per_day}",
            doc: "units/day, $/day",
        },
        Output { name: "note", kind: "text", doc: "how the two are charged" },
    ],
    example: "{}",
};

impl Tool for GetCostInfo {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn plan(&self, _: &View<'_>, _: &Arguments) -> Result<Command, Refusal> {
        Ok(Command::None)
    }

    fn answer(&self, view: &View<'_>, _: &Arguments, _: &ResolvedCommand) -> Value {
        let models: Map<String, Value> = view
            .params()
            .model_tier
            .iter()
            .map(|tier| {
                let facts = json!({
                    "cost_per_usage_unit": tier.unit_cost,
                    "quality_multiplier": tier.quality_multiplier,
                    "class": tier.class,
                });
                (tier.tier.to_string(), facts)
            })
            .collect();
        let capacities: Map<String, Value> = view
            .params()
            .capacity_tier
            .iter()
            .map(|tier| {
                let facts =
                    json!({ "capacity_units": tier.capacity_units, "cost_per_day": tier.cost_per_day });
                (tier.tier.to_string(), facts)
            })
            .collect();
        json!({
            "model_tiers": models,
            "capacity_tiers": capacities,
            "note": "Compute costs units used times the unit cost of the plan's model; capacity is paid every day.",
        })
    }
}
