//! Horizontal bars with names and values, on a common scale that includes zero.

use ratatui::layout::Rect;
use unicode_width::UnicodeWidthStr;

use crate::canvas::{Align, Canvas};
use crate::theme::Role;

/// Characters for drawing the bars of each series. The characters are distinguishable without color and in ASCII.
pub const SERIES_SYMBOLS: [&str; 4] = ["█", "▒", "━", "•"];

/// A bar with its name and value.
pub struct Bar<'a> {
    /// Name of the item; empty if the row above belongs to the same item.
    pub name: &'a str,
    /// Alignment of the name. Names that are numbers are right-aligned.
    pub name_align: Align,
    /// Length of the bar in the unit of the scale; `None` for a row without a bar.
    pub value: Option<f64>,
    /// The value as text.
    pub label: &'a str,
    /// Index of the series, which selects the character of the bar.
    pub series: usize,
    /// Whether the bar is selected.
    pub selected: bool,
}

/// Layout of the names, bars and values in a row, and the scale of the bars.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BarLayout {
    name_width: u16,
    value_width: u16,
    bar_width: u16,
    /// Index of the cell that contains the zero line, counted from the left end of the bars.
    zero_cell: u16,
    cells_per_unit: f64,
}

impl BarLayout {
    /// Returns the layout in which all bars fit into rows of the given width.
    pub fn from_bars<'a>(bars: impl Iterator<Item = Bar<'a>>, width: u16) -> BarLayout {
        let (mut names, mut values, mut least, mut most) = (1, 1, 0.0_f64, 0.0_f64);
        for bar in bars {
            names = names.max(bar.name.width());
            values = values.max(bar.label.width());
            let value = bar.value.filter(|value| value.is_finite()).unwrap_or(0.0);
            (least, most) = (least.min(value), most.max(value));
        }
        let third = (width / 3).max(1);
        let names = (names.min(u16::MAX as usize) as u16).min(third.max(12)).min(width);
        let values = (values.min(u16::MAX as usize) as u16).min(third);
        // Two spaces and the zero line need three columns.
        let room = width.saturating_sub(names + values + 3);
        let span = most - least;
        let per_unit = if span > 0.0 { f64::from(room) / span } else { 0.0 };
        let zero = (-least * per_unit).round() as u16;
        BarLayout {
            name_width: names,
            value_width: values,
            bar_width: room,
            zero_cell: zero.min(room),
            cells_per_unit: per_unit,
        }
    }

    /// Returns the first cell and the number of cells of a bar. Bars of values other than zero have at least one cell.
    fn cells(&self, value: f64) -> (u16, u16) {
        let length = (value.abs() * self.cells_per_unit).round() as u16;
        let length = if value == 0.0 { 0 } else { length.max(1) };
        if value < 0.0 {
            let length = length.min(self.zero_cell);
            (self.zero_cell - length, length)
        } else {
            (self.zero_cell + 1, length.min(self.bar_width - self.zero_cell))
        }
    }

    /// Draws a bar with its name and value in a row.
    pub fn draw(&self, canvas: &mut Canvas<'_>, row: Rect, bar: &Bar<'_>) {
        let name = Rect { width: self.name_width.min(row.width), ..row };
        if bar.selected {
            canvas.clear(name, Role::Selection);
        }
        let role = if bar.selected { Role::Selection } else { Role::Text };
        canvas.draw_aligned(name, bar.name, role, bar.name_align);
        let value = Rect { x: row.x + self.name_width + 1, width: self.value_width, ..row };
        let role = if bar.value.is_some_and(|value| value < 0.0) { Role::Bad } else { Role::Text };
        canvas.draw_aligned(value.intersection(row), bar.label, role, Align::Right);
        let left = row.x + self.name_width + self.value_width + 2;
        let zero = Rect { x: left + self.zero_cell, width: 1, ..row };
        canvas.draw_text(zero.intersection(row), "│", Role::Dim);
        let Some(number) = bar.value.filter(|value| value.is_finite()) else { return };
        let (from, length) = self.cells(number);
        let cells = Rect { x: left + from, width: length, ..row };
        let sign = SERIES_SYMBOLS[bar.series % SERIES_SYMBOLS.len()];
        canvas.draw_text(cells.intersection(row), &sign.repeat(length as usize), Role::Series(bar.series));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scale(values: &[f64], width: u16) -> BarLayout {
        let bar = |value: &f64| Bar {
            name: "name",
            name_align: Align::Left,
            value: Some(*value),
            label: "-1.00",
            series: 0,
            selected: false,
        };
        BarLayout::from_bars(values.iter().map(bar).collect::<Vec<_>>().into_iter(), width)
    }

    #[test]
    fn zero_line_separates_negative_and_positive_bars() {
        // The name needs 4 columns, the value 5 and the gaps 3, which leaves 20 columns for the bars.
        let positive = scale(&[10.0, 5.0, 0.01, 0.0], 32);
        assert_eq!(positive.cells(10.0), (1, 20));
        assert_eq!(positive.cells(5.0), (1, 10));
        assert_eq!(positive.cells(0.01), (1, 1), "values other than zero are visible");
        assert_eq!(positive.cells(0.0), (1, 0));
        let both = scale(&[-10.0, 30.0], 32);
        assert_eq!(both.cells(-10.0), (0, 5));
        assert_eq!(both.cells(30.0), (6, 15));
        let negative = scale(&[-2.0, -1.0], 32);
        assert_eq!(negative.cells(-2.0), (0, 20));
        assert_eq!(negative.cells(-1.0), (10, 10));
    }

    #[test]
    fn bars_fit_any_width_with_non_finite_values() {
        for width in 0..20 {
            let narrow = scale(&[-3.0, f64::NAN, f64::INFINITY, 1e300], width);
            let (from, length) = narrow.cells(1e300);
            assert!(from + length <= narrow.bar_width + 1, "{width}");
        }
        assert_eq!(scale(&[0.0], 32).cells(0.0), (1, 0));
    }
}
