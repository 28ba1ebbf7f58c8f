//! Reading parameters: merge the shipped files with overrides, and say where a wrong value stands.

use std::fmt;

use toml::{Table, Value};

use super::{Params, check};

/// A text that holds parameters, with the name people know it by.
#[derive(Debug, Clone, PartialEq)]
pub struct ParameterSource {
    /// File name for messages, for instance `configs/world/market.toml`.
    pub name: String,
    /// TOML text.
    pub text: String,
}

/// What is wrong with the parameters, and where.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ParameterError {
    /// File or option that holds the value.
    pub source: String,
    /// Line in the file, from 1, where it is known.
    pub line: Option<usize>,
    /// Key as `table.key`, empty when the file as a whole is wrong.
    pub key: String,
    /// What is wrong and what would be right.
    pub problem: String,
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

macro_rules! shipped {
    ($($file:literal),* $(,)?) => {
        [$(ParameterSource {
            name: concat!("configs/world/", $file).to_owned(),
            text: include_str!(concat!("../../../configs/world/", $file)).to_owned(),
        }),*]
    };
}

/// The parameter files compiled into the program.
pub fn shipped_sources() -> Vec<ParameterSource> {
    Vec::from(shipped![
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
    /// The parameters as shipped.
    pub fn shipped() -> Params {
        Params::load(&shipped_sources(), &[]).expect("the shipped parameters are tested")
    }

    /// Reads the base sources, which together hold every key once, and lays the overrides over them in order.
    ///
    /// # Errors
    /// The first wrong value: unreadable text, a table in two base sources, an unknown or missing key, a wrong
    /// type, a value out of range, values that contradict each other.
    pub fn load(base: &[ParameterSource], overrides: &[ParameterSource]) -> Result<Params, ParameterError> {
        let mut merged = Table::new();
        for source in base {
            for (key, value) in parse(source)? {
                if merged.insert(key.clone(), value).is_some() {
                    return Err(locate(&[source], &key, "this table stands in another file too"));
                }
            }
        }
        for source in overrides {
            override_table(&mut merged, parse(source)?)
                .map_err(|(key, problem)| locate(&[source], &key, &problem))?;
        }
        let sources: Vec<&ParameterSource> = overrides.iter().rev().chain(base).collect();
        check::ranges(&merged).map_err(|(key, problem)| locate(&sources, &key, &problem))?;
        let params = read(merged, &sources)?;
        check::relations(&params).map_err(|(key, problem)| locate(&sources, &key, &problem))?;
        Ok(params)
    }
}

fn parse(source: &ParameterSource) -> Result<Table, ParameterError> {
    source.text.parse::<Table>().map_err(|error| ParameterError {
        source: source.name.clone(),
        line: error.span().map(|span| line_of(&source.text, span.start)),
        key: String::new(),
        problem: error.message().to_owned(),
    })
}

fn read(merged: Table, sources: &[&ParameterSource]) -> Result<Params, ParameterError> {
    serde_path_to_error::deserialize(Value::Table(merged)).map_err(|error| {
        let key = error.path().to_string().replace(['[', ']'], "");
        locate(sources, &key, &in_plain_words(error.inner().message()))
    })
}

/// A message of the reader without the names of types in this code.
fn in_plain_words(message: &str) -> String {
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

/// Lays `above` over `below`: tables are merged key by key, everything else is replaced.
///
/// # Errors
/// (key, problem) when a key does not exist below: an override never adds a parameter.
pub fn override_table(below: &mut Table, above: Table) -> Result<(), (String, String)> {
    for (key, value) in above {
        match (below.get_mut(&key), value) {
            (Some(Value::Table(inner)), Value::Table(over)) => {
                override_table(inner, over).map_err(|(path, problem)| (format!("{key}.{path}"), problem))?;
            }
            (Some(slot), value) => *slot = value,
            (None, _) => {
                let near = super::nearest(&key, below.keys().map(String::as_str));
                let help = if near.is_empty() {
                    String::new()
                } else {
                    format!("; did you mean {}?", near.join(" or "))
                };
                let problem = format!("there is no such parameter{help}");
                return Err((key, problem));
            }
        }
    }
    Ok(())
}

/// An error at the place where the first of `sources` that holds `key` has it.
fn locate(sources: &[&ParameterSource], key: &str, problem: &str) -> ParameterError {
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

/// Line of the deepest part of a dotted key that stands in the text; elements of lists are numbered from 0.
pub fn line_of_key(text: &str, key: &str) -> Option<usize> {
    let document = toml::de::DeTable::parse(text).ok()?;
    let mut line = None;
    let mut here = Some(toml::de::DeValue::Table(document.into_inner()));
    for part in key.split('.') {
        let (span, next) = match here.take()? {
            toml::de::DeValue::Table(table) => {
                let (found, value) = table.into_iter().find(|(name, _)| name.get_ref() == part)?;
                (found.span(), value.into_inner())
            }
            toml::de::DeValue::Array(values) => {
                let value = values.into_iter().nth(part.parse().ok()?)?;
                (value.span(), value.into_inner())
            }
            _ => return line,
        };
        line = Some(line_of(text, span.start));
        here = Some(next);
    }
    line
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with_override(text: &str) -> ParameterError {
        let over = ParameterSource { name: "scenario.toml".to_owned(), text: text.to_owned() };
        Params::load(&shipped_sources(), &[over]).expect_err("the override is wrong")
    }

    #[test]
    fn the_shipped_files_load() {
        let params = Params::shipped();
        assert_eq!(params.digest(), Params::shipped().digest());
        assert_eq!(params.digest().len(), 16);
    }

    #[test]
    fn an_override_changes_one_value_and_the_digest() {
        let over = ParameterSource {
            name: "x".to_owned(),
            text: "[competitor]\ncompetitor_events_disabled = true".to_owned(),
        };
        let params = Params::load(&shipped_sources(), &[over]).expect("a correct override");
        assert!(params.competitor.competitor_events_disabled);
        assert_ne!(params.digest(), Params::shipped().digest());
    }

    #[test]
    fn an_unknown_key_names_file_line_key_and_neighbours() {
        let error = with_override("# a comment\n[competitor]\ncompetitor_feedback_max = 1.0\n");
        assert_eq!(error.source, "scenario.toml");
        assert_eq!(error.line, Some(3));
        assert_eq!(error.key, "competitor.competitor_feedback_max");
        assert!(error.problem.contains("competitor_feedback_u_max"), "{}", error.problem);
    }

    #[test]
    fn a_value_out_of_range_names_what_is_allowed() {
        let error = with_override("[competitor]\n\ncompetitor_feedback_u_max = 1.5\n");
        assert_eq!((error.line, error.key.as_str()), (Some(3), "competitor.competitor_feedback_u_max"));
        assert!(error.problem.contains("between 0 and 1"), "{}", error.problem);
    }

    #[test]
    fn a_wrong_type_is_located_in_the_file_that_set_it() {
        let error = with_override("[quality]\nbase_product_quality = \"good\"\n");
        assert_eq!((error.source.as_str(), error.line), ("scenario.toml", Some(2)));
        assert!(error.key.ends_with("base_product_quality"), "{}", error.key);
        let error = with_override("[fidelity]\nsurge_start = \"month\"\n");
        assert_eq!(error.line, Some(2));
        assert!(error.problem.contains("week") && error.problem.contains("day"), "{}", error.problem);
    }

    #[test]
    fn broken_text_names_the_line() {
        let error = with_override("[quality]\nbase_product_quality = = 1\n");
        assert_eq!(error.line, Some(2));
    }

    #[test]
    fn contradictions_are_found() {
        let error = with_override("[competitor]\ncompetitor_feedback_u_min = 0.6\n");
        assert!(error.key.contains("competitor_feedback_u_m"), "{error}");
    }

    #[test]
    fn a_missing_key_is_an_error_with_the_file() {
        let mut sources = shipped_sources();
        sources[4].text = sources[4].text.replace("competitor_event_mean_interval", "# gone");
        let error = Params::load(&sources, &[]).expect_err("a key is missing");
        assert!(error.problem.contains("competitor_event_mean_interval"), "{error}");
        assert!(error.to_string().contains("market.toml"), "{error}");
    }

    #[test]
    fn two_files_with_one_table_are_refused() {
        let mut sources = shipped_sources();
        sources.push(ParameterSource { name: "more.toml".to_owned(), text: "[quality]\nx = 1".to_owned() });
        let error = Params::load(&sources, &[]).expect_err("a table stands twice");
        assert_eq!((error.source.as_str(), error.key.as_str()), ("more.toml", "quality"));
    }
}
