//! The journal as lines to walk: weeks with the newest first, in each what was done in its order.

use serde_json::Value;

use crate::console::company::Company;
use crate::console::text::{number, short_dollars};
use crate::console::theme::Role;
use crate::notation::{compact, dollars, grouped, signed_dollars};
use crate::session::{JournalEntry, WeekFigures};
use crate::tools::Forecast;

/// A line.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// Day.
    pub day: u32,
    /// What happened, in one line.
    pub text: String,
    /// Meaning.
    pub role: Role,
    /// Title of the whole entry.
    pub title: String,
    /// The whole entry.
    pub whole: String,
}

/// What was filed before a week.
struct Filed<'a> {
    day: u32,
    rationale: &'a str,
    forecasts: &'a [Forecast],
    naively: bool,
}

/// A week: what was done before it, what was filed, how it went.
#[derive(Default)]
struct Group<'a> {
    calls: Vec<&'a JournalEntry>,
    filed: Option<Filed<'a>>,
    figures: Option<&'a WeekFigures>,
}

/// All lines.
pub fn lines(company: &Company) -> Vec<Line> {
    let mut groups = vec![Group::default()];
    for entry in &company.journal {
        let Some(last) = groups.last_mut() else { continue };
        match entry {
            JournalEntry::Call { .. } => last.calls.push(entry),
            JournalEntry::Advance { day, rationale, forecasts, filled_naively } => {
                last.filed = Some(Filed { day: *day, rationale, forecasts, naively: *filled_naively });
            }
            JournalEntry::Week { figures } => {
                last.figures = Some(figures);
                groups.push(Group::default());
            }
        }
    }
    groups.iter().rev().flat_map(|group| group.lines(company)).collect()
}

impl Group<'_> {
    fn lines(&self, company: &Company) -> Vec<Line> {
        let Some(head) = self.head(company) else { return Vec::new() };
        let whole = self.whole(company, &head);
        let line = |day: u32, text: String, role: Role| Line {
            day,
            text,
            role,
            title: head.clone(),
            whole: whole.clone(),
        };
        let day = self.figures.map_or(company.seen.day, |week| week.day);
        let mut lines = vec![line(day, head.clone(), Role::Strong)];
        if let Some(filed) = &self.filed {
            let words: Vec<&str> = filed.rationale.split_whitespace().collect();
            lines.push(line(filed.day, format!("  why  {}", words.join(" ")), Role::Text));
            if !filed.forecasts.is_empty() {
                lines.push(line(filed.day, format!("  said {}", filed.in_a_line(company)), Role::Dim));
            }
        }
        lines.extend(self.calls.iter().filter_map(|entry| of_call(entry)));
        lines
    }

    /// The line above a week; none for a week without anything in a run that is over.
    fn head(&self, company: &Company) -> Option<String> {
        match self.figures {
            Some(week) => {
                let sign = if week.cash_change < 0.0 { '-' } else { '+' };
                Some(format!(
                    "week {} · day {} · cash {} ({sign}${})",
                    week.day.div_ceil(7),
                    week.day,
                    short_dollars(week.cash),
                    compact(week.cash_change.abs())
                ))
            }
            None if self.calls.is_empty() && !company.is_running() => None,
            None => {
                let done = match self.calls.len() {
                    0 => "nothing done yet".to_owned(),
                    1 => "1 action".to_owned(),
                    count => format!("{count} actions"),
                };
                Some(format!("week {} · now · {done}", company.seen.day / 7 + 1))
            }
        }
    }

    /// The whole week to read.
    fn whole(&self, company: &Company, head: &str) -> String {
        let mut parts = vec![head.to_owned()];
        if let Some(filed) = &self.filed {
            parts.push(format!("Why, on day {}:\n{}", filed.day, filed.rationale));
            parts.push(filed.in_full(company));
        }
        let calls: Vec<String> =
            self.calls.iter().filter_map(|entry| of_call(entry)).map(|line| line.text).collect();
        if !calls.is_empty() {
            parts.push(format!("Done before it:\n{}", calls.join("\n")));
        }
        if let Some(week) = self.figures {
            parts.push(format!(
                "How it went:\n  cash {} ({})\n  subscribers {} (new {}, cancelled {})\n  seats {}\n  payments {} · running costs {}",
                dollars(week.cash),
                signed_dollars(week.cash_change),
                grouped(f64::from(week.individual_subscribers), 0),
                grouped(f64::from(week.new_individual_subscribers), 0),
                grouped(f64::from(week.cancellations), 0),
                grouped(f64::from(week.enterprise_seats), 0),
                dollars(week.payments),
                dollars(week.costs),
            ));
        }
        parts.join("\n\n")
    }
}

