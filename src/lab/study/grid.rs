//! Combinations of a study's varied settings.

use toml::{Table, Value};

/// A combination of settings.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct FactorLevel {
    /// One text for each column.
    pub labels: Vec<String>,
    /// `(table.key, value as TOML)`.
    pub overrides: Vec<(String, String)>,
}

/// Returns the product of two lists of combinations; the second varies fastest.
pub(super) fn cross_levels(slow: &[FactorLevel], fast: &[FactorLevel]) -> Vec<FactorLevel> {
    let both = |slow: &FactorLevel, fast: &FactorLevel| FactorLevel {
        labels: slow.labels.iter().chain(&fast.labels).cloned().collect(),
        overrides: slow.overrides.iter().chain(&fast.overrides).cloned().collect(),
    };
    slow.iter().flat_map(|one| fast.iter().map(move |other| both(one, other))).collect()
}

/// Returns the entries of a table by `table.key`, from quoted keys and from nested tables.
pub(super) fn flatten_table(table: &Table) -> Vec<(String, &Value)> {
    let mut all = Vec::new();
    for (key, value) in table {
        match value {
            Value::Table(inner) if !key.contains('.') => {
                all.extend(inner.iter().map(|(name, value)| (format!("{key}.{name}"), value)));
            }
            _ => all.push((key.clone(), value)),
        }
    }
    all
}

/// Returns the text of a value for an override.
pub(super) fn override_text(value: &Value) -> String {
    value.to_string()
}
