use serde::Serialize;

use super::super::arguments::{Arguments, serialize_whole_as_integer};
use super::super::{
    EffectTiming, PlannedCall, Rejection, ResultField, Tool, ToolContext, ToolId, ToolKind, ToolModule,
    ToolSpec,
};
use novamind_base::formatting::round_to;
use novamind_world::params::ResearchTier;

/// The tool `list_research_projects`, which returns the R&D tiers with their progress.
pub struct ListResearchProjects;

static SPEC: ToolSpec = ToolSpec {
    id: ToolId::ListResearchProjects,
    code: "PROJ",
    module: ToolModule::Research,
    kind: ToolKind::Read,
    summary: "List the twenty R&D tiers with price, means and progress",
    arguments: &[],
    has_own_unknown_code: false,
    unnamed_argument: None,
    effect_timing: EffectTiming::Never,
    effect: "",
    cost: "nothing",
    written_tables: &[],
    rejection_codes: &[],
    result_fields: &[ResultField {
        name: "tiers",
        kind: "list of {tier, name, cost, mean_days, mean_quality_boost, in_progress, completed, total_quality_boost}",
        description: "$; mean days and quality before the minimum duration and gain apply; counts of projects",
    }],
    example: "{}",
};

/// R&D tiers with their progress.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct ResearchProjects {
    /// Tiers, cheapest first.
    pub tiers: Vec<ResearchTierFacts>,
}

/// Price, means and progress of an R&D tier.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ResearchTierFacts {
    /// Number of the R&D tier, 1 to 20.
    pub tier: u8,
    /// Name of the R&D tier.
    pub name: String,
    /// Price of a project in dollars.
    pub cost: u32,
    /// Mean duration of a project in days, before the minimum duration applies.
    #[serde(serialize_with = "serialize_whole_as_integer")]
    pub mean_days: f64,
    /// Mean quality gain of a project before the minimum gain applies.
    pub mean_quality_boost: f64,
    /// Number of running projects.
    pub in_progress: usize,
    /// Number of completed projects.
    pub completed: usize,
    /// Total quality gain of the completed projects.
    #[serde(serialize_with = "serialize_whole_as_integer")]
    pub total_quality_boost: f64,
}

impl Tool for ListResearchProjects {
    type Args = ();
    type Answer = ResearchProjects;

    fn spec(&self) -> &'static ToolSpec {
        &SPEC
    }

    fn parse_arguments(&self, _: &ToolContext<'_>, _: &Arguments) -> Result<(), Rejection> {
        Ok(())
    }

    fn plan(&self, view: &ToolContext<'_>, (): ()) -> Result<PlannedCall<ResearchProjects>, Rejection> {
        let tiers = view.params().research_tier.iter().map(|tier| tier_facts(tier, view)).collect();
        Ok(PlannedCall::read_only(ResearchProjects { tiers }))
    }
}

fn tier_facts(tier: &ResearchTier, view: &ToolContext<'_>) -> ResearchTierFacts {
    let decimals = view.params().development.rd_report_decimals;
    let tier_projects = || view.world().product.research.iter().filter(|project| project.tier == tier.tier);
    let completed = || tier_projects().filter(|project| project.completed_day.is_some());
    ResearchTierFacts {
        tier: tier.tier,
        name: tier.name.clone(),
        cost: tier.cost,
        mean_days: tier.mean_days,
        mean_quality_boost: tier.mean_quality_boost,
        in_progress: tier_projects().count() - completed().count(),
        completed: completed().count(),
        total_quality_boost: round_to(completed().map(|project| project.boost).sum(), decimals),
    }
}
