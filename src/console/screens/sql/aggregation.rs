//! Statements that are derived from another statement: counts of the values of a column, and a pivot. Derived
//! statements run in the database, so they cover all rows of the result, not only the loaded rows. Derived statements
//! include the filter of the screen and are recorded like other queries.

use super::row_filter::RowFilter;
use super::picker::single_line;
use super::values::full_text;
use novamind_database::{Cell, QueryResult};
use novamind_record::folder::query_library::strip_header;
use novamind_tui::sql::{KEYWORDS, tokenize};

/// Maximum number of value columns of a pivot. Less frequent values share one column.
pub const MAX_PIVOT_COLUMNS: usize = 12;

/// Error for a statement from which no other statement can be derived.
pub const NOT_A_TABLE_ERROR: &str =
    "A query plan cannot be counted or pivoted. Run the statement without EXPLAIN first.";

/// Aggregate function that computes a cell of a pivot from rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Aggregate {
    Count,
    Sum,
    Mean,
    Min,
    Max,
}

impl Aggregate {
    /// Aggregate functions that apply to a column.
    pub const COLUMN_AGGREGATES: [Aggregate; 5] =
        [Aggregate::Sum, Aggregate::Mean, Aggregate::Min, Aggregate::Max, Aggregate::Count];

    pub fn label(self) -> &'static str {
        match self {
            Aggregate::Count => "count",
            Aggregate::Sum => "sum",
            Aggregate::Mean => "mean",
            Aggregate::Min => "min",
            Aggregate::Max => "max",
        }
    }

    /// Returns the SQL expression that aggregates a column, or all rows if `column` is `None`.
    fn sql(self, column: Option<&str>) -> String {
        let function = if self == Aggregate::Mean { "avg" } else { self.label() };
        format!("{function}({})", column.unwrap_or("*"))
    }
}

/// Definition of a pivot. Columns are indexes in the result.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PivotShape {
    /// Column whose values become rows of the pivot.
    pub row_column: usize,
    /// Column whose values become columns of the pivot.
    pub header_column: Option<usize>,
    /// Column to aggregate, or `None` to count rows.
    pub value_column: Option<usize>,
    pub aggregate: Aggregate,
}

/// A statement that is used as the source of a derived statement.
struct Subquery {
    /// WITH clause to put before the derived statement.
    with: String,
    /// Content of the FROM clause, followed by the WHERE clause of the row filter.
    from: String,
    names: Vec<String>,
}

impl Subquery {
    fn from_statement(sql: &str, columns: &[String], covered_rows: &RowFilter) -> Option<Subquery> {
        let body = strip_header(sql).trim().trim_end_matches(';').trim_end();
        let first = tokenize(body).into_iter().next()?;
        if body[first.range].eq_ignore_ascii_case("EXPLAIN") {
            return None;
        }
        let mut given: Vec<String> = Vec::new();
        for column in columns {
            let lower = |name: &str| name.to_lowercase();
            let free = |name: &String| given.iter().all(|given_name| lower(given_name) != lower(name));
            let first = if column.is_empty() { "column".to_owned() } else { column.clone() };
            let numbered = (2..).map(|number| format!("{first}_{number}"));
            given.extend(std::iter::once(first.clone()).chain(numbered).find(free));
        }
        let names: Vec<String> = given.iter().map(|name| quote_identifier(name)).collect();
        let clause = covered_rows.where_clause(&names);
        // SQLite interprets an unknown quoted name as a string, so columns are renamed if their names are not plain
        // identifiers or not unique.
        Some(match given == columns && names == given {
            true => Subquery { with: String::new(), from: format!("(\n{body}\n){clause}"), names },
            false => Subquery {
                with: format!("WITH result ({}) AS (\n{body}\n)\n", names.join(", ")),
                from: format!("result{clause}"),
                names,
            },
        })
    }
}

