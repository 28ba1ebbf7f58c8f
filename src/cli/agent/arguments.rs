//! Converts command-line arguments of an agent to JSON request bodies.

use std::io::Read;

use serde_json::{Map, Value, json};

use crate::cli::Failure;
use crate::tools::{ArgumentKind, FORECAST_KEYS, find};

/// Returns the argument itself, or the content of standard input if the argument is `-`.
///
/// # Errors
/// Standard input cannot be read.
pub fn read_text(word: &str) -> Result<String, Failure> {
    if word != "-" {
        return Ok(word.to_owned());
    }
    let mut text = String::new();
    let read = std::io::stdin().read_to_string(&mut text);
    read.map_err(|error| Failure::failed(format!("cannot read standard input: {error}")))?;
    Ok(text)
}

/// Returns the request body of `next-week`.
///
/// # Errors
/// The arguments are neither one object nor a rationale with twelve numbers.
pub fn parse_next_week(words: &[String]) -> Result<Value, Failure> {
    match words {
        [object] => parse_object(&read_text(object)?),
        [rationale, numbers @ ..] if numbers.len() == 3 * FORECAST_KEYS.len() => {
            let mut predictions = Map::new();
            for (key, forecast) in FORECAST_KEYS.iter().zip(numbers.chunks(3)) {
                let [point, lower, upper] = [0, 1, 2].map(|at| parse_number(&forecast[at]));
                predictions
                    .insert((*key).to_owned(), json!({ "point": point?, "lower": lower?, "upper": upper? }));
            }
            Ok(json!({ "rationale": rationale, "predictions": predictions }))
        }
        _ => Err(Failure::usage(format!(
            "next-week takes one JSON object, or a rationale and {} numbers: point, lower and upper for {}. You gave {} arguments",
            3 * FORECAST_KEYS.len(),
            FORECAST_KEYS.join(", "),
            words.len()
        ))),
    }
}

fn parse_number(word: &str) -> Result<f64, Failure> {
    let read = word.parse::<f64>().ok().filter(|value| value.is_finite());
    read.ok_or_else(|| {
        Failure::usage(format!("{word} is not a number; write a number such as 950000 or 9.5e5"))
    })
}

/// Returns the arguments of a tool call as a JSON value.
///
/// # Errors
/// The arguments are neither one object nor pairs of --KEY VALUE.
pub fn parse_tool_arguments(tool: &str, words: &[String]) -> Result<Value, Failure> {
    match words {
        [] => Ok(json!({})),
        [object] if !object.starts_with("--") => parse_object(&read_text(object)?),
        _ => parse_pairs(tool, words).map(Value::Object),
    }
}

fn parse_object(text: &str) -> Result<Value, Failure> {
    match serde_json::from_str(text) {
        Ok(object @ Value::Object(_)) => Ok(object),
        Ok(_) => Err(Failure::usage("the arguments must be one JSON object, for example '{\"A\": 14}'")),
        Err(error) => Err(Failure::usage(format!("the arguments are not a valid JSON object: {error}"))),
    }
}

fn parse_pairs(tool: &str, words: &[String]) -> Result<Map<String, Value>, Failure> {
    let mut given = Map::new();
    let mut rest = words.iter();
    while let Some(word) = rest.next() {
        let wrong = || {
            Failure::usage(format!(
                "unexpected {word}: give one JSON object, or --KEY VALUE for each argument"
            ))
        };
        let name = word.strip_prefix("--").filter(|name| !name.is_empty()).ok_or_else(wrong)?;
        let (name, value) = match name.split_once('=') {
            Some((name, value)) => (name, value.to_owned()),
            None => {
                (name, rest.next().ok_or_else(|| Failure::usage(format!("--{name} needs a value")))?.clone())
            }
        };
        if given.insert(name.to_owned(), parse_value(tool, name, value)).is_some() {
            return Err(Failure::usage(format!("--{name} is given twice")));
        }
    }
    Ok(given)
}

/// Converts the value of a tool argument to the argument's type. Text arguments remain strings even if they look like numbers.
fn parse_value(tool: &str, name: &str, text: String) -> Value {
    let is_argument = |argument: &&crate::tools::Argument| argument.name == name;
    let kind = find(tool).and_then(|tool| tool.spec().arguments.iter().find(is_argument));
    if kind.is_some_and(|argument| matches!(argument.kind, ArgumentKind::Text)) {
        return Value::String(text);
    }
    serde_json::from_str(&text).unwrap_or(Value::String(text))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn split_words(line: &str) -> Vec<String> {
        line.split('|').map(str::to_owned).collect()
    }

    #[test]
    fn parse_tool_arguments_accepts_an_object_or_pairs() {
        let read = |tool: &str, line: &str| {
            parse_tool_arguments(tool, &split_words(line)).map_err(|failure| failure.to_string())
        };
        assert_eq!(read("set_prices", "--A|14|--B=20.5"), Ok(json!({ "A": 14, "B": 20.5 })));
        assert_eq!(read("set_prices", r#"{"A": null}"#), Ok(json!({ "A": null })));
        assert_eq!(read("post_social_media", "--content|17"), Ok(json!({ "content": "17" })));
        assert_eq!(read("research_group", "--group_id|S1"), Ok(json!({ "group_id": "S1" })));
        for line in ["[1]", "{", "--A", "A|1", "--A|1|--A|2", "--|1"] {
            assert!(read("set_prices", line).is_err(), "{line}");
        }
    }

    #[test]
    fn parse_next_week_accepts_an_object_or_thirteen_words() {
        let filed =
            parse_next_week(&split_words("on|9|8|10|9|8|10|9|8|10|-1e6|-2000000|0")).expect("a filing");
        assert_eq!(filed["predictions"]["cash_26wk"], json!({ "point": -1e6, "lower": -2e6, "upper": 0.0 }));
        assert_eq!(filed["rationale"], "on");
        assert!(parse_next_week(&split_words("on|1|2")).is_err());
        assert!(parse_next_week(&split_words("on|9|8|10|9|8|10|9|8|10|9|x|10")).is_err());
    }
}
