//! Readings: what the company looks like, and what there is to know about commands, tools and tables.

use std::collections::BTreeSet;

use serde_json::{Value, json};

use super::super::answers::Answer;
use super::super::grammar::{Argument, Problem};
use super::super::seed_in_words;
use super::{COMMANDS, Interpreter, NEXT, problem, rules, tool_called, words};
use crate::database;
use crate::glossary;
use crate::notation::{dollars, grouped, nearest, signed_dollars};
use crate::report::chapters::change_in_words;
use crate::report::deals::deals_in_words;
use crate::report::funnel::{Funnel, funnels};
use crate::report::needs::{Need, Place, needs};
use crate::report::peak::PeakProjection;
use crate::report::research::late_lines;
use crate::report::review::{alike_lines, money_lines};
use crate::rules::AskingThread;
use crate::session::{Bands, Change, CompanyNames, JournalEntry, Numbers, Reversal, undone_calls};
use crate::tools::describe::{self, ToolDocument, document};
use crate::tools::{self, Kind};

impl Interpreter {
    pub(super) fn dashboard(&self) -> Answer {
        let dashboard = self.session.dashboard();
        let data = json!({ "day": self.session.day(), "dashboard": dashboard });
        Answer::done("dashboard", dashboard, data)
    }

    pub(super) fn status(&self) -> Answer {
        let seen = self.session.observe();
        let runway =
            seen.weeks_of_cash().map_or("to the last day".to_owned(), |weeks| format!("{weeks} weeks"));
        let ended = seen.ended.map_or(String::new(), |ended| format!("ended: {}\n", ended.id()));
        let tier = self.session.settings().core.capacity_tier;
        let units = self.session.terms().capacities.iter().find(|own| own.tier == tier).map(|own| own.units);
        let next = PeakProjection::of(self.session.weeks()).zip(units);
        let capacity = next
            .map_or(String::new(), |(next, units)| format!("{}\n", next.in_words(u32::from(tier), units)));
        let text = format!(
            "run {}{} · {}\nday {} of {} · week {}\n{ended}cash {} ({} over the last week) · runway {runway}\n\
             subscribers {} · seats {}\n{capacity}waiting threads {} · running research {} · changes this week {}",
            seen.run,
            seed_in_words(seen.seed),
            seen.mode,
            seen.day,
            seen.last_day,
            seen.week,
            dollars(seen.cash),
            signed_dollars(seen.cash_change),
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
            lines.push("nothing needs you".to_owned());
        }
        Answer::done("needs", lines.join("\n"), data)
    }

    pub(super) fn inbox(&mut self) -> Answer {
        let waiting = match AskingThread::all(&mut self.session) {
            Ok((waiting, _)) => waiting,
            Err(refusal) => return Answer::refused("inbox", refusal),
        };
        let funnel = |own: &Funnel| {
            json!({
                "group": own.group.id(),
                "came": own.came,
                "no_plan_good_enough": own.turned_away(),
                "asked": own.asked,
                "signed": own.signed,
            })
        };
        let funnels_so_far: Vec<Value> = funnels(&self.session).iter().map(funnel).collect();
        let names = self.session.company_names();
        let threads: Vec<Value> = waiting.iter().map(|thread| thread.row(names)).collect();
        let data = json!({ "threads": threads, "funnels": funnels_so_far });
        if waiting.is_empty() {
            let mut lines = vec!["no threads waiting".to_owned()];
            lines.extend(funnels(&self.session).iter().map(Funnel::in_words));
            return Answer::done("inbox", lines.join("\n"), data);
        }
        let call = Answer::call("inbox", data.clone());
        Answer::done("inbox", call.as_text().trim_start_matches("ok inbox\n").to_owned(), data)
    }

