//! Commands that show the state of the company, and help on tools and tables.

use std::collections::BTreeSet;

use serde_json::{Value, json};

use super::super::answers::Answer;
use super::super::grammar::{Argument, Problem};
use super::super::seed_in_words;
use super::help::not_there;
use super::{Interpreter, problem, tool_called};
use novamind_base::nearest;
use novamind_base::notation::{dollars, grouped, signed_dollars};
use novamind_record::trajectory::record::Reversal;
use novamind_report::cash_change_in_words;
use novamind_report::chapters::change_in_words;
use novamind_report::deals::deals_in_words;
use novamind_report::needs::{Need, Place, needs};
use novamind_report::parameters::entry_in_words;
use novamind_report::peak::PeakProjection;
use novamind_report::research::late_lines;
use novamind_report::review::{alike_lines, money_lines};
use novamind_session::{Change, CompanyNames, JournalEntry, undone_calls};
use novamind_tools::Numbers;
use novamind_tools::describe::{self, ToolDocument, document};

impl Interpreter {
    pub(super) fn dashboard(&self) -> Answer {
        let dashboard = self.session.company().dashboard();
        let data = json!({ "day": self.session.day(), "dashboard": dashboard });
        Answer::done("dashboard", dashboard, data)
    }

    pub(super) fn status(&self) -> Answer {
        let seen = self.session.company().observe();
        let runway =
            seen.weeks_of_cash().map_or("to the last day".to_owned(), |weeks| format!("{weeks} weeks"));
        let ended = seen.ended.map_or(String::new(), |ended| format!("ended: {}\n", ended.id()));
        let tier = self.session.settings().core.capacity_tier;
        let units = self
            .session
            .company()
            .tool_limits()
            .capacities
            .iter()
            .find(|own| own.tier == tier)
            .map(|own| own.units);
        let next = PeakProjection::of(self.session.weeks()).zip(units);
        let capacity = next
            .map_or(String::new(), |(next, units)| format!("{}\n", next.in_words(u32::from(tier), units)));
        let text = format!(
            "run {}{} · {}\nday {} of {} · week {}\n{ended}cash {} ({}) · runway {runway}\n\
             subscribers {} · seats {}\n{capacity}waiting threads {} · running research {} · changes this week {}",
            seen.run,
            seed_in_words(seen.seed),
            seen.mode,
            seen.day,
            seen.last_day,
            seen.week,
            dollars(seen.cash),
            cash_change_in_words(&seen),
            grouped(f64::from(seen.subscribers), 0),
            grouped(f64::from(seen.seats), 0),
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
            "next_peak_at_last_growth": next.map(|(next, _)| next.next()),
            "changes": seen.changes.len() + seen.purchases.len(),
        });
        Answer::done("status", text, data)
    }

    pub(super) fn needs(&self) -> Answer {
        let needs = needs(&self.session);
        let row = |need: &Need| {
            let call = match &need.place {
                Place::Call(tool, arguments) if !arguments.is_null() => {
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
                "urgent": need.urgent,
            })
        };
        let data = json!({ "needs": needs.iter().map(row).collect::<Vec<Value>>() });
        let mut lines: Vec<String> = needs.iter().flat_map(need_lines).collect();
        if lines.is_empty() {
            lines.push("no action needed".to_owned());
        }
        Answer::done("needs", lines.join("\n"), data)
    }

    pub(super) fn changes(&self) -> Answer {
        let seen = self.session.company().observe();
        let mut lines: Vec<String> = seen.changes.iter().map(change).collect();
        lines.extend(seen.purchases.iter().cloned());
        if lines.is_empty() {
            lines.push("no changes since the last week".to_owned());
        }
        lines.extend(alike_lines(&seen));
        lines.extend(late_lines(&seen));
        lines.extend(money_lines(&seen));
        let data = json!({
            "changes": seen.changes,
            "purchases": seen.purchases,
            "alike_plans": seen.alike_plans,
            "late_projects": seen.late_projects,
            "committed_per_day": seen.pace.committed,
            "one_time_costs": -seen.booked_since.sum(),
            "runway_weeks": seen.runway_weeks,
        });
        Answer::done("changes", lines.join("\n"), data)
    }

    pub(super) fn history(&self, count: u32) -> Answer {
        let journal = self.session.journal();
        let undone = undone_calls(journal);
        let last = &journal[journal.len().saturating_sub(count as usize)..];
        let mut text: String = last
            .iter()
            .map(|entry| entry_line(entry, &undone, self.session.company().company_names()) + "\n")
            .collect();
        if text.is_empty() {
            text = "no actions yet".to_owned();
        }
        Answer::done("history", text, json!({ "entries": last }))
    }
}

