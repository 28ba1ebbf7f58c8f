//! Lines of the journal. The newest week is first, and the actions of a week are in chronological order.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::Value;

use novamind_base::formatting::{compact_number, dollars, grouped_number, short_dollars, signed_dollars};
use novamind_record::figures::WeekFigures;
use novamind_record::trajectory::record::Reversal;
use novamind_report::deals::describe_deals;
use novamind_report::parameters::{describe_recorded_parameter_change, describe_start_day};
use novamind_session::{EnterpriseNames, JournalEntry, ScoredForecast, describe_naive_share, undone_call_lines};
use novamind_tools::{Forecast, ToolKind, ToolSpec};
use novamind_tui::text::format_number;
use novamind_tui::theme::Role;
use novamind_worker::company::DisplayedCompany;

/// A line of the journal.
#[derive(Debug, Clone, PartialEq)]
pub struct JournalLine {
    /// Day of the run to which the line belongs.
    pub day: u32,
    /// Summary that is shown in the list.
    pub text: String,
    /// Display role of the text.
    pub role: Role,
    /// Title of the complete entry.
    pub title: String,
    /// Text of the complete entry.
    pub full_text: String,
    /// Glossary term that explains the line.
    pub term: &'static str,
    /// Query for the source rows of the line, if there are any.
    pub sql: Option<String>,
}

/// The rationale and the forecasts that were submitted before a week.
struct WeekSubmission<'a> {
    day: u32,
    rationale: &'a str,
    forecasts: &'a [Forecast],
    filled_naively: &'a [bool],
}

/// Journal data of a week: the actions before the week, the forecasts and the result.
#[derive(Default)]
struct JournalWeek<'a> {
    calls: Vec<JournalLine>,
    filed: Option<WeekSubmission<'a>>,
    figures: Option<&'a WeekFigures>,
}

/// Returns all lines of the journal.
pub fn journal_lines(company: &DisplayedCompany) -> Vec<JournalLine> {
    let mut groups = vec![JournalWeek::default()];
    let mut settings = KnownSettings::default();
    let undone = undone_call_lines(&company.journal);
    for entry in &company.journal {
        let Some(last) = groups.last_mut() else { continue };
        match entry {
            JournalEntry::Call { .. } => {
                last.calls.extend(call_line(entry, &mut settings, &undone, &company.enterprise_names))
            }
            JournalEntry::Parameter { day, key, old, new, from_day, .. } => {
                last.calls.push(parameter_line(*day, key, [old, new], *from_day));
            }
            JournalEntry::Advance { day, rationale, forecasts, filled_naively } => {
                last.filed = Some(WeekSubmission { day: *day, rationale, forecasts, filled_naively });
            }
            JournalEntry::Week { figures } => {
                last.figures = Some(figures);
                groups.push(JournalWeek::default());
            }
        }
    }
    groups.iter().rev().flat_map(|group| group.lines(company)).collect()
}

