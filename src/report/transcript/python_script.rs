//! Export to a Python program that uses the client library to repeat the decisions of the run on a served run.

use serde_json::{Value, json};

use super::plain_script::{describe_unreproducible, new_run_options, rejected_call_comment};
use super::{Transcript, TranscriptAction, forecasts_as_json};
use novamind_record::error::RunError;

/// Returns the run as a Python program.
///
/// # Errors
/// Returns an error if the run has single days or changed parameters, because servers do not offer these actions.
pub fn to_python_script(run: &Transcript) -> Result<String, RunError> {
    let manifest = &run.manifest;
    let mut text = format!(
        "\"\"\"Run {} of NovaMind console {}: {} days of which {} passed; last state {}.\n\n    \
         novamind serve --client client\n    \
         novamind serve --new {} --port 8001\n    \
         NOVAMIND_API_PORT=8001 PYTHONPATH=client python3 THIS_FILE\n\"\"\"\n\
         from novamind import call, next_week\n\n",
        manifest.id,
        manifest.version,
        manifest.days,
        run.last_day_and_cash.0,
        run.state_hash,
        new_run_options(run),
    );
    text += &describe_unreproducible(run).map(|words| format!("# {words}\n\n")).unwrap_or_default();
    for act in &run.steps {
        match &act.action {
            TranscriptAction::Call { tool, args, answer: Ok(_), .. } => {
                text += &format!("call({}, {})\n", python_literal(&json!(tool.name())), python_literal(args));
            }
            TranscriptAction::Week { rationale, forecasts, .. } => {
                let (why, filed) =
                    (python_literal(&json!(rationale)), python_literal(&forecasts_as_json(forecasts)));
                text += &format!("next_week({why}, {filed})\n");
            }
            TranscriptAction::Debugging(command) => {
                return Err(RunError::InvalidRequest(format!(
                    "day {}: `{command}` is not a tool, so no client program can repeat this run; its plain script \
                     does",
                    act.day
                )));
            }
            TranscriptAction::Call { tool, args, answer: Err(refusal), .. } => {
                text += &format!("{}\n", rejected_call_comment(tool, args, &refusal.code));
            }
            TranscriptAction::Query { .. } | TranscriptAction::Note(_) => {}
        }
    }
    Ok(text)
}

fn python_literal(value: &Value) -> String {
    let in_order = |parts: Vec<String>| parts.join(", ");
    match value {
        Value::Null => "None".to_owned(),
        Value::Bool(true) => "True".to_owned(),
        Value::Bool(false) => "False".to_owned(),
        // JSON escapes are valid in Python, except for surrogate pairs. Non-ASCII characters and `/` are therefore not
        // escaped.
        Value::String(_) | Value::Number(_) => value.to_string(),
        Value::Array(all) => format!("[{}]", in_order(all.iter().map(python_literal).collect())),
        Value::Object(all) => {
            let fields = all.iter().map(|(key, value)| format!("{}: {}", json!(key), python_literal(value)));
            format!("{{{}}}", in_order(fields.collect()))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn python_literals_are_valid() {
        let value = json!({ "a": [1, 2.5, null, true], "b\"": "two\nlines \\ and “quotes”" });
        assert_eq!(
            python_literal(&value),
            "{\"a\": [1, 2.5, None, True], \"b\\\"\": \"two\\nlines \\\\ and “quotes”\"}"
        );
    }
}
