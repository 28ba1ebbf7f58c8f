use serde_json::{Value, json};

use super::super::arguments::Arguments;
use super::super::{Kind, Module, Output, Refusal, Spec, Tool, ToolId, View, When};
use crate::notation::json_number;
use crate::world::command::{Command, ResolvedCommand};
use crate::world::market::economy::round_to;
use crate::world::params::ResearchTier;

/// Lists the R&D tiers.
pub struct ListResearchProjects;

static SPEC: Spec = Spec {
    id: ToolId::ListResearchProjects,
    code: "PROJ",
    module: Module::Research,
    kind: Kind::Read,
    summary: "List the twenty R&D tiers with price, means and progress",
    arguments: &[],
    own_unknown: false,
    whole: None,
    when: When::Never,
    effect: "",
    cost: "nothing",
    writes: &[],
    refusals: &[],
    returns: &[Output {
        name: "tiers",
        kind: "list of {tier, name, cost, mean_days, mean_quality_boost, in_progress, completed, total_quality_boost}",
        doc: "$, days, quality; counts of projects",
    }],
    example: "{}",
};

impl Tool for ListResearchProjects {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn plan(&self, _: &View<'_>, _: &Arguments) -> Result<Command, Refusal> {
        Ok(Command::None)
    }

    fn answer(&self, view: &View<'_>, _: &Arguments, _: &ResolvedCommand) -> Value {
        let decimals = view.params().development.rd_report_decimals;
        let entry = |tier: &ResearchTier| {
            let own = || view.world().product.research.iter().filter(|project| project.tier == tier.tier);
            let completed = || own().filter(|project| project.completed_day.is_some());
            json!({
                "tier": tier.tier,
                "name": tier.name,
                "cost": tier.cost,
                "mean_days": json_number(tier.mean_days),
                "mean_quality_boost": tier.mean_quality_boost,
                "in_progress": own().count() - completed().count(),
                "completed": completed().count(),
                "total_quality_boost": json_number(round_to(completed().map(|project| project.boost).sum(), decimals)),
            })
        };
        json!({ "tiers": view.params().research_tier.iter().map(entry).collect::<Vec<_>>() })
    }
}
