//! Exports frames as text, and as SVG with terminal colors.

mod symbols;

use std::fmt::Write;

use ratatui::buffer::{Buffer, Cell};
use ratatui::style::{Color, Modifier};
use unicode_width::UnicodeWidthStr;

use novamind_base::formatting::escape_html;

/// Width of a cell, in pixels.
const CELL_WIDTH: f64 = 8.4;
/// Height of a cell, in pixels.
const CELL_HEIGHT: f64 = 18.0;
const MARGIN: f64 = 14.0;

/// Default foreground and background colors of a terminal.
#[derive(Debug, Clone, Copy)]
pub struct TerminalColors {
    foreground: &'static str,
    background: &'static str,
}

impl TerminalColors {
    /// Light text on a dark background.
    pub const DARK: TerminalColors = TerminalColors { foreground: "#d6dae1", background: "#14171c" };
    /// Dark text on a light background.
    pub const LIGHT: TerminalColors = TerminalColors { foreground: "#24292f", background: "#fbfbfa" };
}

/// Returns the text of a frame, one line per row.
pub fn frame_text(buffer: &Buffer) -> String {
    let row = |y| {
        let mut line = String::new();
        let mut x = 0;
        while x < buffer.area.width {
            let symbol = buffer[(x, y)].symbol();
            line.push_str(symbol);
            x += symbol.width().max(1) as u16;
        }
        line.trim_end().to_owned() + "\n"
    };
    (0..buffer.area.height).map(row).collect()
}

/// Returns a frame as a self-contained SVG picture.
pub fn frame_svg(buffer: &Buffer, colors: TerminalColors) -> String {
    let width = f64::from(buffer.area.width) * CELL_WIDTH + 2.0 * MARGIN;
    let height = f64::from(buffer.area.height) * CELL_HEIGHT + 2.0 * MARGIN;
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width:.0} {height:.0}\" width=\"{width:.0}\" \
         height=\"{height:.0}\" font-family=\"'DejaVu Sans Mono','Cascadia Mono','Menlo','Consolas',monospace\" \
         font-size=\"14\" xml:space=\"preserve\">\n<rect width=\"100%\" height=\"100%\" rx=\"8\" fill=\"{}\"/>\n",
        colors.background
    );
    for y in 0..buffer.area.height {
        draw_row(&mut out, buffer, y, colors);
    }
    out.push_str("</svg>\n");
    out
}

fn draw_row(out: &mut String, buffer: &Buffer, y: u16, colors: TerminalColors) {
    let cells: Vec<&Cell> = (0..buffer.area.width).map(|x| &buffer[(x, y)]).collect();
    let mut from = 0;
    for same in cells.chunk_by(|left, right| left.style() == right.style()) {
        draw_cell_run(out, (from, y), same, colors);
        from += same.len();
    }
}

/// Draws consecutive cells of a row that have the same style: first the background, then characters that are drawn as
/// paths, then text.
fn draw_cell_run(out: &mut String, (x, y): (usize, u16), cells: &[&Cell], colors: TerminalColors) {
    let (ink, ground) = cell_colors(cells[0], colors);
    let place = |column: usize| MARGIN + (x + column) as f64 * CELL_WIDTH;
    let top = MARGIN + f64::from(y) * CELL_HEIGHT;
    // Writing to a string cannot fail.
    if let Some(ground) = ground {
        let (left, width) = (place(0), cells.len() as f64 * CELL_WIDTH);
        let _ = writeln!(
            out,
            "<rect x=\"{left:.1}\" y=\"{top:.1}\" width=\"{width:.1}\" height=\"{CELL_HEIGHT}\" fill=\"{ground}\"/>"
        );
    }
    let mut shapes = String::new();
    let mut letters: Vec<(usize, String)> = Vec::new();
    let mut follows_letter = false;
    for (column, cell) in cells.iter().enumerate() {
        let drawn = cell.symbol().chars().next().is_some_and(|sign| {
            let path = symbols::symbol_path(sign, place(column), top, (CELL_WIDTH, CELL_HEIGHT));
            path.map(|path| shapes.push_str(&path)).is_some()
        });
        // Spaces are neither drawn as paths nor written as text.
        let written = !drawn && cell.symbol() != " ";
        match letters.last_mut() {
            Some((_, word)) if written && follows_letter => word.push_str(cell.symbol()),
            _ if written => letters.push((column, cell.symbol().to_owned())),
            _ => {}
        }
        follows_letter = written;
    }
    if !shapes.is_empty() {
        let _ = writeln!(out, "<path d=\"{shapes}\" fill=\"{ink}\"/>");
    }
    for (column, word) in letters {
        write_word(out, (place(column), top), &word, (&ink, cells[0].modifier));
    }
}

