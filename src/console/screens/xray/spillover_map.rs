//! Spillover between groups as a heat map. Glyphs and signs show the same information as colors.

use std::ops::Range;

use unicode_width::UnicodeWidthStr;

use super::inspection_text::StyledRow;
use novamind_report::inspection::{HEAT_MARKS, SpilloverCell, SpilloverMap, SpilloverRow};
use novamind_tui::text::wrap;
use novamind_tui::theme::Role;

/// Width of a cell that contains its number.
const WIDE_CELL_WIDTH: usize = 13;
/// Width of a cell that contains only a glyph and a sign.
const NARROW_CELL_WIDTH: usize = 5;
const NAME_WIDTH: usize = 6;

/// Returns the rows of a map that fit into a width. Numbers are in the cells if they fit, otherwise below the map.
/// Columns that do not fit are in an additional block.
pub fn rows(map: &SpilloverMap, width: usize) -> Vec<StyledRow> {
    let plain = |text: &str, role| wrap(text, width).into_iter().map(move |part| vec![(part, role)]);
    let mut rows: Vec<StyledRow> = plain(&map.heading, Role::Header).collect();
    if !map.rows.is_empty() {
        let number = map.rows.iter().map(|row| row.own_change.width()).chain([OWN_CHANGE_LABEL.width()]).max().unwrap_or(0) + 2;
        let room = width.saturating_sub(NAME_WIDTH + number);
        let is_wide = map.targets.len() * WIDE_CELL_WIDTH <= room;
        let cell = if is_wide { WIDE_CELL_WIDTH } else { NARROW_CELL_WIDTH };
        let in_block = (room / cell).max(1);
        for from in (0..map.targets.len().max(1)).step_by(in_block) {
            let block = from..(from + in_block).min(map.targets.len());
            let mut head = format!("{:<NAME_WIDTH$}{OWN_CHANGE_LABEL:<number$}", "from");
            map.targets[block.clone()].iter().for_each(|group| head += &format!("{:<cell$}", group.id()));
            rows.push(vec![(head, Role::Header)]);
            rows.extend(map.rows.iter().map(|row| map_row(row, block.clone(), number, is_wide)));
        }
        rows.extend(plain(LEGEND, Role::Dim));
        if !is_wide {
            let number_texts = map.rows.iter().filter_map(|row| row_numbers(row, map));
            rows.extend(number_texts.flat_map(|text| plain(&text, Role::Text).collect::<Vec<StyledRow>>()));
        }
    }
    rows.extend(map.notes.iter().flat_map(|note| plain(note, Role::Text)));
    rows
}

const OWN_CHANGE_LABEL: &str = "own change";
const LEGEND: &str =
    "░ ▒ ▓ █ share of the largest spillover · + raises, - lowers · x dropped · dot: no weight";

fn map_row(row: &SpilloverRow, block: Range<usize>, number: usize, is_wide: bool) -> StyledRow {
    let mut pieces =
        vec![(format!("{:<NAME_WIDTH$}", row.from.id()), Role::Header), (format!("{:<number$}", row.own_change), Role::Text)];
    pieces.extend(row.cells[block].iter().map(|cell| {
        let (text, role) = match *cell {
            SpilloverCell::NoWeight => ("·".to_owned(), Role::Dim),
            SpilloverCell::Dropped if is_wide => (cell.describe(), Role::Dim),
            SpilloverCell::Dropped => ("x".to_owned(), Role::Dim),
            SpilloverCell::Applied(change, _) if is_wide => (cell.describe(), change_role(change)),
            SpilloverCell::Applied(change, mark) => {
                let sign = if change < 0.0 { "-" } else { "+" };
                (format!("{}{sign}", HEAT_MARKS[mark].repeat(2)), change_role(change))
            }
        };
        let wide = if is_wide { WIDE_CELL_WIDTH } else { NARROW_CELL_WIDTH };
        (format!("{text:<wide$}"), role)
    }));
    pieces
}

fn change_role(change: f64) -> Role {
    if change < 0.0 { Role::Bad } else { Role::Good }
}

/// Formats the numbers of a row: `  S1→ S2 +0.000120, S3 -0.000002`. Returns `None` if no group received spillover.
fn row_numbers(row: &SpilloverRow, map: &SpilloverMap) -> Option<String> {
    let changes = row.cells.iter().zip(&map.targets).filter_map(|(cell, to)| match cell {
        SpilloverCell::Applied(change, _) => Some(format!("{to} {change:+.6}")),
        SpilloverCell::NoWeight | SpilloverCell::Dropped => None,
    });
    let texts: Vec<String> = changes.collect();
    (!texts.is_empty()).then(|| format!("  {}→ {}", row.from, texts.join(", ")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use novamind_session::identifiers::Group;

    fn map(targets: usize) -> SpilloverMap {
        let groups: Vec<Group> = Group::all().take(targets).collect();
        let cell = |at: usize| match at % 4 {
            0 => SpilloverCell::NoWeight,
            1 => SpilloverCell::Dropped,
            mark => SpilloverCell::Applied(if mark == 2 { -0.0002 } else { 0.0003 }, mark),
        };
        let row = SpilloverRow {
            from: groups[0],
            own_change: "+0.001000 dropped".to_owned(),
            cells: (0..targets).map(cell).collect(),
        };
        SpilloverMap {
            heading: "changes".to_owned(),
            targets: groups,
            rows: vec![row],
            notes: vec!["note".to_owned()],
        }
    }

    #[test]
    fn every_spillover_has_a_mark_and_a_number_at_any_width() {
        for (targets, width) in [(4, 120), (4, 40), (12, 120), (12, 60), (26, 30), (1, 1)] {
            let map = map(targets);
            let rows: Vec<String> = rows(&map, width)
                .iter()
                .map(|row| row.iter().map(|(text, _)| text.as_str()).collect())
                .collect();
            let text = rows.join("\n");
            let number = map.rows[0].cells.iter().filter(|cell| matches!(cell, SpilloverCell::Applied(..))).count();
            let words: String = text.split_whitespace().collect();
            assert_eq!(words.matches("0.0002").count() + words.matches("0.0003").count(), number, "{text}");
            let wide = |row: &&String| row.trim_end().width() > width;
            assert!(width < 40 || !rows.iter().any(|row| wide(&row)), "{width}:\n{text}");
        }
    }

    #[test]
    fn symbols_repeat_the_meaning_of_colors() {
        let map = map(4);
        let cells: Vec<(String, Role)> = rows(&map, 40)[2].iter().skip(2).cloned().collect();
        let shown: Vec<(&str, Role)> = cells.iter().map(|(text, role)| (text.trim_end(), *role)).collect();
        let expected = [("·", Role::Dim), ("x", Role::Dim), ("▓▓-", Role::Bad), ("██+", Role::Good)];
        assert_eq!(shown, expected[..shown.len()]);
        assert!(shown.len() >= 3);
    }
}
