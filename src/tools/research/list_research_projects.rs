use serde::Serialize;

use super::super::arguments::{Arguments, plain};
use super::super::{Kind, Module, Output, Planned, Refusal, Spec, Tool, ToolId, View, When};
use novamind_base::notation::round_to;
use novamind_world::params::ResearchTier;

/// The tool `list_research_projects`.
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
        doc: "$; mean days and quality before the minimum duration and gain apply; counts of projects",
    }],
    example: "{}",
};

/// R&D tiers with their progress.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct ResearchProjects {
    /// Tiers, cheapest first.
    pub tiers: Vec<ResearchTierFacts>,
}

/// An R&D tier.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ResearchTierFacts {
    /// Number.
    pub tier: u8,
    /// Name.
    pub name: String,
    /// Dollars.
    pub cost: u32,
    /// Mean days of a project before the minimum duration applies.
    #[serde(serialize_with = "plain")]
    pub mean_days: f64,
    /// Mean quality gain of a project before the minimum gain applies.
    pub mean_quality_boost: f64,
    /// Running projects.
    pub in_progress: usize,
    /// Completed projects.
    pub completed: usize,
    /// Quality gain of the completed projects.
    #[serde(serialize_with = "plain")]
    pub total_quality_boost: f64,
}

impl Tool for ListResearchProjects {
    type Args = ();
    type Answer = ResearchProjects;

    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn read(&self, _: &View<'_>, _: &Arguments) -> Result<(), Refusal> {
        Ok(())
    }

    fn plan(&self, view: &View<'_>, (): ()) -> Result<Planned<ResearchProjects>, Refusal> {
        let tiers = view.params().research_tier.iter().map(|tier| facts(tier, view)).collect();
        Ok(Planned::reading(ResearchProjects { tiers }))
    }
}

fn facts(tier: &ResearchTier, view: &View<'_>) -> ResearchTierFacts {
    let decimals = view.params().development.rd_report_decimals;
    let own = || view.world().product.research.iter().filter(|project| project.tier == tier.tier);
    let completed = || own().filter(|project| project.completed_day.is_some());
    ResearchTierFacts {
        tier: tier.tier,
        name: tier.name.clone(),
        cost: tier.cost,
        mean_days: tier.mean_days,
        mean_quality_boost: tier.mean_quality_boost,
        in_progress: own().count() - completed().count(),
        completed: completed().count(),
        total_quality_boost: round_to(completed().map(|project| project.boost).sum(), decimals),
    }
}
