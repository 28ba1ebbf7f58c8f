//! The rows of a result that a count or pivot covers. Counts and pivots cover the rows that pass the filter of the
//! screen if SQL can select the same rows, otherwise all rows.

use super::picker::single_line;
use novamind_database::{Cell, QueryResult};

/// A selection of rows of a result.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum RowFilter {
    All,
    /// Rows that contain a text in at least one of the given columns.
    Containing {
        /// The searched text in lower case.
        text: String,
        columns: Vec<usize>,
    },
    /// All rows, although a filter is set. The filter matches formatted numbers, which SQL cannot reproduce.
    AllDespiteFilter(String),
}

impl RowFilter {
    /// Returns the row filter for a filter text. `shown` contains the indexes of the rows that the screen shows.
    pub fn from_filter(filter: &str, query_result: &QueryResult, shown: &[usize]) -> RowFilter {
        if filter.is_empty() {
            return RowFilter::All;
        }
        let text = filter.to_lowercase();
        let all: Vec<usize> = (0..query_result.columns.len()).filter(|at| is_exact_in_sql(query_result, *at)).collect();
        let chosen = |columns: &[usize]| -> Vec<usize> {
            let holds = |row: &Vec<Cell>| {
                columns.iter().any(|at| row.get(*at).is_some_and(|cell| cell_contains(cell, &text)))
            };
            (0..query_result.rows.len()).filter(|at| holds(&query_result.rows[*at])).collect()
        };
        let mut expected = shown.to_vec();
        expected.sort_unstable();
        // Rows beyond the row limit are unknown. A filter without letters could match numbers in these rows.
        let is_certain = !query_result.truncated || text.chars().any(char::is_alphabetic);
        if !is_certain || chosen(&all) != expected {
            return RowFilter::AllDespiteFilter(filter.to_owned());
        }
        let one = all.iter().copied().find(|at| !query_result.truncated && chosen(&[*at]) == expected);
        RowFilter::Containing { text, columns: one.map_or(all, |at| vec![at]) }
    }

    /// Returns the WHERE clause with a leading line break, or an empty text for all rows. `names` contains the column
    /// names in SQL.
    pub fn where_clause(&self, names: &[String]) -> String {
        let RowFilter::Containing { text, columns } = self else { return String::new() };
        let text = text.replace('\'', "''");
        let holds = |at: &usize| names.get(*at).map(|name| format!("instr(lower({name}), '{text}') > 0"));
        format!("\nWHERE {}", columns.iter().filter_map(holds).collect::<Vec<_>>().join("\n    OR "))
    }

    /// Returns a suffix for titles, or an empty text if there is no filter.
    pub fn label(&self) -> String {
        match self {
            RowFilter::All => String::new(),
            RowFilter::Containing { text, .. } => format!(", rows with \"{}\"", single_line(text)),
            RowFilter::AllDespiteFilter(_) => ", all rows".to_owned(),
        }
    }

    /// Returns a warning if the filter is ignored.
    pub fn warning(&self) -> Option<String> {
        let RowFilter::AllDespiteFilter(filter) = self else { return None };
        Some(format!("all rows, without the filter \"{filter}\": SQL cannot select the filtered rows"))
    }
}

/// Returns whether SQL compares the values of a column as they are displayed. Decimals are rounded on the screen.
fn is_exact_in_sql(query_result: &QueryResult, at: usize) -> bool {
    query_result.rows.iter().all(|row| !matches!(row.get(at), Some(Cell::Real(_))))
}

/// Evaluates `instr(lower(cell), text) > 0` as SQLite does. SQLite's `lower` changes only ASCII letters.
fn cell_contains(cell: &Cell, text: &str) -> bool {
    match cell {
        Cell::Text(cell_text) => cell_text.to_ascii_lowercase().contains(text),
        Cell::Integer(number) => number.to_string().contains(text),
        Cell::Real(_) | Cell::Null => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::screens::sql::aggregation::count_statement;
    use crate::screens::sql::values;
    use crate::test_kit::new_session;
    use novamind_tui::widgets::Table;

    /// Returns the row filter for a filter text, and the number of displayed rows.
    fn filter_and_row_count(query_result: &QueryResult, filter: &str) -> (RowFilter, usize) {
        let mut table = Table::new(values::columns(query_result));
        table.set_rows(values::cells(query_result));
        table.handle_action(crate::action::Action::Filter, 5);
        table.edit_filter(|field| field.insert(filter));
        (RowFilter::from_filter(filter, query_result, table.visible_rows()), table.visible_rows().len())
    }

    #[test]
    fn sql_filter_selects_the_visible_rows_or_is_omitted() {
        let mut session = new_session();
        let sql = "WITH t(name, units, price) AS (VALUES ('Ada''s', 1234, 2.5), ('GRÜN', 7, 12.0), ('grün 12', 12, NULL))
                   SELECT * FROM t";
        let query_result = session.query(sql).expect("rows");
        for (filter, shown, is_expressible) in [
            ("ada's", 1, true),
            ("12", 2, false),  // in 12.0, and not in 1,234
            ("1,2", 1, false), // the screen shows 1234 with a separator
            ("34", 1, true),
            ("gr", 2, true),
            ("ü", 2, false), // lower does not convert Ü
            ("null", 1, false),
            ("nothing", 0, true),
        ] {
            let (meant, rows) = filter_and_row_count(&query_result, filter);
            assert_eq!(rows, shown, "{filter}");
            assert_eq!(matches!(meant, RowFilter::Containing { .. }), is_expressible, "{filter}: {meant:?}");
            assert_eq!(meant.warning().is_some(), !is_expressible, "{filter}");
            let counting = count_statement(sql, &query_result.columns, 0, &meant).expect("a statement");
            let counted = session.query(&counting).unwrap_or_else(|refusal| panic!("{refusal}\n{counting}"));
            assert_eq!(counted.rows.len(), if is_expressible { shown } else { 3 }, "{counting}");
            assert!(counting.contains(if is_expressible { ", rows with" } else { ", all rows" }), "{counting}");
        }
        assert_eq!(RowFilter::from_filter("", &query_result, &[0, 1, 2]), RowFilter::All);
    }

    #[test]
    fn filters_on_unloaded_rows_apply_only_to_text() {
        let mut session = new_session();
        let sql = "WITH RECURSIVE n(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM n WHERE x < 9000)
                   SELECT x % 2 AS odd, iif(x % 3, 'some', 'third') AS word FROM n";
        let query_result = session.query(sql).expect("rows");
        assert!(query_result.truncated);
        assert!(matches!(filter_and_row_count(&query_result, "1").0, RowFilter::AllDespiteFilter(_)));
        let (words, _) = filter_and_row_count(&query_result, "thi");
        let counting = count_statement(sql, &query_result.columns, 1, &words).expect("a statement");
        let counted = session.query(&counting).expect("a count");
        assert_eq!(counted.rows, [[Cell::Text("third".to_owned()), Cell::Integer(3000), Cell::Real(100.0)]]);
    }
}
