//! Loads parameters: merges the bundled files with overrides and locates invalid values.

use std::fmt;
use std::sync::OnceLock;

use toml::de::DeValue;
use toml::{Spanned, Table, Value};

use super::names::{NAME_FIELDS, element_name, element_position, nearest_keys, replace_indexes_with_names};
use super::{Params, check};
use crate::identifiers::Group;

/// A TOML text with parameters, and its name.
#[derive(Debug, Clone, PartialEq)]
pub struct ParameterSource {
    /// Name of the text in error messages, for instance `configs/world/market.toml`.
    pub name: String,
    /// TOML text with parameters.
    pub text: String,
}

/// An invalid parameter and its location.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ParameterError {
    /// File or option that contains the invalid value.
    pub source: String,
    /// Line in the file, counted from 1; `None` if the line is not known.
    pub line: Option<usize>,
    /// Key of the parameter as `table.key`; empty if the whole file is invalid.
    pub key: String,
    /// Reason why the value is invalid, with the allowed values.
    pub problem: String,
}

impl ParameterError {
    /// Creates an error for text that is not valid TOML, or that has wrong keys or types.
    pub fn from_toml(source: &str, text: &str, error: &toml::de::Error) -> ParameterError {
        ParameterError {
            source: source.to_owned(),
            line: error.span().map(|span| line_of(text, span.start)),
            key: String::new(),
            problem: error.message().to_owned(),
        }
    }

    /// Creates an error for a key, with the line of the key in the text.
    pub fn for_key(source: &str, text: &str, key: &str, problem: impl Into<String>) -> ParameterError {
        ParameterError {
            source: source.to_owned(),
            line: line_of_key(text, key),
            key: key.to_owned(),
            problem: problem.into(),
        }
    }
}

impl fmt::Display for ParameterError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}", self.source)?;
        if let Some(line) = self.line {
            write!(formatter, ", line {line}")?;
        }
        if !self.key.is_empty() {
            write!(formatter, ", {}", self.key)?;
        }
        write!(formatter, ": {}", self.problem)
    }
}

impl std::error::Error for ParameterError {}

macro_rules! bundled {
    ($($file:literal),* $(,)?) => {
        [$(ParameterSource {
            name: concat!("configs/world/", $file).to_owned(),
            text: include_str!(concat!("../../../configs/world/", $file)).to_owned(),
        }),*]
    };
}

/// Returns the bundled parameter files.
pub fn bundled_sources() -> Vec<ParameterSource> {
    Vec::from(bundled![
        "run.toml",
        "customers.toml",
        "product.toml",
        "retention.toml",
        "market.toml",
        "social.toml",
        "enterprise.toml",
        "discovery.toml",
        "groups.toml",
        "channels.toml",
        "network.toml",
        "personas.toml",
    ])
}

impl Params {
    /// Returns the bundled parameters. The files are parsed only once.
    pub fn bundled() -> Params {
        static BUNDLED: OnceLock<Params> = OnceLock::new();
        let read = || Params::load(&bundled_sources(), &[]).expect("the bundled parameters are valid");
        BUNDLED.get_or_init(read).clone()
    }

    /// Merges base sources and overrides. Together, the base sources contain every key once. Overrides are applied in
    /// order.
    ///
    /// # Errors
    /// Returns the first error that is found: invalid TOML, a table in two base sources, an unknown or missing key, a
    /// wrong type, a value out of range, or contradictory values.
    pub fn load(base: &[ParameterSource], overrides: &[ParameterSource]) -> Result<Params, ParameterError> {
        let mut merged = Table::new();
        for source in base {
            for (key, value) in parse_source(source)? {
                if merged.insert(key.clone(), value).is_some() {
                    return Err(locate_error(&[source], &key, "this table is also in another file"));
                }
            }
        }
        for source in overrides {
            apply_override(&mut merged, parse_source(source)?)
                .map_err(|(key, problem)| locate_error(&[source], &key, &problem))?;
        }
        let sources: Vec<&ParameterSource> = overrides.iter().rev().chain(base).collect();
        from_tables(merged).map_err(|(key, problem)| locate_error(&sources, &key, &problem))
    }
}

