//! SQL tokens, for highlighting and completion. Statements are often unfinished, so the tokenizer reports no errors.
//! An unterminated token extends to the end of the text.

use std::ops::Range;

use crate::theme::Role;

/// The kind of a SQL token.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TokenKind {
    /// One of [`KEYWORDS`], in upper or lower case.
    Keyword,
    /// A plain or quoted identifier.
    Identifier,
    /// A string in single quotes.
    StringLiteral,
    /// A number, possibly incomplete.
    Number,
    /// A comment of one or several lines.
    Comment,
    /// Any other character that is not white space.
    Symbol,
}

impl TokenKind {
    /// Returns the role that determines the color of the token.
    pub fn role(self) -> Role {
        match self {
            TokenKind::Keyword => Role::Keyword,
            TokenKind::Identifier | TokenKind::Symbol => Role::Text,
            TokenKind::StringLiteral => Role::SqlString,
            TokenKind::Number => Role::Number,
            TokenKind::Comment => Role::Comment,
        }
    }
}

/// A SQL token with its byte range.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Token {
    /// What the token is, which determines its color.
    pub kind: TokenKind,
    /// The byte range of the token in the text.
    pub range: Range<usize>,
}

/// SQL keywords for highlighting and completion.
pub const KEYWORDS: [&str; 66] = [
    "SELECT",
    "FROM",
    "WHERE",
    "GROUP",
    "ORDER",
    "BY",
    "LIMIT",
    "HAVING",
    "JOIN",
    "LEFT",
    "INNER",
    "CROSS",
    "FULL",
    "OUTER",
    "RIGHT",
    "NATURAL",
    "ON",
    "USING",
    "AS",
    "AND",
    "OR",
    "NOT",
    "IN",
    "IS",
    "NULL",
    "LIKE",
    "GLOB",
    "BETWEEN",
    "EXISTS",
    "CASE",
    "WHEN",
    "THEN",
    "ELSE",
    "END",
    "DISTINCT",
    "ALL",
    "ASC",
    "DESC",
    "NULLS",
    "FIRST",
    "LAST",
    "OFFSET",
    "WITH",
    "RECURSIVE",
    "MATERIALIZED",
    "UNION",
    "INTERSECT",
    "EXCEPT",
    "VALUES",
    "CAST",
    "COLLATE",
    "NOCASE",
    "ESCAPE",
    "OVER",
    "PARTITION",
    "WINDOW",
    "ROWS",
    "RANGE",
    "PRECEDING",
    "FOLLOWING",
    "UNBOUNDED",
    "CURRENT",
    "ROW",
    "FILTER",
    "TRUE",
    "FALSE",
];

/// SQL functions for completion, without the opening parenthesis.
pub const FUNCTIONS: [&str; 32] = [
    "count",
    "sum",
    "avg",
    "min",
    "max",
    "total",
    "round",
    "abs",
    "coalesce",
    "ifnull",
    "nullif",
    "iif",
    "length",
    "lower",
    "upper",
    "substr",
    "instr",
    "replace",
    "trim",
    "printf",
    "group_concat",
    "row_number",
    "rank",
    "dense_rank",
    "ntile",
    "lag",
    "lead",
    "first_value",
    "last_value",
    "sqrt",
    "floor",
    "ceil",
];

/// Returns whether a character can be part of an identifier.
pub fn is_identifier_char(letter: char) -> bool {
    letter.is_alphanumeric() || letter == '_'
}

/// Splits a text into SQL tokens and skips whitespace.
pub fn tokenize(sql: &str) -> Vec<Token> {
    let mut found = Vec::new();
    let mut at = 0;
    while let Some(first) = sql[at..].chars().next() {
        let rest = &sql[at..];
        let (kind, length) = match first {
            blank if blank.is_whitespace() => {
                at += blank.len_utf8();
                continue;
            }
            '-' if rest.starts_with("--") => (TokenKind::Comment, rest.find('\n').unwrap_or(rest.len())),
            '/' if rest.starts_with("/*") => {
                (TokenKind::Comment, rest[2..].find("*/").map_or(rest.len(), |end| end + 4))
            }
            '\'' => (TokenKind::StringLiteral, quoted_length(rest, '\'')),
            '"' | '`' => (TokenKind::Identifier, quoted_length(rest, first)),
            '[' => (TokenKind::Identifier, rest.find(']').map_or(rest.len(), |end| end + 1)),
            digit if digit.is_ascii_digit() => (TokenKind::Number, number_length(rest)),
            '.' if rest[1..].starts_with(|next: char| next.is_ascii_digit()) => {
                (TokenKind::Number, number_length(rest))
            }
            letter if is_identifier_char(letter) => {
                let end = rest.find(|next| !is_identifier_char(next)).unwrap_or(rest.len());
                let known = KEYWORDS.iter().any(|word| word.eq_ignore_ascii_case(&rest[..end]));
                (if known { TokenKind::Keyword } else { TokenKind::Identifier }, end)
            }
            other => (TokenKind::Symbol, other.len_utf8()),
        };
        found.push(Token { kind, range: at..at + length });
        at += length;
    }
    found
}