    pub(super) fn changes(&self) -> Answer {
        let seen = self.session.observe();
        let mut lines: Vec<String> = seen.changes.iter().map(change).collect();
        lines.extend(seen.purchases.iter().cloned());
        if lines.is_empty() {
            lines.push("nothing has changed since the last week".to_owned());
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
            .map(|entry| entry_line(entry, &undone, self.session.company_names()) + "\n")
            .collect();
        if text.is_empty() {
            text = "nothing has been done yet".to_owned();
        }
        Answer::done("history", text, json!({ "entries": last }))
    }
}

/// A need in one line, and the call that would mend it in another.
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

/// A change as one line.
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

/// `help [NAME]`.
pub(super) fn help(name: Option<&str>, arguments: &[Argument], numbers: &Numbers) -> Result<Answer, Problem> {
    let Some(name) = name else {
        let lines: Vec<&str> =
            COMMANDS.iter().map(|(_, line)| *line).filter(|line| !line.is_empty()).collect();
        let tools: Vec<&str> = callable().collect();
        let text = format!(
            "{}\n\nEvery tool is a command too: {}\nFor instance: set_prices A=16 B=34 C=70\n\
             A week as agents call it: next_week {{\"rationale\": \"WHY\", \"predictions\": {{\"cash_1wk\": \
             {{\"point\": 950000, \"lower\": 900000, \"upper\": 990000}}, …}}}} (help next shows all of it)\n\
             help NAME explains one of them, and explain TERM says what a word means.",
            lines.join("\n"),
            tools.join(", ")
        );
        return Ok(Answer::done("help", text, json!({ "commands": lines, "tools": tools })));
    };
    if name == "rules" {
        return Ok(Answer::done("help", rules::IN_FULL.to_owned(), json!({ "command": rules::IN_FULL })));
    }
    if NEXT.contains(&name) {
        let text = next_in_full();
        return Ok(Answer::done("help", text.clone(), json!({ "command": text })));
    }
    if let Some((_, line)) = COMMANDS.iter().find(|(command, line)| *command == name && !line.is_empty()) {
        return Ok(Answer::done("help", (*line).to_owned(), json!({ "command": line })));
    }
    if tools::find(name).is_some() || tool_called(name).is_some() {
        return self::tools(Some(name), arguments, numbers);
    }
    if database::table(name).is_some() {
        return tables(Some(name), arguments);
    }
    if let Ok(found) = glossary::find(name) {
        return Ok(words::answer("help", found, numbers));
    }
    let names = COMMANDS.iter().map(|(name, _)| *name).chain(callable());
    let names = names.chain(database::tables().iter().map(|table| table.name.as_str()));
    Err(problem(arguments, &not_there("nothing", name, nearest(name, names))))
}

/// The forms of the command that runs a week, and what its naive forecasts are worth.
fn next_in_full() -> String {
    format!(
        "next \"WHY\" naive                         naive forecasts\n\
         next \"WHY\" P L U  P L U  P L U  P L U    point, lower, upper of cash in 1, 4, 12 and 26 weeks\n\
         next_week {{\"rationale\": \"WHY\", \"predictions\": {{\"cash_1wk\": {{\"point\": 950000, \"lower\": 900000, \
         \"upper\": 990000}}, \"cash_4wk\": …, \"cash_12wk\": …, \"cash_26wk\": …}}}}\n\
         next                                     asks, at a terminal\n\
         Naive forecasts: income, compute and lead costs go on as in the last four weeks, at the costs set now. {}.",
        Bands::shipped().coverage_in_words()
    )
}

/// `tools [NAME]`.
pub(super) fn tools(
    name: Option<&str>,
    arguments: &[Argument],
    numbers: &Numbers,
) -> Result<Answer, Problem> {
    let Some(name) = name else {
        let all = tools::CATALOGUE.iter().map(|tool| document(tool.spec(), numbers));
        let all: Vec<ToolDocument> = all.collect();
        return Ok(Answer::done("tools", describe::overview(), json!({ "tools": all })));
    };
    let tool = tools::find(name)
        .or_else(|| tool_called(name))
        .or_else(|| tools::catalogue::find_code(name))
        .ok_or_else(|| problem(arguments, &not_there("no tool", name, tools::catalogue::nearest(name))))?;
    Ok(Answer::done("tools", describe::manual(tool.spec(), numbers), json!(document(tool.spec(), numbers))))
}

/// `tables [NAME]`.
pub(super) fn tables(name: Option<&str>, arguments: &[Argument]) -> Result<Answer, Problem> {
    let Some(name) = name else {
        let width = database::tables().iter().map(|table| table.name.len()).max().unwrap_or(0);
        let line = |table: &database::Table| format!("{:<width$}  {}\n", table.name, table.description);
        let text: String = database::tables().iter().map(line).collect();
        return Ok(Answer::done("tables", text, json!({ "tables": database::tables() })));
    };
    let table = database::table(name).ok_or_else(|| {
        let names = database::tables().iter().map(|table| table.name.as_str());
        problem(arguments, &not_there("no table", name, nearest(name, names)))
    })?;
    Ok(Answer::done("tables", table.describe(), json!(table)))
}

fn callable() -> impl Iterator<Item = &'static str> {
    tools::CATALOGUE
        .iter()
        .map(|tool| tool.spec())
        .filter(|spec| spec.kind != Kind::Time)
        .map(|spec| spec.name())
}

fn not_there(what: &str, name: &str, near: Vec<&str>) -> String {
    let near = if near.is_empty() { String::new() } else { format!("; did you mean {}?", near.join(" or ")) };
    format!("there is {what} called {name}{near}")
}
