//! Writes a page as Markdown that is readable both as source and when rendered.

use super::page::{Bar, Block, Chart, Curve, Page, Plot, Table};
use super::plot::{SPARKLINE_CHARS, sparkline_char};
use novamind_base::formatting::is_control_or_bidi;

const BAR_WIDTH: usize = 24;
const TREND_WIDTH: usize = 60;

pub fn to_markdown(page: &Page) -> String {
    let tags: Vec<String> = page.tags.iter().map(|tag| escape(tag)).collect();
    let mut parts = vec![
        format!("# {}", escape(&page.title)),
        format!("**{}**", escape(&page.headline)),
        tags.join(" · "),
    ];
    parts.extend(page.blocks.iter().map(block_markdown));
    parts.push("---".to_owned());
    parts.push(escape(&page.footer));
    parts.join("\n\n") + "\n"
}

fn block_markdown(block: &Block) -> String {
    match block {
        Block::Heading(text) => format!("## {}", escape(text)),
        Block::Text(text) => escape(text),
        Block::Note(text) => format!("*{}*", escape(text)),
        Block::Warning(text) => format!("> **{}**", escape(text)),
        Block::Table(table) => table_markdown(table),
        Block::Facts(facts) => table_markdown(&Table {
            columns: vec![("", false), ("", true), ("", false)],
            rows: facts
                .iter()
                .map(|fact| vec![fact.name.clone(), fact.value.clone(), fact.note.clone()])
                .collect(),
        }),
        Block::Bars(bars) => bars_markdown(bars),
        Block::Chart(chart) => chart_markdown(chart),
        Block::Collapsible { title, note, lines, points } => {
            let mut parts = vec![format!("### {}", escape(title)), escape(note)];
            parts.extend(lines.iter().map(|line| escape(line)));
            if !points.is_empty() {
                parts.push(list_markdown(points));
            }
            parts.join("\n\n")
        }
    }
}

fn list_markdown(lines: &[String]) -> String {
    lines.iter().map(|line| format!("- {}", escape(line))).collect::<Vec<_>>().join("\n")
}

fn table_markdown(table: &Table) -> String {
    let head: Vec<String> = table.columns.iter().map(|(name, _)| escape(name)).collect();
    let rows: Vec<Vec<String>> =
        table.rows.iter().map(|row| row.iter().map(|cell| escape(cell)).collect()).collect();
    let width = |at: usize| {
        let cells = rows.iter().filter_map(|row| row.get(at)).chain(head.get(at));
        cells.map(|cell| cell.chars().count()).max().unwrap_or(0).max(3)
    };
    let widths: Vec<usize> = (0..table.columns.len()).map(width).collect();
    let line = |cells: &[String]| {
        let cell = |(at, width): (usize, &usize)| {
            let text = cells.get(at).map_or("", String::as_str);
            if table.columns[at].1 { format!("{text:>width$}") } else { format!("{text:<width$}") }
        };
        format!("| {} |", widths.iter().enumerate().map(cell).collect::<Vec<_>>().join(" | "))
    };
    let rule = widths.iter().zip(&table.columns).map(|(width, (_, number))| {
        let dashes = "-".repeat(width - usize::from(*number));
        if *number { format!("{dashes}:") } else { dashes }
    });
    let mut lines = vec![line(&head), format!("| {} |", rule.collect::<Vec<_>>().join(" | "))];
    lines.extend(rows.iter().map(|row| line(row)));
    lines.join("\n")
}

fn bars_markdown(bars: &[Bar]) -> String {
    let row = |bar: &Bar| {
        let filled = (bar.share.clamp(0.0, 1.0) * BAR_WIDTH as f64).round() as usize;
        let name = if bar.is_highlighted { format!("{} ◀", bar.name) } else { bar.name.clone() };
        vec![name, bar.value_text.clone(), "█".repeat(filled)]
    };
    table_markdown(&Table {
        columns: vec![("", false), ("", true), ("", false)],
        rows: bars.iter().map(row).collect(),
    })
}

