//! Formats simple Markdown for screens: headings, lists, emphasis, quotes and code blocks. Line breaks in the source
//! become spaces. No word is lost.

use unicode_width::{UnicodeWidthChar, UnicodeWidthStr};

/// Style of a segment of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TextStyle {
    /// Plain text.
    Text,
    /// Emphasized text.
    Strong,
    /// Text of a heading.
    Heading,
}

/// A line of text that consists of segments, each with its style.
pub type ProseLine = Vec<(String, TextStyle)>;

/// A block element of a Markdown text.
#[derive(Debug, PartialEq)]
enum MarkdownBlock {
    Heading(String),
    Paragraph(String),
    /// A list item: marker and text.
    Item(String, String),
    Quote(String),
    /// A line that is copied unchanged.
    Verbatim(String),
    Blank,
}

/// Formats text in lines of at most `width` columns.
pub fn lay_out(text: &str, width: usize) -> Vec<ProseLine> {
    let width = width.max(1);
    let mut lines: Vec<ProseLine> = Vec::new();
    for block in parse_blocks(text) {
        match block {
            MarkdownBlock::Heading(text) => {
                let shown =
                    styled_chars(&text).into_iter().map(|(letter, _)| (letter, TextStyle::Heading)).collect();
                lines.extend(wrap_chars(shown, "", "", width));
            }
            MarkdownBlock::Paragraph(text) => lines.extend(wrap_chars(styled_chars(&text), "", "", width)),
            MarkdownBlock::Item(mark, text) => {
                let blank_mark = " ".repeat(mark.width());
                lines.extend(wrap_chars(styled_chars(&text), &mark, &blank_mark, width));
            }
            MarkdownBlock::Quote(text) => lines.extend(wrap_chars(styled_chars(&text), "  ", "  ", width)),
            MarkdownBlock::Verbatim(text) => {
                let letters = text.chars().map(|letter| (letter, TextStyle::Text)).collect();
                lines.extend(match text.width() <= width {
                    true => vec![vec![(text, TextStyle::Text)]],
                    false => wrap_chars(letters, "", "", width),
                });
            }
            MarkdownBlock::Blank => lines.push(Vec::new()),
        }
    }
    lines
}

/// Formats text without styles in lines of at most `width` columns.
pub fn to_plain_text(text: &str, width: usize) -> String {
    let line = |line: ProseLine| line.into_iter().map(|(piece, _)| piece).collect::<String>();
    lay_out(text, width).into_iter().map(line).collect::<Vec<_>>().join("\n")
}

fn parse_blocks(text: &str) -> Vec<MarkdownBlock> {
    let mut blocks: Vec<MarkdownBlock> = Vec::new();
    let mut fenced = false;
    // Whether the previous line ended a block.
    let mut ends = true;
    for line in text.lines() {
        let (bare, indent) = (line.trim(), line.len() - line.trim_start().len());
        if bare.starts_with("```") {
            (fenced, ends) = (!fenced, true);
            continue;
        }
        let broken = line.ends_with("  ") || bare.ends_with('\\');
        let content = bare.strip_suffix('\\').unwrap_or(bare).trim_end();
        let fresh = match block_at_line_start(bare, indent) {
            _ if fenced => Some(MarkdownBlock::Verbatim(line.trim_end().to_owned())),
            Some(block) => Some(block),
            None => match blocks.last_mut().filter(|_| !ends) {
                Some(
                    MarkdownBlock::Paragraph(text)
                    | MarkdownBlock::Item(_, text)
                    | MarkdownBlock::Quote(text),
                ) => {
                    text.push(' ');
                    text.push_str(content);
                    None
                }
                _ if indent >= 4 => Some(MarkdownBlock::Verbatim(line.trim_end().to_owned())),
                _ => Some(MarkdownBlock::Paragraph(content.to_owned())),
            },
        };
        match (fresh, blocks.last_mut()) {
            (None, _) => {}
            (Some(MarkdownBlock::Blank), None | Some(MarkdownBlock::Blank)) => {}
            (Some(MarkdownBlock::Quote(more)), Some(MarkdownBlock::Quote(text))) if !ends => {
                text.push(' ');
                text.push_str(&more);
            }
            (Some(block), last) => {
                // Lists and headings are separated from the text around them.
                let needs_blank_line = match (last.as_deref(), &block) {
                    (None | Some(MarkdownBlock::Blank), _) | (_, MarkdownBlock::Blank) => false,
                    (Some(MarkdownBlock::Heading(_)), _) | (_, MarkdownBlock::Heading(_)) => true,
                    (Some(MarkdownBlock::Item(..)), MarkdownBlock::Paragraph(_)) => true,
                    _ => false,
                };
                if needs_blank_line {
                    blocks.push(MarkdownBlock::Blank);
                }
                blocks.push(block);
            }
        }
        ends = broken
            || matches!(
                blocks.last(),
                Some(MarkdownBlock::Heading(_) | MarkdownBlock::Verbatim(_) | MarkdownBlock::Blank) | None
            );
    }
    while blocks.last() == Some(&MarkdownBlock::Blank) {
        blocks.pop();
    }
    blocks
}

