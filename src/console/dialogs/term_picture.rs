//! Small pictures beside terms of the glossary: drawn by the functions that decide, of a made-up customer.

use ratatui::layout::Rect;

use crate::console::canvas::Canvas;
use crate::console::theme::Role;
use crate::console::widgets::chart::{Axis, Line, Plot, Side};
use crate::console::widgets::scale::Unit;
use crate::notation::dollars;
use crate::session::example_curve;

/// Lowest picture that can be read.
pub const LEAST_ROWS: u16 = 5;
/// Most rows that one takes.
pub const MOST_ROWS: u16 = 9;
/// Columns that one takes beside text.
pub const COLUMNS: u16 = 44;

/// Whether a term has a picture.
pub fn has_picture(term: &str) -> bool {
    matches!(term, "participation-curve" | "required-quality")
}

/// Draws the picture of a term, if it has one.
pub fn draw(canvas: &mut Canvas<'_>, area: Rect, term: &str) {
    if !has_picture(term) || area.height < LEAST_ROWS {
        return;
    }
    let lines = [Line::through(example_curve(), Role::Series(0))];
    let x = Axis { write: &|value| dollars(value), holds: &[0.0] };
    let y = Side { unit: Unit::Number, holds: &[0.0] };
    Plot { lines: &lines, band: None, mark: None, x: &x, y: &y }.draw(canvas, area);
}
