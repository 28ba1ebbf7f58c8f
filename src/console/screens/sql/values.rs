//! Formats of values in query results: rounded on the screen, in full for copying and export.

use serde_json::Value;

use novamind_base::formatting::{escape_csv_cell, grouped_number, escape_control_characters};
use novamind_database::{Cell, QueryResult};
use novamind_session::rows_to_json;
use novamind_tui::theme::Role;
use novamind_tui::widgets::{TableCell, TableColumn};

/// Maximum column width on the screen. The user can open longer values.
const MAX_COLUMN_WIDTH: u16 = 48;

/// Returns whether a column contains only numbers.
pub fn is_numeric(rows: &QueryResult, at: usize) -> bool {
    let mut values = rows.rows.iter().filter_map(|row| row.get(at)).filter(|cell| **cell != Cell::Null);
    let is_number = |cell: &Cell| matches!(cell, Cell::Integer(_) | Cell::Real(_));
    values.next().is_some_and(is_number) && values.all(is_number)
}

/// Returns the number of decimals that a column shows.
pub fn decimals_shown(rows: &QueryResult, at: usize) -> usize {
    NumberFormat::for_column(rows, at).decimals
}

/// Returns the table columns for a result.
pub fn columns(rows: &QueryResult) -> Vec<TableColumn> {
    let column = |(at, name): (usize, &String)| {
        if is_numeric(rows, at) { TableColumn::numeric(name.as_str()) } else { TableColumn::text(name.as_str()) }
    };
    rows.columns.iter().enumerate().map(column).map(|column| column.with_max_width(MAX_COLUMN_WIDTH)).collect()
}

/// Returns the table cells for a result.
pub fn cells(rows: &QueryResult) -> Vec<Vec<TableCell>> {
    let styles: Vec<NumberFormat> = (0..rows.columns.len()).map(|at| NumberFormat::for_column(rows, at)).collect();
    let row = |row: &Vec<Cell>| row.iter().zip(&styles).map(|(cell, style)| style.display_cell(cell)).collect();
    rows.rows.iter().map(row).collect()
}

/// Number format of a column, which is the same for all rows.
struct NumberFormat {
    decimals: usize,
    groups_digits: bool,
}

impl NumberFormat {
    fn for_column(rows: &QueryResult, at: usize) -> NumberFormat {
        let reals = || {
            let cells = rows.rows.iter().filter_map(|row| row.get(at));
            cells.filter_map(|cell| match cell {
                Cell::Real(number) if number.is_finite() => Some(*number),
                _ => None,
            })
        };
        let largest = reals().fold(0.0, |most: f64, number| most.max(number.abs()));
        let needed = reals().map(decimal_count).max().unwrap_or(0);
        let sensible = match largest {
            _ if largest >= 1000.0 => 2,
            _ if largest >= 1.0 => 4,
            _ => 6,
        };
        // Identifiers and days are shown without thousands separators.
        let name = rows.columns.get(at).map_or(String::new(), |name| name.to_lowercase());
        let names = ["id", "day", "week", "year", "seed"];
        let groups = !names
            .iter()
            .any(|part| name.split(|letter: char| !letter.is_alphanumeric()).any(|word| word == *part));
        NumberFormat { decimals: needed.min(sensible), groups_digits: groups }
    }

    fn display_cell(&self, cell: &Cell) -> TableCell {
        match cell {
            Cell::Null => TableCell::from_text("NULL").with_role(Role::Dim),
            Cell::Text(text) => TableCell::from_text(single_line(text)),
            Cell::Integer(number) if self.groups_digits => TableCell::from_number(*number as f64, grouped_integer(*number)),
            Cell::Integer(number) => TableCell::from_number(*number as f64, number.to_string()),
            Cell::Real(number) => TableCell::from_number(*number, self.format_real(*number)),
        }
    }

    fn format_real(&self, number: f64) -> String {
        let text = format!("{number:.*}", self.decimals);
        let vanishes = number != 0.0 && text.parse() == Ok(0.0);
        match number {
            _ if !number.is_finite() => number.to_string(),
            _ if vanishes || number.abs() >= 1e15 => format!("{number:.3e}"),
            _ if self.groups_digits => grouped_number(number, self.decimals),
            _ => text,
        }
    }
}

/// Returns the number of decimals in the shortest exact notation of a number.
fn decimal_count(number: f64) -> usize {
    number.to_string().split_once('.').map_or(0, |(_, decimals)| decimals.len())
}

