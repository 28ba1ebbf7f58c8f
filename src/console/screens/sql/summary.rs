//! Statements derived from a statement: the frequency of each value of a column, and a pivot. They run in the
//! database, so they cover all rows of the result and not only the loaded ones. They include the screen's
//! filter and are recorded like any query.

use super::meant::RowsMeant;
use super::picker::in_a_line;
use super::values::whole;
use novamind_database::{Cell, Rows};
use novamind_record::folder::library::body;
use novamind_tui::sql::{KEYWORDS, tokens};

/// Maximum number of value columns of a pivot; the other values share one column.
pub const MOST_ACROSS: usize = 12;

/// Error for statements that cannot be derived from.
pub const NOT_A_TABLE: &str =
    "A query plan cannot be counted or pivoted. Run the statement without EXPLAIN first.";

/// Aggregation of the rows in a cell of a pivot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Aggregate {
    Count,
    Sum,
    Mean,
    Min,
    Max,
}

impl Aggregate {
    /// Aggregations of a column.
    pub const OF_COLUMNS: [Aggregate; 5] =
        [Aggregate::Sum, Aggregate::Mean, Aggregate::Min, Aggregate::Max, Aggregate::Count];

    pub fn word(self) -> &'static str {
        match self {
            Aggregate::Count => "count",
            Aggregate::Sum => "sum",
            Aggregate::Mean => "mean",
            Aggregate::Min => "min",
            Aggregate::Max => "max",
        }
    }

    /// Returns the SQL expression for a column, or for rows.
    fn sql(self, column: Option<&str>) -> String {
        let function = if self == Aggregate::Mean { "avg" } else { self.word() };
        format!("{function}({})", column.unwrap_or("*"))
    }
}

/// Definition of a pivot; columns are indexes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PivotShape {
    /// Column with a row for each value.
    pub rows: usize,
    /// Column with a column for each value.
    pub across: Option<usize>,
    /// Column to aggregate; `None` counts rows.
    pub values: Option<usize>,
    pub aggregate: Aggregate,
}

/// A statement as the source of another one.
struct Source {
    /// WITH clause before the outer statement.
    with: String,
    /// FROM clause, with the clause for the covered rows.
    from: String,
    names: Vec<String>,
}

impl Source {
    fn of(sql: &str, columns: &[String], meant: &RowsMeant) -> Option<Source> {
        let body = body(sql).trim().trim_end_matches(';').trim_end();
        let first = tokens(body).into_iter().next()?;
        if body[first.place].eq_ignore_ascii_case("EXPLAIN") {
            return None;
        }
        let mut given: Vec<String> = Vec::new();
        for column in columns {
            let lower = |name: &str| name.to_lowercase();
            let free = |name: &String| given.iter().all(|own| lower(own) != lower(name));
            let first = if column.is_empty() { "column".to_owned() } else { column.clone() };
            let numbered = (2..).map(|number| format!("{first}_{number}"));
            given.extend(std::iter::once(first.clone()).chain(numbered).find(free));
        }
        let names: Vec<String> = given.iter().map(|name| identifier(name)).collect();
        let clause = meant.clause(&names);
        // SQLite reads an unknown quoted name as text, so columns without a plain name are renamed.
        Some(match given == columns && names == given {
            true => Source { with: String::new(), from: format!("(\n{body}\n){clause}"), names },
            false => Source {
                with: format!("WITH result ({}) AS (\n{body}\n)\n", names.join(", ")),
                from: format!("result{clause}"),
                names,
            },
        })
    }
}

/// Returns an identifier, quoted if necessary.
fn identifier(name: &str) -> String {
    let is_word = |letter: char| letter.is_ascii_alphanumeric() || letter == '_';
    let plain = name.chars().all(is_word) && !name.starts_with(|first: char| first.is_ascii_digit());
    match plain && !name.is_empty() && !KEYWORDS.iter().any(|word| word.eq_ignore_ascii_case(name)) {
        true => name.to_owned(),
        false => format!("\"{}\"", name.replace('"', "\"\"")),
    }
}

/// Returns a literal; `None` for values that SQL cannot compare.
fn literal(cell: &Cell) -> Option<String> {
    match cell {
        Cell::Real(number) if !number.is_finite() => None,
        Cell::Text(text) => Some(format!("'{}'", text.replace('\'', "''"))),
        other => Some(whole(other)),
    }
}

/// Returns a statement that counts each value of a column in the result of another one, most frequent first.
pub fn count(sql: &str, columns: &[String], at: usize, meant: &RowsMeant) -> Option<String> {
    let source = Source::of(sql, columns, meant)?;
    let name = source.names.get(at)?;
    Some(format!(
        "-- title: {} counted{}\n{}SELECT {name}, count(*) AS count,\n    \
         round(100.0 * count(*) / sum(count(*)) OVER (), 1) AS percent\nFROM {}\nGROUP BY 1\nORDER BY 2 DESC, 1",
        in_a_line(&columns[at]),
        meant.in_words(),
        source.with,
        source.from
    ))
}

