//! Definitions of the visible tables and of the hidden tables of the x-ray, for the schema browser, the documentation
//! and SQL help.

use std::sync::LazyLock;

use serde::{Deserialize, Serialize};

use novamind_world::params::Interface;

/// Definition of a visible or hidden table.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Table {
    /// Name of the table. Names of hidden tables include the schema.
    pub name: String,
    /// Description of what a row represents.
    pub description: String,
    /// Description of when rows are written.
    pub written: String,
    /// Names of the key columns.
    pub key: Vec<String>,
    /// Whether the table has further columns in the released simulator that no query may read.
    #[serde(default, skip_serializing)]
    pub(super) has_hidden_columns: bool,
    /// Names of the columns in the order of release 2; empty if the columns of both releases are the same.
    #[serde(default, skip_serializing)]
    release_2: Vec<String>,
    /// Definitions of the columns, in order.
    pub columns: Vec<Column>,
}

/// Definition of a column.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Column {
    /// Name of the column.
    pub name: String,
    /// Declared type of the column: INTEGER, REAL or TEXT.
    #[serde(rename = "type")]
    pub kind: String,
    /// All possible values of the column, if they are few.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub values: Vec<String>,
    /// Text that explains the column in the schema browser and in SQL help.
    pub description: String,
}

#[derive(Deserialize)]
struct Catalogue {
    table: Vec<Table>,
}

static CATALOGUE: LazyLock<Vec<Table>> = LazyLock::new(|| {
    let text = include_str!("../../assets/tables.toml");
    toml::from_str::<Catalogue>(text).expect("the bundled catalog of tables is valid").table
});

static RELEASE_2_CATALOGUE: LazyLock<Vec<Table>> =
    LazyLock::new(|| CATALOGUE.iter().map(Table::with_columns_of_release_2).collect());

static HIDDEN_CATALOGUE: LazyLock<Vec<Table>> = LazyLock::new(|| {
    let text = include_str!("../../assets/hidden_tables.toml");
    toml::from_str::<Catalogue>(text).expect("the catalogue of hidden tables is tested").table
});

/// The set of tables that the statements of a connection may name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scope {
    /// Only visible tables.
    Visible,
    /// Visible tables and hidden tables of the x-ray.
    Hidden,
}

/// The tables of a connection: their release and their scope.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Surface {
    /// Release that determines the columns of the visible tables and the allowed statements.
    pub interface: Interface,
    /// Tables that statements may name.
    pub scope: Scope,
}

impl Surface {
    /// Returns the tables that statements may name. Visible tables precede hidden tables.
    pub fn tables(self) -> impl Iterator<Item = &'static Table> {
        let hidden = match self.scope {
            Scope::Visible => &[][..],
            Scope::Hidden => &HIDDEN_CATALOGUE,
        };
        tables(self.interface).iter().chain(hidden)
    }

    /// Returns the hidden table with the schema and name that the engine reports. If a statement only counts rows, the
    /// engine reports the schema as written in the statement. The schema can then be missing.
    pub fn hidden_table(self, schema: Option<&str>, name: &str) -> Option<&'static Table> {
        let is_there = match schema {
            Some(schema) => schema.eq_ignore_ascii_case(HIDDEN_SCHEMA),
            None => table(self.interface, name).is_none(),
        };
        let mut tables = self.tables().filter(|_| is_there);
        tables.find(|table| table.hidden_name().is_some_and(|text| text.eq_ignore_ascii_case(name)))
    }
}

/// Schema of the hidden tables.
pub(super) const HIDDEN_SCHEMA: &str = "hidden";

/// Returns the hidden tables of the x-ray; their names include the schema.
pub fn hidden_tables() -> &'static [Table] {
    &HIDDEN_CATALOGUE
}

/// Returns the definitions of all visible tables of a release.
pub fn tables(interface: Interface) -> &'static [Table] {
    match interface {
        Interface::Release1 => &CATALOGUE,
        Interface::Release2 => &RELEASE_2_CATALOGUE,
    }
}

