//! Large letters for the projector view.

use ratatui::layout::Rect;

use crate::canvas::{Canvas, row_rects};
use crate::theme::Role;

/// Height of a letter, in points.
const LETTER_HEIGHT_POINTS: usize = 5;
/// Width of a letter and the gap after it, in points.
pub const LETTER_WIDTH_POINTS: u16 = 4;

/// Width and height of one point of a large letter.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum PointSize {
    /// A point that is one column wide and half a row high.
    Small,
    /// A point that is two columns wide and one row high.
    Large,
}

impl PointSize {
    /// Returns the width of a point, in columns.
    pub fn columns(self) -> u16 {
        if self == PointSize::Small { 1 } else { 2 }
    }

    /// Returns the height of a letter, in rows.
    pub fn rows(self) -> u16 {
        if self == PointSize::Small { 3 } else { LETTER_HEIGHT_POINTS as u16 }
    }
}

/// Draws a figure in large letters, or as plain text if large letters do not fit.
pub fn draw_large_text(canvas: &mut Canvas<'_>, area: Rect, figure: &str, role: Role, size: PointSize) {
    let columns = figure.chars().count() as u16 * LETTER_WIDTH_POINTS * size.columns();
    if columns > area.width + size.columns() {
        return canvas.draw_text(Rect { y: area.y + area.height / 2, height: 1, ..area }, figure, role);
    }
    for (row, place) in row_rects(area).enumerate() {
        let mut text = String::new();
        for letter in figure.chars() {
            let points = letter_bitmap(letter);
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
        canvas.draw_text(place, text.trim_end(), role);
    }
}

/// Returns the bitmap of a letter: one value per row, from top to bottom. The lower three bits of a value are the
/// points of the row.
fn letter_bitmap(letter: char) -> [u8; LETTER_HEIGHT_POINTS] {
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
        _ => [0; LETTER_HEIGHT_POINTS],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render_rows;

    #[test]
    fn large_text_falls_back_without_space() {
        let drawn = |figure: &str, size| {
            render_rows(30, letter_rows(size), |canvas, area| {
                draw_large_text(canvas, area, figure, Role::Text, size)
            })
        };
        fn letter_rows(size: PointSize) -> u16 {
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
    fn every_letter_of_a_figure_has_a_bitmap() {
        for text in ["0123456789", "-$1.23M", "+$999k", "1.2B"] {
            for letter in text.chars() {
                assert_ne!(letter_bitmap(letter), [0; LETTER_HEIGHT_POINTS], "{letter}");
            }
        }
    }
}