/// Returns an identifier, quoted if necessary.
fn quote_identifier(name: &str) -> String {
    let is_word = |letter: char| letter.is_ascii_alphanumeric() || letter == '_';
    let plain = name.chars().all(is_word) && !name.starts_with(|first: char| first.is_ascii_digit());
    match plain && !name.is_empty() && !KEYWORDS.iter().any(|word| word.eq_ignore_ascii_case(name)) {
        true => name.to_owned(),
        false => format!("\"{}\"", name.replace('"', "\"\"")),
    }
}

/// Returns the SQL literal of a value, or `None` if SQL cannot compare the value.
fn sql_literal(cell: &Cell) -> Option<String> {
    match cell {
        Cell::Real(number) if !number.is_finite() => None,
        Cell::Text(text) => Some(format!("'{}'", text.replace('\'', "''"))),
        other => Some(full_text(other)),
    }
}

/// Returns a statement that counts the values of a column in the result of `sql`, the most frequent first.
pub fn count_statement(sql: &str, columns: &[String], at: usize, covered_rows: &RowFilter) -> Option<String> {
    let source = Subquery::from_statement(sql, columns, covered_rows)?;
    let name = source.names.get(at)?;
    Some(format!(
        "-- title: {} counted{}\n{}SELECT {name}, count(*) AS count,\n    \
         round(100.0 * count(*) / sum(count(*)) OVER (), 1) AS percent\nFROM {}\nGROUP BY 1\nORDER BY 2 DESC, 1",
        single_line(&columns[at]),
        covered_rows.label(),
        source.with,
        source.from
    ))
}

/// Returns a statement that pivots the rows of the result of `sql` that pass the row filter.
pub fn pivot_statement(sql: &str, query_result: &QueryResult, shape: PivotShape, covered_rows: &RowFilter) -> Option<String> {
    let source = Subquery::from_statement(sql, &query_result.columns, covered_rows)?;
    let PivotShape { row_column: rows, header_column: across, value_column: values, aggregate } = shape;
    let name = |at: usize| source.names.get(at).map(String::as_str);
    let aggregated = aggregate.sql(values.and_then(name));
    let mut cells = vec![name(rows)?.to_owned()];
    if let Some(across) = across {
        let column = name(across)?;
        let DistinctValues { values, complete } = DistinctValues::from_rows(query_result, across);
        let mut listed = Vec::new();
        for value in &values {
            let (condition, label) = match value {
                Cell::Null => (format!("{column} IS NULL"), "NULL".to_owned()),
                value => (format!("{column} = {}", sql_literal(value)?), single_line(&full_text(value))),
            };
            let label = if label.is_empty() { "(empty)" } else { &label };
            cells.push(format!("{aggregated} FILTER (WHERE {condition}) AS {}", quote_identifier(label)));
            listed.extend(sql_literal(value).filter(|_| *value != Cell::Null));
        }
        if !complete {
            let or_null = if values.contains(&Cell::Null) { "" } else { &format!(" OR {column} IS NULL") };
            let condition = format!("{column} NOT IN ({}){or_null}", listed.join(", "));
            cells.push(format!("{aggregated} FILTER (WHERE {condition}) AS other"));
        }
        cells.push(format!("{aggregated} AS \"all\""));
    } else {
        let alias =
            values.map_or("count".to_owned(), |at| format!("{}_{}", aggregate.label(), query_result.columns[at]));
        cells.push(format!("{aggregated} AS {}", quote_identifier(&alias)));
    }
    Some(format!(
        "-- title: {}{}\n{}SELECT {}\nFROM {}\nGROUP BY 1\nORDER BY 1",
        pivot_title(query_result, shape),
        covered_rows.label(),
        source.with,
        cells.join(",\n    "),
        source.from
    ))
}

/// Returns the title of a pivot, for example `sum of amount by category and day`.
fn pivot_title(query_result: &QueryResult, shape: PivotShape) -> String {
    let name = |at: usize| single_line(&query_result.columns[at]);
    let what = match shape.value_column {
        Some(at) => format!("{} of {}", shape.aggregate.label(), name(at)),
        None => "rows".to_owned(),
    };
    let across = shape.header_column.map_or(String::new(), |at| format!(" and {}", name(at)));
    format!("{what} by {}{across}", name(shape.row_column))
}

