//! Completion of SQL: columns of the tables in the statement, tables, keywords, functions.

use novamind_database::catalogue::{Column, Table};
use novamind_database::{Interface, table, tables};
use novamind_tui::sql::{FUNCTIONS, KEYWORDS, TokenKind, Token, is_identifier_char, statement_at, tokenize};

/// A suggestion for the word at the cursor.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Candidate {
    /// Text that the suggestion inserts.
    pub word: String,
    pub description: String,
}

/// Suggestions for the word at the cursor, and the selected suggestion.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Completion {
    /// Suggestions, the best first.
    pub candidates: Vec<Candidate>,
    pub selected: usize,
    /// Number of typed characters of the word.
    pub typed_chars: usize,
}

const MAX_CANDIDATES: usize = 40;

/// A table of a statement with its alias.
struct NamedTable {
    name: String,
    table: &'static Table,
}

/// Returns the suggestions at a byte offset, from the tables of a release. Returns `None` if the word is shorter than
/// `least` characters, unless the word follows a period.
pub fn complete(sql: &str, place: usize, least: usize, interface: Interface) -> Option<Completion> {
    let (range, ..) = statement_at(sql, place);
    let start = range.start.min(place);
    let statement = &sql[start..range.end.max(place)];
    let place = place - start;
    let pieces = tokenize(statement);
    let inside = |token: &&Token| token.range.start < place && place <= token.range.end;
    let here = pieces.iter().find(inside);
    let open_comment = |token: &Token| token.kind == TokenKind::Comment;
    if here.is_some_and(|token| {
        matches!(token.kind, TokenKind::StringLiteral | TokenKind::Number) || open_comment(token)
    }) {
        return None;
    }
    let before = &statement[..place];
    let word_start = before
        .char_indices()
        .rev()
        .take_while(|(_, letter)| is_identifier_char(*letter))
        .last()
        .map_or(place, |(at, _)| at);
    let word = &before[word_start..];
    let sources = statement_tables(statement, &pieces, interface);
    let found = match before[..word_start].strip_suffix('.') {
        Some(rest) => {
            let name = rest.rsplit(|letter| !is_identifier_char(letter)).next().unwrap_or_default();
            source_candidates(name, &sources, interface)?
        }
        None if word.chars().count() < least.max(1) => return None,
        None => all_candidates(statement, &pieces, word_start, &sources, interface),
    };
    let candidates = filter_candidates(found, word);
    let finished = candidates.first().is_some_and(|first| first.word.trim_end_matches('(') == word);
    (!candidates.is_empty() && !finished).then(|| Completion {
        candidates,
        selected: 0,
        typed_chars: word.chars().count(),
    })
}

fn column_candidate(table: &Table, column: &Column) -> Candidate {
    Candidate { word: column.name.clone(), description: format!("{} {}", table.name, column.kind) }
}

fn table_candidate(table: &Table) -> Candidate {
    Candidate { word: table.name.clone(), description: "table".to_owned() }
}

/// Returns the columns of the table that has a name or alias in the statement, or a name in the database.
fn source_candidates(name: &str, sources: &[NamedTable], interface: Interface) -> Option<Vec<Candidate>> {
    let named_source = sources.iter().find(|source| source.name.eq_ignore_ascii_case(name)).map(|source| source.table);
    let source_table = named_source.or_else(|| table(interface, name))?;
    Some(source_table.columns.iter().map(|column| column_candidate(source_table, column)).collect())
}

/// Returns the suggestions for a word that does not follow a period.
fn all_candidates(
    sql: &str,
    pieces: &[Token],
    word_start: usize,
    sources: &[NamedTable],
    interface: Interface,
) -> Vec<Candidate> {
    let is_before_word = |token: &&Token| token.kind != TokenKind::Comment && token.range.end <= word_start;
    let last = pieces.iter().rev().find(is_before_word).map(|token| sql[token.range.clone()].to_uppercase());
    let wants_table = last.is_some_and(|word| word == "FROM" || word == "JOIN");
    let names = cte_names(sql, pieces)
        .into_iter()
        .map(|word| Candidate { word, description: "in this statement".to_owned() });
    let all_tables = tables(interface).iter().map(table_candidate);
    if wants_table {
        return names.chain(all_tables).collect();
    }
    let columns_of = |table: &'static Table| table.columns.iter().map(move |column| column_candidate(table, column));
    let near = sources.iter().flat_map(|source| columns_of(source.table));
    let far = tables(interface).iter().filter(|_| sources.is_empty()).flat_map(columns_of);
    let small = uses_lowercase_keywords(sql, pieces);
    let keyword = |word: &&str| Candidate {
        word: if small { word.to_lowercase() } else { (*word).to_owned() },
        description: "keyword".to_owned(),
    };
    let function = |word: &&str| Candidate { word: format!("{word}("), description: "function".to_owned() };
    near.chain(names)
        .chain(KEYWORDS.iter().map(keyword))
        .chain(FUNCTIONS.iter().map(function))
        .chain(all_tables)
        .chain(far)
        .collect()
}

/// Returns whether the user writes keywords in lower case.
fn uses_lowercase_keywords(sql: &str, pieces: &[Token]) -> bool {
    let mut keywords = pieces.iter().filter(|token| token.kind == TokenKind::Keyword);
    keywords.any(|token| sql[token.range.clone()].chars().all(char::is_lowercase))
}