impl Filed<'_> {
    /// Cash on the day a forecast was made for, once it has come.
    fn outcome(&self, forecast: &Forecast, company: &Company) -> Option<f64> {
        company.cash_by_day.get((self.day + forecast.horizon_days) as usize).copied()
    }

    fn in_a_line(&self, company: &Company) -> String {
        let one = |forecast: &Forecast| {
            let came = match self.outcome(forecast, company) {
                Some(cash) if forecast.lower <= cash && cash <= forecast.upper => " inside",
                Some(_) => " OUTSIDE",
                None => "",
            };
            format!("{} wk {}{came}", forecast.horizon_days / 7, short_dollars(forecast.point))
        };
        let all: Vec<String> = self.forecasts.iter().map(one).collect();
        let naively = if self.naively { "naively " } else { "" };
        format!("{naively}{}", all.join(" · "))
    }

    fn in_full(&self, company: &Company) -> String {
        let head = format!("{:>8} {:>14} {:>14} {:>14}   {}", "", "low", "point", "high", "outcome");
        let one = |forecast: &Forecast| {
            let outcome = match self.outcome(forecast, company) {
                Some(cash) => {
                    let inside = forecast.lower <= cash && cash <= forecast.upper;
                    format!("{} {}", dollars(cash), if inside { "inside" } else { "OUTSIDE" })
                }
                None => format!("on day {}", self.day + forecast.horizon_days),
            };
            format!(
                "{:>5} wk {:>14} {:>14} {:>14}   {outcome}",
                forecast.horizon_days / 7,
                dollars(forecast.lower),
                dollars(forecast.point),
                dollars(forecast.upper)
            )
        };
        let lines: Vec<String> = std::iter::once(head).chain(self.forecasts.iter().map(one)).collect();
        let naively = if self.naively { ", filled with the naive projection" } else { "" };
        format!("Forecasts of cash{naively}:\n{}", lines.join("\n"))
    }
}

fn of_call(entry: &JournalEntry) -> Option<Line> {
    let JournalEntry::Call { day, tool, args, undoes } = entry else { return None };
    let back = if undoes.is_some() { "undo: " } else { "" };
    let text = format!("  {back}{tool} {}", in_words(args)).trim_end().to_owned();
    let pretty = serde_json::to_string_pretty(args).unwrap_or_default();
    let undone = if undoes.is_some() { "\n\nThis took back an earlier call." } else { "" };
    Some(Line {
        day: *day,
        text,
        role: if undoes.is_some() { Role::Dim } else { Role::Text },
        title: format!("{tool} · day {day}"),
        whole: format!("{tool}\n\n{pretty}{undone}"),
    })
}

/// Arguments of a call in few characters: `A 12 B 25`, `search_ads(S3 40)`.
pub fn in_words(value: &Value) -> String {
    match value {
        Value::Null => "–".to_owned(),
        Value::Bool(truth) => truth.to_string(),
        Value::Number(own) => own.as_f64().map_or_else(|| own.to_string(), plain),
        Value::String(text) => text.split_whitespace().collect::<Vec<_>>().join(" "),
        Value::Array(values) => format!("[{}]", values.iter().map(in_words).collect::<Vec<_>>().join(" ")),
        Value::Object(fields) => {
            let field = |(name, value): (&String, &Value)| match value {
                Value::Object(_) => format!("{name}({})", in_words(value)),
                _ => format!("{name} {}", in_words(value)),
            };
            fields.iter().map(field).collect::<Vec<_>>().join(" ")
        }
    }
}

/// A number with the digits that matter; the whole entry has them all.
fn plain(value: f64) -> String {
    let short = if value.abs() >= 0.01 { (value * 1e4).round() / 1e4 } else { value };
    if short.fract() == 0.0 { number(short) } else { short.to_string() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn arguments_are_written_in_few_characters() {
        for (args, words) in [
            (json!({"A": 12.0, "B": 25.5, "C": 1200}), "A 12 B 25.5 C 1,200"),
            (json!({"targeted_spend": {"search_ads": {"S3": 40}}}), "targeted_spend(search_ads(S3 40))"),
            (json!({"text": "two\nlines", "to": [1, 2], "x": null}), "text two lines to [1 2] x –"),
            (json!({}), ""),
            (json!({"rate": 0.0125, "spend": 172.35000000000002}), "rate 0.0125 spend 172.35"),
        ] {
            assert_eq!(in_words(&args), words);
        }
    }
}
