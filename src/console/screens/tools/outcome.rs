//! Text below the values of a form, and the leads of each channel.

use std::collections::BTreeMap;

use serde_json::Value;

use super::Tools;
use super::form::ToolForm;
use super::margins::form_margin_lines;
use super::reference::reference_lines;
use super::sheet::ArgumentBlock;
use crate::action::Action;
use crate::context::ScreenContext;
use novamind_base::formatting::{dollars, grouped_number};
use novamind_database::{QueryResult, number_at, text_at};
use novamind_report::research::outlook_lines;
use novamind_report::cost_review::cost_line;
use novamind_tools::{ArgumentKind, MapKey};
use novamind_tui::text::{format_count, format_number, wrap};
use novamind_tui::theme::Role;

/// Leads and advertising spending of the last four weeks by channel and group, from `ad_channel_leads`.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct ChannelLeads(BTreeMap<(String, String), (f64, f64)>);

impl ChannelLeads {
    pub fn from_rows(rows: &QueryResult) -> ChannelLeads {
        let to_pair = |row: &Vec<novamind_database::Cell>| {
            let pair = (text_at(row, 0).to_owned(), text_at(row, 1).to_owned());
            (pair, (number_at(row, 2), number_at(row, 3)))
        };
        ChannelLeads(rows.rows.iter().map(to_pair).collect())
    }

    /// Returns whether the leads belong to the values of a block.
    pub fn applies_to(&self, block: &ArgumentBlock) -> bool {
        matches!(block.argument.kind, ArgumentKind::Matrix(MapKey::Channel, MapKey::Group, _))
    }

    /// Formats the groups with the most leads per dollar in a channel, the best first: `S1 298 · S3 71`.
    pub fn best_groups(&self, channel: &str) -> Option<String> {
        let mut rates: Vec<(&str, f64)> = self
            .0
            .iter()
            .filter(|((text, _), (_, spend))| text == channel && *spend > 0.0)
            .map(|((_, group), (leads, spend))| (group.as_str(), leads / spend * 1000.0))
            .collect();
        rates.sort_by(|left, right| right.1.total_cmp(&left.1).then(left.0.cmp(right.0)));
        let one = |(group, rate): &(&str, f64)| format!("{group} {}", format_rate(*rate));
        let best: Vec<String> = rates.iter().take(2).map(one).collect();
        (!best.is_empty()).then(|| best.join(" · "))
    }

    /// Describes the leads and the spending of one channel and group.
    pub fn pair_summary(&self, channel: &str, group: &str) -> Option<String> {
        let (leads, spend) =
            self.0.get(&(channel.to_owned(), group.to_owned())).filter(|(_, spend)| *spend > 0.0)?;
        Some(format!(
            "{channel} × {group}, last four weeks: {} for {}, {} per $1,000",
            format_count(*leads, "lead"),
            dollars(*spend),
            format_rate(leads / spend * 1000.0)
        ))
    }
}

fn format_rate(rate: f64) -> String {
    grouped_number(rate, if rate < 10.0 { 1 } else { 0 })
}

/// Level of detail of the text below the values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum DetailLevel {
    /// Complete text with blank rows.
    Full,
    /// Text without repetitions and blank rows.
    Compact,
    /// Compact text with margins only for the model tiers that are set.
    Brief,
}

pub(super) struct OutcomeLines {
    pub lines: Vec<(String, Role)>,
    /// Number of leading lines that must be visible: all lines up to the last row that shows a margin or the project's
    /// range. 0 if there are no such rows.
    pub required_lines: usize,
}

impl OutcomeLines {
    /// Returns whether a required line is wider than `width`.
    pub fn is_truncated(&self, width: usize) -> bool {
        self.lines.iter().take(self.required_lines).any(|(line, _)| line.chars().count() > width)
    }
}

