use indexmap::IndexMap;
use serde::Serialize;

use super::super::arguments::Arguments;
use super::super::{
    EffectTiming, PlannedCall, REMARK_TYPE, Rejection, ResultField, Tool, ToolContext, ToolId, ToolKind,
    ToolModule, ToolSpec,
};
use novamind_world::params::Params;

/// The tool `get_cost_info`, which returns the costs of model tiers and capacity tiers.
pub struct GetCostInfo;

static SPEC: ToolSpec = ToolSpec {
    id: ToolId::GetCostInfo,
    code: "COST",
    module: ToolModule::Infrastructure,
    kind: ToolKind::Read,
    summary: "Show unit cost and quality of the model tiers, and the capacity prices",
    arguments: &[],
    has_own_unknown_code: false,
    unnamed_argument: None,
    effect_timing: EffectTiming::Never,
    effect: "",
    cost: "nothing",
    written_tables: &[],
    rejection_codes: &[],
    result_fields: &[
        ResultField {
            name: "model_tiers",
            kind: "map tier -> {cost_per_usage_unit, quality_multiplier, class}",
            description: "$ per unit; exact",
        },
        ResultField {
            name: "capacity_tiers",
            kind: "map tier -> {capacity_units, cost_per_day}",
            description: "units/day, $/day",
        },
        ResultField {
            name: "note",
            kind: REMARK_TYPE,
            description: "definition of a unit, the neutral model tier, and the billing of both",
        },
    ],
    example: "{}",
};

/// Costs of models and capacity.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct PriceList {
    /// Facts about each model tier, by tier.
    pub model_tiers: IndexMap<u8, ModelTierFacts>,
    /// Facts about each capacity tier, by tier.
    pub capacity_tiers: IndexMap<u8, CapacityTierFacts>,
    /// Text that defines a unit and explains the billing.
    pub note: String,
}

/// The cost and quality of a model tier.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ModelTierFacts {
    /// Compute cost in dollars per unit.
    pub cost_per_usage_unit: f64,
    /// Factor by which the tier multiplies product quality.
    pub quality_multiplier: f64,
    /// Class of the model, as the parameters name it.
    pub class: String,
}

/// The size and cost of a capacity tier.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct CapacityTierFacts {
    /// Capacity in units per day.
    pub capacity_units: u32,
    /// Rent in dollars per day.
    pub cost_per_day: u32,
}

fn cost_note(params: &Params) -> String {
    let neutral = params.model_tier.iter().find(|tier| tier.quality_multiplier == 1.0);
    let neutral = neutral.map_or_else(String::new, |tier| format!("; tier {} = 1.0×", tier.tier));
    format!(
        "1 unit = 1K tokens{neutral}. Compute costs units used times the unit cost of the plan's model; capacity is paid \
         every day."
    )
}

impl Tool for GetCostInfo {
    type Args = ();
    type Answer = PriceList;

    fn spec(&self) -> &'static ToolSpec {
        &SPEC
    }

    fn parse_arguments(&self, _: &ToolContext<'_>, _: &Arguments) -> Result<(), Rejection> {
        Ok(())
    }

    fn plan(&self, view: &ToolContext<'_>, (): ()) -> Result<PlannedCall<PriceList>, Rejection> {
        let models = view.params().model_tier.iter().map(|tier| {
            let facts = ModelTierFacts {
                cost_per_usage_unit: tier.unit_cost,
                quality_multiplier: tier.quality_multiplier,
                class: tier.class.clone(),
            };
            (tier.tier, facts)
        });
        let capacities = view.params().capacity_tier.iter().map(|tier| {
            let facts =
                CapacityTierFacts { capacity_units: tier.capacity_units, cost_per_day: tier.cost_per_day };
            (tier.tier, facts)
        });
        Ok(PlannedCall::read_only(PriceList {
            model_tiers: models.collect(),
            capacity_tiers: capacities.collect(),
            note: cost_note(view.params()),
        }))
    }
}