/// Returns a statement that pivots the covered rows of another one; `held` are its loaded rows.
pub fn pivot(sql: &str, held: &Rows, shape: PivotShape, meant: &RowsMeant) -> Option<String> {
    let source = Source::of(sql, &held.columns, meant)?;
    let PivotShape { rows, across, values, aggregate } = shape;
    let name = |at: usize| source.names.get(at).map(String::as_str);
    let aggregated = aggregate.sql(values.and_then(name));
    let mut cells = vec![name(rows)?.to_owned()];
    if let Some(across) = across {
        let column = name(across)?;
        let Distinct { values, complete } = Distinct::of(held, across);
        let mut listed = Vec::new();
        for value in &values {
            let (condition, label) = match value {
                Cell::Null => (format!("{column} IS NULL"), "NULL".to_owned()),
                value => (format!("{column} = {}", literal(value)?), in_a_line(&whole(value))),
            };
            let label = if label.is_empty() { "(empty)" } else { &label };
            cells.push(format!("{aggregated} FILTER (WHERE {condition}) AS {}", identifier(label)));
            listed.extend(literal(value).filter(|_| *value != Cell::Null));
        }
        if !complete {
            let or_null = if values.contains(&Cell::Null) { "" } else { &format!(" OR {column} IS NULL") };
            let condition = format!("{column} NOT IN ({}){or_null}", listed.join(", "));
            cells.push(format!("{aggregated} FILTER (WHERE {condition}) AS other"));
        }
        cells.push(format!("{aggregated} AS \"all\""));
    } else {
        let alias =
            values.map_or("count".to_owned(), |at| format!("{}_{}", aggregate.word(), held.columns[at]));
        cells.push(format!("{aggregated} AS {}", identifier(&alias)));
    }
    Some(format!(
        "-- title: {}{}\n{}SELECT {}\nFROM {}\nGROUP BY 1\nORDER BY 1",
        title(held, shape),
        meant.in_words(),
        source.with,
        cells.join(",\n    "),
        source.from
    ))
}

/// Returns a title such as `sum of amount by category and day`.
fn title(held: &Rows, shape: PivotShape) -> String {
    let name = |at: usize| in_a_line(&held.columns[at]);
    let what = match shape.values {
        Some(at) => format!("{} of {}", shape.aggregate.word(), name(at)),
        None => "rows".to_owned(),
    };
    let across = shape.across.map_or(String::new(), |at| format!(" and {}", name(at)));
    format!("{what} by {}{across}", name(shape.rows))
}

/// Values of a column of a pivot.
pub struct Distinct {
    /// In ascending order, NULL last.
    pub values: Vec<Cell>,
    /// Whether the column has no other values.
    pub complete: bool,
}

impl Distinct {
    /// Returns the most frequent values of a column among the loaded rows.
    pub fn of(held: &Rows, at: usize) -> Distinct {
        let mut counted: Vec<(Cell, usize)> = Vec::new();
        let mut cells: Vec<&Cell> = held.rows.iter().filter_map(|row| row.get(at)).collect();
        cells.sort_by(|one, other| order(one, other));
        for cell in cells {
            match counted.last_mut().filter(|(known, _)| known == cell) {
                Some((_, count)) => *count += 1,
                None => counted.push((cell.clone(), 1)),
            }
        }
        let all = counted.len();
        counted.retain(|(cell, _)| literal(cell).is_some());
        // The sort is stable: of equally frequent values the smaller ones come first.
        counted.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
        counted.truncate(MOST_ACROSS);
        counted.sort_by(|(one, _), (other, _)| order(one, other));
        // The printed form of a real number may not parse to the same number.
        let exact = counted.iter().all(|(cell, _)| !matches!(cell, Cell::Real(_)));
        let complete = exact && !held.truncated && counted.len() == all;
        Distinct { values: counted.into_iter().map(|(cell, _)| cell).collect(), complete }
    }
}

