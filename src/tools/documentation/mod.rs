//! Tools that return the documentation of tables.

mod describe_tables;
mod list_all_tables;

pub use describe_tables::DescribeTables;
pub use list_all_tables::ListAllTables;
use serde_json::Value;

use super::arguments::{Arguments, wrong_type_rejection};
use super::rejection::Rejection;
use novamind_base::similar_names;

/// Names of tools or tables that a call requests.
pub enum NameSelection {
    /// All tools or tables.
    All,
    /// Only the tools or tables in this list.
    Named(Vec<String>),
}

impl NameSelection {
    /// Parses a name or a list of names. `all` (alone or in a list) selects all names, and so does a missing argument.
    pub(super) fn parse(arguments: &Arguments, field: &'static str) -> Result<NameSelection, Rejection> {
        let wrong = || wrong_type_rejection(field, "a name, a list of names, or all");
        match arguments.get(field) {
            None => Ok(NameSelection::All),
            Some(Value::String(name)) if name == "all" => Ok(NameSelection::All),
            Some(Value::String(name)) => Ok(NameSelection::Named(vec![name.clone()])),
            Some(Value::Array(names)) if names.iter().any(|name| name == "all") => Ok(NameSelection::All),
            Some(Value::Array(names)) => {
                let names = names.iter().map(|name| name.as_str().map(str::to_owned));
                names.collect::<Option<_>>().map(NameSelection::Named).ok_or_else(wrong)
            }
            Some(_) => Err(wrong()),
        }
    }

    /// Returns the requested names that are known. Rejects the call only if none is known.
    pub(super) fn resolve_names<'a>(
        &self,
        known: &[&'a str],
        field: &'static str,
        code: &'static str,
    ) -> Result<Vec<&'a str>, Rejection> {
        let NameSelection::Named(asked) = self else { return Ok(known.to_vec()) };
        let found: Vec<&str> =
            known.iter().copied().filter(|name| asked.iter().any(|text| text == name)).collect();
        if !found.is_empty() {
            return Ok(found);
        }
        let near = similar_names(asked.first().map_or("", String::as_str), known.iter().copied());
        let near =
            if near.is_empty() { known.join(", ") } else { format!("did you mean {}?", near.join(" or ")) };
        let asked = if asked.is_empty() { "an empty list".to_owned() } else { asked.join(", ") };
        Err(Rejection::for_field(field, code, format!("{asked} names nothing that exists; {near}")))
    }
}
