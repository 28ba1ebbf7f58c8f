//! Combinations of what a study varies.

use toml::{Table, Value};

/// A combination: what its columns say, and the parameters it sets.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Level {
    /// One text for each column.
    pub labels: Vec<String>,
    /// `(table.key, value as TOML)`.
    pub overrides: Vec<(String, String)>,
}

/// Each of some combinations with each of others; the later ones vary fastest.
pub(super) fn crossed(slow: &[Level], fast: &[Level]) -> Vec<Level> {
    let both = |slow: &Level, fast: &Level| Level {
        labels: slow.labels.iter().chain(&fast.labels).cloned().collect(),
        overrides: slow.overrides.iter().chain(&fast.overrides).cloned().collect(),
    };
    slow.iter().flat_map(|one| fast.iter().map(move |other| both(one, other))).collect()
}

/// The entries of a table by `table.key`, written as one quoted key or as a key of a table.
pub(super) fn flat(table: &Table) -> Vec<(String, &Value)> {
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

/// A value as an override takes it.
pub(super) fn value_text(value: &Value) -> String {
    value.to_string()
}
