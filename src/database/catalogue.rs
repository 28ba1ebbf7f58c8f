//! The visible tables as data: for the schema browser, the documentation and the help of the SQL prompt.

use std::sync::LazyLock;

use serde::{Deserialize, Serialize};

/// A visible table.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Table {
    /// Name.
    pub name: String,
    /// What its rows are.
    pub description: String,
    /// When rows are written.
    pub written: String,
    /// Columns that name a row.
    pub key: Vec<String>,
    /// Visible columns, in order.
    pub columns: Vec<Column>,
}

/// A visible column.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Column {
    /// Name.
    pub name: String,
    /// Declared type: INTEGER, REAL or TEXT.
    #[serde(rename = "type")]
    pub kind: String,
    /// All values it can have, where that is a short list.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub values: Vec<String>,
    /// What it holds.
    pub description: String,
}

#[derive(Deserialize)]
struct Catalogue {
    table: Vec<Table>,
}

static CATALOGUE: LazyLock<Vec<Table>> = LazyLock::new(|| {
    let text = include_str!("../../assets/tables.toml");
    toml::from_str::<Catalogue>(text).expect("the shipped catalogue of tables is tested").table
});

/// All visible tables.
pub fn tables() -> &'static [Table] {
    &CATALOGUE
}

/// The visible table with this name; case does not count, as in SQL.
pub fn table(name: &str) -> Option<&'static Table> {
    CATALOGUE.iter().find(|table| table.name.eq_ignore_ascii_case(name))
}

impl Table {
    /// The statement that makes an ordinary table like it, with the types of its columns and its key.
    pub fn declaration(&self) -> String {
        let column = |column: &Column| match self.row_number() {
            Some(key) if key == column.name => format!("{key} INTEGER PRIMARY KEY"),
            _ => format!("{} {}", column.name, column.kind),
        };
        let mut parts: Vec<String> = self.columns.iter().map(column).collect();
        if self.row_number().is_none() {
            parts.push(format!("PRIMARY KEY ({})", self.key.join(", ")));
        }
        format!("CREATE TABLE {} ({})", self.name, parts.join(", "))
    }

    /// The column that numbers its rows, where one does.
    pub fn row_number(&self) -> Option<&str> {
        let [key] = self.key.as_slice() else { return None };
        let own = self.columns.iter().find(|column| column.name == *key)?;
        (own.kind == "INTEGER").then_some(&own.name)
    }

    /// The table in a few lines of text.
    pub fn describe(&self) -> String {
        let mut text = format!("{}: {}.\n  Written {}.\n", self.name, self.description, self.written);
        let width = self.columns.iter().map(|column| column.name.len()).max().unwrap_or(0);
        for column in &self.columns {
            let values = match column.values.as_slice() {
                [] => String::new(),
                values => format!(" [{}]", values.join(", ")),
            };
            text +=
                &format!("  {:<width$}  {:<7}  {}{values}\n", column.name, column.kind, column.description);
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_are_19_tables_with_148_columns() {
        assert_eq!(tables().len(), 19);
        assert_eq!(tables().iter().map(|table| table.columns.len()).sum::<usize>(), 148);
        assert!(
            tables()
                .iter()
                .all(|table| table.key.iter().all(|key| table.columns.iter().any(|c| c.name == *key)))
        );
        assert!(table("LEDGER").is_some() && table("customer_state").is_none());
    }

    #[test]
    fn rows_are_numbered_where_the_key_is_one_whole_number() {
        let number = |name: &str| table(name).and_then(Table::row_number);
        assert_eq!(number("subscriptions"), Some("subscription_id"));
        assert_eq!([number("research_projects"), number("daily_usage")], [None, None]);
        let declared = table("daily_usage").map(Table::declaration).expect("a table");
        let expected = "CREATE TABLE daily_usage (day INTEGER, customer_id INTEGER, usage_units INTEGER, \
                        PRIMARY KEY (day, customer_id))";
        assert_eq!(declared, expected);
    }
}
