//! Names of parameters in the form `table.key`. A list element is addressed by its name, as in `group.S1.c_max_mean`,
//! `capacity_tier.3.capacity_units` and `reputation_influence.S1.S3`, or by its index from 0.

use toml::{Table, Value};

use super::super::identifiers::Group;
use novamind_base::similar_names;

/// Fields that contain the name of a list element.
pub(super) const NAME_FIELDS: [&str; 3] = ["id", "tier", "level"];

/// Returns the name of a list element: its `id`, `tier` or `level`, the identifier of its group, or its index.
pub(super) fn element_name(list: &[Value], at: usize) -> String {
    let text = NAME_FIELDS.iter().find_map(|field| match list.get(at)?.get(field)? {
        Value::String(id) => Some(id.clone()),
        Value::Integer(number) => Some(number.to_string()),
        _ => None,
    });
    let group_name = || Group::all().nth(at).filter(|_| is_by_group(list)).map(|group| group.id().to_owned());
    text.or_else(group_name).unwrap_or_else(|| at.to_string())
}

/// Returns the index of a list element with a given name.
pub(super) fn element_position(list: &[Value], name: &str) -> Option<usize> {
    (0..list.len()).find(|at| element_name(list, *at) == name)
}

fn is_by_group(list: &[Value]) -> bool {
    let is_number = |value: &Value| matches!(value, Value::Float(_) | Value::Integer(_));
    list.len() == Group::COUNT && list.iter().all(is_number)
}

/// Replaces list indexes in a key with element names.
pub(super) fn replace_indexes_with_names(tables: &Table, indexed_key: &str) -> String {
    let mut parts = indexed_key.split('.');
    let Some(first) = parts.next() else { return String::new() };
    let (mut key, mut here) = (first.to_owned(), tables.get(first));
    for part in parts {
        let at = part.parse::<usize>().ok();
        let (name, next) = match (here, at) {
            (Some(Value::Array(list)), Some(at)) => (element_name(list, at), list.get(at)),
            (value, _) => (part.to_owned(), value.and_then(|value| value.get(part))),
        };
        key = format!("{key}.{name}");
        here = next;
    }
    key
}

/// Returns the parameter, list or table with this key.
pub(super) fn value_at<'a>(tables: &'a Table, key: &str) -> Option<&'a Value> {
    let mut parts = key.split('.');
    let first = tables.get(parts.next()?)?;
    parts.try_fold(first, |here, part| match here {
        Value::Array(list) => list.get(element_position(list, part)?),
        value => value.get(part),
    })
}

/// Returns the keys of all parameters.
pub(crate) fn keys(tables: &Table) -> Vec<String> {
    entries(tables).into_iter().map(|(key, _)| key).collect()
}

/// Returns all parameters with their keys.
pub(super) fn entries(tables: &Table) -> Vec<(String, &Value)> {
    let mut all = Vec::new();
    tables.iter().for_each(|(key, value)| collect_entries(key.clone(), value, &mut all));
    all
}

fn collect_entries<'a>(path: String, value: &'a Value, all: &mut Vec<(String, &'a Value)>) {
    match value {
        Value::Table(table) => {
            table.iter().for_each(|(key, inner)| collect_entries(format!("{path}.{key}"), inner, all));
        }
        Value::Array(list) => {
            let inner = list.iter().enumerate();
            inner.for_each(|(at, inner)| {
                collect_entries(format!("{path}.{}", element_name(list, at)), inner, all)
            });
        }
        _ => all.push((path, value)),
    }
}

/// Returns the existing keys that are most similar to an unknown key, most similar first. If any keys have the same
/// last part, returns only these keys.
pub(super) fn nearest_keys(tables: &Table, key: &str) -> Vec<String> {
    let all = keys(tables);
    let last = |key: &str| key.rsplit('.').next().unwrap_or_default().to_owned();
    let text = last(key);
    let is_index = text.parse::<usize>().is_ok();
    let ends_alike = |one: &&String| !is_index && last(one) == text;
    let alike: Vec<&str> = all.iter().filter(ends_alike).map(String::as_str).collect();
    let near = match alike.is_empty() {
        // The user probably meant a key with the same last part, even if the distance is large.
        false => sort_by_distance(key, alike),
        true => similar_names(key, all.iter().map(String::as_str)),
    };
    near.into_iter().map(str::to_owned).collect()
}

/// Maximum length of a key, in bytes, for which distances are computed.
const MAX_KEY_BYTES: usize = 200;

fn sort_by_distance<'a>(key: &str, mut alike: Vec<&'a str>) -> Vec<&'a str> {
    if key.len() <= MAX_KEY_BYTES {
        alike.sort_by_key(|one| strsim::damerau_levenshtein(key, one));
    }
    alike.truncate(3);
    alike
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::params::Params;

    fn bundled_tables() -> Table {
        Table::try_from(Params::bundled()).expect("parameters are tables")
    }

    #[test]
    fn parameter_names_are_unique_and_resolvable() {
        let tables = bundled_tables();
        let all = keys(&tables);
        let once: std::collections::BTreeSet<&String> = all.iter().collect();
        assert_eq!(once.len(), all.len());
        for key in &all {
            assert!(
                value_at(&tables, key).is_some_and(|value| !value.is_table() && !value.is_array()),
                "{key}"
            );
        }
        for key in ["group.S1.c_max_mean", "capacity_tier.3.capacity_units", "reputation_influence.S1.S3"] {
            assert!(once.contains(&key.to_owned()), "{key}");
        }
    }

    #[test]
    fn list_elements_have_readable_names() {
        let tables = bundled_tables();
        for (indexed_key, key) in [
            ("group.0.c_max_mean", "group.S1.c_max_mean"),
            ("model_tier.0.unit_cost", "model_tier.1.unit_cost"),
            ("reputation_influence.S1.2", "reputation_influence.S1.S3"),
            ("calendar.weekly.6", "calendar.weekly.6"),
            ("group.99.x", "group.99.x"),
            ("nothing.1.x", "nothing.1.x"),
            ("", ""),
        ] {
            assert_eq!(replace_indexes_with_names(&tables, indexed_key), key);
        }
    }

    #[test]
    fn nearest_keys_prefers_the_same_suffix() {
        let tables = bundled_tables();
        assert_eq!(nearest_keys(&tables, "group.S2.c_max_meen")[0], "group.S2.c_max_mean");
        assert_eq!(nearest_keys(&tables, "groups.S2.c_max_mean")[0], "group.S2.c_max_mean");
        assert_eq!(nearest_keys(&tables, "base_product_quality"), ["quality.base_product_quality"]);
        assert_eq!(nearest_keys(&tables, "capacity_tier.9.capacity_units").len(), 3);
        assert_eq!(nearest_keys(&tables, "reputation_influence.S2.0")[0], "reputation_influence.S2.S1");
    }
}