/// Returns the length in bytes of a quoted token. A doubled quote does not end the token.
fn quoted_length(rest: &str, quote: char) -> usize {
    let mut at = 1;
    while let Some(end) = rest[at..].find(quote) {
        at += end + 1;
        if !rest[at..].starts_with(quote) {
            return at;
        }
        at += 1;
    }
    rest.len()
}

/// Returns the length in bytes of a number token, which can contain digits, letters, a decimal point and an exponent
/// with a sign.
fn number_length(rest: &str) -> usize {
    let mut before = ' ';
    let part_of = |letter: char| {
        let exponent = matches!(before, 'e' | 'E') && matches!(letter, '+' | '-');
        before = letter;
        letter.is_ascii_alphanumeric() || letter == '.' || exponent
    };
    let mut part_of = part_of;
    rest.find(|letter| !part_of(letter)).unwrap_or(rest.len())
}

/// Returns the range of the statement at a byte position (excluding its final semicolon), the index of the statement,
/// and the number of statements. A position after the last semicolon belongs to the last statement unless another
/// statement follows.
pub fn statement_at(sql: &str, place: usize) -> (Range<usize>, usize, usize) {
    let pieces = tokenize(sql);
    let ends =
        pieces.iter().filter(|token| token.kind == TokenKind::Symbol && &sql[token.range.clone()] == ";");
    let mut from = 0;
    let mut all: Vec<Range<usize>> = Vec::new();
    for end in ends.map(|token| token.range.start).chain([sql.len()]) {
        let is_code =
            |token: &&Token| token.kind != TokenKind::Comment && (from..end).contains(&token.range.start);
        if pieces.iter().filter(is_code).count() > 0 {
            all.push(from..end);
        }
        from = (end + 1).min(sql.len());
    }
    let at = all.iter().position(|range| place <= range.end).unwrap_or(all.len().saturating_sub(1));
    match all.get(at) {
        Some(range) => (range.clone(), at + 1, all.len()),
        None => (0..sql.len(), 1, 1),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kinds(sql: &str) -> Vec<(TokenKind, &str)> {
        tokenize(sql).into_iter().map(|token| (token.kind, &sql[token.range])).collect()
    }

    #[test]
    fn tokenize_distinguishes_token_kinds() {
        use TokenKind::{Comment, Identifier, Keyword, Number, StringLiteral, Symbol};
        assert_eq!(
            kinds("select s.plan, 'it''s' -- why\nFROM \"a b\" WHERE x>=1.5e-3"),
            [
                (Keyword, "select"),
                (Identifier, "s"),
                (Symbol, "."),
                (Identifier, "plan"),
                (Symbol, ","),
                (StringLiteral, "'it''s'"),
                (Comment, "-- why"),
                (Keyword, "FROM"),
                (Identifier, "\"a b\""),
                (Keyword, "WHERE"),
                (Identifier, "x"),
                (Symbol, ">"),
                (Symbol, "="),
                (Number, "1.5e-3"),
            ]
        );
        assert_eq!(kinds("/* a */ .5 [x y]"), [(Comment, "/* a */"), (Number, ".5"), (Identifier, "[x y]")]);
    }

    #[test]
    fn tokenize_accepts_unterminated_text() {
        for sql in ["'abc", "\"", "/* x", "--", "[", "'a''", "1e", ".", "/*", "é'日", "/*/"] {
            let pieces = tokenize(sql);
            assert_eq!(pieces.last().map(|token| token.range.end), Some(sql.len()), "{sql}");
        }
        assert!(tokenize(" \n").is_empty());
    }

    #[test]
    fn statement_at_returns_the_statement_at_the_cursor() {
        let sql = "SELECT 1; SELECT ';' ;\n";
        assert_eq!(statement_at(sql, 3), (0..8, 1, 2));
        assert_eq!(statement_at(sql, 8), (0..8, 1, 2));
        assert_eq!(statement_at(sql, 12), (9..21, 2, 2));
        assert_eq!(statement_at(sql, sql.len()), (9..21, 2, 2));
        assert_eq!(statement_at("SELECT 1 -- ;\n", 2), (0..14, 1, 1));
        assert_eq!(statement_at("", 0), (0..0, 1, 1));
        assert_eq!(statement_at(";;", 1), (0..2, 1, 1));
    }
}