/// Creates parameters from complete tables and checks their values.
///
/// # Errors
/// Returns the key of the first invalid value, and the reason why the value is invalid.
pub(super) fn from_tables(tables: Table) -> Result<Params, (String, String)> {
    let with_names = |(key, problem): (String, String)| (replace_indexes_with_names(&tables, &key), problem);
    let whole = Value::Table(tables.clone());
    check::check_ranges(&whole).map_err(with_names)?;
    check::check_bounds(&tables).map_err(with_names)?;
    let params = deserialize(whole).map_err(with_names)?;
    check::check_relations(&params).map_err(with_names)?;
    Ok(params)
}

fn parse_source(source: &ParameterSource) -> Result<Table, ParameterError> {
    source
        .text
        .parse::<Table>()
        .map_err(|error| ParameterError::from_toml(&source.name, &source.text, &error))
}

fn deserialize(tables: Value) -> Result<Params, (String, String)> {
    serde_path_to_error::deserialize(tables).map_err(|error| {
        // Convert list indexes in the parser's path, such as `group[0].c_max_mean`, to the form of parameter names.
        let key = error.path().to_string().replace('[', ".").replace(']', "");
        (key, plain_message(error.inner().message()))
    })
}

/// Removes Rust type names from an error message of the TOML parser.
fn plain_message(message: &str) -> String {
    let Some((found, expected)) = message.rsplit_once(", expected ") else { return message.to_owned() };
    let words = match expected {
        "f64" => "a number",
        "u8" | "u16" | "u32" | "u64" | "usize" => "a whole number of at least 0",
        "i64" => "a whole number",
        "a boolean" => "true or false",
        "a string" => "a text",
        other => other,
    };
    format!("{found}, expected {words}")
}

/// Merges the table `above` into `below`. Merges nested tables key by key, finds list elements by name, and replaces
/// other values.
///
/// # Errors
/// Returns the key and the reason if a key does not exist in `below`, or if a single value would replace a table or
/// list. An override never adds a parameter.
pub fn apply_override(below: &mut Table, above: Table) -> Result<(), (String, String)> {
    merge_table(below, above).map_err(|OverrideError { key, kind }| {
        let problem = match kind {
            OverrideErrorKind::Unknown => {
                let near = nearest_keys(below, &key);
                let help = match near.is_empty() {
                    true => String::new(),
                    false => format!("; did you mean {}?", near.join(" or ")),
                };
                format!("there is no such parameter{help}")
            }
            OverrideErrorKind::Table(part) => {
                format!("is a table; name one of its parameters, for instance {key}.{part}")
            }
            OverrideErrorKind::List(part) => {
                format!("is a list; name one of its elements, for instance {key}.{part}")
            }
            OverrideErrorKind::SingleValue => "is a single value, not a table".to_owned(),
        };
        (key, problem)
    })
}

/// Error for an override that does not match the existing value.
struct OverrideError {
    key: String,
    kind: OverrideErrorKind,
}

/// Kind of the existing value that an override does not match.
enum OverrideErrorKind {
    /// No value exists.
    Unknown,
    /// A table, with one of its keys as an example.
    Table(String),
    /// A list, with one of its elements as an example.
    List(String),
    /// A value that is neither a table nor a list.
    SingleValue,
}

impl OverrideErrorKind {
    fn with_key(self, key: impl Into<String>) -> OverrideError {
        OverrideError { key: key.into(), kind: self }
    }
}

impl OverrideError {
    fn nested_under(self, name: &str) -> OverrideError {
        let key = if self.key.is_empty() { name.to_owned() } else { format!("{name}.{}", self.key) };
        OverrideError { key, ..self }
    }
}