impl JournalWeek<'_> {
    fn lines(&self, company: &DisplayedCompany) -> Vec<JournalLine> {
        let Some(head) = self.heading(company) else { return Vec::new() };
        let whole = self.full_text(company, &head);
        let line = |day: u32, text: String, role: Role| JournalLine {
            day,
            text,
            role,
            title: head.clone(),
            full_text: whole.clone(),
            term: "decision-day",
            sql: None,
        };
        let day = self.figures.map_or(company.observation.day, |week| week.day);
        let mut lines = vec![line(day, head.clone(), Role::Strong)];
        if let Some(week) = self.figures {
            lines[0].term = "cash-change";
            // Purchases of a decision day are paid before the following week.
            lines[0].sql = Some(format!(
                "SELECT category, sum(amount) AS amount FROM ledger\nWHERE category <> 'initial_funding' AND CASE\n    \
                 WHEN category IN ('market_research', 'group_research', 'research_project') THEN day >= {from} AND day < {to}\n    \
                 ELSE day > {from} AND day <= {to} END\nGROUP BY 1 ORDER BY 2",
                from = week.day - week.days_run,
                to = week.day
            ));
        }
        if let Some(filed) = &self.filed {
            let words: Vec<&str> = filed.rationale.split_whitespace().collect();
            let why = line(filed.day, format!("  why  {}", words.join(" ")), Role::Text);
            lines.push(JournalLine { term: "rationale", ..why });
            if !filed.forecasts.is_empty() {
                let journal_line = line(filed.day, format!("  forecasts{}", filed.summary(company)), Role::Dim);
                let sql = format!("SELECT * FROM predictions WHERE submit_day = {}", filed.day);
                lines.push(JournalLine { term: "forecast", sql: Some(sql), ..journal_line });
            }
        }
        lines.extend(self.calls.iter().cloned());
        lines
    }

    /// Returns the heading of a week, or `None` for an empty week of a finished run.
    fn heading(&self, company: &DisplayedCompany) -> Option<String> {
        match self.figures {
            Some(week) => {
                let sign = if week.cash_change < 0.0 { '-' } else { '+' };
                Some(format!(
                    "week {} · day {} · cash {} ({sign}${})",
                    week.day.div_ceil(7),
                    week.day,
                    short_dollars(week.cash),
                    compact_number(week.cash_change.abs())
                ))
            }
            None if self.calls.is_empty() && !company.is_running() => None,
            None => {
                let done = match self.calls.len() {
                    0 => "no actions yet".to_owned(),
                    1 => "1 action".to_owned(),
                    count => format!("{count} actions"),
                };
                Some(format!("week {} · now · {done}", company.observation.day / 7 + 1))
            }
        }
    }

    fn full_text(&self, company: &DisplayedCompany, head: &str) -> String {
        let mut parts = vec![head.to_owned()];
        if let Some(filed) = &self.filed {
            parts.push(format!("Rationale of day {}:\n{}", filed.day, filed.rationale));
            parts.push(filed.full_description(company));
        }
        let calls: Vec<&str> = self.calls.iter().map(|line| line.text.as_str()).collect();
        if !calls.is_empty() {
            parts.push(format!("Actions before the week:\n{}", calls.join("\n")));
        }
        if let Some(week) = self.figures {
            parts.push(format!(
                "Result:\n  cash {} ({})\n  subscribers {} (new {}, cancelled {})\n  seats {}\n  payments {} · running costs {}",
                dollars(week.cash),
                signed_dollars(week.cash_change),
                grouped_number(f64::from(week.individual_subscribers), 0),
                grouped_number(f64::from(week.new_individual_subscribers), 0),
                grouped_number(f64::from(week.cancellations), 0),
                grouped_number(f64::from(week.enterprise_seats), 0),
                dollars(week.payments),
                dollars(week.costs),
            ));
        }
        parts.join("\n\n")
    }
}

impl WeekSubmission<'_> {
    /// Returns the forecasts that are due within the run. The others are not asked for.
    fn forecasts_in_run(&self, company: &DisplayedCompany) -> impl Iterator<Item = &Forecast> + use<'_> {
        let days = company.observation.last_day.saturating_sub(self.day);
        self.forecasts.iter().filter(move |forecast| forecast.horizon_days <= days)
    }

    fn summary(&self, company: &DisplayedCompany) -> String {
        let one = |forecast: &Forecast| {
            let filed = ScoredForecast::new(self.day, forecast, &company.weeks);
            let coverage = match filed.outcome {
                Some(_) if filed.is_covered() => " inside",
                Some(_) => " OUTSIDE",
                None => "",
            };
            format!("{} wk {}{coverage}", forecast.horizon_days / 7, short_dollars(forecast.point))
        };
        let all: Vec<String> = self.forecasts_in_run(company).map(one).collect();
        let naively = describe_naive_share(self.filled_naively).map_or(String::new(), |naively| format!(" filled {naively}"));
        format!("{naively}: {}", all.join(" · "))
    }

    fn full_description(&self, company: &DisplayedCompany) -> String {
        let head = format!("{:>8} {:>14} {:>14} {:>14}   {}", "", "low", "point", "high", "outcome");
        let one = |forecast: &Forecast| {
            let filed = ScoredForecast::new(self.day, forecast, &company.weeks);
            let outcome = match filed.outcome {
                Some(cash) => {
                    format!("{} {}", dollars(cash), if filed.is_covered() { "inside" } else { "OUTSIDE" })
                }
                None => format!("on day {}", filed.due_day()),
            };
            format!(
                "{:>5} wk {:>14} {:>14} {:>14}   {outcome}",
                forecast.horizon_days / 7,
                dollars(forecast.lower),
                dollars(forecast.point),
                dollars(forecast.upper)
            )
        };
        let lines: Vec<String> = std::iter::once(head).chain(self.forecasts_in_run(company).map(one)).collect();
        let naively =
            describe_naive_share(self.filled_naively).map_or(String::new(), |naively| format!(", filled {naively}"));
        format!("Forecasts of cash{naively}:\n{}", lines.join("\n"))
    }
}