/// Returns the text below the values: the draft, the check of the call, the call itself, reference figures, and the
/// answer.
pub(super) fn outcome_lines(
    form: &ToolForm,
    tools: &Tools,
    context: &ScreenContext<'_>,
    (width, detail): (usize, DetailLevel),
) -> OutcomeLines {
    let dense = detail != DetailLevel::Full;
    let mut lines: Vec<(String, Role)> = Vec::new();
    let mut paragraph = |text: &str, role: Role| {
        lines.extend(wrap(text, width).into_iter().map(|line| (line, role)));
    };
    if form.spec.kind.changes_company() && form.sheet.is_changed() {
        paragraph(&draft_line(form, context, dense), Role::Changed);
    }
    match &form.preview {
        Some(Ok(preview)) => {
            if let Some(terms) = cost_line(preview) {
                paragraph(&format!("→ {terms}"), Role::Strong);
            }
            for line in preview.research.iter().flat_map(outlook_lines) {
                paragraph(&line, Role::Text);
            }
        }
        Some(Err(refusal)) => paragraph(&format!("! {}", refusal.message), Role::Bad),
        None => {}
    }
    // The output of code has precedence over the call text.
    let answer = form.answer.as_ref().filter(|_| !form.sheet.is_changed() || form.spec.id.executes_code());
    let is_output_shown = answer.is_some() && form.spec.id.executes_code();
    if !dense && !is_output_shown && (form.sheet.is_changed() || !form.spec.kind.changes_company()) {
        paragraph(&format!("≡ {}", form.call_text()), Role::Dim);
    }
    if let Some(words) = form.cell_names().and_then(|(channel, group)| tools.leads.pair_summary(channel, group)) {
        paragraph(&words, Role::Text);
    }
    if let Some(answer) = answer {
        answer_lines(answer, &mut paragraph);
    }
    let spread =
        form.preview.as_ref().is_some_and(|preview| preview.as_ref().is_ok_and(|result| result.research.is_some()));
    let mut needed = if spread { lines.len() } else { 0 };
    let tables =
        [form_margin_lines(form, &tools.sales, context.company, detail == DetailLevel::Brief), reference_lines(form.spec.id, context.company)];
    for (number, table) in tables.iter().enumerate().filter(|(_, table)| !table.is_empty()) {
        if !dense {
            lines.push((" ".to_owned(), Role::Text));
        }
        for (at, line) in table.iter().enumerate() {
            let role = if at == 0 { Role::Header } else { Role::Text };
            // Table rows keep their spaces, and only sentences are wrapped.
            let is_row = line.contains("  ") || line.chars().count() <= width;
            let parts = if is_row { vec![line.clone()] } else { wrap(line, width) };
            lines.extend(parts.into_iter().map(|part| (part, role)));
            if number == 0 && (line.contains("  ") || detail == DetailLevel::Brief) {
                needed = lines.len();
            }
        }
    }
    for text in tools.price_curve.lines(form, context.company) {
        if !dense {
            lines.push((" ".to_owned(), Role::Text));
        }
        lines.extend(wrap(&text, width).into_iter().map(|line| (line, Role::Strong)));
    }
    let mut about = |text: &str| {
        if !text.is_empty() {
            lines.push((String::new(), Role::Text));
            lines.extend(wrap(text, width).into_iter().map(|line| (line, Role::Text)));
        }
    };
    about(&context.company.numbers.substitute(form.spec.effect));
    OutcomeLines { lines, required_lines: needed }
}

/// Describes the draft: values as old → new, and the keys that send or discard the draft.
fn draft_line(form: &ToolForm, context: &ScreenContext<'_>, dense: bool) -> String {
    let changes: Vec<String> = form
        .sheet
        .positions()
        .filter_map(|place| {
            let (block, slot) = (&form.sheet.blocks[place.block], form.sheet.cell(place)?);
            if block.is_text() || !slot.is_changed() {
                return None;
            }
            let new = slot.value().ok()?.map_or("–".to_owned(), format_number);
            let old = slot.current.map_or("–".to_owned(), format_number);
            let path = block.path(place.row, place.column);
            let name = path.split_once('.').map_or(path.as_str(), |(_, rest)| rest).replace('.', " × ");
            Some(format!("{name} {old} → {new}"))
        })
        .collect();
    let more = changes.len().saturating_sub(3);
    let mut words = changes.into_iter().take(3).collect::<Vec<_>>().join(" · ");
    if more > 0 {
        words += &format!(" · {more} more");
    }
    let keys = context.hints(&[Action::Apply, Action::ResetForm]);
    let draft = if dense { "* draft" } else { "* draft, kept until sent or reset" };
    format!("{draft}{}{words} ({keys})", if words.is_empty() { "" } else { ": " })
}

