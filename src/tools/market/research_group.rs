use serde::Serialize;

use super::super::arguments::Arguments;
use super::super::research::check_affordable;
use super::super::{
    Argument, ArgumentKind, EffectTiming, NumberRange, PlannedCall, Rejection, ResultField, Tool,
    ToolContext, ToolId, ToolKind, ToolModule, ToolSpec,
};
use super::parse_group_argument;
use novamind_world::command::{Command, ResolvedCommand};
use novamind_world::identifiers::Group;
use novamind_world::market::studies::default_target;

/// The tool `research_group`, which orders a market study of a known group.
pub struct ResearchGroup;

static SPEC: ToolSpec = ToolSpec {
    id: ToolId::ResearchGroup,
    code: "STUDY",
    module: ToolModule::Market,
    kind: ToolKind::Purchase,
    summary: "Order a study of a known group for better or fresh estimates",
    arguments: &[
        Argument {
            name: "group_id",
            alias: None,
            kind: ArgumentKind::Text,
            required: true,
            unit: "group",
            description: "a known group, for instance S1",
        },
        Argument {
            name: "target_level",
            alias: None,
            kind: ArgumentKind::Integer(NumberRange::between(2.0, 5.0)),
            required: false,
            unit: "level",
            description: "level {group_research.min_target_level} to {group_research.max_target_level}; if left out, the \
                  present level, at least {group_research.min_target_level}. Levels can be skipped; the present \
                  level is a refresh",
        },
    ],
    has_own_unknown_code: false,
    unnamed_argument: None,
    effect_timing: EffectTiming::AtCompletion,
    effect: "On its completion day the level rises to the target, and get_group_insights describes the market of that day. \
             Level 2 takes {info_level.2.delay_days} days, 3 takes {info_level.3.delay_days}, 4 takes \
             {info_level.4.delay_days}, 5 takes {info_level.5.delay_days}; the errors are at most \
             {info_level.2.noise:100}, {info_level.3.noise:100}, {info_level.4.noise:100} and {info_level.5.noise:%}. \
             One study of a group at a time; studies of several groups run side by side.",
    cost: "{info_level.2.cost:$} for level 2, {info_level.3.cost:$} for 3, {info_level.4.cost:$} for 4, \
           {info_level.5.cost:$} for 5, at once",
    written_tables: &["ledger", "group_info_levels", "notifications"],
    rejection_codes: &[
        "group_not_discovered",
        "level_out_of_range",
        "no_downgrade",
        "study_in_progress",
        "insufficient_funds",
    ],
    result_fields: &[
        ResultField { name: "group_id", kind: "text", description: "the group" },
        ResultField { name: "new_level", kind: "integer", description: "new level" },
        ResultField { name: "expected_completion_day", kind: "integer", description: "day" },
        ResultField { name: "is_refresh", kind: "boolean", description: "whether the level stays the same" },
    ],
    example: r#"{"group_id": "E2", "target_level": 3}"#,
};

/// Arguments of a call that orders a market study.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StudyOrder {
    group: Group,
    target: u8,
}

/// A market study that a call ordered.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct OrderedStudy {
    /// Group that is studied.
    pub group_id: Group,
    /// Study level of the group after the completion, 2 to 5.
    pub new_level: u8,
    /// Day on which the study is completed.
    pub expected_completion_day: u32,
    /// Whether the study only refreshes the estimates at the same level.
    pub is_refresh: bool,
}

/// Parses the target level. As in the released simulator, a level that is written as 3.0 is invalid.
fn parse_target_level(arguments: &Arguments, group: Group, view: &ToolContext<'_>) -> Result<u8, Rejection> {
    let research = &view.params().group_research;
    let level = view.world().market.knowledge[group].level;
    let Some(given) = arguments.get("target_level") else { return Ok(default_target(level, research)) };
    let range = u64::from(research.min_target_level)..=u64::from(research.max_target_level);
    let target = given.as_u64().filter(|target| range.contains(target)).ok_or_else(|| {
        let message = format!("the level must be 2, 3, 4 or 5, not {given}; {group} is at level {level}");
        Rejection::for_field("target_level", "level_out_of_range", message)
    })? as u8;
    if target < level {
        let message = format!(
            "group {group} is already at level {level}; order the same level for a refresh, or a higher one \
             for better estimates"
        );
        return Err(Rejection::for_field("target_level", "no_downgrade", message));
    }
    Ok(target)
}

impl Tool for ResearchGroup {
    type Args = StudyOrder;
    type Answer = OrderedStudy;

    fn spec(&self) -> &'static ToolSpec {
        &SPEC
    }

    fn parse_arguments(
        &self,
        view: &ToolContext<'_>,
        arguments: &Arguments,
    ) -> Result<StudyOrder, Rejection> {
        let group = parse_group_argument(arguments, view)?;
        Ok(StudyOrder { group, target: parse_target_level(arguments, group, view)? })
    }

    fn plan(
        &self,
        view: &ToolContext<'_>,
        order: StudyOrder,
    ) -> Result<PlannedCall<OrderedStudy>, Rejection> {
        let StudyOrder { group, target } = order;
        if let Some(study) = view.world().market.running_study(group) {
            let message =
                format!("a study of {group} runs until day {}; order the next one after that", study.due_day);
            return Err(Rejection::for_field("group_id", "study_in_progress", message));
        }
        check_affordable(view.params().study_level(target).cost, view)?;
        Ok(PlannedCall::with_draws(Command::ResearchGroup(group, target), |resolved| match resolved {
            ResolvedCommand::ResearchGroup(study, _) => Some(OrderedStudy {
                group_id: study.group,
                new_level: study.target,
                expected_completion_day: study.due_day,
                is_refresh: study.is_refresh(),
            }),
            _ => None,
        }))
    }
}
