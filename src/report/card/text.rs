//! The card as text: the cash curve in block characters, and the figures below the curve.

use super::{Card, LabeledFigure};
use crate::formatting::format_dollar_tick;

const CURVE_COLUMNS: usize = 66;
const CURVE_ROWS: usize = 10;
const LABEL_WIDTH: usize = 10;
const FIGURE_WIDTH: usize = 26;

/// Block characters, filled from the bottom by zero to eight eighths.
const EIGHTHS: [char; 9] = [' ', '▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];

pub fn to_text(card: &Card) -> String {
    let mut lines = vec![format!("NovaMind · {}", card.source), String::new(), card.headline.clone()];
    lines.extend(card.rank.clone());
    lines.extend(card.voice.map(str::to_owned));
    lines.push(String::new());
    lines.extend(curve_lines(&card.cash_by_day));
    lines.push(String::new());
    lines.extend(figure_lines(&card.turning_points));
    lines.extend(figure_lines(&card.numbers));
    lines.join("\n") + "\n"
}

fn figure_lines(facts: &[LabeledFigure]) -> [String; 2] {
    let row = |text: fn(&LabeledFigure) -> &String| {
        facts
            .iter()
            .map(|fact| format!("{:<FIGURE_WIDTH$}", text(fact)))
            .collect::<String>()
            .trim_end()
            .to_owned()
    };
    [row(|fact| &fact.value), row(|fact| &fact.name)]
}

/// Draws the cash on equally spaced days as columns of block characters that start at zero.
fn curve_lines(cash: &[f64]) -> Vec<String> {
    let last = cash.len().saturating_sub(1);
    let max = cash.iter().copied().fold(0.0, f64::max);
    let height = |column: usize| {
        let value = cash.get(column * last / (CURVE_COLUMNS - 1)).copied().unwrap_or(0.0);
        let share = if max > 0.0 { (value / max).clamp(0.0, 1.0) } else { 0.0 };
        (share * (8 * CURVE_ROWS) as f64).round() as usize
    };
    let heights: Vec<usize> = (0..CURVE_COLUMNS).map(height).collect();
    let line = |row: usize| {
        let below = 8 * (CURVE_ROWS - 1 - row);
        let label = if row == 0 { format_dollar_tick(max) } else { String::new() };
        let cells: String =
            heights.iter().map(|number| EIGHTHS[number.saturating_sub(below).min(8)]).collect();
        format!("{label:>LABEL_WIDTH$} ┤{cells}").trim_end().to_owned()
    };
    let mut lines: Vec<String> = (0..CURVE_ROWS).map(line).collect();
    lines.push(format!("{:>LABEL_WIDTH$} ┼{}", "$0", "─".repeat(CURVE_COLUMNS)));
    let (from, to) = ("day 0", format!("day {last}"));
    let gap = CURVE_COLUMNS.saturating_sub(from.len() + to.len());
    lines.push(format!("{:LABEL_WIDTH$}  {from}{}{to}", "", " ".repeat(gap)));
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn card_column_heights_match_cash() {
        let cash: Vec<f64> = (0..66).map(|day| f64::from(day) * 10.0).collect();
        let lines = curve_lines(&cash);
        assert_eq!(lines.len(), CURVE_ROWS + 2);
        let column = |at: usize| -> usize {
            let cell = |line: &String| line.chars().nth(LABEL_WIDTH + 2 + at).unwrap_or(' ');
            let eighths =
                |line: &String| EIGHTHS.iter().position(|character| *character == cell(line)).unwrap_or(0);
            lines[..CURVE_ROWS].iter().map(eighths).sum()
        };
        assert_eq!((column(0), column(65)), (0, 80));
        for at in 0..66 {
            assert_eq!(column(at), (80.0 * at as f64 / 65.0).round() as usize, "column {at}");
        }
        assert!(lines[CURVE_ROWS + 1].ends_with("day 65"));
    }

    #[test]
    fn card_draws_bankrupt_and_empty_runs() {
        for cash in [&[][..], &[1e6][..], &[1e6, -5.0][..], &[-1.0, -2.0][..]] {
            assert_eq!(curve_lines(cash).len(), CURVE_ROWS + 2);
        }
    }
}
