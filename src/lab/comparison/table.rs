//! Comparison of runs as text and as CSV rows.

use super::compared_runs::{Comparison, ComparisonRow, PublishedRange};
use super::run_rows::row_per_run_report;
use novamind_base::formatting::{dollars, grouped_number, percent};
use novamind_report::ranking::{describe_published_conditions, format_horizon, published_results};
use novamind_world::params::HorizonRule;

/// Maximum number of cash rows in the text. For longer runs, weeks are skipped.
const MAX_CASH_ROWS: usize = 20;

const MAX_LINE_WIDTH: usize = 124;

/// Formats the comparison as text. Runs are columns if they fit into `width`; otherwise each run is a row.
pub fn comparison_to_text(comparison: &Comparison, width: usize) -> String {
    let table = side_by_side(comparison);
    if table.lines().any(|line| line.chars().count() > width) {
        let mut exhibit = row_per_run_report(comparison);
        exhibit.notes.extend(comparison.caveats.iter().cloned());
        return exhibit.to_text(width);
    }
    let foot: String = footnotes(comparison).into_iter().map(|line| line + "\n").collect();
    table + &decision_lines(comparison, width.min(MAX_LINE_WIDTH)) + &published_agents_text() + &foot
}

fn side_by_side(comparison: &Comparison) -> String {
    let mut head = vec![String::new()];
    head.extend(comparison.runs.iter().cloned());
    head.push("published".to_owned());
    let mut rows = vec![head];
    let mut players = vec!["who".to_owned()];
    players.extend(comparison.participants.iter().map(|who| who.clone().unwrap_or_else(|| "-".to_owned())));
    players.push(String::new());
    rows.push(players);
    rows.extend(condition_rows(comparison));
    rows.extend(comparison.figures.iter().map(text_row));
    rows.push(vec![String::new(); comparison.runs.len() + 2]);
    let last = comparison.cash.len().saturating_sub(1);
    let every = comparison.cash.len().div_ceil(MAX_CASH_ROWS).max(1);
    let shown = comparison.cash.iter().enumerate().filter(|(at, _)| at % every == 0 || *at == last);
    rows.extend(shown.map(|(_, row)| text_row(row)));
    align_cells(&rows)
}

/// Returns the rows with scenario, generation and last day of each run and of the paper's runs.
fn condition_rows(comparison: &Comparison) -> [Vec<String>; 3] {
    let row = |name: &str, cells: Vec<String>, published: String| {
        [vec![name.to_owned()], cells, vec![published]].concat()
    };
    let generations = comparison.generations.iter().map(|generation| generation.name().to_owned()).collect();
    let paper = published_results().paper();
    [
        row("scenario", comparison.scenarios.clone(), String::new()),
        row("generation", generations, paper.generation.name().to_owned()),
        row(
            "last day",
            comparison.horizons.iter().map(describe_horizon).collect(),
            paper.describe_horizons(),
        ),
    ]
}

/// Describes a last day, followed by the horizon rule unless the rule is `Exact`: `497 (whole_weeks_below)`.
pub(super) fn describe_horizon((days, rule): &(u32, HorizonRule)) -> String {
    match rule {
        HorizonRule::Exact => days.to_string(),
        _ => format!("{days} ({})", rule.name()),
    }
}

/// Returns the notes on comparability and the source of the published figures.
fn footnotes(comparison: &Comparison) -> Vec<String> {
    let mut lines = comparison.caveats.clone();
    lines.push(format!("{}.", describe_published_conditions()));
    lines.push(format!("Published: {}.", published_results().paper().source));
    lines.push(format!("{}.", published_results().explain_unranked_agents()));
    lines
}

fn text_row(row: &ComparisonRow) -> Vec<String> {
    let name = match (row.figure.as_str(), row.of.as_str()) {
        (figure, "") => figure.to_owned(),
        ("cash", day) => format!("cash on day {day}"),
        (figure, days) if days.bytes().all(|byte| byte.is_ascii_digit()) => format!("{figure}, {days} days"),
        (figure, of) => format!("{figure}, {of}"),
    };
    let mut cells = vec![name];
    cells.extend(
        row.values.iter().map(|value| value.map_or("-".to_owned(), |value| format_value(value, row.unit))),
    );
    cells.push(row.published.map(|range| format_range(&range, row.unit)).unwrap_or_default());
    cells
}

fn format_range(range: &PublishedRange, unit: &str) -> String {
    let (least, most) = (format_value(range.least, unit), format_value(range.most, unit));
    if least == most {
        format!("{least} ({})", range.what)
    } else {
        format!("{least} to {most} ({})", range.what)
    }
}

fn format_value(value: f64, unit: &str) -> String {
    match unit {
        "dollars" => dollars(value),
        "share" => percent(value, 1),
        "count" | "days" => grouped_number(value, 0),
        _ => grouped_number(value, 1),
    }
}

