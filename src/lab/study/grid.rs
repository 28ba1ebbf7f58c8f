//! Combinations of the varied settings of a study.

use toml::{Table, Value};

/// A combination of varied settings.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct FactorLevel {
    /// Texts of the settings, one for each factor column.
    pub labels: Vec<String>,
    /// Parameter overrides, as `(table.key, value as TOML)`.
    pub overrides: Vec<(String, String)>,
}

/// Returns the Cartesian product of two lists of combinations. The second list varies fastest.
pub(super) fn cross_levels(slow: &[FactorLevel], fast: &[FactorLevel]) -> Vec<FactorLevel> {
    let both = |slow: &FactorLevel, fast: &FactorLevel| FactorLevel {
        labels: slow.labels.iter().chain(&fast.labels).cloned().collect(),
        overrides: slow.overrides.iter().chain(&fast.overrides).cloned().collect(),
    };
    slow.iter().flat_map(|one| fast.iter().map(move |other| both(one, other))).collect()
}

/// Returns the values of a table by `table.key`. A key can be quoted or written as a nested table.
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

/// Formats a TOML value for an override.
pub(super) fn override_text(value: &Value) -> String {
    value.to_string()
}
