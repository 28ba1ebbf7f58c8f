//! Wrapping of text, and short formats of figures.

use unicode_width::UnicodeWidthStr;

use novamind_base::notation::grouped;

/// Wraps text to a width, between words if possible.
pub fn wrapped(text: &str, width: usize) -> Vec<String> {
    let width = width.max(1);
    let mut lines = Vec::new();
    for paragraph in text.lines() {
        // Text that fits is kept, because spaces may align columns.
        if paragraph.width() <= width {
            lines.push(paragraph.to_owned());
            continue;
        }
        let indent: String = paragraph.chars().take_while(|letter| *letter == ' ').collect();
        let mut line = indent.clone();
        for word in paragraph.split_whitespace() {
            let starts = line.trim().is_empty();
            if !starts && line.width() + 1 + word.width() > width {
                lines.push(std::mem::replace(&mut line, indent.clone()));
            } else if !starts {
                line.push(' ');
            }
            let mut rest = word;
            while line.width() + rest.width() > width && !rest.is_empty() {
                let room = width.saturating_sub(line.width()).max(1);
                let cut = rest.char_indices().map(|(at, letter)| at + letter.len_utf8());
                let cut = cut.take_while(|at| rest[..*at].width() <= room).last().unwrap_or(rest.len());
                line.push_str(&rest[..cut]);
                rest = &rest[cut..];
                if !rest.is_empty() {
                    lines.push(std::mem::take(&mut line));
                }
            }
            line.push_str(rest);
        }
        lines.push(line);
    }
    lines
}

/// Formats a change with its direction: `▲ 120`, `▼ 3`, `=`.
pub fn arrow(change: f64, shown: &str) -> String {
    match change {
        change if change > 0.0 => format!("▲ {shown}"),
        change if change < 0.0 => format!("▼ {shown}"),
        _ => "=".to_owned(),
    }
}

/// Formats a count with its noun: `1 seat`, `1,200 seats`.
pub fn count(number: f64, noun: &str) -> String {
    novamind_base::notation::count(number.clamp(0.0, f64::from(u32::MAX)) as u32, noun)
}

/// Formats a number with as many decimals as it needs, at most two.
pub fn number(value: f64) -> String {
    // An empty sum is minus zero.
    let value = value + 0.0;
    let decimals = if value.fract() == 0.0 || value.abs() >= 10_000.0 { 0 } else { 2 };
    grouped(value, decimals)
}

/// Returns the first wording that fits into a width, or the last one.
pub fn fitting(wordings: impl IntoIterator<Item = String>, width: usize) -> String {
    let mut last = String::new();
    for wording in wordings {
        if wording.width() <= width {
            return wording;
        }
        last = wording;
    }
    last
}

/// Joins pieces with dots and wraps the result between pieces. Only a piece wider than a line is split.
pub fn flowed(pieces: &[String], width: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for piece in pieces {
        match lines.last_mut() {
            Some(line) if line.width() + 3 + piece.width() <= width => {
                line.push_str(" · ");
                line.push_str(piece);
            }
            _ => lines.extend(wrapped(piece, width)),
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_is_singular() {
        assert_eq!(
            [count(1.0, "seat"), count(0.0, "seat"), count(1204.0, "seat")],
            ["1 seat", "0 seats", "1,204 seats"]
        );
    }

    #[test]
    fn a_shorter_wording_is_taken_where_the_longer_one_has_no_room() {
        let wordings = || ["the longest", "shorter", "short"].map(str::to_owned);
        let taken = [11, 10, 7, 6, 1].map(|width| fitting(wordings(), width));
        assert_eq!(taken, ["the longest", "shorter", "shorter", "short", "short"]);
    }

    #[test]
    fn a_piece_joins_a_line_in_which_it_fits_with_its_dot() {
        let pieces = ["12345".to_owned(), "1234567".to_owned()];
        assert_eq!(flowed(&pieces, 15), ["12345 · 1234567"]);
        assert_eq!(flowed(&pieces, 14), ["12345", "1234567"]);
    }

    #[test]
    fn lines_break_between_words_and_long_words_in_themselves() {
        assert_eq!(wrapped("one two three", 8), ["one two", "three"]);
        assert_eq!(wrapped("abcdefghij", 4), ["abcd", "efgh", "ij"]);
        assert_eq!(wrapped("  a b c", 4), ["  a", "  b", "  c"]);
        assert_eq!(wrapped("a\n\nb", 9), ["a", "", "b"]);
        assert_eq!(wrapped("日本語", 4), ["日本", "語"]);
        assert_eq!(wrapped("x", 0), ["x"]);
        assert_eq!(wrapped("a    b\nc  d", 6), ["a    b", "c  d"]);
    }
}