/// The most frequent distinct values of a column.
pub struct DistinctValues {
    /// Values in ascending order, with NULL last.
    pub values: Vec<Cell>,
    /// Whether the column has no other values.
    pub complete: bool,
}

impl DistinctValues {
    /// Returns the most frequent values of a column among the loaded rows.
    pub fn from_rows(query_result: &QueryResult, at: usize) -> DistinctValues {
        let mut counted: Vec<(Cell, usize)> = Vec::new();
        let mut cells: Vec<&Cell> = query_result.rows.iter().filter_map(|row| row.get(at)).collect();
        cells.sort_by(|one, other| compare_cells(one, other));
        for cell in cells {
            match counted.last_mut().filter(|(known, _)| known == cell) {
                Some((_, count)) => *count += 1,
                None => counted.push((cell.clone(), 1)),
            }
        }
        let all = counted.len();
        counted.retain(|(cell, _)| sql_literal(cell).is_some());
        // The sort is stable, so equally frequent values stay in ascending order.
        counted.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
        counted.truncate(MAX_PIVOT_COLUMNS);
        counted.sort_by(|(one, _), (other, _)| compare_cells(one, other));
        // A real number may differ from the number that its text represents.
        let exact = counted.iter().all(|(cell, _)| !matches!(cell, Cell::Real(_)));
        let complete = exact && !query_result.truncated && counted.len() == all;
        DistinctValues { values: counted.into_iter().map(|(cell, _)| cell).collect(), complete }
    }
}