fn merge_table(below: &mut Table, above: Table) -> Result<(), OverrideError> {
    above.into_iter().try_for_each(|(name, value)| {
        let slot = below.get_mut(&name).ok_or_else(|| OverrideErrorKind::Unknown.with_key(name.clone()))?;
        replace_value(slot, value).map_err(|misfit| misfit.nested_under(&name))
    })
}

fn replace_value(slot: &mut Value, value: Value) -> Result<(), OverrideError> {
    match (slot, value) {
        (Value::Table(inner), Value::Table(over)) => merge_table(inner, over),
        (Value::Table(inner), _) => {
            let first = inner.keys().next().cloned().unwrap_or_default();
            Err(OverrideErrorKind::Table(first).with_key(""))
        }
        (Value::Array(list), Value::Table(over)) => over.into_iter().try_for_each(|(name, value)| {
            let at = element_position(list, &name)
                .ok_or_else(|| OverrideErrorKind::Unknown.with_key(name.clone()))?;
            replace_value(&mut list[at], value).map_err(|misfit| misfit.nested_under(&name))
        }),
        (slot @ Value::Array(_), Value::Array(values)) => {
            *slot = Value::Array(values);
            Ok(())
        }
        (Value::Array(list), _) => Err(OverrideErrorKind::List(element_name(list, 0)).with_key("")),
        (_, Value::Table(over)) => Err(match over.into_iter().next() {
            Some((name, _)) => OverrideErrorKind::Unknown.with_key(name),
            None => OverrideErrorKind::SingleValue.with_key(""),
        }),
        (slot, value) => {
            *slot = value;
            Ok(())
        }
    }
}

/// Creates an error at the location of `key` in the first of `sources` that contains it.
fn locate_error(sources: &[&ParameterSource], key: &str, problem: &str) -> ParameterError {
    let place = sources.iter().find_map(|source| line_of_key(&source.text, key).map(|line| (source, line)));
    ParameterError {
        source: place
            .map_or_else(|| sources.first().map_or("parameters", |s| &s.name), |(s, _)| &s.name)
            .to_owned(),
        line: place.map(|(_, line)| line),
        key: key.to_owned(),
        problem: problem.to_owned(),
    }
}

fn line_of(text: &str, offset: usize) -> usize {
    text[..offset.min(text.len())].matches('\n').count() + 1
}

/// Returns the line in which the longest existing prefix of a dotted key is defined. List elements have names or are
/// numbered from 0.
pub fn line_of_key(text: &str, key: &str) -> Option<usize> {
    let document = toml::de::DeTable::parse(text).ok()?;
    let mut line = None;
    let mut here = Some(DeValue::Table(document.into_inner()));
    for part in key.split('.') {
        let (span, next) = match here.take()? {
            DeValue::Table(table) => {
                let (found, value) = table.into_iter().find(|(name, _)| name.get_ref() == part)?;
                (found.span(), value.into_inner())
            }
            DeValue::Array(values) => {
                let has_name =
                    |value: &Spanned<DeValue<'_>>| entry_name(value.get_ref()).as_deref() == Some(part);
                let group_position =
                    || Group::parse(part).map(Group::index).filter(|_| values.len() == Group::COUNT);
                let at =
                    values.iter().position(has_name).or_else(group_position).or_else(|| part.parse().ok())?;
                let value = values.into_iter().nth(at)?;
                (value.span(), value.into_inner())
            }
            _ => return line,
        };
        line = Some(line_of(text, span.start));
        here = Some(next);
    }
    line
}

/// Returns the comment that follows a parameter in the bundled files, or `None` if there is none.
pub fn parameter_comment(key: &str) -> Option<String> {
    bundled_sources().iter().find_map(|source| {
        let line = source.text.lines().nth(line_of_key(&source.text, key)? - 1)?;
        line.split_once(" # ").map(|(_, comment)| comment.trim().to_owned())
    })
}