fn chart_markdown(chart: &Chart) -> String {
    let mut parts = vec![format!("**{}.** {}", escape(&chart.title), escape(&chart.summary))];
    let trends: Vec<(String, String)> = match &chart.plot {
        Plot::Lines { curves, .. } => {
            // All curves of a chart have the same scale, so that they can be compared.
            let all: Vec<f64> = curves.iter().flat_map(curve_values).collect();
            let trend = |curve: &Curve| sparkline_between(&curve_values(curve), min_and_max(&all));
            curves.iter().map(|curve| (curve.name.clone(), trend(curve))).collect()
        }
        Plot::Stacks { series: parts, .. } => {
            parts.iter().map(|part| (part.name.clone(), sparkline(&part.values))).collect()
        }
    };
    let width = trends.iter().map(|(name, _)| name.chars().count()).max().unwrap_or(0);
    let lines: Vec<String> = trends.iter().map(|(name, trend)| format!("{name:<width$}  {trend}")).collect();
    parts.push(format!("```text\n{}\n```", lines.join("\n")));
    parts.join("\n\n")
}

fn curve_values(curve: &Curve) -> Vec<f64> {
    curve.points.iter().map(|point| point.1).collect()
}

/// Draws values as one row of bars, scaled between the smallest and the largest value. If no value is positive, draws
/// the absolute values.
fn sparkline(values: &[f64]) -> String {
    let is_cost = values.iter().all(|value| *value <= 0.0);
    let sizes: Vec<f64> =
        sample_values(values).into_iter().map(|value| if is_cost { -value } else { value }).collect();
    sparkline_between(&sizes, min_and_max(&sizes))
}

fn sample_values(values: &[f64]) -> Vec<f64> {
    let count = values.len().min(TREND_WIDTH);
    (0..count).map(|at| values[at * (values.len() - 1) / (count - 1).max(1)]).collect()
}

fn min_and_max(values: &[f64]) -> [f64; 2] {
    let min = values.iter().copied().fold(f64::INFINITY, f64::min);
    [min, values.iter().copied().fold(f64::NEG_INFINITY, f64::max)]
}

/// Draws values as one row of bars, scaled between two limits.
fn sparkline_between(values: &[f64], [min, most]: [f64; 2]) -> String {
    let height = |value: &f64| match most > min {
        true => sparkline_char((value - min) / (most - min)),
        false => SPARKLINE_CHARS[3],
    };
    sample_values(values).iter().map(height).collect()
}

/// Escapes text for Markdown, so that it is shown on one line without markup.
pub fn escape(text: &str) -> String {
    let flat: Vec<&str> = text.split_whitespace().collect();
    let characters: Vec<char> =
        flat.join(" ").chars().filter(|letter| !is_control_or_bidi(*letter)).collect();
    let mut safe = String::with_capacity(characters.len());
    for (at, letter) in characters.iter().enumerate() {
        let inside_word = |at: Option<usize>| {
            at.and_then(|at| characters.get(at)).is_some_and(|character| character.is_alphanumeric())
        };
        let marks = match letter {
            '\\' | '`' | '*' | '[' | ']' | '<' | '>' | '|' | '~' | '&' => true,
            // Underscores inside words, such as names of tools and channels, are not escaped, because backslashes make
            // the source harder to read.
            '_' => !(inside_word(at.checked_sub(1)) && inside_word(at.checked_add(1))),
            '#' | '-' | '+' | '=' => {
                at == 0 && characters.get(1).is_none_or(|next| !next.is_ascii_digit() && *next != '$')
            }
            _ => false,
        };
        if marks {
            safe.push('\\');
        }
        safe.push(*letter);
    }
    safe
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn escape_removes_markup() {
        assert_eq!(escape("a|b <i> *x*\n_y_ set_prices"), "a\\|b \\<i\\> \\*x\\* \\_y\\_ set_prices");
        assert_eq!(escape("# no"), "\\# no");
        assert_eq!(escape("-$1,200"), "-$1,200");
        assert_eq!(escape("\u{1b}[31m"), "\\[31m");
    }

    #[test]
    fn table_columns_are_aligned() {
        let table = Table {
            columns: vec![("group", false), ("leads", true)],
            rows: vec![vec!["S1".to_owned(), "1,200".to_owned()], vec!["D_S01".to_owned(), "7".to_owned()]],
        };
        assert_eq!(
            table_markdown(&table),
            "| group | leads |\n| ----- | ----: |\n| S1    | 1,200 |\n| D_S01 |     7 |"
        );
    }

    #[test]
    fn sparkline_follows_values() {
        assert_eq!(sparkline(&[0.0, 7.0, 3.0]), "▁█▄");
        assert_eq!(sparkline(&[-10.0, -20.0, -20.0]), "▁██");
        assert_eq!(sparkline(&[1.0]), "▄");
        assert_eq!(sparkline(&[]), "");
        assert_eq!(sparkline(&(0..500).map(f64::from).collect::<Vec<_>>()).chars().count(), TREND_WIDTH);
    }
}