/// Formats a whole number with thousands separators. A conversion to a float would lose digits.
fn grouped_integer(number: i64) -> String {
    let digits = number.unsigned_abs().to_string();
    let mut text = String::from(if number < 0 { "-" } else { "" });
    for (at, digit) in digits.chars().enumerate() {
        if at > 0 && (digits.len() - at).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// Formats the start of a text in one line.
fn single_line(text: &str) -> String {
    text.chars().take(400).map(|letter| if letter.is_control() { ' ' } else { letter }).collect()
}

/// Formats a value in full for copying and export. NULL becomes an empty text.
pub fn full_text(cell: &Cell) -> String {
    match cell {
        Cell::Null => String::new(),
        Cell::Integer(number) => number.to_string(),
        Cell::Real(number) => format!("{number:?}"),
        Cell::Text(text) => text.clone(),
    }
}

/// Formats a row as tab-separated values for a spreadsheet.
pub fn tab_separated_row(row: &[Cell]) -> String {
    let clean = |cell: &Cell| escape_for_spreadsheet(cell).replace(['\t', '\n', '\r'], " ");
    row.iter().map(clean).collect::<Vec<_>>().join("\t")
}

/// Formats a result as tab-separated values with column headings.
pub fn to_tab_separated(rows: &QueryResult) -> String {
    let mut text = rows.columns.join("\t") + "\n";
    for row in &rows.rows {
        text += &(tab_separated_row(row) + "\n");
    }
    text
}

/// Formats a result as a Markdown table with right-aligned numbers.
pub fn to_markdown(rows: &QueryResult) -> String {
    let clean = |text: &str| {
        escape_control_characters(text).replace('\\', "\\\\").replace('|', "\\|").replace(['\n', '\r', '\t'], " ")
    };
    let line = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
    let mut text = line(rows.columns.iter().map(|name| clean(name)).collect());
    let side = |at: usize| if is_numeric(rows, at) { "---:" } else { "---" }.to_owned();
    text += &line((0..rows.columns.len()).map(side).collect());
    for row in &rows.rows {
        text += &line(row.iter().map(|cell| clean(&full_text(cell))).collect());
    }
    text
}

/// Formats a result as CSV with column headings.
///
/// # Errors
/// Writing to memory does not fail. The CSV writer requires the error type.
pub fn to_csv(rows: &QueryResult) -> Result<Vec<u8>, String> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(&rows.columns).map_err(|error| error.to_string())?;
    for row in &rows.rows {
        writer.write_record(row.iter().map(escape_for_spreadsheet)).map_err(|error| error.to_string())?;
    }
    writer.into_inner().map_err(|error| error.to_string())
}

/// Formats a value in full, so that spreadsheet programs do not interpret it as a formula.
fn escape_for_spreadsheet(cell: &Cell) -> String {
    match cell {
        Cell::Text(text) => escape_csv_cell(text).into_owned(),
        other => full_text(other),
    }
}

/// Formats a result as a JSON list with one object per row.
pub fn to_json(rows: &QueryResult) -> Vec<u8> {
    let list = rows_to_json(rows).remove("rows").unwrap_or(Value::Array(Vec::new()));
    let mut text = serde_json::to_vec_pretty(&list).unwrap_or_default();
    text.push(b'\n');
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn result(columns: &[&str], rows: Vec<Vec<Cell>>) -> QueryResult {
        QueryResult { columns: columns.iter().map(|name| (*name).to_owned()).collect(), rows, ..QueryResult::default() }
    }

    fn column_texts(name: &str, cells: &[Cell]) -> Vec<String> {
        let rows = result(&[name], cells.iter().map(|cell| vec![cell.clone()]).collect());
        self::cells(&rows).into_iter().map(|row| row[0].text.clone()).collect()
    }

    #[test]
    fn numbers_of_a_column_have_the_same_decimals() {
        use Cell::{Integer, Null, Real, Text};
        assert_eq!(column_texts("price", &[Real(12.0), Real(1.25), Null]), ["12.00", "1.25", "NULL"]);
        assert_eq!(column_texts("cash", &[Real(1_234_567.891_23), Real(0.5)]), ["1,234,567.89", "0.50"]);
        assert_eq!(column_texts("share", &[Real(1.0 / 3.0), Real(1e-9)]), ["0.333333", "1.000e-9"]);
        assert_eq!(column_texts("x", &[Real(3.0), Real(f64::INFINITY), Real(1e300)]), ["3", "inf", "1.000e300"]);
        assert_eq!(column_texts("subs", &[Integer(28_114), Integer(-5)]), ["28,114", "-5"]);
        assert_eq!(column_texts("customer_id", &[Integer(28_114)]), ["28114"]);
        assert_eq!(column_texts("n", &[Integer(i64::MIN)]), ["-9,223,372,036,854,775,808"]);
        assert_eq!(column_texts("text", &[Text("a\nb".to_owned())]), ["a b"]);
    }

    #[test]
    fn numeric_columns_are_right_aligned() {
        use novamind_tui::canvas::Align;
        let rows = result(
            &["a", "b", "c"],
            vec![
                vec![Cell::Null, Cell::Null, Cell::Integer(1)],
                vec![Cell::Real(1.0), Cell::Null, Cell::Text("x".to_owned())],
            ],
        );
        let sides: Vec<Align> = columns(&rows).into_iter().map(|column| column.align).collect();
        assert_eq!(sides, [Align::Right, Align::Left, Align::Left]);
    }

    #[test]
    fn exports_keep_every_digit() {
        let rows = result(
            &["a", "b", "a"],
            vec![
                vec![Cell::Real(0.1 + 0.2), Cell::Text("say \"no\", twice\n".to_owned()), Cell::Integer(7)],
                vec![Cell::Null, Cell::Null, Cell::Real(2.0)],
            ],
        );
        let text = String::from_utf8(to_csv(&rows).expect("CSV")).expect("text");
        assert_eq!(text, "a,b,a\n0.30000000000000004,\"say \"\"no\"\", twice\n\",7\n,,2.0\n");
        let value: Value = serde_json::from_slice(&to_json(&rows)).expect("JSON");
        assert_eq!(value[0]["a"], 0.1 + 0.2);
        assert_eq!(value[1]["b"], Value::Null);
        assert_eq!(
            to_markdown(&rows),
            "| a | b | a |\n| ---: | --- | ---: |\n| 0.30000000000000004 | say \"no\", twice  | 7 |\n|  |  | 2.0 |\n"
        );
        let sign = result(&["x"], vec![vec![Cell::Text("a|b\\".to_owned())]]);
        assert_eq!(to_markdown(&sign), "| x |\n| --- |\n| a\\|b\\\\ |\n");
        assert!(to_tab_separated(&rows).starts_with("a\tb\ta\n0.3"));
        assert_eq!(tab_separated_row(&rows.rows[0]), "0.30000000000000004\tsay \"no\", twice \t7");
    }
}