fn entry_name(entry: &DeValue<'_>) -> Option<String> {
    let DeValue::Table(fields) = entry else { return None };
    NAME_FIELDS.iter().find_map(|field| match fields.get(*field)?.get_ref() {
        DeValue::String(id) => Some(id.to_string()),
        DeValue::Integer(number) => Some(number.as_str().to_owned()),
        _ => None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with_override(text: &str) -> ParameterError {
        let over = ParameterSource { name: "scenario.toml".to_owned(), text: text.to_owned() };
        Params::load(&bundled_sources(), &[over]).expect_err("the override is invalid")
    }

    #[test]
    fn bundled_files_load() {
        let params = Params::bundled();
        assert_eq!(params.digest(), Params::bundled().digest());
        assert_eq!(params.digest().len(), 16);
    }

    #[test]
    fn override_changes_one_value_and_the_digest() {
        let over = ParameterSource {
            name: "x".to_owned(),
            text: "[competitor]\ncompetitor_events_disabled = true".to_owned(),
        };
        let params = Params::load(&bundled_sources(), &[over]).expect("a correct override");
        assert!(params.competitor.competitor_events_disabled);
        assert_ne!(params.digest(), Params::bundled().digest());
    }

    #[test]
    fn unknown_key_error_names_location_and_similar_keys() {
        let error = with_override("# a comment\n[competitor]\ncompetitor_feedback_max = 1.0\n");
        assert_eq!(error.source, "scenario.toml");
        assert_eq!(error.line, Some(3));
        assert_eq!(error.key, "competitor.competitor_feedback_max");
        assert!(error.problem.contains("competitor_feedback_u_max"), "{}", error.problem);
    }

    #[test]
    fn out_of_range_error_names_the_range() {
        let error = with_override("[competitor]\n\ncompetitor_feedback_u_max = 1.5\n");
        assert_eq!((error.line, error.key.as_str()), (Some(3), "competitor.competitor_feedback_u_max"));
        assert!(error.problem.contains("between 0 and 1"), "{}", error.problem);
    }

    #[test]
    fn wrong_type_error_names_the_file() {
        let error = with_override("[quality]\nbase_product_quality = \"good\"\n");
        assert_eq!((error.source.as_str(), error.line), ("scenario.toml", Some(2)));
        assert!(error.key.ends_with("base_product_quality"), "{}", error.key);
        let error = with_override("[fidelity]\nsurge_start = \"month\"\n");
        assert_eq!(error.line, Some(2));
        assert!(error.problem.contains("week") && error.problem.contains("day"), "{}", error.problem);
    }

    #[test]
    fn syntax_error_names_the_line() {
        let error = with_override("[quality]\nbase_product_quality = = 1\n");
        assert_eq!(error.line, Some(2));
    }

    #[test]
    fn contradicting_values_are_rejected() {
        let error = with_override("[competitor]\ncompetitor_feedback_u_min = 0.6\n");
        assert!(error.key.contains("competitor_feedback_u_m"), "{error}");
    }

    #[test]
    fn missing_key_error_names_the_file() {
        let mut sources = bundled_sources();
        sources[4].text = sources[4].text.replace("competitor_event_mean_interval", "# gone");
        let error = Params::load(&sources, &[]).expect_err("a key is missing");
        assert!(error.problem.contains("competitor_event_mean_interval"), "{error}");
        assert!(error.to_string().contains("market.toml"), "{error}");
    }

    #[test]
    fn duplicate_tables_are_rejected() {
        let mut sources = bundled_sources();
        sources.push(ParameterSource { name: "more.toml".to_owned(), text: "[quality]\nx = 1".to_owned() });
        let error = Params::load(&sources, &[]).expect_err("a table is defined twice");
        assert_eq!((error.source.as_str(), error.key.as_str()), ("more.toml", "quality"));
    }
}
