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
}
