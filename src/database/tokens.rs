//! Splits a statement into tokens, as the engine does: names, texts, numbers and symbols.

use std::borrow::Cow;
use std::ops::Range;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum TokenKind {
    /// An unquoted name or a keyword.
    Name,
    /// A name in double quotes, brackets or backquotes, or a text in double quotes.
    Quoted,
    /// A text in single quotes.
    Text,
    /// A number or a parameter.
    Number,
    /// Any other character, such as an operator or a bracket.
    Symbol,
}

/// A token of a statement.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Token<'a> {
    /// Whether the token is a name, a text, a number or a symbol.
    pub kind: TokenKind,
    /// Source text of the token.
    pub text: &'a str,
    /// Byte offset of the token in the statement.
    pub offset: usize,
}

impl<'a> Token<'a> {
    /// Returns the byte range of the token in the statement.
    pub fn range(&self) -> Range<usize> {
        self.offset..self.offset + self.text.len()
    }

    /// Returns the text of the token without quotes.
    pub fn unquoted(&self) -> Cow<'a, str> {
        let quote = match (self.kind, self.text.chars().next()) {
            (TokenKind::Quoted | TokenKind::Text, Some('[')) => ']',
            (TokenKind::Quoted | TokenKind::Text, Some(quote)) => quote,
            _ => return Cow::Borrowed(self.text),
        };
        let inner = &self.text[1..];
        let inner = inner.strip_suffix(quote).unwrap_or(inner);
        match quote != ']' && inner.contains(quote) {
            true => Cow::Owned(inner.replace(&String::from_iter([quote, quote]), &quote.to_string())),
            false => Cow::Borrowed(inner),
        }
    }

    /// Returns whether the token is this unquoted keyword or name, ignoring case.
    pub fn is_word(&self, word: &str) -> bool {
        self.kind == TokenKind::Name && self.text.eq_ignore_ascii_case(word)
    }

    /// Returns whether the token is this symbol.
    pub fn is_symbol(&self, sign: &str) -> bool {
        self.kind == TokenKind::Symbol && self.text == sign
    }

    /// Returns whether the token is a quoted or unquoted name.
    pub fn can_be_name(&self) -> bool {
        matches!(self.kind, TokenKind::Name | TokenKind::Quoted | TokenKind::Text)
    }
}

/// Returns all tokens of a statement, without spaces and comments. An unterminated token extends to the end of the
/// text.
pub(super) fn tokenize(sql: &str) -> Vec<Token<'_>> {
    let mut found = Vec::new();
    let mut at = 0;
    while at < sql.len() {
        let (kind, length) = next_token(&sql[at..]);
        found.extend(kind.map(|kind| Token { kind, text: &sql[at..at + length], offset: at }));
        at += length;
    }
    found
}

/// Returns the kind and length of the first token. The kind of spaces and comments is `None`.
fn next_token(rest: &str) -> (Option<TokenKind>, usize) {
    let until = |end: &str, from: usize| rest[from..].find(end).map(|at| from + at + end.len());
    let first = rest.chars().next().unwrap_or(' ');
    match first {
        _ if rest.starts_with("--") => (None, until("\n", 2).unwrap_or(rest.len())),
        _ if rest.starts_with("/*") => (None, until("*/", 2).unwrap_or(rest.len())),
        blank if blank.is_ascii_whitespace() => (None, 1),
        '\'' => (Some(TokenKind::Text), quoted_length(rest, '\'')),
        '"' | '`' => (Some(TokenKind::Quoted), quoted_length(rest, first)),
        '[' => (Some(TokenKind::Quoted), until("]", 1).unwrap_or(rest.len())),
        '?' | '0'..='9' => (Some(TokenKind::Number), 1 + word_length(&rest[1..])),
        ':' | '@' | '#' if word_length(&rest[1..]) > 0 => {
            (Some(TokenKind::Number), 1 + word_length(&rest[1..]))
        }
        letter if starts_name(letter) => (Some(TokenKind::Name), word_length(rest)),
        other => (Some(TokenKind::Symbol), other.len_utf8()),
    }
}

fn starts_name(letter: char) -> bool {
    letter.is_ascii_alphabetic() || letter == '_' || !letter.is_ascii()
}

fn word_length(rest: &str) -> usize {
    let outside = |letter: char| !(starts_name(letter) || letter.is_ascii_digit() || letter == '$');
    rest.find(outside).unwrap_or(rest.len())
}

/// Returns the length of the quoted text at the start of `rest`. A doubled quote does not end the text.
fn quoted_length(rest: &str, quote: char) -> usize {
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
    fn tokenize_splits_names_texts_and_symbols() {
        let sql =
            "SELECT c.\"row\"\"id\", 'it''s' -- from words\n FROM [a b] /* x */ c WHERE x<>1.5e3 AND ?1=:a";
        let words: Vec<(TokenKind, String)> =
            tokenize(sql).iter().map(|token| (token.kind, token.unquoted().into_owned())).collect();
        let name = |word: &str| (TokenKind::Name, word.to_owned());
        let sign = |word: &str| (TokenKind::Symbol, word.to_owned());
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
        fn tokenize_consumes_any_text(sql in "\\PC*") {
            let mut end = 0;
            for token in tokenize(&sql) {
                prop_assert!(token.offset >= end && !token.text.is_empty());
                prop_assert_eq!(&sql[token.range()], token.text);
                end = token.range().end;
                token.unquoted();
            }
        }
    }
}