/// Returns the block element that the first characters of a line start, or `None` for ordinary text.
fn block_at_line_start(bare: &str, indent: usize) -> Option<MarkdownBlock> {
    if bare.is_empty() {
        return Some(MarkdownBlock::Blank);
    }
    let marks = bare.chars().take_while(|letter| *letter == '#').count();
    if let (1..=6, Some(text)) = (marks, bare[marks..].strip_prefix(' ')) {
        return Some(MarkdownBlock::Heading(text.trim().trim_end_matches('#').trim_end().to_owned()));
    }
    if bare.len() >= 3 && ["-", "*", "_", "="].iter().any(|rule| bare.replace(rule, "").trim().is_empty()) {
        // A horizontal rule or the underline of a heading contains no text.
        return Some(MarkdownBlock::Blank);
    }
    if bare.starts_with('|') {
        return Some(MarkdownBlock::Verbatim(bare.to_owned()));
    }
    if let Some(text) = bare.strip_prefix("> ") {
        return Some(MarkdownBlock::Quote(text.trim().to_owned()));
    }
    let margin = " ".repeat(indent.min(8));
    if let Some(text) = ["- ", "* ", "+ "].iter().find_map(|mark| bare.strip_prefix(mark)) {
        return Some(MarkdownBlock::Item(format!("{margin}· "), text.trim().to_owned()));
    }
    let digits = bare.chars().take_while(char::is_ascii_digit).count();
    let numbered = (1..=3).contains(&digits).then(|| bare[digits..].strip_prefix(". ")).flatten();
    numbered.map(|text| MarkdownBlock::Item(format!("{margin}{}. ", &bare[..digits]), text.trim().to_owned()))
}

/// Returns the characters of a text with their styles. Omits emphasis marks.
fn styled_chars(text: &str) -> Vec<(char, TextStyle)> {
    let characters: Vec<char> = text.chars().collect();
    let mut found = Vec::new();
    let mut at = 0;
    while at < characters.len() {
        let rest = &characters[at..];
        if rest[0] == '\\' && rest.get(1).is_some_and(char::is_ascii_punctuation) {
            found.push((rest[1], TextStyle::Text));
            at += 2;
            continue;
        }
        let before = at.checked_sub(1).map(|before| characters[before]);
        match emphasized_span(rest, before) {
            Some((inner, taken)) => {
                found.extend(inner.iter().map(|letter| (*letter, TextStyle::Strong)));
                at += taken;
            }
            None => {
                found.push((rest[0], TextStyle::Text));
                at += 1;
            }
        }
    }
    found
}

/// Returns the characters between two equal emphasis marks at the start of a text, and the length of the span with both
/// marks.
fn emphasized_span(rest: &[char], before: Option<char>) -> Option<(&[char], usize)> {
    const MARKS: [&[char]; 5] = [&['*', '*'], &['_', '_'], &['*'], &['_'], &['`']];
    let mark = MARKS.into_iter().find(|mark| rest.starts_with(mark))?;
    let inner = &rest[mark.len()..];
    let opens = inner.first().is_some_and(|letter| !letter.is_whitespace());
    // Underscores within a name like `filled_naively` are not emphasis marks.
    let in_word = mark[0] == '_' && before.is_some_and(char::is_alphanumeric);
    if !opens || in_word {
        return None;
    }
    let closes = |at: &usize| {
        let after = inner.get(at + mark.len());
        inner[*at..].starts_with(mark)
            && !inner[at - 1].is_whitespace()
            && (mark[0] == '`' || after != Some(&mark[0]))
            && (mark[0] != '_' || after.is_none_or(|letter| !letter.is_alphanumeric()))
    };
    let end = (1..inner.len()).find(closes)?;
    Some((&inner[..end], end + 2 * mark.len()))
}

