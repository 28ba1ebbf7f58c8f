//! Formats query results as text.

use unicode_width::UnicodeWidthStr;

use super::query_result::{Cell, QueryResult};

/// Formats a value of a query result.
pub fn format_cell(cell: &Cell) -> String {
    match cell {
        Cell::Null => "NULL".to_owned(),
        Cell::Integer(number) => number.to_string(),
        Cell::Real(number) => format!("{number:?}"),
        Cell::Text(text) => text.clone(),
    }
}

/// Formats a query result as aligned columns with headings, row count, warning and hint.
pub fn format_result(rows: &QueryResult) -> String {
    let mut text = format_columns(rows);
    text += &match (rows.rows.len(), rows.truncated) {
        (count, true) => format!("({count} rows, more exist)\n"),
        (1, false) => "(1 row)\n".to_owned(),
        (count, false) => format!("({count} rows)\n"),
    };
    if let Some(warning) = &rows.warning {
        text += &format!("warning: {warning}\n");
    }
    if let Some(hint) = &rows.hint {
        text += &format!("hint: {hint}\n");
    }
    text
}

/// Formats a query result as aligned columns with headings.
pub fn format_columns(rows: &QueryResult) -> String {
    let cells: Vec<Vec<String>> = rows
        .rows
        .iter()
        .map(|row| row.iter().map(|cell| format_cell(cell).replace(['\n', '\r', '\t'], " ")).collect())
        .collect();
    align_columns(&rows.columns, &cells)
}

/// Formats rows of text as aligned columns with headings.
pub fn align_columns(columns: &[String], rows: &[Vec<String>]) -> String {
    let width = |at: usize| {
        let cells = rows.iter().filter_map(|row| row.get(at)).chain([&columns[at]]);
        cells.map(|cell| cell.width()).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..columns.len()).map(width).collect();
    let line = |cells: &[String]| {
        let mut text = String::new();
        for (cell, width) in cells.iter().zip(&widths) {
            text += cell;
            text += &" ".repeat(width - cell.width() + 2);
        }
        text.trim_end().to_owned() + "\n"
    };
    let mut text = line(columns);
    rows.iter().for_each(|row| text += &line(row));
    text
}
