//! Parses bodies that contain `NaN` or `Infinity`. These literals are not valid JSON, but Python's `json.dumps` writes
//! them. They are rejected in the same form as an invalid argument, so that every client shows the name of the
//! argument.

use serde_json::Value;

use novamind_tools::Rejection;

/// The non-finite literals, longest first.
const LITERALS: [&str; 3] = ["-Infinity", "Infinity", "NaN"];
/// Prefix that marks a text as a converted literal.
const MARK: &str = "\u{1}not a number: ";

/// Parses a body with non-finite literals. Returns the body, in which the literals are strings, and a rejection that
/// names the first literal. Returns `None` if the body contains no such literal or is invalid for another reason.
pub fn parse_with_non_finite_numbers(bytes: &[u8]) -> Option<(Value, Rejection)> {
    let mut value = serde_json::from_str(&mark_literals(std::str::from_utf8(bytes).ok()?)).ok()?;
    let (path, literal) = restore_literals(&mut value)?;
    let argument = path.strip_prefix("args.").unwrap_or(&path).to_owned();
    let message = format!("{argument} is {literal}, and must be a finite number");
    Some((value, Rejection::for_field(argument, "wrong_type", message)))
}

/// Converts each non-finite literal outside of strings to a marked string.
fn mark_literals(body: &str) -> String {
    let (mut text, mut rest, mut in_text) = (String::new(), body, false);
    while let Some(letter) = rest.chars().next() {
        let literal = LITERALS.iter().find(|literal| !in_text && rest.starts_with(**literal));
        let taken = match (literal, letter) {
            (Some(literal), _) => {
                text += &Value::from(format!("{MARK}{literal}")).to_string();
                rest = &rest[literal.len()..];
                continue;
            }
            (None, '\\') if in_text => 1 + rest[1..].chars().next().map_or(0, char::len_utf8),
            (None, _) => letter.len_utf8(),
        };
        in_text ^= letter == '"';
        text += &rest[..taken];
        rest = &rest[taken..];
    }
    text
}

/// Converts marked strings back to strings that contain only the literal. Returns the path and the literal of the
/// first marked string.
fn restore_literals(value: &mut Value) -> Option<(String, String)> {
    let join = |name: String, (path, literal): (String, String)| match path.is_empty() {
        true => (name, literal),
        false => (format!("{name}.{path}"), literal),
    };
    let mut first = None;
    match value {
        Value::String(text) => {
            if let Some(literal) = text.strip_prefix(MARK) {
                *text = literal.to_owned();
                first = Some((String::new(), text.clone()));
            }
        }
        Value::Array(all) => {
            for (at, inner) in all.iter_mut().enumerate() {
                let found = restore_literals(inner).map(|found| join(at.to_string(), found));
                first = first.or(found);
            }
        }
        Value::Object(fields) => {
            for (name, inner) in fields.iter_mut() {
                let found = restore_literals(inner).map(|found| join(name.clone(), found));
                first = first.or(found);
            }
        }
        Value::Null | Value::Bool(_) | Value::Number(_) => {}
    }
    first
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn first_non_finite_literal_is_named() {
        let (value, rejection) =
            parse_with_non_finite_numbers(br#"{"tool":"t \" NaN","args":{"m":{"a":[1,-Infinity]},"n":NaN}}"#)
                .expect("it reads");
        assert_eq!(value, json!({"tool": "t \" NaN", "args": {"m": {"a": [1, "-Infinity"]}, "n": "NaN"}}));
        assert_eq!((rejection.code, rejection.field.as_deref()), ("wrong_type", Some("m.a.1")));
        assert_eq!(rejection.message, "m.a.1 is -Infinity, and must be a finite number");
        for other in ["{\"a\": \"NaN\"", "{\"a\": nan}", "{\"a\": NaNa}", "{\"a\": \"NaN\"}", "\\", "\"\\"] {
            assert!(parse_with_non_finite_numbers(other.as_bytes()).is_none(), "{other}");
        }
    }
}
