//! Replaces box-drawing, block and braille characters in a finished frame.

use ratatui::buffer::Buffer;

/// Replaces every non-ASCII character with a similar ASCII character.
pub fn replace_non_ascii(buffer: &mut Buffer) {
    for cell in &mut buffer.content {
        if !cell.symbol().is_ascii() {
            let substitute = cell.symbol().chars().next().map_or(' ', ascii_substitute);
            cell.set_char(substitute);
        }
    }
}

fn ascii_substitute(letter: char) -> char {
    match letter {
        // Thick lines mark the focused pane, so their ASCII character differs from the character of thin lines.
        '━' => '=',
        '┃' | '┏' | '┓' | '┗' | '┛' => '#',
        '─' | '–' | '—' | '⠤' | '⎯' => '-',
        '│' | '▏' | '▌' | '▎' | '┊' => '|',
        '┈' => '.',
        '▀' => '"',
        '┌' | '┐' | '└' | '┘' | '├' | '┤' | '┬' | '┴' | '┼' | '╭' | '╮' | '╰' | '╯' => {
            '+'
        }
        '▁' => '_',
        '▂' => '.',
        '▃' | '▄' => '-',
        '▅' | '▆' => '=',
        '▇' => '%',
        '█' | '▓' => '#',
        '▒' | '░' => ':',
        '▲' | '↑' => '^',
        '◂' => '<',
        '¼' | '½' => '.',
        '▼' | '↓' | '▾' => 'v',
        '▸' | '►' | '→' | '›' => '>',
        '←' | '‹' => '<',
        '●' | '•' | '·' | '◆' => '*',
        '✓' => 'x',
        '…' | '±' => '~',
        '↳' => '>',
        '×' => 'x',
        '≡' => '=',
        '’' | '‘' => '\'',
        '“' | '”' => '"',
        '\u{2800}' => ' ',
        '\u{2801}'..='\u{28ff}' => '*',
        _ => '?',
    }
}
