//! Help for SQL: explanations of errors and of empty results.

use std::collections::BTreeSet;

use super::catalogue::{HIDDEN_SCHEMA, Scope, Surface, Table, table};
use super::guard::is_unsafe_function;
use super::math_functions::register_math_functions;
use super::tokens::{Token, TokenKind, tokenize};
use novamind_base::similar_names;

/// Converts an error message of the engine to an explanation with valid alternatives. Suggestions contain only names
/// of visible tables, functions of the engine and names in the statement.
pub(super) fn explain_error(message: &str, sql: &str, surface: Surface) -> String {
    if let Some(column) = message.strip_prefix("no such column: ") {
        return explain_unknown_column(column, sql, surface);
    }
    if let Some(name) = message.strip_prefix("no such table: ") {
        return explain_unknown_table(name, surface);
    }
    if let Some(name) = message.strip_prefix("no such function: ") {
        let known = function_names();
        let meant = suggestion(name, known.iter().map(String::as_str));
        return format!("there is no function {name}{meant}");
    }
    if let Some(column) = message.strip_prefix("ambiguous column name: ") {
        let holders: Vec<&str> = surface
            .tables()
            .filter(|table| {
                table.columns.iter().any(|table_column| table_column.name.eq_ignore_ascii_case(column))
            })
            .map(|table| table.name.as_str())
            .collect();
        let holders = if holders.is_empty() { "several tables".to_owned() } else { holders.join(", ") };
        return format!(
            "column {column} is ambiguous: {holders} have this column; put the table name before \
             the column, as in table.{column}"
        );
    }
    message.to_owned()
}

/// Returns a question such as `; did you mean customers?` if a known name is similar to `name`.
fn suggestion<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> String {
    let near = similar_names(name, known);
    // A known name that differs in more than a third of the letters is not a useful suggestion.
    let is_close =
        |known: &&&str| strsim::damerau_levenshtein(&name.to_lowercase(), known) * 3 <= name.len().max(3);
    let begins =
        |known: &&&str| known.starts_with(&name.to_lowercase()) || name.to_lowercase().starts_with(**known);
    let near: Vec<&str> =
        near.iter().filter(|known| is_close(known) || (name.len() > 2 && begins(known))).copied().collect();
    match near[..] {
        [] => String::new(),
        [one] => format!("; did you mean {one}?"),
        [ref others @ .., last] => format!("; did you mean {} or {last}?", others.join(", ")),
    }
}

/// Returns the names of the functions that a statement can call.
fn function_names() -> Vec<String> {
    let names = || -> rusqlite::Result<Vec<String>> {
        let engine = rusqlite::Connection::open_in_memory()?;
        register_math_functions(&engine)?;
        let mut statement = engine.prepare("SELECT DISTINCT name FROM pragma_function_list ORDER BY name")?;
        statement.query_map([], |row| row.get(0))?.collect()
    };
    let can_be_called = |name: &String| {
        name.starts_with(|first: char| first.is_ascii_lowercase())
            && !name.starts_with("sqlite_")
            && !is_unsafe_function(name)
    };
    names().unwrap_or_default().into_iter().filter(can_be_called).collect()
}

fn explain_unknown_table(name: &str, surface: Surface) -> String {
    let mut names: Vec<&str> = surface.tables().map(|table| table.name.as_str()).collect();
    names.sort_unstable();
    let (schema, alone) = name.split_once('.').unwrap_or_default();
    let help = match table(surface.interface, alone) {
        Some(_) => format!("; write {alone} alone"),
        None if surface.scope == Scope::Hidden && schema.eq_ignore_ascii_case(HIDDEN_SCHEMA) => {
            suggestion(name, names.iter().copied())
        }
        None => suggestion(if alone.is_empty() { name } else { alone }, names.iter().copied()),
    };
    // A suggestion already ends with a question mark.
    let end = if help.ends_with('?') { " The" } else { "; the" };
    format!("there is no table {name}{help}{end} tables are {}", names.join(", "))
}

fn explain_unknown_column(column: &str, sql: &str, surface: Surface) -> String {
    let mentioned = mentioned_tables(sql, surface);
    if mentioned.is_empty() {
        return format!(
            "there is no column {column}; describe_tables and the table browser list the columns of every table"
        );
    }
    let alone = column.rsplit('.').next().unwrap_or(column);
    let columns =
        mentioned.iter().flat_map(|table| &table.columns).map(|table_column| table_column.name.as_str());
    let columns: BTreeSet<&str> = columns.collect();
    let mut help = match columns.contains(alone) {
        // The column exists under another alias of its table.
        true => String::new(),
        false => suggestion(alone, columns.iter().copied()),
    };
    let elsewhere = surface.tables().filter(|table| {
        table.columns.iter().any(|table_column| table_column.name.eq_ignore_ascii_case(alone))
    });
    let elsewhere: Vec<&str> = elsewhere.map(|table| table.name.as_str()).collect();
    if help.is_empty() && !columns.contains(alone) && !elsewhere.is_empty() {
        let verb = if elsewhere.len() == 1 { "has" } else { "have" };
        help = format!("; {} {verb} a column of that name", elsewhere.join(", "));
    }
    let lists: Vec<String> = mentioned
        .iter()
        .map(|table| {
            let columns: Vec<&str> = table.columns.iter().map(|column| column.name.as_str()).collect();
            format!("{} has {}", table.name, columns.join(", "))
        })
        .collect();
    let end = if help.ends_with('?') { " " } else { "; " };
    format!("there is no column {column}{help}{end}{}", lists.join("; "))
}