fn answer_lines(answer: &Result<Value, novamind_tools::Rejection>, paragraph: &mut impl FnMut(&str, Role)) {
    match answer {
        Ok(value) => {
            paragraph("✓ answered", Role::Good);
            if let (Some(text), Some(remarks)) = (value["stdout"].as_str(), value["stderr"].as_str()) {
                // Line breaks in the output of a script are kept.
                text.lines().for_each(|line| paragraph(line, Role::Text));
                return remarks.lines().for_each(|line| paragraph(line, Role::Dim));
            }
            for line in format_answer(value, 0) {
                paragraph(&line, Role::Text);
            }
        }
        Err(refusal) => {
            paragraph(&format!("! {}: {}", refusal.code, refusal.message), Role::Bad);
            if refusal.results.len() > 1 {
                let results = serde_json::to_value(&refusal.results).unwrap_or_default();
                format_answer(&results, 0).iter().for_each(|line| paragraph(line, Role::Text));
            }
        }
    }
}

/// Formats an answer as indented lines, with flat objects on one line.
fn format_answer(value: &Value, depth: usize) -> Vec<String> {
    let indent = "  ".repeat(depth + 1);
    let flat = |value: &Value| !matches!(value, Value::Object(_) | Value::Array(_));
    let word = |value: &Value| match value {
        Value::String(text) => text.clone(),
        Value::Number(figure) => figure.as_f64().map_or(figure.to_string(), |figure| {
            if figure.fract() == 0.0 { format_number(figure) } else { figure.to_string() }
        }),
        Value::Null => "–".to_owned(),
        other => other.to_string(),
    };
    let pairs = |map: &serde_json::Map<String, Value>| {
        map.iter().map(|(name, value)| format!("{name} {}", word(value))).collect::<Vec<_>>().join(" · ")
    };
    match value {
        Value::Object(map) if map.is_empty() => vec![format!("{indent}none")],
        Value::Object(map) if map.values().all(flat) => vec![format!("{indent}{}", pairs(map))],
        Value::Object(map) => map
            .iter()
            .flat_map(|(name, inner)| match inner {
                inner if flat(inner) => vec![format!("{indent}{name} {}", word(inner))],
                Value::Object(fields) if !fields.is_empty() && fields.values().all(flat) => {
                    vec![format!("{indent}{name}: {}", pairs(fields))]
                }
                inner => {
                    std::iter::once(format!("{indent}{name}")).chain(format_answer(inner, depth + 1)).collect()
                }
            })
            .collect(),
        Value::Array(items) => items.iter().flat_map(|item| format_answer(item, depth)).collect(),
        other => vec![format!("{indent}{}", word(other))],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use novamind_database::Cell;

    #[test]
    fn channel_groups_are_ranked_by_leads_per_dollar() {
        let row = |channel: &str, group: &str, leads: i64, spend: f64| {
            let text = |text: &str| Cell::Text(text.to_owned());
            vec![text(channel), text(group), Cell::Integer(leads), Cell::Real(spend)]
        };
        let rows = vec![
            row("linkedin", "E1", 2, 8000.0),
            row("linkedin", "S1", 300, 1000.0),
            row("linkedin", "S2", 30, 1000.0),
            row("search_ads", "S1", 0, 0.0),
        ];
        let leads = ChannelLeads::from_rows(&QueryResult { rows, ..QueryResult::default() });
        assert_eq!(leads.best_groups("linkedin").as_deref(), Some("S1 300 · S2 30"));
        assert_eq!((leads.best_groups("search_ads"), leads.pair_summary("search_ads", "S1")), (None, None));
        let words = leads.pair_summary("linkedin", "E1").expect("words");
        assert!(words.ends_with("2 leads for $8,000, 0.2 per $1,000"), "{words}");
    }
}