/// Returns the visible table of a release with this name, ignoring case.
pub fn table(interface: Interface, name: &str) -> Option<&'static Table> {
    tables(interface).iter().find(|table| table.name.eq_ignore_ascii_case(name))
}

impl Table {
    /// Returns the CREATE statement of an ordinary table with the same columns and key.
    pub fn create_statement(&self) -> String {
        let column = |column: &Column| match self.row_number_column() {
            Some(key) if key == column.name => format!("{key} INTEGER PRIMARY KEY"),
            _ => format!("{} {}", column.name, column.kind),
        };
        let mut parts: Vec<String> = self.columns.iter().map(column).collect();
        if self.row_number_column().is_none() {
            parts.push(format!("PRIMARY KEY ({})", self.key.join(", ")));
        }
        format!("CREATE TABLE {} ({})", self.name, parts.join(", "))
    }

    fn with_columns_of_release_2(&self) -> Table {
        let column = |name: &String| self.columns.iter().find(|column| column.name == *name).cloned();
        let columns = match self.release_2.as_slice() {
            [] => self.columns.clone(),
            names => names.iter().filter_map(column).collect(),
        };
        Table { columns, ..self.clone() }
    }

    /// Returns the names of the columns, in order.
    pub fn column_names(&self) -> Vec<&str> {
        self.columns.iter().map(|column| column.name.as_str()).collect()
    }

    /// Returns the name of a hidden table without the schema, or `None` for a visible table.
    fn hidden_name(&self) -> Option<&str> {
        self.name.strip_prefix(HIDDEN_SCHEMA)?.strip_prefix('.')
    }

    /// Returns the name of the column that is the rowid, if the table has such a column.
    pub fn row_number_column(&self) -> Option<&str> {
        let [key] = self.key.as_slice() else { return None };
        let key_column = self.columns.iter().find(|column| column.name == *key)?;
        (key_column.kind == "INTEGER").then_some(&key_column.name)
    }

    /// Returns a description of the table in a few lines.
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

    fn tables() -> &'static [Table] {
        super::tables(Interface::Release1)
    }

    fn table(name: &str) -> Option<&'static Table> {
        super::table(Interface::Release1, name)
    }

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
    fn hidden_tables_require_the_hidden_scope() {
        assert_eq!(hidden_tables().len(), 7);
        assert!(
            hidden_tables()
                .iter()
                .all(|hidden_table| hidden_table.hidden_name().is_some()
                    && table(&hidden_table.name).is_none())
        );
        let named = |scope: Scope, schema, name| {
            let surface = Surface { interface: Interface::Release1, scope };
            surface.hidden_table(schema, name).map(|hidden_table| hidden_table.name.as_str())
        };
        assert_eq!(named(Scope::Hidden, Some("HIDDEN"), "Groups"), Some("hidden.groups"));
        assert_eq!(named(Scope::Hidden, None, "groups"), Some("hidden.groups"));
        assert_eq!(named(Scope::Hidden, None, "customers"), None, "the visible table is meant");
        assert_eq!(named(Scope::Hidden, Some("main"), "groups"), None);
        assert_eq!(named(Scope::Visible, Some("hidden"), "groups"), None);
    }

    #[test]
    fn row_number_column_is_a_single_integer_key() {
        let number = |name: &str| table(name).and_then(Table::row_number_column);
        assert_eq!(number("subscriptions"), Some("subscription_id"));
        assert_eq!([number("research_projects"), number("daily_usage")], [None, None]);
        let declared = table("daily_usage").map(Table::create_statement).expect("a table");
        let expected = "CREATE TABLE daily_usage (day INTEGER, customer_id INTEGER, usage_units INTEGER, \
                        PRIMARY KEY (day, customer_id))";
        assert_eq!(declared, expected);
    }
}
