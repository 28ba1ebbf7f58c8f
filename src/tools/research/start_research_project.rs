use serde::Serialize;
use serde_json::Value;

use super::super::arguments::{Arguments, serialize_whole_as_integer};
use super::super::{
    Argument, ArgumentKind, EffectTiming, NumberRange, PlannedCall, Rejection, ResultField, Tool,
    ToolContext, ToolId, ToolKind, ToolModule, ToolSpec,
};
use super::check_affordable;
use novamind_base::formatting::round_to;
use novamind_world::command::{Command, ResolvedCommand};
use novamind_world::events::Project;

/// The tool `start_research_project`, which buys an R&D project.
pub struct StartResearchProject;

const TIER_RANGE: NumberRange = NumberRange::between(1.0, 20.0);

static SPEC: ToolSpec = ToolSpec {
    id: ToolId::StartResearchProject,
    code: "RND",
    module: ToolModule::Research,
    kind: ToolKind::Purchase,
    summary: "Buy an R&D project; its duration and gain are known at once",
    arguments: &[Argument {
        name: "tier",
        alias: None,
        kind: ArgumentKind::Integer(TIER_RANGE),
        required: true,
        unit: "tier",
        description: "R&D tier 1 to 20; list_research_projects shows prices and means",
    }],
    has_own_unknown_code: false,
    unnamed_argument: None,
    effect_timing: EffectTiming::AtCompletion,
    effect: "On its completion day the gain is permanently added to the quality for all groups. Projects take \
             at least {development.rd_min_duration_days} days; tiers are independent, can be repeated, and \
             run in parallel, one per tier at a time.",
    cost: "the price of the tier, at once",
    written_tables: &["ledger", "research_projects"],
    rejection_codes: &["rd_tier_unknown", "rd_in_progress", "insufficient_funds"],
    result_fields: &[
        ResultField {
            name: "project_id",
            kind: "text",
            description: "t<tier>_<n>, where n counts the starts of the tier",
        },
        ResultField { name: "tier", kind: "integer", description: "1 to 20" },
        ResultField { name: "name", kind: "text", description: "name of the tier" },
        ResultField { name: "cost", kind: "integer", description: "$" },
        ResultField { name: "expected_completion_day", kind: "integer", description: "day" },
        ResultField { name: "expected_duration_days", kind: "integer", description: "days" },
        ResultField {
            name: "expected_quality_boost",
            kind: "number",
            description: "quality, {development.rd_report_decimals} decimals",
        },
    ],
    example: r#"{"tier": 2}"#,
};

/// An R&D project that a call started.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StartedProject {
    /// Identifier `t<tier>_<n>`, where `n` counts the projects started in the tier.
    pub project_id: String,
    /// R&D tier of the project, 1 to 20.
    pub tier: u8,
    /// Name of the R&D tier.
    pub name: String,
    /// Price paid, in dollars.
    #[serde(serialize_with = "serialize_whole_as_integer")]
    pub cost: f64,
    /// Day on which the project is completed.
    pub expected_completion_day: u32,
    /// Duration of the project in days.
    pub expected_duration_days: u32,
    /// Quality gain of the project.
    pub expected_quality_boost: f64,
}

impl Tool for StartResearchProject {
    type Args = u8;
    type Answer = StartedProject;

    fn spec(&self) -> &'static ToolSpec {
        &SPEC
    }

    fn parse_arguments(&self, _: &ToolContext<'_>, arguments: &Arguments) -> Result<u8, Rejection> {
        let given = arguments.get("tier").unwrap_or(&Value::Null);
        TIER_RANGE.parse_integer(given).ok_or_else(|| {
            let message = format!("R&D tier {given} does not exist; the tiers are {}", TIER_RANGE.describe());
            Rejection::for_field("tier", "rd_tier_unknown", message)
        })
    }

    fn plan(&self, view: &ToolContext<'_>, tier: u8) -> Result<PlannedCall<StartedProject>, Rejection> {
        let running = |project: &&Project| project.tier == tier && project.completed_day.is_none();
        if let Some(project) = view.world().product.research.iter().find(running) {
            let message =
                format!("a project of tier {tier} is already running until day {}", project.due_day);
            return Err(Rejection::for_field("tier", "rd_in_progress", message));
        }
        let facts = view.params().research_tier(tier);
        check_affordable(f64::from(facts.cost), view)?;
        let (name, decimals) = (facts.name.clone(), view.params().development.rd_report_decimals);
        Ok(PlannedCall::with_draws(Command::StartResearch(tier), move |resolved| match resolved {
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