/// Compares cells: numbers are before texts, and NULL is last.
fn compare_cells(one: &Cell, other: &Cell) -> std::cmp::Ordering {
    let rank = |cell: &Cell| match cell {
        Cell::Integer(_) | Cell::Real(_) => 0,
        Cell::Text(_) => 1,
        Cell::Null => 2,
    };
    let number = |cell: &Cell| match cell {
        Cell::Integer(number) => *number as f64,
        Cell::Real(number) => *number,
        _ => 0.0,
    };
    let text = |cell: &Cell| if let Cell::Text(text) = cell { text.clone() } else { String::new() };
    rank(one)
        .cmp(&rank(other))
        .then_with(|| number(one).total_cmp(&number(other)))
        .then_with(|| text(one).cmp(&text(other)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_kit::new_session;
    use novamind_session::Session;

    fn query(session: &mut Session, sql: &str) -> QueryResult {
        session.query(sql).unwrap_or_else(|refusal| panic!("{refusal}\n{sql}"))
    }

    /// A statement whose result has duplicate and unusual column names, NULL and quotes.
    const ODD_COLUMN_NAMES_SQL: &str = "-- title: Odd\nWITH t AS (VALUES ('it''s', 1, 2.5), ('it''s', 2, NULL), (NULL, 1, 4.0), ('b', 1, 1.5))
        SELECT column1 AS \"group by\", column2 AS n, column3 AS n, count(*) OVER () FROM t -- the end";

    #[test]
    fn values_are_counted_with_their_shares() {
        let mut session = new_session();
        let rows = query(&mut session, ODD_COLUMN_NAMES_SQL);
        let counted =
            query(&mut session, &count_statement(ODD_COLUMN_NAMES_SQL, &rows.columns, 0, &RowFilter::All).expect("a statement"));
        assert_eq!(counted.columns, ["group by", "count", "percent"]);
        let text = |text: &str| Cell::Text(text.to_owned());
        let row = |cell, count, percent| vec![cell, Cell::Integer(count), Cell::Real(percent)];
        assert_eq!(
            counted.rows,
            [row(text("it's"), 2, 50.0), row(Cell::Null, 1, 25.0), row(text("b"), 1, 25.0)]
        );
        let second =
            query(&mut session, &count_statement(ODD_COLUMN_NAMES_SQL, &rows.columns, 2, &RowFilter::All).expect("a statement"));
        assert_eq!(second.rows.len(), 4, "the second column of the same name is counted: {second:?}");
    }

    #[test]
    fn counts_include_rows_that_are_not_loaded() {
        let mut session = new_session();
        let sql = "WITH RECURSIVE n(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM n WHERE x < 9000) SELECT x % 2 AS odd FROM n;";
        let query_result = query(&mut session, sql);
        assert!(query_result.truncated);
        let counted =
            query(&mut session, &count_statement(sql, &query_result.columns, 0, &RowFilter::All).expect("a statement"));
        assert_eq!(counted.rows[0][1], Cell::Integer(4500));
        let shape = PivotShape { row_column: 0, header_column: Some(0), value_column: None, aggregate: Aggregate::Count };
        let pivoted = query(&mut session, &pivot_statement(sql, &query_result, shape, &RowFilter::All).expect("a statement"));
        assert_eq!(pivoted.columns, ["odd", "0", "1", "other", "all"], "other values cannot be excluded");
        assert_eq!(pivoted.rows[1][2..], [4500, 0, 4500].map(Cell::Integer));
    }

    #[test]
    fn pivot_has_a_row_and_column_per_value() {
        let mut session = new_session();
        let query_result = query(&mut session, ODD_COLUMN_NAMES_SQL);
        let shape = PivotShape { row_column: 1, header_column: Some(0), value_column: Some(2), aggregate: Aggregate::Sum };
        let rows = query(&mut session, &pivot_statement(ODD_COLUMN_NAMES_SQL, &query_result, shape, &RowFilter::All).expect("a statement"));
        assert_eq!(rows.columns, ["n", "b", "it's", "NULL", "all"]);
        let real = Cell::Real;
        assert_eq!(rows.rows[0], [Cell::Integer(1), real(1.5), real(2.5), real(4.0), real(8.0)]);
        assert_eq!(rows.rows[1], [Cell::Integer(2), Cell::Null, Cell::Null, Cell::Null, Cell::Null]);
        for (aggregate, all) in [(Aggregate::Mean, 8.0 / 3.0), (Aggregate::Min, 1.5), (Aggregate::Max, 4.0)] {
            let rows = query(
                &mut session,
                &pivot_statement(ODD_COLUMN_NAMES_SQL, &query_result, PivotShape { aggregate, ..shape }, &RowFilter::All).expect("one"),
            );
            assert_eq!(rows.rows[0][4], real(all), "{aggregate:?}");
        }
        let flat = PivotShape { header_column: None, value_column: None, aggregate: Aggregate::Count, ..shape };
        let rows = query(&mut session, &pivot_statement(ODD_COLUMN_NAMES_SQL, &query_result, flat, &RowFilter::All).expect("a statement"));
        assert_eq!((rows.columns[1].as_str(), &rows.rows[0][1]), ("count", &Cell::Integer(3)));
    }

    #[test]
    fn rare_values_share_a_column() {
        let mut session = new_session();
        let sql = "WITH RECURSIVE n(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM n WHERE x < 40)
                   SELECT 'a' AS k, nullif(x, 40) AS x FROM n";
        let query_result = query(&mut session, sql);
        let shape = PivotShape { row_column: 0, header_column: Some(1), value_column: None, aggregate: Aggregate::Count };
        let rows = query(&mut session, &pivot_statement(sql, &query_result, shape, &RowFilter::All).expect("a statement"));
        assert_eq!(rows.columns.len(), 1 + MAX_PIVOT_COLUMNS + 2);
        assert_eq!(rows.rows[0][1 + MAX_PIVOT_COLUMNS..], [40 - MAX_PIVOT_COLUMNS as i64, 40].map(Cell::Integer));
    }

    #[test]
    fn query_plans_cannot_be_counted() {
        let columns = ["plan", "day"].map(str::to_owned);
        let sql = count_statement("SELECT plan, day FROM t;", &columns, 0, &RowFilter::All).expect("a statement");
        assert!(sql.contains("FROM (\nSELECT plan, day FROM t\n)") && !sql.contains("WITH"), "{sql}");
        assert_eq!(count_statement("explain query plan SELECT 1", &columns, 0, &RowFilter::All), None);
        assert_eq!(count_statement("-- only words", &columns, 0, &RowFilter::All), None);
    }
}
