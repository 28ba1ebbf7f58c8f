use serde_json::{Value, json};

use super::super::arguments::{Arguments, integer};
use super::super::{
    Argument, ArgumentKind, Kind, Module, Output, Range, Refusal, Spec, Tool, ToolId, View, When,
};
use super::affordable;
use crate::notation::json_number;
use crate::world::command::{Command, ResolvedCommand};
use crate::world::market::economy::round_to;

/// Buys an R&D project.
pub struct StartResearchProject;

static SPEC: Spec = Spec {
    id: ToolId::StartResearchProject,
    code: "RND",
    module: Module::Research,
    kind: Kind::Purchase,
    summary: "Buy an R&D project; its duration and gain are known at once",
    arguments: &[Argument {
        name: "tier",
        alias: None,
        kind: ArgumentKind::Integer(Range::between(1.0, 20.0)),
        required: true,
        unit: "tier",
        doc: "R&D tier 1 to 20; list_research_projects shows prices and means",
    }],
    own_unknown: false,
    whole: None,
    when: When::AtCompletion,
    effect: "On its completion day the gain is added to the quality of every group, for good. Projects take \
             at least {development.rd_min_duration_days} days; tiers are independent, can be repeated, and \
             run in parallel, one per tier at a time.",
    cost: "the price of the tier, at once",
    writes: &["ledger", "research_projects"],
    refusals: &["rd_tier_unknown", "rd_in_progress", "insufficient_funds"],
    returns: &[
        Output { name: "project_id", kind: "text", doc: "t<tier>_<n>, n counts the starts of the tier" },
        Output { name: "tier", kind: "integer", doc: "1 to 20" },
        Output { name: "name", kind: "text", doc: "name of the tier" },
        Output { name: "cost", kind: "integer", doc: "$" },
        Output { name: "expected_completion_day", kind: "integer", doc: "day" },
        Output { name: "expected_duration_days", kind: "integer", doc: "days" },
        Output { name: "expected_quality_boost", kind: "number", doc: "quality, 4 decimals" },
    ],
    example: r#"{"tier": 2}"#,
};

fn tier_of(arguments: &Arguments) -> Result<u8, Refusal> {
    let given = arguments.get("tier").unwrap_or(&Value::Null);
    integer(given).filter(|tier| (1..=20).contains(tier)).map(|tier| tier as u8).ok_or_else(|| {
        let message = format!("R&D tier {given} does not exist; the tiers are 1 to 20");
        Refusal::at("tier", "rd_tier_unknown", message)
    })
}

impl Tool for StartResearchProject {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn plan(&self, view: &View<'_>, arguments: &Arguments) -> Result<Command, Refusal> {
        let tier = tier_of(arguments)?;
        let running = |p: &&crate::world::events::Project| p.tier == tier && p.completed_day.is_none();
        if let Some(project) = view.world().product.research.iter().find(running) {
            let message = format!("tier {tier} is already running until day {}", project.due_day);
            return Err(Refusal::at("tier", "rd_in_progress", message));
        }
        affordable(f64::from(view.params().research(tier).cost), view)?;
        Ok(Command::StartResearch(tier))
    }

    fn answer(&self, view: &View<'_>, _: &Arguments, resolved: &ResolvedCommand) -> Value {
        let ResolvedCommand::StartResearch(project, cost) = resolved else { return Value::Null };
        let decimals = view.params().development.rd_report_decimals;
        json!({
            "project_id": project.id(),
            "tier": project.tier,
            "name": view.params().research(project.tier).name,
            "cost": json_number(*cost),
            "expected_completion_day": project.due_day,
            "expected_duration_days": project.due_day - project.started_day,
            "expected_quality_boost": round_to(project.boost, decimals),
        })
    }
}