/// Returns the suggestions that start with the typed word, followed by suggestions with a later part that starts with
/// the typed word. For example, `source` finds `acquisition_source`.
fn filter_candidates(found: Vec<Candidate>, word: &str) -> Vec<Candidate> {
    let wanted = word.to_lowercase();
    let begins = |candidate: &Candidate| candidate.word.to_lowercase().starts_with(&wanted);
    let part = |candidate: &Candidate| {
        wanted.len() > 1 && candidate.word.to_lowercase().contains(&format!("_{wanted}"))
    };
    let (first, rest): (Vec<_>, Vec<_>) = found.into_iter().partition(begins);
    let mut kept: Vec<Candidate> = Vec::new();
    for candidate in first.into_iter().chain(rest.into_iter().filter(part)) {
        if kept.len() < MAX_CANDIDATES && !kept.iter().any(|other| other.word == candidate.word) {
            kept.push(candidate);
        }
    }
    kept
}

/// Returns the tables in a statement, with their aliases.
fn statement_tables(sql: &str, pieces: &[Token], interface: Interface) -> Vec<NamedTable> {
    let text = |at: usize| pieces.get(at).map_or("", |token| &sql[token.range.clone()]);
    let is_name = |at: usize| pieces.get(at).is_some_and(|token| token.kind == TokenKind::Identifier);
    let mut found = Vec::new();
    for at in (0..pieces.len()).filter(|at| is_name(*at)) {
        let Some(table) = table(interface, text(at).trim_matches(['"', '`', '[', ']'])) else { continue };
        let alias = match text(at + 1).eq_ignore_ascii_case("as") {
            true => at + 2,
            false => at + 1,
        };
        // Without AS, a second name is interpreted as an alias.
        let name = if is_name(alias) { text(alias) } else { table.name.as_str() };
        found.push(NamedTable { name: name.to_owned(), table });
    }
    found
}

/// Returns the names of common table expressions: names before `AS (`.
fn cte_names(sql: &str, pieces: &[Token]) -> Vec<String> {
    let text = |token: &Token| sql[token.range.clone()].to_owned();
    let names = pieces.windows(3).filter(|three| {
        three[0].kind == TokenKind::Identifier
            && text(&three[1]).eq_ignore_ascii_case("as")
            && text(&three[2]) == "("
    });
    names.map(|three| text(&three[0])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the suggestions at the position of `|` in a statement.
    fn suggested_words(marked: &str) -> Vec<String> {
        let place = marked.find('|').expect("a mark");
        let sql = marked.replace('|', "");
        let found = complete(&sql, place, 2, Interface::Release1);
        found.map_or_else(Vec::new, |all| all.candidates.into_iter().map(|one| one.word).collect())
    }

    #[test]
    fn columns_of_the_named_tables_come_first() {
        assert_eq!(suggested_words("SELECT cust| FROM ledger JOIN customers")[..2], ["customer_id", "customer_type"]);
        assert_eq!(suggested_words("SELECT am| FROM ledger")[0], "amount");
        assert_eq!(suggested_words("SELECT sour| FROM customers")[0], "acquisition_source");
    }

    #[test]
    fn an_alias_limits_the_columns_to_its_table() {
        let all = suggested_words("SELECT s.| FROM subscriptions s JOIN customers AS c");
        assert_eq!(all.len(), table(Interface::Release1, "subscriptions").expect("a table").columns.len());
        assert_eq!(suggested_words("SELECT c.em| FROM subscriptions s JOIN customers AS c"), ["email"]);
        assert_eq!(suggested_words("SELECT customers.em|"), ["email"]);
        assert!(suggested_words("SELECT x.| FROM customers c").is_empty());
    }

    #[test]
    fn multibyte_symbol_before_a_point_is_not_a_table() {
        for typed in ["€.|", "SELECT 😀.|", "x ,–.a|", "\u{202e}٣😀.|"] {
            assert!(suggested_words(typed).is_empty(), "{typed}");
        }
    }

    #[test]
    fn tables_follow_from_and_join() {
        assert_eq!(suggested_words("SELECT * FROM le|")[0], "ledger");
        assert!(suggested_words("SELECT * FROM customers JOIN su|").contains(&"subscriptions".to_owned()));
        assert_eq!(suggested_words("WITH weekly AS (SELECT 1) SELECT * FROM we|"), ["weekly"]);
    }

    #[test]
    fn keywords_follow_the_case_of_the_statement() {
        assert_eq!(suggested_words("sel|"), ["SELECT"]);
        assert!(suggested_words("select 1 ord|").contains(&"order".to_owned()));
        assert!(suggested_words("SELECT 1 ord|").contains(&"ORDER".to_owned()));
    }

    #[test]
    fn no_completion_in_strings_comments_and_finished_words() {
        for marked in
            ["'sel|", "-- sel|", "/* sel|", "SELECT|", "SELECT 12|", "s|", "|", "SELECT * FROM ledger|"]
        {
            assert!(suggested_words(marked).is_empty(), "{marked}");
        }
        assert!(complete("s", 1, 1, Interface::Release1).is_some());
    }
}
