//! Functions that wrap text and format figures in short form.

use unicode_width::UnicodeWidthStr;

use super::canvas::truncate_to_width;
use novamind_base::formatting::grouped_number;

/// Wraps text to a width. Lines are broken between words if possible.
pub fn wrap(text: &str, width: usize) -> Vec<String> {
    let width = width.max(1);
    let mut lines = Vec::new();
    for paragraph in text.lines() {
        // A paragraph that fits is kept unchanged, because spaces may align columns.
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

/// Wraps sentences to a width and a number of lines. Text that does not fit is cut after a sentence and marked. If even
/// the first sentence does not fit, it is cut.
pub fn wrap_sentences(text: &str, width: usize, lines: usize) -> Vec<String> {
    let all = wrap(text, width);
    if all.len() <= lines {
        return all;
    }
    let mut shortened = text.rmatch_indices(". ").map(|(at, _)| wrap(&format!("{} …", &text[..=at]), width));
    if let Some(fitting) = shortened.find(|rows| rows.len() <= lines) {
        return fitting;
    }
    let mut rows: Vec<String> = all.iter().take(lines).cloned().collect();
    if let Some(last) = rows.last_mut() {
        // The next word does not fit, so the text is cut and marked.
        *last = truncate_to_width(&format!("{last} {}", all[lines]), width);
    }
    rows
}

/// Formats a change with a sign for its direction: `▲ 120`, `▼ 3`, `=`.
pub fn format_change(change: f64, shown: &str) -> String {
    match change {
        change if change > 0.0 => format!("▲ {shown}"),
        change if change < 0.0 => format!("▼ {shown}"),
        _ => "=".to_owned(),
    }
}

/// Formats a count with its noun: `1 seat`, `1,200 seats`.
pub fn format_count(number: f64, noun: &str) -> String {
    novamind_base::formatting::pluralize(number.clamp(0.0, f64::from(u32::MAX)) as u32, noun)
}

/// Formats a number with as many decimals as necessary, at most two.
pub fn format_number(value: f64) -> String {
    // The sum of an empty iterator is minus zero. Adding zero removes its sign.
    let value = value + 0.0;
    let decimals = if value.fract() == 0.0 || value.abs() >= 10_000.0 { 0 } else { 2 };
    grouped_number(value, decimals)
}

/// Returns the first wording that fits into a width, or the last wording if none fits.
pub fn first_fitting(wordings: impl IntoIterator<Item = String>, width: usize) -> String {
    let mut last = String::new();
    for wording in wordings {
        if wording.width() <= width {
            return wording;
        }
        last = wording;
    }
    last
}

/// Joins pieces with dots and wraps the result between pieces. A piece is split only if it is wider than a line.
pub fn join_into_lines(pieces: &[String], width: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for piece in pieces {
        match lines.last_mut() {
            Some(line) if line.width() + 3 + piece.width() <= width => {
                line.push_str(" · ");
                line.push_str(piece);
            }
            _ => lines.extend(wrap(piece, width)),
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrap_sentences_ends_after_a_sentence_with_a_mark() {
        let text = "Cash is low. It lasts 2.5 weeks. Reduce costs.";
        assert_eq!(wrap_sentences(text, 80, 1), [text]);
        assert_eq!(wrap_sentences(text, 34, 1), ["Cash is low. It lasts 2.5 weeks. …"]);
        assert_eq!(wrap_sentences(text, 14, 2), ["Cash is low. …"]);
        assert_eq!(wrap_sentences(text, 8, 1), ["Cash is…"]);
        assert_eq!(wrap_sentences(text, 8, 0), [""; 0]);
    }

    #[test]
    fn format_count_uses_the_singular_for_one() {
        assert_eq!(
            [format_count(1.0, "seat"), format_count(0.0, "seat"), format_count(1204.0, "seat")],
            ["1 seat", "0 seats", "1,204 seats"]
        );
    }

    #[test]
    fn first_fitting_falls_back_to_shorter_wordings() {
        let wordings = || ["the longest", "shorter", "short"].map(str::to_owned);
        let taken = [11, 10, 7, 6, 1].map(|width| first_fitting(wordings(), width));
        assert_eq!(taken, ["the longest", "shorter", "shorter", "short", "short"]);
    }

    #[test]
    fn join_into_lines_counts_the_separator() {
        let pieces = ["12345".to_owned(), "1234567".to_owned()];
        assert_eq!(join_into_lines(&pieces, 15), ["12345 · 1234567"]);
        assert_eq!(join_into_lines(&pieces, 14), ["12345", "1234567"]);
    }

    #[test]
    fn wrap_breaks_between_words_and_inside_long_words() {
        assert_eq!(wrap("one two three", 8), ["one two", "three"]);
        assert_eq!(wrap("abcdefghij", 4), ["abcd", "efgh", "ij"]);
        assert_eq!(wrap("  a b c", 4), ["  a", "  b", "  c"]);
        assert_eq!(wrap("a\n\nb", 9), ["a", "", "b"]);
        assert_eq!(wrap("日本語", 4), ["日本", "語"]);
        assert_eq!(wrap("x", 0), ["x"]);
        assert_eq!(wrap("a    b\nc  d", 6), ["a    b", "c  d"]);
    }
}