fn write_word(out: &mut String, (left, top): (f64, f64), word: &str, (ink, modifiers): (&str, Modifier)) {
    let weight = if modifiers.contains(Modifier::BOLD) { " font-weight=\"bold\"" } else { "" };
    let faint = if modifiers.contains(Modifier::DIM) { " opacity=\"0.6\"" } else { "" };
    let line = if modifiers.contains(Modifier::UNDERLINED) { " text-decoration=\"underline\"" } else { "" };
    // An explicit text length keeps columns aligned in any font.
    let length = word.width() as f64 * CELL_WIDTH;
    let base = top + CELL_HEIGHT * 0.76;
    let _ = writeln!(
        out,
        "<text x=\"{left:.1}\" y=\"{base:.1}\" textLength=\"{length:.1}\" lengthAdjust=\"spacingAndGlyphs\" \
         fill=\"{ink}\"{weight}{faint}{line}>{}</text>",
        escape_html(word)
    );
}

/// Returns the foreground color of a cell, and its background color unless this is the default background.
fn cell_colors(cell: &Cell, colors: TerminalColors) -> (String, Option<String>) {
    let ink = css_color(cell.fg).unwrap_or_else(|| colors.foreground.to_owned());
    let ground = css_color(cell.bg);
    if cell.modifier.contains(Modifier::REVERSED) {
        (ground.unwrap_or_else(|| colors.background.to_owned()), Some(ink))
    } else {
        (ink, ground)
    }
}

/// Returns a terminal color in CSS notation, or `None` for the default color.
fn css_color(colour: Color) -> Option<String> {
    let name = match colour {
        Color::Reset => return None,
        Color::Black => "#16191d",
        Color::Red => "#d9534f",
        Color::Green => "#3fa45b",
        Color::Yellow => "#c99a2e",
        Color::Blue => "#4f83d1",
        Color::Magenta => "#b06fc4",
        Color::Cyan => "#2fa3b5",
        Color::Gray => "#aab2bd",
        Color::DarkGray => "#6b7280",
        Color::LightRed => "#f07f7a",
        Color::LightGreen => "#74cf8c",
        Color::LightYellow => "#e8c465",
        Color::LightBlue => "#86aef0",
        Color::LightMagenta => "#d29be3",
        Color::LightCyan => "#6fd0de",
        Color::White => "#f4f6f8",
        Color::Rgb(red, green, blue) => return Some(format!("#{red:02x}{green:02x}{blue:02x}")),
        Color::Indexed(number) => return Some(indexed_color(number)),
    };
    Some(name.to_owned())
}

/// Returns a color of the 256-color terminal palette in CSS notation.
fn indexed_color(number: u8) -> String {
    let level = |step: u8| if step == 0 { 0 } else { 55 + 40 * step };
    let (red, green, blue) = match number {
        0..=15 => (128, 128, 128),
        16..=231 => (level((number - 16) / 36), level((number - 16) / 6 % 6), level((number - 16) % 6)),
        232..=255 => (8 + 10 * (number - 232), 8 + 10 * (number - 232), 8 + 10 * (number - 232)),
    };
    format!("#{red:02x}{green:02x}{blue:02x}")
}

#[cfg(test)]
mod tests {
    use ratatui::layout::Rect;
    use ratatui::style::Style;

    use super::*;

    #[test]
    fn frames_export_as_text_and_svg() {
        let mut buffer = Buffer::empty(Rect::new(0, 0, 8, 2));
        buffer.set_string(0, 0, "a<b 日本", Style::new().fg(Color::Red));
        buffer.set_string(0, 1, "on", Style::new().add_modifier(Modifier::REVERSED | Modifier::BOLD));
        assert_eq!(frame_text(&buffer), "a<b 日本\non\n");
        let picture = frame_svg(&buffer, TerminalColors::DARK);
        assert!(picture.starts_with("<svg ") && picture.ends_with("</svg>\n"), "{picture}");
        assert!(picture.contains(">a&lt;b</text>"), "{picture}");
        assert!(picture.contains("fill=\"#d9534f\""), "{picture}");
        assert!(picture.contains("fill=\"#14171c\" font-weight=\"bold\">on<"), "{picture}");
        assert_eq!(picture.matches("<text").count(), picture.matches("</text>").count());
    }

    #[test]
    fn indexed_colors_match_the_terminal_cube() {
        assert_eq!(indexed_color(16), "#000000");
        assert_eq!(indexed_color(196), "#ff0000");
        assert_eq!(indexed_color(231), "#ffffff");
        assert_eq!(indexed_color(244), "#808080");
    }
}
