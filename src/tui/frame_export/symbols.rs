//! SVG paths of box-drawing, block and braille characters. Characters are drawn as paths so that lines connect and
//! curves are visible in any font.

use std::fmt::Write;

/// Line width and dot diameter, in pixels.
const LINE_WIDTH: f64 = 1.2;
const THICK_LINE_WIDTH: f64 = 2.6;
const DOT_DIAMETER: f64 = 2.3;

/// Returns the SVG path of a character in a cell, or `None` for characters that are written as text.
pub fn symbol_path(sign: char, left: f64, top: f64, (width, height): (f64, f64)) -> Option<String> {
    let block = |from: f64, to: f64| rectangle_path(left, top + height * from, width, height * (to - from));
    Some(match sign {
        '\u{2801}'..='\u{28ff}' => braille_path(sign, left, top, (width, height)),
        '▁'..='█' => block(1.0 - f64::from(sign as u32 - 0x2580) / 8.0, 1.0),
        '▀' => block(0.0, 0.5),
        '░' | '▒' | '▓' => shade_path(sign, left, top, (width, height)),
        '⎯' => line_path('─', LINE_WIDTH, left, top, (width, height)),
        '─' | '│' | '┌' | '┐' | '└' | '┘' | '├' | '┤' | '┬' | '┴' | '┼' => {
            line_path(sign, LINE_WIDTH, left, top, (width, height))
        }
        _ => line_path(thin_variant(sign)?, THICK_LINE_WIDTH, left, top, (width, height)),
    })
}

fn rectangle_path(left: f64, top: f64, width: f64, height: f64) -> String {
    let mut path = String::new();
    // Writing to a string cannot fail.
    let _ = write!(path, "M{left:.1} {top:.1}h{width:.1}v{height:.1}h-{width:.1}z");
    path
}

/// Returns the path of a braille character, which has two columns of four dots. The lower six bits of its code are the
/// first three rows, column by column, and the upper two bits are the last row.
fn braille_path(sign: char, left: f64, top: f64, (width, height): (f64, f64)) -> String {
    let bits = sign as u32 - 0x2800;
    let places = [(0, 0), (0, 1), (0, 2), (1, 0), (1, 1), (1, 2), (0, 3), (1, 3)];
    let dot = |(bit, (column, row)): (usize, &(u32, u32))| {
        (bits >> bit & 1 == 1).then(|| {
            let x = left + width * (0.25 + 0.5 * f64::from(*column)) - DOT_DIAMETER / 2.0;
            let y = top + height * (0.125 + 0.25 * f64::from(*row)) - DOT_DIAMETER / 2.0;
            rectangle_path(x, y, DOT_DIAMETER, DOT_DIAMETER)
        })
    };
    places.iter().enumerate().filter_map(dot).collect()
}

/// Returns the path of a shade character: stripes that fill a quarter, a half or three quarters of the cell.
fn shade_path(sign: char, left: f64, top: f64, (width, height): (f64, f64)) -> String {
    let share = match sign {
        '░' => 0.25,
        '▒' => 0.5,
        _ => 0.75,
    };
    const STRIPES: u32 = 6;
    let step = height / f64::from(STRIPES);
    (0..STRIPES)
        .map(|stripe| rectangle_path(left, top + f64::from(stripe) * step, width, step * share))
        .collect()
}

fn thin_variant(sign: char) -> Option<char> {
    let pairs = [('━', '─'), ('┃', '│'), ('┏', '┌'), ('┓', '┐'), ('┗', '└'), ('┛', '┘')];
    pairs.into_iter().find(|(thick, _)| *thick == sign).map(|(_, thin)| thin)
}

/// Returns the path of a box-drawing character: lines from the center of the cell to those sides that the character
/// connects.
fn line_path(sign: char, line: f64, left: f64, top: f64, (width, height): (f64, f64)) -> String {
    let (to_left, to_right) = (!"│┌└├".contains(sign), !"│┐┘┤".contains(sign));
    let (up, down) = (!"─┌┐┬".contains(sign), !"─└┘┴".contains(sign));
    let (x, y) = (left + (width - line) / 2.0, top + (height - line) / 2.0);
    let (half_width, half_height) = ((width + line) / 2.0, (height + line) / 2.0);
    let lines = [
        (to_left, rectangle_path(left, y, half_width, line)),
        (to_right, rectangle_path(x, y, half_width, line)),
        (up, rectangle_path(x, top, line, half_height)),
        (down, rectangle_path(x, y, line, half_height)),
    ];
    lines.into_iter().filter(|(there, _)| *there).map(|(_, line)| line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_drawing_symbols_have_paths() {
        let drawn = |sign| symbol_path(sign, 0.0, 0.0, (8.0, 16.0));
        assert_eq!(drawn('a'), None);
        assert_eq!(drawn('…'), None);
        assert_eq!(drawn('█').as_deref(), Some("M0.0 0.0h8.0v16.0h-8.0z"));
        assert_eq!(drawn('▂').as_deref(), Some("M0.0 12.0h8.0v4.0h-8.0z"));
        let pieces = |sign| drawn(sign).map(|path| path.matches('M').count());
        assert_eq!(pieces('┼'), Some(4));
        assert_eq!(pieces('┌'), Some(2));
        assert_eq!(pieces('─'), Some(2));
        assert_eq!(pieces('┏'), Some(2));
        assert_ne!(drawn('┏'), drawn('┌'), "pictures show the focus");
        assert_eq!(pieces('\u{28ff}'), Some(8));
        assert_eq!(pieces('\u{2801}'), Some(1));
    }
}
