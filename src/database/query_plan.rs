//! Query plans for users. The names of internal tables are masked.

use super::catalogue::{table, tables};
use super::guard::find_visible_table;
use super::query_result::{Cell, text_at};
use super::tokens::tokenize;
use novamind_world::params::Interface;

/// Index of the plan column that contains the number of the parent step. Column 0 contains the number of the step.
const PARENT_COLUMN: usize = 1;

const DETAIL_COLUMN: usize = 3;

/// Text that replaces internal names.
const MASK: &str = "\u{2026}";

const LOWERCASE_WORDS: [&str; 3] = ["rowid", "subquery", "join"];

/// Masks internal names in the plan of a statement, and removes the steps that only read internal tables.
pub(super) fn mask_plan(plan: &mut Vec<Vec<Cell>>, sql: &str) {
    for row in plan.iter_mut() {
        if let Some(Cell::Text(detail)) = row.get_mut(DETAIL_COLUMN) {
            *detail = mask_detail(detail, sql);
        }
    }
    let is_internal_step = |row: &Vec<Cell>| {
        let detail = text_at(row, DETAIL_COLUMN);
        let looked_up = detail.strip_prefix("SEARCH ").or(detail.strip_prefix("SCAN "));
        looked_up.is_some_and(|rest| rest.starts_with(MASK))
    };
    let (inside, mut rest): (Vec<_>, Vec<_>) = plan.drain(..).partition(is_internal_step);
    let parents: Vec<&Cell> = inside.iter().filter_map(|row| row.get(PARENT_COLUMN)).collect();
    let still: Vec<Cell> = rest.iter().filter_map(|row| row.get(PARENT_COLUMN).cloned()).collect();
    rest.retain(|row| row.first().is_none_or(|id| !parents.contains(&id) || still.contains(id)));
    *plan = rest;
}

fn mask_detail(detail: &str, sql: &str) -> String {
    // Remove the internal index string of a virtual table.
    let detail = detail.split_once(" VIRTUAL TABLE INDEX").map_or(detail, |(before, _)| before);
    let mut text = String::new();
    for word in detail.split_inclusive(|letter: char| !is_word_character(letter)) {
        let name = word.trim_end_matches(|letter| !is_word_character(letter));
        let shown = if name.is_empty() { "" } else { mask_word(name, sql) };
        // Omit the name of an index, because the columns of the index follow.
        let is_index = shown == MASK && text.ends_with("INDEX ");
        text += if is_index { "" } else { shown };
        text += if is_index { word[name.len()..].trim_start() } else { &word[name.len()..] };
    }
    text.trim_end().to_owned()
}

fn is_word_character(letter: char) -> bool {
    letter.is_alphanumeric() || letter == '_'
}

/// Returns a word of a plan, or the mask if the word may be an internal name.
fn mask_word<'a>(word: &'a str, sql: &str) -> &'a str {
    let is_keyword = word.chars().all(|letter| letter.is_ascii_uppercase() || letter.is_ascii_digit());
    let column = || {
        let mut columns = tables(Interface::Release1).iter().flat_map(|table| &table.columns);
        columns.any(|column| column.name.eq_ignore_ascii_case(word))
    };
    let occurs_in_statement = || {
        let mut contents = tokenize(sql).into_iter().map(|token| token.unquoted());
        contents.any(|content| content.split(|letter| !is_word_character(letter)).any(|text| text == word))
    };
    if is_keyword
        || LOWERCASE_WORDS.contains(&word)
        || table(Interface::Release1, word).is_some()
        || column()
        || occurs_in_statement()
    {
        return word;
    }
    find_visible_table(word).unwrap_or(MASK)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn masked_plan_names_only_visible_tables() {
        let sql = "SELECT * FROM customers c JOIN issues mine USING (customer_id)";
        for (detail, expected) in [
            ("SCAN c", "SCAN c"),
            ("SCAN customer_rows", "SCAN customers"),
            (
                "SEARCH issues USING INDEX issues_of_customers (customer_id=?)",
                "SEARCH issues USING INDEX (customer_id=?)",
            ),
            (
                "SCAN subscription_rows USING COVERING INDEX of_days",
                "SCAN subscriptions USING COVERING INDEX",
            ),
            (
                "SEARCH mine USING INTEGER PRIMARY KEY (rowid>?)",
                "SEARCH mine USING INTEGER PRIMARY KEY (rowid>?)",
            ),
            (
                "SEARCH words USING PRIMARY KEY (axis=? AND n=?)",
                "SEARCH \u{2026} USING PRIMARY KEY (\u{2026}=? AND \u{2026}=?)",
            ),
            ("CO-ROUTINE inner_0f_customers", "CO-ROUTINE \u{2026}"),
            ("SCAN daily_usage VIRTUAL TABLE INDEX 0:=c", "SCAN daily_usage"),
            ("SCAN (subquery-3)", "SCAN (subquery-3)"),
            ("USE TEMP B-TREE FOR GROUP BY", "USE TEMP B-TREE FOR GROUP BY"),
        ] {
            assert_eq!(mask_detail(detail, sql), expected);
        }
    }
}
