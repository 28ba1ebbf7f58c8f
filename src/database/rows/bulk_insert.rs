//! Inserts many rows with few statements, because starting a statement takes as long as writing a row.

use rusqlite::Transaction;
use rusqlite::types::{ToSqlOutput, ValueRef};

/// An SQL value of a row to insert.
pub(crate) type Value<'a> = ToSqlOutput<'a>;

const ROWS_PER_STATEMENT: usize = 24;

/// SQL NULL.
pub(crate) const NULL: Value<'static> = ToSqlOutput::Borrowed(ValueRef::Null);

pub(crate) fn integer(number: impl Into<i64>) -> Value<'static> {
    ToSqlOutput::Borrowed(ValueRef::Integer(number.into()))
}

pub(crate) fn real(number: f64) -> Value<'static> {
    ToSqlOutput::Borrowed(ValueRef::Real(number))
}

pub(crate) fn text(text: &str) -> Value<'_> {
    ToSqlOutput::Borrowed(ValueRef::Text(text.as_bytes()))
}

/// Converts a value with `write`. Returns NULL for `None`.
pub(super) fn value_or_null<'a, T>(value: Option<T>, write: impl FnOnce(T) -> Value<'a>) -> Value<'a> {
    value.map_or(NULL, write)
}

/// Inserts rows in order. `head` is the statement up to and including `VALUES`.
pub(crate) fn insert_rows<'a, const COLUMNS: usize>(
    transaction: &Transaction<'_>,
    head: &str,
    rows: impl IntoIterator<Item = [Value<'a>; COLUMNS]>,
) -> rusqlite::Result<()> {
    let statement = |rows: usize| {
        let row = format!("({})", ["?"; COLUMNS].join(","));
        transaction.prepare_cached(&format!("{head} {}", vec![row; rows].join(",")))
    };
    let mut waiting: Vec<[Value<'a>; COLUMNS]> = Vec::with_capacity(ROWS_PER_STATEMENT);
    let mut many = None;
    for row in rows {
        waiting.push(row);
        if waiting.len() == ROWS_PER_STATEMENT {
            let many = match &mut many {
                Some(many) => many,
                none => none.insert(statement(ROWS_PER_STATEMENT)?),
            };
            for (at, value) in (1..).zip(waiting.drain(..).flatten()) {
                many.raw_bind_parameter(at, value)?;
            }
            many.raw_execute()?;
        }
    }
    if waiting.is_empty() {
        return Ok(());
    }
    let mut single = statement(1)?;
    for row in waiting {
        for (at, value) in (1..).zip(row) {
            single.raw_bind_parameter(at, value)?;
        }
        single.raw_execute()?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use rusqlite::Connection;

    use super::*;

    #[test]
    fn insert_rows_keeps_the_order() {
        let mut connection = Connection::open_in_memory().expect("memory");
        connection.execute_batch("CREATE TABLE t (id INTEGER PRIMARY KEY, n, word)").expect("a table");
        let counts = [0, 1, ROWS_PER_STATEMENT, 2 * ROWS_PER_STATEMENT + 5];
        let transaction = connection.transaction().expect("a transaction");
        let mut next = 0;
        for count in counts {
            let rows = (0..count).map(|at| {
                let word = value_or_null((at % 2 == 0).then_some("even"), text);
                [real((next + at) as f64 / 2.0), word]
            });
            insert_rows(&transaction, "INSERT INTO t (n, word) VALUES", rows).expect("rows");
            next += count;
        }
        transaction.commit().expect("a commit");
        let right = "SELECT count(*) FROM t WHERE n = (id - 1) / 2.0";
        let found: i64 = connection.query_row(right, [], |row| row.get(0)).expect("an answer");
        assert_eq!(found, counts.iter().sum::<usize>() as i64);
        let words: i64 =
            connection.query_row("SELECT count(word) FROM t", [], |row| row.get(0)).expect("words");
        assert_eq!(words, 1 + ROWS_PER_STATEMENT as i64 / 2 + ROWS_PER_STATEMENT as i64 + 3);
    }
}
