//! Writes a page as Markdown that is readable as source and rendered.

use super::page::{Bar, Block, Chart, Curve, Page, Plot, Table};
use super::plot::{LEVELS, level};
use novamind_base::notation::acts;

const BAR: usize = 24;
const TREND: usize = 60;

pub fn write(page: &Page) -> String {
    let tags: Vec<String> = page.tags.iter().map(|tag| escaped(tag)).collect();
    let mut parts = vec![
        format!("# {}", escaped(&page.title)),
        format!("**{}**", escaped(&page.headline)),
        tags.join(" · "),
    ];
    parts.extend(page.blocks.iter().map(block));
    parts.push("---".to_owned());
    parts.push(escaped(&page.foot));
    parts.join("\n\n") + "\n"
}

fn block(block: &Block) -> String {
    match block {
        Block::Heading(text) => format!("## {}", escaped(text)),
        Block::Text(text) => escaped(text),
        Block::Note(text) => format!("*{}*", escaped(text)),
        Block::Warning(text) => format!("> **{}**", escaped(text)),
        Block::Table(own) => table(own),
        Block::Facts(facts) => table(&Table {
            columns: vec![("", false), ("", true), ("", false)],
            rows: facts
                .iter()
                .map(|fact| vec![fact.name.clone(), fact.value.clone(), fact.note.clone()])
                .collect(),
        }),
        Block::Bars(bars) => bar_table(bars),
        Block::Chart(chart) => chart_in_words(chart),
        Block::Folded { title, note, lines, points } => {
            let mut parts = vec![format!("### {}", escaped(title)), escaped(note)];
            parts.extend(lines.iter().map(|line| escaped(line)));
            if !points.is_empty() {
                parts.push(list(points));
            }
            parts.join("\n\n")
        }
    }
}

fn list(lines: &[String]) -> String {
    lines.iter().map(|line| format!("- {}", escaped(line))).collect::<Vec<_>>().join("\n")
}

fn table(table: &Table) -> String {
    let head: Vec<String> = table.columns.iter().map(|(name, _)| escaped(name)).collect();
    let rows: Vec<Vec<String>> =
        table.rows.iter().map(|row| row.iter().map(|cell| escaped(cell)).collect()).collect();
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

fn bar_table(bars: &[Bar]) -> String {
    let row = |bar: &Bar| {
        let filled = (bar.share.clamp(0.0, 1.0) * BAR as f64).round() as usize;
        let name = if bar.own { format!("{} ◀", bar.name) } else { bar.name.clone() };
        vec![name, bar.shown.clone(), "█".repeat(filled)]
    };
    table(&Table {
        columns: vec![("", false), ("", true), ("", false)],
        rows: bars.iter().map(row).collect(),
    })
}

fn chart_in_words(chart: &Chart) -> String {
    let mut parts = vec![format!("**{}.** {}", escaped(&chart.title), escaped(&chart.summary))];
    let trends: Vec<(String, String)> = match &chart.plot {
        Plot::Lines { curves, .. } => {
            // The curves of one chart share a scale so that they can be compared.
            let all: Vec<f64> = curves.iter().flat_map(values_of).collect();
            let trend = |own: &Curve| trend_between(&values_of(own), extremes(&all));
            curves.iter().map(|curve| (curve.name.clone(), trend(curve))).collect()
        }
        Plot::Stacks { parts, .. } => {
            parts.iter().map(|part| (part.name.clone(), trend(&part.values))).collect()
        }
    };
    let width = trends.iter().map(|(name, _)| name.chars().count()).max().unwrap_or(0);
    let lines: Vec<String> = trends.iter().map(|(name, trend)| format!("{name:<width$}  {trend}")).collect();
    parts.push(format!("```text\n{}\n```", lines.join("\n")));
    parts.join("\n\n")
}

fn values_of(curve: &Curve) -> Vec<f64> {
    curve.points.iter().map(|point| point.1).collect()
}

/// Draws values as one row of bars, scaled from the smallest to the largest; costs count by their amount.
fn trend(values: &[f64]) -> String {
    let is_cost = values.iter().all(|own| *own <= 0.0);
    let sizes: Vec<f64> = picked(values).into_iter().map(|own| if is_cost { -own } else { own }).collect();
    trend_between(&sizes, extremes(&sizes))
}

fn picked(values: &[f64]) -> Vec<f64> {
    let count = values.len().min(TREND);
    (0..count).map(|at| values[at * (values.len() - 1) / (count - 1).max(1)]).collect()
}

fn extremes(values: &[f64]) -> [f64; 2] {
    let least = values.iter().copied().fold(f64::INFINITY, f64::min);
    [least, values.iter().copied().fold(f64::NEG_INFINITY, f64::max)]
}

/// Draws values as one row of bars between two limits.
fn trend_between(values: &[f64], [least, most]: [f64; 2]) -> String {
    let height = |value: &f64| match most > least {
        true => level((value - least) / (most - least)),
        false => LEVELS[3],
    };
    picked(values).iter().map(height).collect()
}

/// Escapes text for Markdown: one line, without markup.
pub fn escaped(text: &str) -> String {
    let flat: Vec<&str> = text.split_whitespace().collect();
    let letters: Vec<char> = flat.join(" ").chars().filter(|letter| !acts(*letter)).collect();
    let mut safe = String::with_capacity(letters.len());
    for (at, letter) in letters.iter().enumerate() {
        let inside_word =
            |at: Option<usize>| at.and_then(|at| letters.get(at)).is_some_and(|own| own.is_alphanumeric());
        let marks = match letter {
            '\\' | '`' | '*' | '[' | ']' | '<' | '>' | '|' | '~' | '&' => true,
            // Names of tools and channels are easier to read unescaped.
            '_' => !(inside_word(at.checked_sub(1)) && inside_word(at.checked_add(1))),
            '#' | '-' | '+' | '=' => {
                at == 0 && letters.get(1).is_none_or(|next| !next.is_ascii_digit() && *next != '$')
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
    fn text_means_itself() {
        assert_eq!(escaped("a|b <i> *x*\n_y_ set_prices"), "a\\|b \\<i\\> \\*x\\* \\_y\\_ set_prices");
        assert_eq!(escaped("# no"), "\\# no");
        assert_eq!(escaped("-$1,200"), "-$1,200");
        assert_eq!(escaped("\u{1b}[31m"), "\\[31m");
    }

    #[test]
    fn columns_stand_below_each_other() {
        let own = Table {
            columns: vec![("group", false), ("leads", true)],
            rows: vec![vec!["S1".to_owned(), "1,200".to_owned()], vec!["D_S01".to_owned(), "7".to_owned()]],
        };
        assert_eq!(table(&own), "| group | leads |\n| ----- | ----: |\n| S1    | 1,200 |\n| D_S01 |     7 |");
    }

    #[test]
    fn trends_show_how_values_ran() {
        assert_eq!(trend(&[0.0, 7.0, 3.0]), "▁█▄");
        assert_eq!(trend(&[-10.0, -20.0, -20.0]), "▁██");
        assert_eq!(trend(&[1.0]), "▄");
        assert_eq!(trend(&[]), "");
        assert_eq!(trend(&(0..500).map(f64::from).collect::<Vec<_>>()).chars().count(), TREND);
    }
}
