//! Tokens of a statement: names, texts and signs with their positions, as in the engine.

use std::borrow::Cow;
use std::ops::Range;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum TokenKind {
    /// A name or a keyword.
    Name,
    /// A name in double quotes, brackets or backquotes, or a text in double quotes.
    Quoted,
    /// A text in single quotes.
    Text,
    /// A number or a parameter.
    Number,
    /// Anything else: one character.
    Sign,
}

/// A token of a statement.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Token<'a> {
    /// Kind.
    pub kind: TokenKind,
    /// Source text.
    pub written: &'a str,
    /// Byte offset.
    pub at: usize,
}

impl<'a> Token<'a> {
    /// Returns its byte range.
    pub fn place(&self) -> Range<usize> {
        self.at..self.at + self.written.len()
    }

    /// Returns its content without quotes.
    pub fn content(&self) -> Cow<'a, str> {
        let quote = match (self.kind, self.written.chars().next()) {
            (TokenKind::Quoted | TokenKind::Text, Some('[')) => ']',
            (TokenKind::Quoted | TokenKind::Text, Some(quote)) => quote,
            _ => return Cow::Borrowed(self.written),
        };
        let inner = &self.written[1..];
        let inner = inner.strip_suffix(quote).unwrap_or(inner);
        match quote != ']' && inner.contains(quote) {
            true => Cow::Owned(inner.replace(&String::from_iter([quote, quote]), &quote.to_string())),
            false => Cow::Borrowed(inner),
        }
    }

    /// Returns whether it is this keyword or name; case-insensitive.
    pub fn is(&self, word: &str) -> bool {
        self.kind == TokenKind::Name && self.written.eq_ignore_ascii_case(word)
    }

    /// Returns whether it is this sign.
    pub fn is_sign(&self, sign: &str) -> bool {
        self.kind == TokenKind::Sign && self.written == sign
    }

    /// Returns whether it is a name, quoted or not.
    pub fn may_name(&self) -> bool {
        matches!(self.kind, TokenKind::Name | TokenKind::Quoted | TokenKind::Text)
    }
}

/// Returns all tokens of a statement, without spaces and comments. An unterminated token extends to the end of the text.
pub(super) fn tokens(sql: &str) -> Vec<Token<'_>> {
    let mut found = Vec::new();
    let mut at = 0;
    while at < sql.len() {
        let (kind, length) = next(&sql[at..]);
        found.extend(kind.map(|kind| Token { kind, written: &sql[at..at + length], at }));
        at += length;
    }
    found
}

/// Returns kind and length of the first token; spaces and comments have no kind.
fn next(rest: &str) -> (Option<TokenKind>, usize) {
    let until = |end: &str, from: usize| rest[from..].find(end).map(|at| from + at + end.len());
    let first = rest.chars().next().unwrap_or(' ');
    match first {
        _ if rest.starts_with("--") => (None, until("\n", 2).unwrap_or(rest.len())),
        _ if rest.starts_with("/*") => (None, until("*/", 2).unwrap_or(rest.len())),
        blank if blank.is_ascii_whitespace() => (None, 1),
        '\'' => (Some(TokenKind::Text), quoted(rest, '\'')),
        '"' | '`' => (Some(TokenKind::Quoted), quoted(rest, first)),
        '[' => (Some(TokenKind::Quoted), until("]", 1).unwrap_or(rest.len())),
        '?' | '0'..='9' => (Some(TokenKind::Number), 1 + word_length(&rest[1..])),
        ':' | '@' | '#' if word_length(&rest[1..]) > 0 => {
            (Some(TokenKind::Number), 1 + word_length(&rest[1..]))
        }
        letter if begins_name(letter) => (Some(TokenKind::Name), word_length(rest)),
        other => (Some(TokenKind::Sign), other.len_utf8()),
    }
}

fn begins_name(letter: char) -> bool {
    letter.is_ascii_alphabetic() || letter == '_' || !letter.is_ascii()
}

fn word_length(rest: &str) -> usize {
    let outside = |letter: char| !(begins_name(letter) || letter.is_ascii_digit() || letter == '$');
    rest.find(outside).unwrap_or(rest.len())
}

/// Returns the length of a leading quoted text; a doubled quote does not end it.
fn quoted(rest: &str, quote: char) -> usize {
    let mut letters = rest.char_indices().skip(1).peekable();
    while let Some((at, letter)) = letters.next() {
        if letter == quote && letters.next_if(|(_, next)| *next == quote).is_none() {
            return at + 1;
        }
    }
    rest.len()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn statements_fall_into_names_texts_and_signs() {
        let sql =
            "SELECT c.\"row\"\"id\", 'it''s' -- from words\n FROM [a b] /* x */ c WHERE x<>1.5e3 AND ?1=:a";
        let words: Vec<(TokenKind, String)> =
            tokens(sql).iter().map(|token| (token.kind, token.content().into_owned())).collect();
        let name = |word: &str| (TokenKind::Name, word.to_owned());
        let sign = |word: &str| (TokenKind::Sign, word.to_owned());
        let quoted = |word: &str| (TokenKind::Quoted, word.to_owned());
        let number = |word: &str| (TokenKind::Number, word.to_owned());
        let expected = [
            name("SELECT"),
            name("c"),
            sign("."),
            quoted("row\"id"),
            sign(","),
            (TokenKind::Text, "it's".to_owned()),
            name("FROM"),
            quoted("a b"),
            name("c"),
            name("WHERE"),
            name("x"),
            sign("<"),
            sign(">"),
            number("1"),
            sign("."),
            number("5e3"),
            name("AND"),
            number("?1"),
            sign("="),
            number(":a"),
        ];
        assert_eq!(words, expected);
    }

    proptest! {
        #[test]
        fn any_text_is_read_to_its_end(sql in "\\PC*") {
            let mut end = 0;
            for token in tokens(&sql) {
                prop_assert!(token.at >= end && !token.written.is_empty());
                prop_assert_eq!(&sql[token.place()], token.written);
                end = token.place().end;
                token.content();
            }
        }
    }
}
