use indexmap::IndexMap;
use serde::Serialize;

use super::super::arguments::Arguments;
use super::super::{Kind, Module, Output, Planned, REMARK, Refusal, Spec, Tool, ToolId, View, When};
use novamind_world::params::Params;

/// The tool `get_cost_info`.
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
        Output {
            name: "note",
            kind: REMARK,
            doc: "definition of a unit, the neutral model tier, and the billing of both",
        },
    ],
    example: "{}",
};

/// Costs of models and capacity.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct PriceList {
    /// Model tiers by number.
    pub model_tiers: IndexMap<u8, ModelTierFacts>,
    /// Capacity tiers by number.
    pub capacity_tiers: IndexMap<u8, CapacityTierFacts>,
    /// Definition of a unit, and the billing.
    pub note: String,
}

/// A model tier.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ModelTierFacts {
    /// Dollars per unit.
    pub cost_per_usage_unit: f64,
    /// Factor on product quality.
    pub quality_multiplier: f64,
    /// Kind of model.
    pub class: String,
}

/// A capacity tier.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct CapacityTierFacts {
    /// Capacity, units per day.
    pub capacity_units: u32,
    /// Dollars per day.
    pub cost_per_day: u32,
}

fn note(params: &Params) -> String {
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

    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn read(&self, _: &View<'_>, _: &Arguments) -> Result<(), Refusal> {
        Ok(())
    }

    fn plan(&self, view: &View<'_>, (): ()) -> Result<Planned<PriceList>, Refusal> {
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
        Ok(Planned::reading(PriceList {
            model_tiers: models.collect(),
            capacity_tiers: capacities.collect(),
            note: note(view.params()),
        }))
    }
}
