//! The card as text: a curve of block characters with figures below.

use super::{Card, CardFigure};
use crate::words::dollar_tick;

const COLUMNS: usize = 66;
const ROWS: usize = 10;
const LABELS: usize = 10;
const FACT: usize = 26;

/// Characters filled from below, by eighths.
const EIGHTHS: [char; 9] = [' ', '▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];

pub fn write(card: &Card) -> String {
    let mut lines = vec![format!("NovaMind · {}", card.source), String::new(), card.headline.clone()];
    lines.extend(card.rank.clone());
    lines.extend(card.voice.map(str::to_owned));
    lines.push(String::new());
    lines.extend(curve(&card.cash_by_day));
    lines.push(String::new());
    lines.extend(facts(&card.turning_points));
    lines.extend(facts(&card.numbers));
    lines.join("\n") + "\n"
}

fn facts(facts: &[CardFigure]) -> [String; 2] {
    let row = |text: fn(&CardFigure) -> &String| {
        facts.iter().map(|fact| format!("{:<FACT$}", text(fact))).collect::<String>().trim_end().to_owned()
    };
    [row(|fact| &fact.value), row(|fact| &fact.name)]
}

/// Draws columns from zero to the cash of each day.
fn curve(cash: &[f64]) -> Vec<String> {
    let last = cash.len().saturating_sub(1);
    let most = cash.iter().copied().fold(0.0, f64::max);
    let height = |column: usize| {
        let value = cash.get(column * last / (COLUMNS - 1)).copied().unwrap_or(0.0);
        let share = if most > 0.0 { (value / most).clamp(0.0, 1.0) } else { 0.0 };
        (share * (8 * ROWS) as f64).round() as usize
    };
    let heights: Vec<usize> = (0..COLUMNS).map(height).collect();
    let line = |row: usize| {
        let below = 8 * (ROWS - 1 - row);
        let label = if row == 0 { dollar_tick(most) } else { String::new() };
        let cells: String = heights.iter().map(|own| EIGHTHS[own.saturating_sub(below).min(8)]).collect();
        format!("{label:>LABELS$} ┤{cells}").trim_end().to_owned()
    };
    let mut lines: Vec<String> = (0..ROWS).map(line).collect();
    lines.push(format!("{:>LABELS$} ┼{}", "$0", "─".repeat(COLUMNS)));
    let (from, to) = ("day 0", format!("day {last}"));
    let gap = COLUMNS.saturating_sub(from.len() + to.len());
    lines.push(format!("{:LABELS$}  {from}{}{to}", "", " ".repeat(gap)));
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_as_high_as_the_cash_of_their_days() {
        let cash: Vec<f64> = (0..66).map(|day| f64::from(day) * 10.0).collect();
        let lines = curve(&cash);
        assert_eq!(lines.len(), ROWS + 2);
        let column = |at: usize| -> usize {
            let cell = |line: &String| line.chars().nth(LABELS + 2 + at).unwrap_or(' ');
            let eighths = |line: &String| EIGHTHS.iter().position(|own| *own == cell(line)).unwrap_or(0);
            lines[..ROWS].iter().map(eighths).sum()
        };
        assert_eq!((column(0), column(65)), (0, 80));
        for at in 0..66 {
            assert_eq!(column(at), (80.0 * at as f64 / 65.0).round() as usize, "column {at}");
        }
        assert!(lines[ROWS + 1].ends_with("day 65"));
    }

    #[test]
    fn a_ruin_and_nothing_at_all_are_drawn_too() {
        for cash in [&[][..], &[1e6][..], &[1e6, -5.0][..], &[-1.0, -2.0][..]] {
            assert_eq!(curve(cash).len(), ROWS + 2);
        }
    }
}