/// Returns a tool call as a line. Undone calls, undo calls and redo calls are marked.
fn call_line(
    entry: &JournalEntry,
    settings: &mut KnownSettings,
    undone: &BTreeSet<u64>,
    names: &EnterpriseNames,
) -> Option<JournalLine> {
    let JournalEntry::Call { seq, day, tool, args, reversal } = entry else { return None };
    let spec = tool.spec();
    let words = match spec.kind {
        ToolKind::Setting => settings.describe_change(spec, args),
        _ => describe_deals(*tool, args, names).unwrap_or_else(|| format_arguments(args)),
    };
    let is_undone = undone.contains(seq);
    let (sign, remark) = match reversal {
        _ if is_undone => ("undone: ", "\n\nThis call was undone."),
        Some(Reversal::Undoes(_)) => ("undo: ", "\n\nThis call undid an earlier call."),
        Some(Reversal::Redoes(_)) => ("redo: ", "\n\nThis call redid an undone call."),
        None => ("", ""),
    };
    let gone = is_undone || matches!(reversal, Some(Reversal::Undoes(_)));
    let pretty = serde_json::to_string_pretty(args).unwrap_or_default();
    Some(JournalLine {
        day: *day,
        text: format!("  {sign}{tool} {words}").trim_end().to_owned(),
        role: if gone { Role::Dim } else { Role::Text },
        title: format!("{tool} · day {day}"),
        full_text: format!("{tool}\n\n{pretty}{remark}"),
        term: spec.name(),
        sql: history_query(spec, *day),
    })
}

/// Returns a parameter change as a line.
fn parameter_line(day: u32, key: &str, [old, new]: [&Value; 2], from_day: Option<u32>) -> JournalLine {
    JournalLine {
        day,
        text: format!("  {}", describe_recorded_parameter_change(key, [old, new], from_day)),
        role: Role::Text,
        title: format!("{key} · day {day}"),
        full_text: format!("set {key}{}\n\nbefore: {old}\nafter: {new}", describe_start_day(from_day)),
        term: "",
        sql: None,
    }
}

/// Returns the query for the settings that a call on a day stored, or `None` if the tool stores no settings.
fn history_query(spec: &ToolSpec, day: u32) -> Option<String> {
    let table = spec.written_tables.iter().find(|table| table.starts_with("config_"))?;
    let tool = match *table {
        "config_overrides" => format!(" AND tool_name = '{}'", spec.name()),
        _ => String::new(),
    };
    Some(format!("SELECT * FROM {table} WHERE day = {day}{tool}"))
}

/// Values that earlier calls set, by tool and path.
#[derive(Default)]
struct KnownSettings(BTreeMap<String, f64>);

impl KnownSettings {
    /// Describes the values that a call sets. Changed values are shown as old → new.
    fn describe_change(&mut self, spec: &ToolSpec, args: &Value) -> String {
        let mut leaves = Vec::new();
        collect_numbers(args, "", &mut leaves);
        let key = |path: &str| format!("{}/{path}", spec.name());
        if leaves.is_empty() || leaves.iter().all(|(path, _)| !self.0.contains_key(&key(path))) {
            self.0.extend(leaves.into_iter().map(|(path, value)| (key(&path), value)));
            return format_arguments(args);
        }
        let mut changes = Vec::new();
        for (path, value) in &leaves {
            match self.0.insert(key(path), *value) {
                Some(old) if old == *value => {}
                Some(old) => changes.push(format!("{path} {} → {}", format_plain(old), format_plain(*value))),
                None => changes.push(format!("{path} {}", format_plain(*value))),
            }
        }
        // A call replaces a map completely. Entries that the new map does not contain are removed.
        let maps = args.as_object().into_iter().flatten().filter(|(_, value)| value.is_object());
        for (name, _) in maps {
            let start = key(&format!("{name} "));
            let gone =
                |path: &String| path.starts_with(&start) && !leaves.iter().any(|leaf| key(&leaf.0) == *path);
            let lost: Vec<String> = self.0.keys().filter(|path| gone(path)).cloned().collect();
            for path in lost {
                let old = self.0.remove(&path).unwrap_or(0.0);
                let short = path.split_once('/').map_or("", |(_, rest)| rest).to_owned();
                changes.push(format!("{short} {} → –", format_plain(old)));
            }
        }
        if changes.is_empty() { "unchanged".to_owned() } else { changes.join(" · ") }
    }
}

