//! Detection of statements that read hidden state.

use novamind_tui::sql::{TokenKind, Token, tokenize};

/// Returns whether a statement contains the name of an x-ray table, such as `hidden.groups`.
pub fn reads_hidden_tables(sql: &str) -> bool {
    let pieces: Vec<Token> =
        tokenize(sql).into_iter().filter(|token| token.kind != TokenKind::Comment).collect();
    let text = |token: &Token| sql[token.range.clone()].trim_matches(['"', '`', '[', ']']);
    let is_hidden = |pair: &[Token]| {
        pair[0].kind == TokenKind::Identifier
            && text(&pair[0]).eq_ignore_ascii_case("hidden")
            && pair[1].kind == TokenKind::Symbol
            && text(&pair[1]) == "."
    };
    pieces.windows(2).any(is_hidden)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hidden_tables_are_named_by_their_schema() {
        for sql in ["SELECT * FROM hidden.groups", "select 1 from \"Hidden\" . drift", "x [hidden]/**/.pmi"] {
            assert!(reads_hidden_tables(sql), "{sql}");
        }
        for sql in
            ["SELECT 'hidden.groups'", "SELECT hidden FROM x", "-- hidden.groups\nSELECT 1", "hidden", ""]
        {
            assert!(!reads_hidden_tables(sql), "{sql}");
        }
    }
}
