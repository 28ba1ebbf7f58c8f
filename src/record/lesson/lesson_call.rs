//! Calls in a lesson file: a tool with its arguments, or rules for messages of enterprises.

use serde::Deserialize;
use serde_json::{Map, Value};

use novamind_tools::{Language, ToolId, find};

/// A call in a lesson file.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(try_from = "String")]
pub enum LessonCall {
    /// A call to a tool with JSON arguments.
    Tool(ToolId, Value),
    /// Text of the rules that answer every waiting enterprise.
    Rules(String),
}

impl TryFrom<String> for LessonCall {
    type Error = String;

    fn try_from(text: String) -> Result<LessonCall, String> {
        if let Some(rules) = text.strip_prefix("rules:") {
            return Ok(LessonCall::Rules(rules.trim().to_owned()));
        }
        let (name, rest) = text.trim().split_once(' ').unwrap_or((text.trim(), ""));
        let tool = find(name).ok_or_else(|| format!("there is no tool {name}"))?;
        let args = match rest.trim() {
            "" => Value::Object(Map::new()),
            rest => serde_json::from_str(rest)
                .map_err(|error| format!("the arguments of {name} are not valid JSON: {error}"))?,
        };
        // Python is not allowed: the student would execute code of the lesson's author.
        if args["code"].as_str().is_some_and(|code| Language::detect(code) == Language::Python) {
            return Err(format!("{name} in a lesson takes SQL statements, not Python"));
        }
        Ok(LessonCall::Tool(tool.spec().id, args))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lesson_calls_parse_or_report_the_error() {
        let read = |text: &str| LessonCall::try_from(text.to_owned());
        let call = read(r#"set_prices {"A": 12}"#).expect("a call");
        assert_eq!(call, LessonCall::Tool(ToolId::SetPrices, serde_json::json!({ "A": 12 })));
        assert_eq!(read("rules: reject rest").expect("rules"), LessonCall::Rules("reject rest".to_owned()));
        assert!(read("set_price {}").expect_err("no tool").contains("set_price"));
        assert!(read("set_prices {A}").expect_err("invalid JSON").contains("not valid JSON"));
        assert!(read(r##"python_exec {"code": "# python"}"##).expect_err("no SQL").contains("not Python"));
    }
}
