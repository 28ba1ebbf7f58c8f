//! Documents: what tables and tools there are.

mod describe_tables;
mod get_tool_documentation;
mod list_all_tables;

pub use describe_tables::DescribeTables;
pub use get_tool_documentation::GetToolDocumentation;
pub use list_all_tables::ListAllTables;
use serde_json::Value;

use super::arguments::{Arguments, wrong_type};
use super::refusal::Refusal;
use crate::notation::nearest;

/// Those of the known names that an argument asks for: a name, a list of names, `all`, or nothing for all. Names
/// that are not known are passed over, unless none is.
fn chosen<'a>(
    arguments: &Arguments,
    field: &'static str,
    known: &[&'a str],
    code: &'static str,
) -> Result<Vec<&'a str>, Refusal> {
    let wrong = || wrong_type(field, "a name, a list of names, or all");
    let asked: Vec<&str> = match arguments.get(field) {
        None => return Ok(known.to_vec()),
        Some(Value::String(name)) if name == "all" => return Ok(known.to_vec()),
        Some(Value::String(name)) => vec![name],
        Some(Value::Array(names)) => {
            names.iter().map(Value::as_str).collect::<Option<_>>().ok_or_else(wrong)?
        }
        Some(_) => return Err(wrong()),
    };
    let found: Vec<&str> = known.iter().copied().filter(|name| asked.contains(name)).collect();
    if !found.is_empty() {
        return Ok(found);
    }
    let near = nearest(asked.first().copied().unwrap_or_default(), known.iter().copied());
    let near =
        if near.is_empty() { known.join(", ") } else { format!("did you mean {}?", near.join(" or ")) };
    let asked = if asked.is_empty() { "an empty list".to_owned() } else { asked.join(", ") };
    Err(Refusal::at(field, code, format!("{asked} names nothing that exists; {near}")))
}