/// Formats a need as one line, and the call that addresses it as another.
fn need_lines(need: &Need) -> Vec<String> {
    let mark = if need.urgent { '!' } else { '-' };
    let risk = grouped(need.at_risk, 0);
    let mut lines = vec![format!("{mark} {} (${risk} of the next four weeks at risk)", need.in_words())];
    if let Place::Call(tool, arguments) = &need.place
        && !arguments.is_null()
    {
        lines.push(format!("  {tool} {arguments}"));
    }
    lines
}

/// Formats a change as one line.
pub fn change(change: &Change) -> String {
    change_in_words(change)
}

fn entry_line(entry: &JournalEntry, undone: &BTreeSet<u64>, names: &CompanyNames) -> String {
    match entry {
        JournalEntry::Call { seq, day, tool, args, reversal } => {
            let remark = match reversal {
                _ if undone.contains(seq) => " (undone)",
                Some(Reversal::Undoes(_)) => " (undo)",
                Some(Reversal::Redoes(_)) => " (redo)",
                None => "",
            };
            let words = deals_in_words(*tool, args, names).unwrap_or_else(|| args.to_string());
            format!("day {day:>3}  {tool}{remark} {words}")
        }
        JournalEntry::Parameter { day, key, old, new, from_day, .. } => {
            format!("day {day:>3}  {}", entry_in_words(key, [old, new], *from_day))
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

/// `tools [NAME]`.
pub(super) fn tools(
    name: Option<&str>,
    arguments: &[Argument],
    numbers: &Numbers,
) -> Result<Answer, Problem> {
    let Some(name) = name else {
        let all = novamind_tools::CATALOGUE.iter().map(|tool| document(tool.spec(), numbers));
        let all: Vec<ToolDocument> = all.collect();
        return Ok(Answer::done("tools", novamind_tools::catalogue::overview(), json!({ "tools": all })));
    };
    let tool = novamind_tools::find(name)
        .or_else(|| tool_called(name))
        .or_else(|| novamind_tools::catalogue::find_code(name))
        .ok_or_else(|| {
            problem(
                arguments,
                &not_there("no tool", name, novamind_tools::catalogue::nearest(name), "tools lists them"),
            )
        })?;
    Ok(Answer::done("tools", describe::manual(tool.spec(), numbers), json!(document(tool.spec(), numbers))))
}

/// `tables [NAME]`.
pub(super) fn tables(name: Option<&str>, arguments: &[Argument]) -> Result<Answer, Problem> {
    let Some(name) = name else {
        let width = novamind_database::tables().iter().map(|table| table.name.len()).max().unwrap_or(0);
        let line =
            |table: &novamind_database::Table| format!("{:<width$}  {}\n", table.name, table.description);
        let text: String = novamind_database::tables().iter().map(line).collect();
        return Ok(Answer::done("tables", text, json!({ "tables": novamind_database::tables() })));
    };
    let table = novamind_database::table(name).ok_or_else(|| {
        let names = novamind_database::tables().iter().map(|table| table.name.as_str());
        problem(arguments, &not_there("no table", name, nearest(name, names), "tables lists them"))
    })?;
    Ok(Answer::done("tables", table.describe(), json!(table)))
}
