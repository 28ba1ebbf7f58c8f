//! Commands that show the state of the company, and help on tools and tables.

use std::collections::BTreeSet;

use serde_json::{Value, json};

use super::super::describe_seed;
use super::super::grammar::{Argument, ParseError};
use super::super::response::CommandResponse;
use super::help::not_found_message;
use super::{Interpreter, argument_error, find_tool};
use novamind_base::formatting::{dollars, grouped_number, signed_dollars};
use novamind_base::similar_names;
use novamind_database::Interface;
use novamind_record::trajectory::record::Reversal;
use novamind_report::action_items::{ActionItem, ActionTarget, action_items};
use novamind_report::cost_review::{identical_plan_lines, income_and_cost_lines};
use novamind_report::deals::describe_deals;
use novamind_report::decision_periods::describe_change;
use novamind_report::describe_cash_change;
use novamind_report::parameters::describe_recorded_parameter_change;
use novamind_report::peak::PeakProjection;
use novamind_report::research::late_project_lines;
use novamind_session::{EnterpriseNames, JournalEntry, SettingChange, undone_call_lines};
use novamind_tools::ParameterNumbers;
use novamind_tools::describe::{self, ToolDocument, document_tool};

impl Interpreter {
    pub(super) fn dashboard(&self) -> CommandResponse {
        let dashboard = self.session.company().dashboard();
        let data = json!({ "day": self.session.day(), "dashboard": dashboard });
        CommandResponse::success("dashboard", dashboard, data)
    }

    pub(super) fn status(&self) -> CommandResponse {
        let seen = self.session.company().observe();
        let runway = match (seen.ended, seen.runway.describe_weeks()) {
            (Some(_), _) => String::new(),
            (None, Some(weeks)) => format!(" · runway {weeks} weeks"),
            (None, None) => " · runway to the last day".to_owned(),
        };
        let ended = seen.ended.map_or(String::new(), |ended| format!("ended: {}\n", ended.id()));
        let tier = self.session.settings().core.capacity_tier;
        let units = self
            .session
            .company()
            .tool_limits()
            .capacities
            .iter()
            .find(|capacity_tier| capacity_tier.tier == tier)
            .map(|capacity| capacity.units);
        let next = PeakProjection::from_weeks(self.session.weeks()).zip(units);
        let capacity = next
            .map_or(String::new(), |(next, units)| format!("{}\n", next.describe(u32::from(tier), units)));
        let text = format!(
            "run {}{} · {}\nday {} of {} · week {}\n{ended}cash {} ({}){runway}\n\
             subscribers {} · seats {}\n{capacity}waiting threads {} · running research {} · changes this week {}",
            seen.run,
            describe_seed(seen.seed),
            seen.mode,
            seen.day,
            seen.last_day,
            seen.week,
            dollars(seen.cash),
            describe_cash_change(&seen),
            grouped_number(f64::from(seen.subscribers), 0),
            grouped_number(f64::from(seen.seats), 0),
            seen.waiting.len(),
            seen.running_research,
            seen.changes.len() + seen.purchases.len(),
        );
        let data = json!({
            "run": seen.run,
            "mode": seen.mode,
            "day": seen.day,
            "days": seen.last_day,
            "week": seen.week,
            "ended": seen.ended,
            "score": seen.score,
            "cash": seen.cash,
            "cash_change": seen.cash_change,
            "runway_weeks": seen.runway_weeks,
            "individual_subscribers": seen.subscribers,
            "enterprise_seats": seen.seats,
            "waiting_threads": seen.waiting.len(),
            "running_research": seen.running_research,
            "next_peak_at_last_growth": next.map(|(next, _)| next.next_peak()),
            "changes": seen.changes.len() + seen.purchases.len(),
        });
        CommandResponse::success("status", text, data)
    }

    pub(super) fn action_needed(&self) -> CommandResponse {
        let needs = action_items(&self.session);
        let row = |need: &ActionItem| {
            let call = match &need.target {
                ActionTarget::Call(tool, arguments) if !arguments.is_null() => {
                    json!({ "tool": tool, "args": arguments })
                }
                _ => Value::Null,
            };
            json!({
                "problem": need.problem.id(),
                "text": need.text,
                "proposal": need.proposal,
                "call": call,
                "at_risk": need.at_risk.round(),
                "urgent": need.is_urgent,
            })
        };
        let data = json!({ "needs": needs.iter().map(row).collect::<Vec<Value>>() });
        let mut lines: Vec<String> = needs.iter().flat_map(action_item_lines).collect();
        if lines.is_empty() {
            lines.push("no action needed".to_owned());
        }
        CommandResponse::success("needs", lines.join("\n"), data)
    }

    pub(super) fn changes(&self) -> CommandResponse {
        let seen = self.session.company().observe();
        let mut lines: Vec<String> = seen.changes.iter().map(describe_setting_change).collect();
        lines.extend(seen.purchases.iter().cloned());
        if lines.is_empty() {
            lines.push("no changes since the last week".to_owned());
        }
        lines.extend(identical_plan_lines(&seen));
        lines.extend(late_project_lines(&seen));
        lines.extend(income_and_cost_lines(&seen));
        let data = json!({
            "changes": seen.changes,
            "purchases": seen.purchases,
            "alike_plans": seen.alike_plans,
            "late_projects": seen.late_projects,
            "committed_per_day": seen.committed,
            "one_time_costs": -seen.booked_since.sum(),
            "runway_weeks": seen.runway_weeks,
        });
        CommandResponse::success("changes", lines.join("\n"), data)
    }

