//! Components of terminal applications, independent of the simulator: canvas, themes, widgets, keys, fuzzy
//! search, and pictures of frames.

pub mod ascii;
pub mod asciicast;
pub mod canvas;
pub mod chord;
pub mod frame_export;
pub mod fuzzy;
pub mod glyphs;
pub mod sql;
pub mod terminal;
pub mod text;
pub mod theme;
pub mod widgets;

/// Draws into a window of the given size and returns the text of each row, without trailing spaces.
#[cfg(test)]
fn render_rows(
    width: u16,
    height: u16,
    draw: impl FnOnce(&mut canvas::Canvas<'_>, ratatui::layout::Rect),
) -> Vec<String> {
    let area = ratatui::layout::Rect::new(0, 0, width, height);
    let mut buffer = ratatui::buffer::Buffer::empty(area);
    let theme = theme::Theme::bundled("mono").expect("a theme");
    draw(&mut canvas::Canvas::new(&mut buffer, &theme), area);
    let line = |y: u16| (0..width).map(|x| buffer[(x, y)].symbol()).collect::<String>();
    (0..height).map(|y| line(y).trim_end().to_owned()).collect()
}