/// Breaks characters into lines, between words if possible. The first line starts with the prefix `first`, and all
/// other lines start with `next`.
fn wrap_chars(letters: Vec<(char, TextStyle)>, first: &str, next: &str, width: usize) -> Vec<ProseLine> {
    let width_of = |word: &[(char, TextStyle)]| {
        word.iter().map(|(letter, _)| letter.width().unwrap_or(0)).sum::<usize>()
    };
    let room = width.saturating_sub(first.width()).max(1);
    let mut rows: Vec<Vec<(char, TextStyle)>> = vec![Vec::new()];
    let words = letters.split(|(letter, _)| letter.is_whitespace()).filter(|word| !word.is_empty());
    for word in words {
        let row = rows.last_mut().filter(|row| !row.is_empty());
        match row {
            Some(row) if width_of(row) + 1 + width_of(word) <= room => {
                // The space between two words of the same style also has this style.
                let face = row.last().map(|(_, face)| *face).filter(|face| *face == word[0].1);
                row.push((' ', face.unwrap_or(TextStyle::Text)));
                row.extend(word);
                continue;
            }
            Some(_) => rows.push(Vec::new()),
            None => {}
        }
        for letter in word {
            if rows.last().is_some_and(|row| !row.is_empty() && width_of(row) + width_of(&[*letter]) > room) {
                rows.push(Vec::new());
            }
            rows.extend(rows.is_empty().then(Vec::new));
            if let Some(row) = rows.last_mut() {
                row.push(*letter);
            }
        }
    }
    let line = |(at, row): (usize, Vec<(char, TextStyle)>)| {
        let before = if at == 0 { first } else { next };
        let mut line: ProseLine = Vec::new();
        if !before.is_empty() {
            line.push((before.to_owned(), TextStyle::Text));
        }
        for (letter, face) in row {
            match line.last_mut() {
                Some((piece, text_style)) if *text_style == face => piece.push(letter),
                _ => line.push((letter.to_string(), face)),
            }
        }
        line
    };
    rows.into_iter().enumerate().map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const CONSENT_TEXT: &str = "# Taking part\n\nYou run **four simulated\nweeks** of a company. Names like filled_naively\nand 3 * 4 \
                           stay.\n- one *thing*\n  that goes on\n- `withdraw` erases it\n1. first\n\n> said\n> twice\n\n    as it   \
                           is\n```\n# no heading\n```\nSigned: A\\_B  \nNext line\n";

    #[test]
    fn headings_lists_and_emphasis_are_styled() {
        assert_eq!(
            to_plain_text(CONSENT_TEXT, 40),
            "Taking part\n\nYou run four simulated weeks of a\ncompany. Names like filled_naively and 3\n* 4 stay.\n\
             · one thing that goes on\n· withdraw erases it\n1. first\n\n  said twice\n\n    as it   is\n# no heading\n\
             Signed: A_B\nNext line"
        );
        let lines = lay_out(CONSENT_TEXT, 40);
        assert_eq!(lines[0], [("Taking part".to_owned(), TextStyle::Heading)]);
        let (text, strong) = (TextStyle::Text, TextStyle::Strong);
        let third = [("You run ", text), ("four simulated weeks", strong), (" of a", text)];
        assert_eq!(lines[2], third.map(|(piece, face)| (piece.to_owned(), face)));
    }

    #[test]
    fn wrapping_keeps_every_word_within_the_width() {
        let bare = |text: &str| text.chars().filter(|letter| letter.is_alphanumeric()).collect::<String>();
        for text in [
            CONSENT_TEXT,
            "**open",
            "a ** b",
            "*",
            "`",
            "__",
            "# ",
            "#none",
            "- ",
            "日本語の同意書です。 **同意**",
            "\\",
        ] {
            for width in 1..60 {
                let shown = to_plain_text(text, width);
                assert_eq!(bare(&shown), bare(text), "{width}: {shown}");
                // A line can be no narrower than a list marker and one double-width character.
                let widest = shown.lines().map(UnicodeWidthStr::width).max().unwrap_or(0);
                assert!(widest <= width.max(6), "{width}: {shown}");
            }
        }
    }
}
