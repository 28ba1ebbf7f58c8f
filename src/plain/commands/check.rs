//! `check CALL`: previews the effect and cost of a tool call.

use serde_json::{Value, json};

use super::super::grammar::{self, ParseError, ParsedLine};
use super::super::response::CommandResponse;
use super::{
    COMMANDS, Interpreter, describe_setting_change, find_tool, parse_call_arguments, unknown_command,
};
use novamind_base::formatting::percent;
use novamind_report::cost_review::cost_line;
use novamind_report::peak::describe_peak_and_tier;
use novamind_report::plan_margins::{DraftPlanTerms, MarginSetting, PlanSales, margin_sentences};
use novamind_report::pluralize;
use novamind_report::research::outlook_lines;
use novamind_session::Preview;
use novamind_session::identifiers::ByPlan;
use novamind_tools::ToolId;

impl Interpreter {
    /// Parses and previews the tool call in a line that begins with `check`. Errors report columns of the whole line.
    pub(super) fn check_command(&mut self, line: &str) -> Result<CommandResponse, ParseError> {
        let call = line.replacen("check", "     ", 1);
        let ParsedLine::Call { word, column, arguments } = grammar::parse_line(&call)? else {
            let text = "check needs a call, for example check set_prices B=30".to_owned();
            return Err(ParseError { text, column: line.chars().count() });
        };
        let tool = find_tool(&word).ok_or_else(|| not_a_tool_error(&word, column))?;
        let arguments = parse_call_arguments(tool, &arguments)?;
        Ok(match self.session.preview_call(tool.spec().name(), &arguments) {
            Ok(preview) => {
                let offers = self.planned_offers(preview.tool, &arguments);
                self.preview_response(&preview, &arguments, &self.describe_offers(&offers))
            }
            Err(rejection) => CommandResponse::rejected("check", rejection),
        })
    }

    fn preview_response(&self, preview: &Preview, arguments: &Value, offers: &[String]) -> CommandResponse {
        let mut lines = vec![format!("{} would be accepted; nothing was changed", preview.tool)];
        lines.extend(preview.changes.iter().map(|change| format!("  {}", describe_setting_change(change))));
        lines.extend(cost_line(preview).map(|line| format!("  {line}")));
        let notes = preview
            .research
            .iter()
            .flat_map(outlook_lines)
            .chain(self.describe_capacity(preview.tool, arguments))
            .chain(self.describe_study_level(preview.tool, arguments))
            .chain(self.describe_margins(preview.tool, arguments))
            .chain(offers.iter().cloned());
        lines.extend(notes.map(|note| format!("  {note}")));
        CommandResponse::success("check", lines.join("\n"), json!(preview))
    }

    /// Compares a capacity tier with the busiest day of the last week.
    fn describe_capacity(&self, tool: ToolId, arguments: &Value) -> Option<String> {
        let tier = arguments.get("tier").filter(|_| tool == ToolId::SetCapacityTier)?.as_u64()?;
        let terms = self.session.company().tool_limits();
        let capacity_tier = terms.capacities.iter().find(|candidate| u64::from(candidate.tier) == tier)?;
        Some(describe_peak_and_tier(self.session.weeks(), u32::from(capacity_tier.tier), capacity_tier.units))
    }

    /// Describes the study level before and after a market study.
    fn describe_study_level(&self, tool: ToolId, arguments: &Value) -> Option<String> {
        let group = arguments.get("group_id").filter(|_| tool == ToolId::ResearchGroup)?.as_str()?;
        let terms = self.session.company().tool_limits();
        let now = self
            .session
            .company()
            .estimates()
            .into_iter()
            .find(|estimate| estimate.group.id().eq_ignore_ascii_case(group))?;
        let given = arguments.get("target_level").and_then(Value::as_u64);
        let target = given.map_or(now.level.max(terms.targets.0), |target| target as u8);
        let level = terms.study_level(target)?;
        let from = match target == now.level {
            true => format!("stays at level {target}, with fresh estimates"),
            false => format!("goes from level {} to level {target}", now.level),
        };
        Some(format!(
            "{} {from}: estimates off by at most {}, after {}",
            now.group,
            percent(level.noise, 0),
            pluralize(level.days, "day")
        ))
    }

    /// Describes the gross margins after a tool call. Returns an empty list if the tool does not affect margins.
    fn describe_margins(&self, tool: ToolId, arguments: &Value) -> Vec<String> {
        let Some(lever) = MarginSetting::from_tool(tool) else { return Vec::new() };
        let core = self.session.settings().core;
        let now = ByPlan::from_fn(|plan| DraftPlanTerms {
            price: core.prices[plan],
            tier: core.tiers[plan],
            quota: core.quotas[plan].units(),
        });
        let models = self.session.company().tool_limits().unit_costs();
        match PlanSales::load(&self.session) {
            Ok(sales) => {
                margin_sentences(&sales, &lever.apply(now, arguments), lever, &models, self.session.day())
            }
            Err(rejection) => vec![format!("no margins: {}", rejection.message)],
        }
    }
}

/// Returns the error for a word that is not the name of a tool.
fn not_a_tool_error(word: &str, column: usize) -> ParseError {
    if !COMMANDS.iter().any(|(name, _)| *name == grammar::current_name(word)) {
        return unknown_command(word, column);
    }
    let text = format!(
        "check takes a tool call, for example: check set_prices B=30. {word} is a command. To list the changed \
         settings, type: changes"
    );
    ParseError { text, column }
}
