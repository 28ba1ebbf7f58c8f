//! `check CALL`: previews the effect and cost of a call.

use serde_json::{Value, json};

use super::super::answers::Answer;
use super::super::grammar::{self, Line, Problem};
use super::{COMMANDS, Interpreter, change_line, read_arguments, tool_called, unknown};
use novamind_base::notation::percent;
use novamind_report::count;
use novamind_report::peak::peak_beside_tier;
use novamind_report::plan_margins::{Lever, PlanTerms, Sales, margin_sentences};
use novamind_report::research::outlook_lines;
use novamind_report::review::terms_line;
use novamind_session::Preview;
use novamind_session::identifiers::ByPlan;
use novamind_tools::ToolId;

impl Interpreter {
    /// Parses the call in a line that begins with `check`, so that columns are those of the line.
    pub(super) fn check(&self, line: &str) -> Result<Answer, Problem> {
        let call = line.replacen("check", "     ", 1);
        let Line::Call { word, column, arguments } = grammar::parse(&call)? else {
            let text = "check needs a call, for example check set_prices B=30".to_owned();
            return Err(Problem { text, column: line.chars().count() });
        };
        let tool = tool_called(&word).ok_or_else(|| no_tool(&word, column))?;
        let arguments = read_arguments(tool, &arguments)?;
        Ok(match self.session.check(tool.spec().name(), &arguments) {
            Ok(preview) => self.told(&preview, &arguments),
            Err(refusal) => Answer::refused("check", refusal),
        })
    }

    fn told(&self, preview: &Preview, arguments: &Value) -> Answer {
        let mut lines = vec![format!("{} would be accepted; it was not made", preview.tool)];
        lines.extend(preview.changes.iter().map(|change| format!("  {}", change_line(change))));
        lines.extend(terms_line(preview).map(|line| format!("  {line}")));
        let notes = preview
            .research
            .iter()
            .flat_map(outlook_lines)
            .chain(self.capacity(preview.tool, arguments))
            .chain(self.study(preview.tool, arguments))
            .chain(self.margins(preview.tool, arguments));
        lines.extend(notes.map(|note| format!("  {note}")));
        Answer::done("check", lines.join("\n"), json!(preview))
    }

    /// Compares a capacity tier with the busiest day of the last week.
    fn capacity(&self, tool: ToolId, arguments: &Value) -> Option<String> {
        let tier = arguments.get("tier").filter(|_| tool == ToolId::SetCapacityTier)?.as_u64()?;
        let terms = self.session.company().tool_limits();
        let own = terms.capacities.iter().find(|own| u64::from(own.tier) == tier)?;
        Some(peak_beside_tier(self.session.weeks(), u32::from(own.tier), own.units))
    }

    /// Describes the level that a study reaches.
    fn study(&self, tool: ToolId, arguments: &Value) -> Option<String> {
        let group = arguments.get("group_id").filter(|_| tool == ToolId::ResearchGroup)?.as_str()?;
        let terms = self.session.company().tool_limits();
        let now = self
            .session
            .company()
            .estimates()
            .into_iter()
            .find(|own| own.group.id().eq_ignore_ascii_case(group))?;
        let given = arguments.get("target_level").and_then(Value::as_u64);
        let target = given.map_or(now.level.max(terms.targets.0), |target| target as u8);
        let level = terms.level(target)?;
        let from = match target == now.level {
            true => format!("stays at level {target}, with fresh estimates"),
            false => format!("goes from level {} to level {target}", now.level),
        };
        Some(format!(
            "{} {from}: estimates off by at most {}, after {}",
            now.group,
            percent(level.noise, 0),
            count(level.days, "day")
        ))
    }

    /// Returns the margins after a call. Returns an empty list if its tool does not affect them.
    fn margins(&self, tool: ToolId, arguments: &Value) -> Vec<String> {
        let Some(lever) = Lever::of(tool) else { return Vec::new() };
        let core = self.session.settings().core;
        let now = ByPlan::from_fn(|plan| PlanTerms {
            price: core.prices[plan],
            tier: core.tiers[plan],
            quota: core.quotas[plan].units(),
        });
        let models = self.session.company().tool_limits().unit_costs();
        match Sales::of(&self.session) {
            Ok(sales) => {
                margin_sentences(&sales, &lever.apply(now, arguments), lever, &models, self.session.day())
            }
            Err(refusal) => vec![format!("no margins: {}", refusal.message)],
        }
    }
}

/// Returns the problem of a word that is not a tool.
fn no_tool(word: &str, column: usize) -> Problem {
    if !COMMANDS.iter().any(|(name, _)| *name == word) {
        return unknown(word, column);
    }
    let text = format!(
        "check takes the call of a tool, but {word} is a command; changes lists the settings, and check set_prices B=30 \
         is an example of a call"
    );
    Problem { text, column }
}
