//! A run that is watched from far away: four figures, the curve of cash, and what was decided.

use ratatui::layout::Rect;

use super::canvas::{Canvas, rows_of};
use super::company::Company;
use super::screens::Look;
use super::text::short_dollars;
use super::theme::Role;
use super::viewer::{EntriesShown, Viewer};
use super::widgets::chart::zero_if_near;
use super::widgets::{Axis, Line, Side, Unit, chart};
use novamind_base::notation::compact;

/// Rows of a letter, in points.
const POINTS: usize = 5;
/// Columns of a letter with the gap after it, in points.
const LETTER: u16 = 4;
/// Letters of the longest figure: `-$12.3M`.
const LONGEST: u16 = 7;
/// Columns that the four figures take side by side when a point is a column wide.
const SIDE_BY_SIDE: u16 = 4 * (LONGEST * LETTER + 1);

/// How large a point of a letter is.
#[derive(Clone, Copy, PartialEq, Eq)]
enum PointSize {
    /// A column wide and half a row high.
    Small,
    /// Two columns wide and a row high.
    Large,
}

impl PointSize {
    fn columns(self) -> u16 {
        if self == PointSize::Small { 1 } else { 2 }
    }

    fn rows(self) -> u16 {
        if self == PointSize::Small { 3 } else { POINTS as u16 }
    }
}

/// Draws the view.
pub fn draw(canvas: &mut Canvas<'_>, area: Rect, viewer: &Viewer, look: &Look<'_>) {
    let size = match area.width >= 2 * SIDE_BY_SIDE - 36 && area.height >= 30 {
        true => PointSize::Large,
        false => PointSize::Small,
    };
    let beside = if area.width >= SIDE_BY_SIDE * size.columns() - 36 { 4 } else { 2 };
    // Label and letters.
    let tall = size.rows() + 1;
    let gap = u16::from(area.height >= 24);
    for (at, (label, figure, role)) in (0u16..).zip(figures(look.company)) {
        let place = Rect {
            x: area.x + at % beside * (area.width / beside),
            y: area.y + at / beside * (tall + gap),
            width: area.width / beside,
            height: tall,
        };
        canvas.text(
            Rect { x: place.x + 1, width: place.width.saturating_sub(1), height: 1, ..place },
            label,
            Role::Dim,
        );
        let letters = Rect {
            x: place.x + 1,
            y: place.y + 1,
            width: place.width.saturating_sub(1),
            height: size.rows(),
        };
        draw_large(canvas, letters, &figure, role, size);
    }
    let used = 4 / beside * (tall + gap);
    let below = Rect { y: area.y + used, height: area.height.saturating_sub(used), ..area };
    let left = Rect { width: below.width * 3 / 5, ..below };
    draw_cash(canvas, left, look.company);
    let right = Rect { x: left.right(), width: below.width - left.width, ..below };
    viewer.draw_decisions(canvas, right, look, EntriesShown::Decisions);
}

