//! Rasters, which draw curves as dots in terminal cells. Some markers have several dots per cell.

use ratatui::layout::Rect;
use ratatui::symbols::Marker;

use crate::canvas::Canvas;
use crate::theme::Role;

/// Bits of the braille dots, by column and row.
const BRAILLE: [[u8; 4]; 2] = [[0x01, 0x02, 0x04, 0x40], [0x08, 0x10, 0x20, 0x80]];

/// A raster of dots in an area of cells.
pub struct Raster {
    marker: Marker,
    columns: usize,
    rows: usize,
    /// For each cell, the bits of its dots, and the role of the dot that was set last.
    cells: Vec<(u8, Role)>,
}

/// Returns the number of dots per cell, horizontally and vertically.
fn dots_per_cell(marker: Marker) -> (usize, usize) {
    match marker {
        Marker::Braille => (2, 4),
        Marker::HalfBlock => (1, 2),
        _ => (1, 1),
    }
}

/// Returns the row, counted from the top, in which a raster with `rows` rows draws a share of its height, and the
/// distance of the share from the middle of that row, in rows.
pub fn row_of_share(marker: Marker, rows: u16, share: f64) -> (u16, f64) {
    let down = f64::from(dots_per_cell(marker).1 as u16);
    let dot = (1.0 - share.clamp(0.0, 1.0)) * (f64::from(rows) * down - 1.0).max(0.0);
    let row = (dot.round() / down).floor();
    (row as u16, (dot - (row * down + (down - 1.0) / 2.0)).abs() / down)
}

impl Raster {
    /// Returns an empty raster with a size in cells.
    pub fn new(marker: Marker, columns: u16, rows: u16) -> Raster {
        let (columns, rows) = (columns as usize, rows as usize);
        Raster { marker, columns, rows, cells: vec![(0, Role::Text); columns * rows] }
    }

    /// Sets a dot. Coordinates count dots from the top left corner.
    fn set_dot(&mut self, x: usize, y: usize, role: Role) {
        let (across, down) = dots_per_cell(self.marker);
        let (column, row) = (x / across, y / down);
        if column >= self.columns || row >= self.rows {
            return;
        }
        let bit = match self.marker {
            Marker::Braille => BRAILLE[x % 2][y % 4],
            Marker::HalfBlock => 1 << (y % 2),
            _ => 1,
        };
        let cell = &mut self.cells[row * self.columns + column];
        *cell = (cell.0 | bit, role);
    }

    /// Draws a line between two points. Coordinates are shares of the width and the height, from the lower left corner.
    pub fn draw_line(&mut self, from: (f64, f64), to: (f64, f64), role: Role) {
        let (from, to) = (self.dot_position(from), self.dot_position(to));
        let steps = (to.0 - from.0).abs().max((to.1 - from.1).abs()).ceil().max(1.0);
        for step in 0..=steps as usize {
            let share = step as f64 / steps;
            let (x, y) = (from.0 + (to.0 - from.0) * share, from.1 + (to.1 - from.1) * share);
            self.set_dot(x.round() as usize, y.round() as usize, role);
        }
    }

    fn dot_position(&self, (x, y): (f64, f64)) -> (f64, f64) {
        let (across, down) = dots_per_cell(self.marker);
        let max = |dots: usize| dots.saturating_sub(1) as f64;
        (x.clamp(0.0, 1.0) * max(self.columns * across), (1.0 - y.clamp(0.0, 1.0)) * max(self.rows * down))
    }

    /// Draws the dots over the existing content of an area.
    pub fn draw(&self, canvas: &mut Canvas<'_>, area: Rect) {
        for (at, (bits, role)) in self.cells.iter().enumerate().filter(|(_, (bits, _))| *bits != 0) {
            let glyph = match self.marker {
                Marker::Braille => char::from_u32(0x2800 + u32::from(*bits)).unwrap_or('⣿'),
                Marker::HalfBlock => ['▀', '▄', '█'][usize::from(*bits - 1).min(2)],
                Marker::Block => '█',
                Marker::Bar => '▄',
                Marker::Custom(character) => character,
                _ => '•',
            };
            let (x, y) = (area.x + (at % self.columns) as u16, area.y + (at / self.columns) as u16);
            let cell = Rect { x, y, width: 1, height: 1 };
            canvas.draw_text(cell, glyph.encode_utf8(&mut [0; 4]), *role);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn row_of_share_is_the_row_of_the_drawn_dot() {
        for (rows, share, row) in
            [(4, 0.0, 3), (4, 0.18, 3), (4, 0.5, 2), (4, 1.0, 0), (3, 0.5, 1), (5, 0.5, 2)]
        {
            assert_eq!(row_of_share(Marker::Braille, rows, share).0, row, "{share} of {rows} rows");
            let mut raster = Raster::new(Marker::Braille, 1, rows);
            raster.draw_line((0.0, share), (0.0, share), Role::Text);
            assert_ne!(raster.cells[usize::from(row)].0, 0, "{share} of {rows} rows");
        }
        assert!(
            row_of_share(Marker::Braille, 4, 0.5).1 > 0.25 && row_of_share(Marker::Braille, 5, 0.5).1 < 0.25
        );
        assert_eq!(row_of_share(Marker::Dot, 4, 1.0 / 3.0).0, 2);
    }
}