/// Returns the tables whose names occur in a statement as whole words.
fn mentioned_tables(sql: &str, surface: Surface) -> Vec<&'static Table> {
    let words: Vec<&str> = sql.split(|letter: char| !letter.is_alphanumeric() && letter != '_').collect();
    let is_mentioned = |name: &str| words.iter().any(|word| word.eq_ignore_ascii_case(name));
    surface.tables().filter(|table| table.name.split('.').all(is_mentioned)).collect()
}

/// Returns a hint for an empty result if the statement compares a column with a text that the column never contains.
pub(super) fn empty_result_hint(sql: &str, surface: Surface) -> Option<String> {
    let mentioned = mentioned_tables(sql, surface);
    let mut hints = Vec::new();
    for (column, value) in text_comparisons(sql, surface) {
        let lists = mentioned.iter().flat_map(|table| &table.columns).filter(|table_column| {
            table_column.name.eq_ignore_ascii_case(&column) && !table_column.values.is_empty()
        });
        let lists: Vec<&Vec<String>> = lists.map(|table_column| &table_column.values).collect();
        if !lists.is_empty() && !lists.iter().any(|values| values.contains(&value)) {
            let valid: Vec<String> = lists[0].iter().map(|known| format!("'{known}'")).collect();
            hints.push(format!("{column} is never '{value}'; it is one of {}", valid.join(", ")));
        }
    }
    (!hints.is_empty()).then(|| hints.join("; "))
}

/// Returns the column and the text of each comparison between a column and a text, in either order. Like the engine,
/// treats a name in double quotes as a text if no column has this name.
fn text_comparisons(sql: &str, surface: Surface) -> Vec<(String, String)> {
    let tokens = tokenize(sql);
    let mut found = Vec::new();
    for (at, token) in tokens.iter().enumerate() {
        let doubled = tokens.get(at + 1).is_some_and(|next| next.is_symbol("="));
        let compares = (token.is_symbol("=") && !doubled) || token.is_word("IS");
        let Some(left) = tokens[..at].iter().rfind(|before| !before.is_symbol("=")) else { continue };
        let Some(right) = tokens.get(at + 1).filter(|_| compares) else { continue };
        for (column, text) in [(left, right), (right, left)] {
            if is_text_literal(text, surface) && column.can_be_name() && !is_text_literal(column, surface) {
                found.push((column.unquoted().into_owned(), text.unquoted().into_owned()));
            }
        }
    }
    found
}

