use serde::Serialize;
use serde_json::Value;

use super::super::arguments::{Arguments, plain};
use super::super::{
    Argument, ArgumentKind, Kind, Module, Output, Planned, Range, Refusal, Spec, Tool, ToolId, View, When,
};
use super::affordable;
use novamind_base::notation::round_to;
use novamind_world::command::{Command, ResolvedCommand};
use novamind_world::events::Project;

/// The tool `start_research_project`.
pub struct StartResearchProject;

const TIERS: Range = Range::between(1.0, 20.0);

static SPEC: Spec = Spec {
    id: ToolId::StartResearchProject,
    code: "RND",
    module: Module::Research,
    kind: Kind::Purchase,
    summary: "Buy an R&D project; its duration and gain are known at once",
    arguments: &[Argument {
        name: "tier",
        alias: None,
        kind: ArgumentKind::Integer(TIERS),
        required: true,
        unit: "tier",
        doc: "R&D tier 1 to 20; list_research_projects shows prices and means",
    }],
    own_unknown: false,
    whole: None,
    when: When::AtCompletion,
    effect: "On its completion day the gain is permanently added to the quality for all groups. Projects take \
             at least {development.rd_min_duration_days} days; tiers are independent, can be repeated, and \
             run in parallel, one per tier at a time.",
    cost: "the price of the tier, at once",
    writes: &["ledger", "research_projects"],
    refusals: &["rd_tier_unknown", "rd_in_progress", "insufficient_funds"],
    returns: &[
        Output {
            name: "project_id",
            kind: "text",
            doc: "t<tier>_<n>, where n counts the starts of the tier",
        },
        Output { name: "tier", kind: "integer", doc: "1 to 20" },
        Output { name: "name", kind: "text", doc: "name of the tier" },
        Output { name: "cost", kind: "integer", doc: "$" },
        Output { name: "expected_completion_day", kind: "integer", doc: "day" },
        Output { name: "expected_duration_days", kind: "integer", doc: "days" },
        Output {
            name: "expected_quality_boost",
            kind: "number",
            doc: "quality, {development.rd_report_decimals} decimals",
        },
    ],
    example: r#"{"tier": 2}"#,
};

/// A started project.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StartedProject {
    /// Identifier.
    pub project_id: String,
    /// Tier.
    pub tier: u8,
    /// Name of the tier.
    pub name: String,
    /// Dollars paid.
    #[serde(serialize_with = "plain")]
    pub cost: f64,
    /// Completion day.
    pub expected_completion_day: u32,
    /// Duration in days.
    pub expected_duration_days: u32,
    /// Quality gain.
    pub expected_quality_boost: f64,
}

impl Tool for StartResearchProject {
    type Args = u8;
    type Answer = StartedProject;

    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn read(&self, _: &View<'_>, arguments: &Arguments) -> Result<u8, Refusal> {
        let given = arguments.get("tier").unwrap_or(&Value::Null);
        TIERS.whole(given).ok_or_else(|| {
            let message = format!("R&D tier {given} does not exist; the tiers are {}", TIERS.words());
            Refusal::at("tier", "rd_tier_unknown", message)
        })
    }

    fn plan(&self, view: &View<'_>, tier: u8) -> Result<Planned<StartedProject>, Refusal> {
        let running = |project: &&Project| project.tier == tier && project.completed_day.is_none();
        if let Some(project) = view.world().product.research.iter().find(running) {
            let message = format!("tier {tier} is already running until day {}", project.due_day);
            return Err(Refusal::at("tier", "rd_in_progress", message));
        }
        let facts = view.params().research(tier);
        affordable(f64::from(facts.cost), view)?;
        let (name, decimals) = (facts.name.clone(), view.params().development.rd_report_decimals);
        Ok(Planned::drawing(Command::StartResearch(tier), move |resolved| match resolved {
            ResolvedCommand::StartResearch(project, cost) => Some(StartedProject {
                project_id: project.id(),
                tier: project.tier,
                name,
                cost: *cost,
                expected_completion_day: project.due_day,
                expected_duration_days: project.due_day - project.started_day,
                expected_quality_boost: round_to(project.boost, decimals),
            }),
            _ => None,
        }))
    }
}