/// Collects the numbers of a call with their paths: `targeted_spend linkedin E1`.
fn collect_numbers(value: &Value, path: &str, leaves: &mut Vec<(String, f64)>) {
    match value {
        Value::Object(fields) => {
            for (name, inner) in fields {
                let path = if path.is_empty() { name.clone() } else { format!("{path} {name}") };
                collect_numbers(inner, &path, leaves);
            }
        }
        Value::Number(json_number) => leaves.extend(json_number.as_f64().map(|number| (path.to_owned(), number))),
        _ => {}
    }
}

/// Describes arguments in short form: `A 16 B 34`, `search_ads(S3 40)`.
pub fn format_arguments(value: &Value) -> String {
    match value {
        Value::Null => "–".to_owned(),
        Value::Bool(truth) => truth.to_string(),
        Value::Number(number) => number.as_f64().map_or_else(|| number.to_string(), format_plain),
        Value::String(text) => text.split_whitespace().collect::<Vec<_>>().join(" "),
        Value::Array(values) => {
            // Whole numbers in a list are customer or thread numbers, which have no digit grouping.
            let item = |value: &Value| if value.is_u64() { value.to_string() } else { format_arguments(value) };
            format!("[{}]", values.iter().map(item).collect::<Vec<_>>().join(" "))
        }
        Value::Object(fields) => {
            let field = |(name, value): (&String, &Value)| match value {
                Value::Object(_) => format!("{name}({})", format_arguments(value)),
                _ => format!("{name} {}", format_arguments(value)),
            };
            fields.iter().map(field).collect::<Vec<_>>().join(" ")
        }
    }
}

/// Formats a rounded number. The complete entry shows all digits.
fn format_plain(value: f64) -> String {
    let short = if value.abs() >= 0.01 { (value * 1e4).round() / 1e4 } else { value };
    if short.fract() == 0.0 { format_number(short) } else { short.to_string() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn format_arguments_is_short() {
        for (args, words) in [
            (json!({"A": 12.0, "B": 25.5, "C": 1200}), "A 12 B 25.5 C 1,200"),
            (json!({"targeted_spend": {"search_ads": {"S3": 40}}}), "targeted_spend(search_ads(S3 40))"),
            (json!({"text": "two\nlines", "to": [1, 2], "x": null}), "text two lines to [1 2] x –"),
            (json!({"deals": [[1037, [["C", 40.05]]]]}), "deals [[1037 [[C 40.05]]]]"),
            (json!({}), ""),
            (json!({"rate": 0.0125, "spend": 172.35000000000002}), "rate 0.0125 spend 172.35"),
        ] {
            assert_eq!(format_arguments(&args), words);
        }
    }

    #[test]
    fn later_calls_show_the_previous_value() {
        let mut settings = KnownSettings::default();
        let mut describe = |tool: &str, args: Value| {
            settings.describe_change(novamind_tools::find(tool).expect("a tool").spec(), &args)
        };
        assert_eq!(describe("set_prices", json!({"A": 12})), "A 12");
        assert_eq!(describe("set_prices", json!({"A": 14, "B": 25})), "A 12 → 14 · B 25");
        assert_eq!(describe("set_prices", json!({"A": 14})), "unchanged");
        let ads = "set_targeted_ad_spend";
        let first = describe(ads, json!({"targeted_spend": {"linkedin": {"E1": 200, "E2": 50}}}));
        assert_eq!(first, "targeted_spend(linkedin(E1 200 E2 50))");
        let second = describe(ads, json!({"targeted_spend": {"linkedin": {"E1": 300}}}));
        assert_eq!(second, "targeted_spend linkedin E1 200 → 300 · targeted_spend linkedin E2 50 → –");
    }
}