/// Orders numbers before texts, and NULL last.
fn order(one: &Cell, other: &Cell) -> std::cmp::Ordering {
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
    use crate::test_kit::session;
    use novamind_session::Session;

    fn asked(session: &mut Session, sql: &str) -> Rows {
        session.query(sql).unwrap_or_else(|refusal| panic!("{refusal}\n{sql}"))
    }

    /// A statement with duplicate and unusual names, NULL and quotes.
    const SQL: &str = "-- title: Odd\nWITH t AS (VALUES ('it''s', 1, 2.5), ('it''s', 2, NULL), (NULL, 1, 4.0), ('b', 1, 1.5))
        SELECT column1 AS \"group by\", column2 AS n, column3 AS n, count(*) OVER () FROM t -- the end";

    #[test]
    fn values_are_counted_with_their_shares() {
        let mut session = session();
        let rows = asked(&mut session, SQL);
        let counted =
            asked(&mut session, &count(SQL, &rows.columns, 0, &RowsMeant::All).expect("a statement"));
        assert_eq!(counted.columns, ["group by", "count", "percent"]);
        let text = |text: &str| Cell::Text(text.to_owned());
        let row = |cell, count, percent| vec![cell, Cell::Integer(count), Cell::Real(percent)];
        assert_eq!(
            counted.rows,
            [row(text("it's"), 2, 50.0), row(Cell::Null, 1, 25.0), row(text("b"), 1, 25.0)]
        );
        let second =
            asked(&mut session, &count(SQL, &rows.columns, 2, &RowsMeant::All).expect("a statement"));
        assert_eq!(second.rows.len(), 4, "the second column of the same name is counted: {second:?}");
    }

    #[test]
    fn all_rows_are_counted_and_not_only_those_that_are_held() {
        let mut session = session();
        let sql = "WITH RECURSIVE n(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM n WHERE x < 9000) SELECT x % 2 AS odd FROM n;";
        let held = asked(&mut session, sql);
        assert!(held.truncated);
        let counted =
            asked(&mut session, &count(sql, &held.columns, 0, &RowsMeant::All).expect("a statement"));
        assert_eq!(counted.rows[0][1], Cell::Integer(4500));
        let shape = PivotShape { rows: 0, across: Some(0), values: None, aggregate: Aggregate::Count };
        let pivoted = asked(&mut session, &pivot(sql, &held, shape, &RowsMeant::All).expect("a statement"));
        assert_eq!(pivoted.columns, ["odd", "0", "1", "other", "all"], "other values cannot be excluded");
        assert_eq!(pivoted.rows[1][2..], [4500, 0, 4500].map(Cell::Integer));
    }

    #[test]
    fn a_pivot_has_a_row_and_a_column_for_each_value() {
        let mut session = session();
        let held = asked(&mut session, SQL);
        let shape = PivotShape { rows: 1, across: Some(0), values: Some(2), aggregate: Aggregate::Sum };
        let rows = asked(&mut session, &pivot(SQL, &held, shape, &RowsMeant::All).expect("a statement"));
        assert_eq!(rows.columns, ["n", "b", "it's", "NULL", "all"]);
        let real = Cell::Real;
        assert_eq!(rows.rows[0], [Cell::Integer(1), real(1.5), real(2.5), real(4.0), real(8.0)]);
        assert_eq!(rows.rows[1], [Cell::Integer(2), Cell::Null, Cell::Null, Cell::Null, Cell::Null]);
        for (aggregate, all) in [(Aggregate::Mean, 8.0 / 3.0), (Aggregate::Min, 1.5), (Aggregate::Max, 4.0)] {
            let rows = asked(
                &mut session,
                &pivot(SQL, &held, PivotShape { aggregate, ..shape }, &RowsMeant::All).expect("one"),
            );
            assert_eq!(rows.rows[0][4], real(all), "{aggregate:?}");
        }
        let flat = PivotShape { across: None, values: None, aggregate: Aggregate::Count, ..shape };
        let rows = asked(&mut session, &pivot(SQL, &held, flat, &RowsMeant::All).expect("a statement"));
        assert_eq!((rows.columns[1].as_str(), &rows.rows[0][1]), ("count", &Cell::Integer(3)));
    }

    #[test]
    fn rare_values_are_in_one_column() {
        let mut session = session();
        let sql = "WITH RECURSIVE n(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM n WHERE x < 40)
                   SELECT 'a' AS k, nullif(x, 40) AS x FROM n";
        let held = asked(&mut session, sql);
        let shape = PivotShape { rows: 0, across: Some(1), values: None, aggregate: Aggregate::Count };
        let rows = asked(&mut session, &pivot(sql, &held, shape, &RowsMeant::All).expect("a statement"));
        assert_eq!(rows.columns.len(), 1 + MOST_ACROSS + 2);
        assert_eq!(rows.rows[0][1 + MOST_ACROSS..], [40 - MOST_ACROSS as i64, 40].map(Cell::Integer));
    }

    #[test]
    fn plain_columns_need_no_names_and_plans_are_refused() {
        let columns = ["plan", "day"].map(str::to_owned);
        let sql = count("SELECT plan, day FROM t;", &columns, 0, &RowsMeant::All).expect("a statement");
        assert!(sql.contains("FROM (\nSELECT plan, day FROM t\n)") && !sql.contains("WITH"), "{sql}");
        assert_eq!(count("explain query plan SELECT 1", &columns, 0, &RowsMeant::All), None);
        assert_eq!(count("-- only words", &columns, 0, &RowsMeant::All), None);
    }
}