    pub(super) fn history(&self, count: u32) -> CommandResponse {
        let journal = self.session.journal();
        let undone = undone_call_lines(journal);
        let last = &journal[journal.len().saturating_sub(count as usize)..];
        let mut text: String = last
            .iter()
            .map(|entry| {
                format_history_entry(entry, &undone, self.session.company().enterprise_names()) + "\n"
            })
            .collect();
        if text.is_empty() {
            text = "no actions yet".to_owned();
        }
        CommandResponse::success("history", text, json!({ "entries": last }))
    }
}

/// Formats a problem as one line, and the tool call that addresses the problem as a second line.
fn action_item_lines(need: &ActionItem) -> Vec<String> {
    let mark = if need.is_urgent { '!' } else { '-' };
    let risk = grouped_number(need.at_risk, 0);
    let mut lines = vec![format!("{mark} {} ${risk} of the next four weeks is at risk.", need.describe())];
    if let ActionTarget::Call(tool, arguments) = &need.target
        && !arguments.is_null()
    {
        lines.push(format!("  {tool} {arguments}"));
    }
    lines
}

/// Formats a changed setting as one line.
pub fn describe_setting_change(change: &SettingChange) -> String {
    describe_change(change)
}

fn format_history_entry(entry: &JournalEntry, undone: &BTreeSet<u64>, names: &EnterpriseNames) -> String {
    match entry {
        JournalEntry::Call { seq, day, tool, args, reversal } => {
            let remark = match reversal {
                _ if undone.contains(seq) => " (undone)",
                Some(Reversal::Undoes(_)) => " (undo)",
                Some(Reversal::Redoes(_)) => " (redo)",
                None => "",
            };
            let words = describe_deals(*tool, args, names).unwrap_or_else(|| args.to_string());
            format!("day {day:>3}  {tool}{remark} {words}")
        }
        JournalEntry::Parameter { day, key, old, new, from_day, .. } => {
            format!("day {day:>3}  {}", describe_recorded_parameter_change(key, [old, new], *from_day))
        }
        JournalEntry::Advance { day, rationale, forecasts, filled_naively } => {
            let naive = if filled_naively[0] { ", naive" } else { "" };
            let next = forecasts.first().map_or(String::new(), |first| dollars(first.point));
            format!("day {day:>3}  next week: {rationale} (expects {next} in a week{naive})")
        }
        JournalEntry::Week { figures } => {
            format!(
                "day {:>3}  cash {} ({})",
                figures.day,
                dollars(figures.cash),
                signed_dollars(figures.cash_change)
            )
        }
    }
}

/// Executes `tools [NAME]`.
pub(super) fn tools_command(
    name: Option<&str>,
    arguments: &[Argument],
    numbers: &ParameterNumbers,
) -> Result<CommandResponse, ParseError> {
    let Some(name) = name else {
        let all = novamind_tools::CATALOGUE.iter().map(|tool| document_tool(tool.spec(), numbers));
        let all: Vec<ToolDocument> = all.collect();
        return Ok(CommandResponse::success(
            "tools",
            novamind_tools::catalogue::list_by_module(),
            json!({ "tools": all }),
        ));
    };
    let tool = novamind_tools::find(name)
        .or_else(|| find_tool(name))
        .or_else(|| novamind_tools::catalogue::find_code(name))
        .ok_or_else(|| {
            argument_error(
                arguments,
                &not_found_message(
                    "no tool",
                    name,
                    novamind_tools::catalogue::similar_tools(name),
                    "type tools to list all tools",
                ),
            )
        })?;
    Ok(CommandResponse::success(
        "tools",
        describe::format_manual(tool.spec(), numbers),
        json!(document_tool(tool.spec(), numbers)),
    ))
}

/// Executes `tables [NAME]`.
pub(super) fn tables_command(
    name: Option<&str>,
    arguments: &[Argument],
    interface: Interface,
) -> Result<CommandResponse, ParseError> {
    let tables = novamind_database::tables(interface);
    let Some(name) = name else {
        let width = tables.iter().map(|table| table.name.len()).max().unwrap_or(0);
        let line =
            |table: &novamind_database::Table| format!("{:<width$}  {}\n", table.name, table.description);
        let text: String = tables.iter().map(line).collect();
        return Ok(CommandResponse::success("tables", text, json!({ "tables": tables })));
    };
    let table = novamind_database::table(interface, name).ok_or_else(|| {
        let names = tables.iter().map(|table| table.name.as_str());
        argument_error(
            arguments,
            &not_found_message(
                "no table",
                name,
                similar_names(name, names),
                "type tables to list all tables",
            ),
        )
    })?;
    Ok(CommandResponse::success("tables", table.describe(), json!(table)))
}
