use serde::Serialize;

use super::super::arguments::{Arguments, plain};
use super::super::{Kind, Module, Output, Planned, Refusal, Spec, Tool, ToolId, View, When};
use novamind_base::notation::round_to;
use novamind_world::params::ResearchTier;

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
        doc: "$; days and quality on average before the least duration and the least gain apply; counts of projects",
    }],
    example: "{}",
};

/// What can be researched, and how far it is.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct ResearchProjects {
    /// The tiers, the cheapest first.
    pub tiers: Vec<ResearchTierFacts>,
}

/// A tier of R&D.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ResearchTierFacts {
    /// Its number.
    pub tier: u8,
    /// What people call it.
    pub name: String,
    /// Dollars.
    pub cost: u32,
    /// Days that a project takes on average before the least duration applies.
    #[serde(serialize_with = "plain")]
    pub mean_days: f64,
    /// Quality that a project adds on average before the least gain applies.
    pub mean_quality_boost: f64,
    /// Projects that run.
    pub in_progress: usize,
    /// Projects that are done.
    pub completed: usize,
    /// Quality that those have added.
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
