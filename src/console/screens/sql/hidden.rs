//! Detection of statements that read hidden state.

use novamind_tui::sql::{LexemeKind, Token, tokens};

/// Returns whether a statement contains the name of an x-ray table, such as `hidden.groups`.
pub fn names_hidden(sql: &str) -> bool {
    let pieces: Vec<Token> =
        tokens(sql).into_iter().filter(|token| token.kind != LexemeKind::Comment).collect();
    let text = |token: &Token| sql[token.place.clone()].trim_matches(['"', '`', '[', ']']);
    let is_hidden = |pair: &[Token]| {
        pair[0].kind == LexemeKind::Name
            && text(&pair[0]).eq_ignore_ascii_case("hidden")
            && pair[1].kind == LexemeKind::Sign
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
            assert!(names_hidden(sql), "{sql}");
        }
        for sql in
            ["SELECT 'hidden.groups'", "SELECT hidden FROM x", "-- hidden.groups\nSELECT 1", "hidden", ""]
        {
            assert!(!names_hidden(sql), "{sql}");
        }
    }
}