/// Aligns cells in columns. The first and the last column are left-aligned, and all others are right-aligned.
fn align_cells(rows: &[Vec<String>]) -> String {
    let columns = rows.first().map_or(0, Vec::len);
    let width = |at: usize| rows.iter().map(|row| row[at].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let mut text = String::new();
    for row in rows {
        let mut line = String::new();
        for (at, (cell, width)) in row.iter().zip(&widths).enumerate() {
            let left = at == 0 || at + 1 == columns;
            line += &if left { format!("{cell:<width$}  ") } else { format!("{cell:>width$}  ") };
        }
        text += line.trim_end();
        text.push('\n');
    }
    text
}

fn decision_lines(comparison: &Comparison, line: usize) -> String {
    let mut text = "\nDecisions\n".to_owned();
    let width = comparison.runs.iter().map(|run| run.chars().count()).max().unwrap_or(0);
    for decided in &comparison.decisions {
        text += &format!("  day {}\n", decided.day);
        for (run, texts) in comparison.runs.iter().zip(&decided.by_run).filter(|(_, texts)| !texts.is_empty())
        {
            let lines = wrap_decisions(&merge_equal_decisions(texts), line.saturating_sub(width + 6));
            for (at, line) in lines.iter().enumerate() {
                let name = if at == 0 { run.as_str() } else { "" };
                text += &format!("    {name:<width$}  {line}\n");
            }
        }
    }
    text + "\n"
}

/// Merges equal decisions of a week and appends their count.
fn merge_equal_decisions(decisions: &[String]) -> Vec<String> {
    let mut counted: Vec<(&str, usize)> = Vec::new();
    for decision in decisions {
        match counted.iter_mut().find(|(known, _)| known == decision) {
            Some((_, count)) => *count += 1,
            None => counted.push((decision, 1)),
        }
    }
    let describe = |(decision, count): (&str, usize)| match count {
        1 => decision.to_owned(),
        count => format!("{decision} ({count} times)"),
    };
    counted.into_iter().map(describe).collect()
}

/// Joins decisions into lines of limited width without breaking a decision.
fn wrap_decisions(decisions: &[String], width: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for (at, decision) in decisions.iter().enumerate() {
        let text = if at + 1 < decisions.len() { format!("{decision};") } else { decision.clone() };
        match lines.last_mut().filter(|line| line.chars().count() + 1 + text.chars().count() <= width) {
            Some(line) => *line += &format!(" {text}"),
            None => lines.push(text),
        }
    }
    lines
}

fn published_agents_text() -> String {
    let head = [
        "published agent",
        "generation",
        "last day",
        "best cash",
        "mean survival",
        "turns a week",
        "targeted development",
    ];
    let mut rows: Vec<Vec<String>> = vec![head.map(str::to_owned).to_vec()];
    for agent in published_results().paper().agent.iter().chain(published_results().unranked_agents()) {
        rows.push(vec![
            agent.name.clone(),
            agent.generation.name().to_owned(),
            format_horizon(agent.horizon_days),
            dollars(agent.best_cash),
            format!("{:.1} days", agent.mean_survival_days),
            format!("{:.2}", agent.turns_per_week),
            agent.targeted_development_share.map_or("-".to_owned(), |share| percent(share, 0)),
        ]);
    }
    align_cells(&rows) + "\n"
}

/// Returns the comparison as table rows, one per figure and day. The first row contains the column names.
pub fn comparison_to_rows(comparison: &Comparison) -> Vec<Vec<String>> {
    let mut head = ["figure", "of", "unit"].map(str::to_owned).to_vec();
    head.extend(comparison.runs.iter().cloned());
    head.extend(["published_least", "published_most", "published_what"].map(str::to_owned));
    let mut rows = vec![head];
    for row in comparison.figures.iter().chain(&comparison.cash) {
        let mut cells = vec![row.figure.clone(), row.of.clone(), row.unit.to_owned()];
        cells.extend(row.values.iter().map(|value| value.map(|value| value.to_string()).unwrap_or_default()));
        cells.extend(match row.published {
            Some(range) => [range.least.to_string(), range.most.to_string(), range.what.to_owned()],
            None => [String::new(), String::new(), String::new()],
        });
        rows.push(cells);
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_decisions_are_counted_and_lines_wrapped() {
        let texts = ["found nothing", "price A: 1 → 2", "found nothing"].map(str::to_owned);
        let counted = merge_equal_decisions(&texts);
        assert_eq!(counted, ["found nothing (2 times)", "price A: 1 → 2"]);
        assert_eq!(wrap_decisions(&counted, 100), ["found nothing (2 times); price A: 1 → 2"]);
        assert_eq!(wrap_decisions(&counted, 30), ["found nothing (2 times);", "price A: 1 → 2"]);
        assert!(wrap_decisions(&[], 30).is_empty());
    }
}