fn is_text_literal(token: &Token<'_>, surface: Surface) -> bool {
    let is_column = |name: &str| {
        let mut columns = surface.tables().flat_map(|table| &table.columns);
        columns.any(|column| column.name.eq_ignore_ascii_case(name))
    };
    match token.kind {
        TokenKind::Text => true,
        TokenKind::Quoted => token.text.starts_with('"') && !is_column(&token.unquoted()),
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use novamind_world::params::Interface;

    const VISIBLE: Surface = Surface { interface: Interface::Release1, scope: Scope::Visible };
    const HIDDEN: Surface = Surface { interface: Interface::Release1, scope: Scope::Hidden };

    fn explain_error(message: &str, sql: &str) -> String {
        super::explain_error(message, sql, VISIBLE)
    }

    fn empty_result_hint(sql: &str) -> Option<String> {
        super::empty_result_hint(sql, VISIBLE)
    }

    #[test]
    fn unknown_column_error_lists_valid_columns() {
        let text = explain_error("no such column: c_max", "SELECT c_max FROM issues");
        assert!(text.starts_with("there is no column c_max; issues has issue_id, customer_id"), "{text}");
        assert!(explain_error("no such column: x", "SELECT x").contains("table browser"));
    }

    #[test]
    fn misspelled_names_get_suggestions() {
        for (message, sql, help) in [
            (
                "no such table: custmers",
                "",
                "there is no table custmers; did you mean customers? The tables are ",
            ),
            ("no such table: main.Ledgr", "", "there is no table main.Ledgr; did you mean ledger? The"),
            ("no such table: xyz", "", "there is no table xyz; the tables are"),
            (
                "no such column: c.grup_id",
                "SELECT c.grup_id FROM customers c",
                "; did you mean group_id? customers has",
            ),
            ("no such column: amout", "SELECT amout FROM ledger", "; did you mean amount? ledger has"),
            (
                "no such column: effective_price",
                "SELECT effective_price FROM ledger",
                "; subscriptions has a column of that",
            ),
            ("no such function: roundd", "", "there is no function roundd; did you mean round?"),
            ("no such function: sqr", "", "there is no function sqr; did you mean sqrt?"),
            ("no such function: median_of_all", "", "there is no function median_of_all"),
        ] {
            let text = explain_error(message, sql);
            assert!(text.contains(help), "{text}");
        }
    }

    #[test]
    fn suggestions_contain_only_visible_names() {
        let hidden =
            ["customer_rows", "subscription_rows", "ledger_blocks", "issue_clock", "repeated_losses"];
        let inside =
            ["c_max", "q_max", "sqlite_master", "load_extension", "pragma_table_info", "fts3_tokenizer"];
        for name in hidden.into_iter().chain(inside) {
            // Each misspelled name omits one letter.
            for at in 0..name.len() {
                let typed = format!("{}{}", &name[..at], &name[at + 1..]);
                for kind in ["table", "column", "function"] {
                    let text = explain_error(&format!("no such {kind}: {typed}"), "SELECT 1 FROM customers");
                    assert!(!text.contains(name), "{text}");
                }
            }
        }
    }

    #[test]
    fn unknown_table_error_lists_all_19_tables() {
        let text = explain_error("no such table: customer", "SELECT 1 FROM customer");
        assert!(text.contains("ad_channel_leads, ads_revenue, agent_social_media_posts"));
        assert_eq!(text.matches(", ").count(), 18);
        let text = explain_error("no such table: temp.customers", "SELECT 1 FROM temp.customers");
        assert!(text.starts_with("there is no table temp.customers; write customers alone; the"), "{text}");
    }

    #[test]
    fn ambiguous_column_error_names_its_tables() {
        let text = explain_error("ambiguous column name: status", "");
        assert!(text.contains("subscriptions, research_projects, issues"), "{text}");
        let text = explain_error("ambiguous column name: rowid", "");
        assert!(text.starts_with("column rowid is ambiguous: several tables have this column"), "{text}");
    }

    #[test]
    fn empty_result_hints_keep_case() {
        let sql = "SELECT * FROM subscriptions WHERE status = 'active'";
        let hint = empty_result_hint(sql).expect("a hint");
        assert!(hint.contains("'lead', 'subscribed', 'cancelled', 'lost'"), "{hint}");
        assert_eq!(empty_result_hint("SELECT * FROM subscriptions WHERE plan = 'A'"), None);
        assert!(empty_result_hint("SELECT * FROM subscriptions WHERE plan = 'a'").is_some());
        assert_eq!(empty_result_hint("SELECT * FROM ledger WHERE category='ad_revenue'"), None);
        assert_eq!(empty_result_hint("SELECT * FROM ledger WHERE note = 'x'"), None);
        assert_eq!(empty_result_hint("SELECT 1 WHERE status = 'active'"), None);
        assert!(empty_result_hint("SELECT * FROM issues i WHERE i.status=='closed'").is_some());
    }

    #[test]
    fn double_quoted_text_gets_the_same_hint() {
        let plain = empty_result_hint("SELECT * FROM subscriptions WHERE status = 'active'");
        for sql in [
            "SELECT * FROM subscriptions WHERE status = \"active\"",
            "SELECT * FROM subscriptions WHERE \"status\" = \"active\"",
            "SELECT * FROM subscriptions WHERE \"active\" == status",
            "SELECT * FROM subscriptions WHERE 'active' = [status]",
            "SELECT * FROM subscriptions AS s WHERE s.status IS \"active\"",
        ] {
            assert_eq!(empty_result_hint(sql), plain, "{sql}");
        }
        assert_eq!(empty_result_hint("SELECT * FROM subscriptions WHERE status = \"plan\""), None);
        assert_eq!(
            empty_result_hint("SELECT * FROM subscriptions WHERE status = \"lost\" -- or = 'active'"),
            None
        );
        assert_eq!(
            empty_result_hint("SELECT 'status = ''active''' FROM subscriptions WHERE end_day = 5"),
            None
        );
    }

    #[test]
    fn only_the_xray_connection_suggests_hidden_tables() {
        let explain = |message: &str, sql: &str| super::explain_error(message, sql, HIDDEN);
        let text = explain("no such table: hidden.group", "");
        assert!(text.starts_with("there is no table hidden.group; did you mean hidden.groups"), "{text}");
        assert!(text.contains("hidden.competitors, hidden.customers, hidden.drift"), "{text}");
        let text = explain("no such column: reputaton", "SELECT reputaton FROM hidden.groups");
        assert!(text.contains("did you mean reputation? hidden.groups has day, group_id"), "{text}");
        let sql = "SELECT 1 FROM hidden.threads WHERE kind = 'lead'";
        let hint = super::empty_result_hint(sql, HIDDEN).expect("a hint");
        assert!(hint.contains("'new_lead', 'plan_change'"), "{hint}");
        assert_eq!(empty_result_hint(sql), None);
        let unknown = |schema: &str| {
            explain_error(&format!("no such table: {schema}.groups"), "").replace(schema, "other")
        };
        assert_eq!(unknown("hidden"), unknown("sealed"));
        assert!(!unknown("sealed").contains("hidden"));
    }
}
