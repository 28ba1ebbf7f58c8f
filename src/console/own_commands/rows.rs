//! Rows of a list as CSV or JSON, for external programs.

use serde_json::{Map, Value};

use novamind_base::formatting::json_number;
use novamind_tui::widgets::{Table, TableCell};

/// Rows of the focused list, with the titles of the columns.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ListRows {
    columns: Vec<String>,
    rows: Vec<Vec<TableCell>>,
}

impl ListRows {
    /// Returns rows of a table, in the displayed order. `is_wanted` receives the index of each displayed row.
    pub fn from_table(table: &Table, is_wanted: impl Fn(usize) -> bool) -> ListRows {
        let columns = table.columns().iter().map(|column| column.title.clone()).collect();
        let wanted = table.visible_rows().iter().filter(|row| is_wanted(**row));
        ListRows { columns, rows: wanted.map(|row| table.rows()[*row].clone()).collect() }
    }

    /// Returns whether there are no rows.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Formats the rows as CSV with the titles of the columns in the first line.
    pub fn to_csv(&self) -> String {
        let mut writer = csv::Writer::from_writer(Vec::new());
        let texts = self.rows.iter().map(|row| row.iter().map(plain_text).collect::<Vec<_>>());
        for record in std::iter::once(self.columns.clone()).chain(texts) {
            // Writing to memory does not fail: all records have the same length.
            let _ = writer.write_record(&record);
        }
        String::from_utf8(writer.into_inner().unwrap_or_default()).unwrap_or_default()
    }

    /// Formats the rows as a JSON list of objects.
    pub fn to_json(&self) -> String {
        let object = |row: &Vec<TableCell>| {
            let value =
                |cell: &TableCell| cell.number.map_or_else(|| Value::from(cell.text.as_str()), json_number);
            let fields = self.columns.iter().cloned().zip(row.iter().map(value));
            Value::Object(fields.collect::<Map<String, Value>>())
        };
        format!("{}\n", Value::Array(self.rows.iter().map(object).collect()))
    }
}

/// Returns the number of a cell without separators and units, otherwise its text.
fn plain_text(cell: &TableCell) -> String {
    cell.number.map_or_else(|| cell.text.clone(), |number| json_number(number).to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use novamind_tui::widgets::TableColumn;

    #[test]
    fn rows_become_csv_and_json_with_plain_numbers() {
        let mut table = Table::new(vec![TableColumn::text("name"), TableColumn::numeric("seats")]);
        let row = |name: &str, seats: f64| {
            vec![TableCell::from_text(name), TableCell::from_number(seats, format!("{seats} seats"))]
        };
        table.set_rows(vec![row("A, \"B\"", 1200.0), row("C", 0.5)]);
        let all = ListRows::from_table(&table, |_| true);
        assert_eq!(all.to_csv(), "name,seats\n\"A, \"\"B\"\"\",1200\nC,0.5\n");
        let second = ListRows::from_table(&table, |row| row == 1);
        assert_eq!(second.to_json(), "[{\"name\":\"C\",\"seats\":0.5}]\n");
        assert!(ListRows::from_table(&table, |_| false).is_empty());
    }
}