fn figures(company: &Company) -> [(&'static str, String, Role); 4] {
    let seen = &company.seen;
    let change = company.weeks.last().map_or(0.0, |week| week.cash_change);
    let sign = if change > 0.0 { "+" } else { "" };
    let role = |value: f64| if value < 0.0 { Role::Bad } else { Role::Good };
    [
        ("day", seen.day.to_string(), Role::Strong),
        ("cash", short_dollars(seen.cash), role(seen.cash)),
        ("cash, last week", format!("{sign}{}", short_dollars(change)), role(change)),
        ("subscribers", compact(f64::from(seen.subscribers)), Role::Strong),
    ]
}

fn draw_cash(canvas: &mut Canvas<'_>, area: Rect, company: &Company) {
    let inside = canvas.pane(area, "Cash", &format!("of {} days", company.seen.last_day), false);
    let points = (0u32..).zip(&company.cash_by_day).map(|(day, cash)| (f64::from(day), *cash)).collect();
    let x = Axis { write: &|day| format!("day {day:.0}"), holds: &[0.0] };
    let y = Side { unit: Unit::Dollars, holds: zero_if_near(company.cash_by_day.iter().copied()) };
    chart(canvas, inside, &[Line::through(points, Role::Series(0))], &x, &y);
}

/// Draws a figure in large letters; as it is where they have no room.
fn draw_large(canvas: &mut Canvas<'_>, area: Rect, figure: &str, role: Role, size: PointSize) {
    let columns = figure.chars().count() as u16 * LETTER * size.columns();
    if columns > area.width + size.columns() {
        return canvas.text(Rect { y: area.y + area.height / 2, height: 1, ..area }, figure, role);
    }
    for (row, place) in rows_of(area).enumerate() {
        let mut text = String::new();
        for letter in figure.chars() {
            let points = letter_points(letter);
            let at = |y: usize, x: u8| points.get(y).is_some_and(|row| row & (0b100 >> x) != 0);
            for x in 0..3 {
                match size {
                    PointSize::Small => text.push(match (at(2 * row, x), at(2 * row + 1, x)) {
                        (true, true) => '█',
                        (true, false) => '▀',
                        (false, true) => '▄',
                        (false, false) => ' ',
                    }),
                    PointSize::Large => text += if at(row, x) { "██" } else { "  " },
                }
            }
            text += if size == PointSize::Small { " " } else { "  " };
        }
        canvas.text(place, text.trim_end(), role);
    }
}

/// A letter of figures, row by row from above, three points each.
fn letter_points(letter: char) -> [u8; POINTS] {
    match letter {
        '0' => [0b111, 0b101, 0b101, 0b101, 0b111],
        '1' => [0b010, 0b110, 0b010, 0b010, 0b111],
        '2' => [0b111, 0b001, 0b111, 0b100, 0b111],
        '3' => [0b111, 0b001, 0b111, 0b001, 0b111],
        '4' => [0b101, 0b101, 0b111, 0b001, 0b001],
        '5' => [0b111, 0b100, 0b111, 0b001, 0b111],
        '6' => [0b111, 0b100, 0b111, 0b101, 0b111],
        '7' => [0b111, 0b001, 0b010, 0b010, 0b010],
        '8' => [0b111, 0b101, 0b111, 0b101, 0b111],
        '9' => [0b111, 0b101, 0b111, 0b001, 0b111],
        '$' => [0b011, 0b110, 0b111, 0b011, 0b110],
        '.' => [0b000, 0b000, 0b000, 0b000, 0b010],
        ',' => [0b000, 0b000, 0b000, 0b010, 0b100],
        '-' => [0b000, 0b000, 0b111, 0b000, 0b000],
        '+' => [0b000, 0b010, 0b111, 0b010, 0b000],
        'k' => [0b100, 0b101, 0b110, 0b101, 0b101],
        'M' => [0b101, 0b111, 0b111, 0b101, 0b101],
        'B' => [0b110, 0b101, 0b110, 0b101, 0b110],
        _ => [0; POINTS],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_kit::painted;

    #[test]
    fn a_figure_is_large_where_it_has_room() {
        let drawn = |figure: &str, size| {
            painted(30, size_rows(size), |canvas, area| draw_large(canvas, area, figure, Role::Text, size))
        };
        fn size_rows(size: PointSize) -> u16 {
            size.rows()
        }
        assert_eq!(
            drawn("17", PointSize::Small),
            ["▄█  ▀▀█", " █   █", "▀▀▀  ▀"].map(|row| row.to_owned()).to_vec()
        );
        assert_eq!(drawn("1", PointSize::Large)[4], "██████");
        assert_eq!(drawn("$12,345,678,901", PointSize::Small)[1], "$12,345,678,901");
    }

    #[test]
    fn every_letter_of_a_figure_is_known() {
        for text in ["0123456789", "-$1.23M", "+$999k", "1.2B"] {
            for letter in text.chars() {
                assert_ne!(letter_points(letter), [0; POINTS], "{letter}");
            }
        }
    }
}
