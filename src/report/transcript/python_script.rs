//! Export to a Python program that uses the client: the same decisions on a served run.

use serde_json::{Value, json};

use super::plain_script::{judge_in_words, new_run, refused_in_words};
use super::{Deed, Transcript, predictions};
use novamind_record::error::RunError;

/// Returns the program.
///
/// # Errors
/// Returns an error if the run has single days or changed parameters, which no server offers.
pub fn python_script(run: &Transcript) -> Result<String, RunError> {
    let own = &run.manifest;
    let mut text = format!(
        "\"\"\"Run {} of NovaMind console {}: {} days of which {} passed; last state {}.\n\n    \
         novamind serve --client client\n    \
         novamind serve --new {} --port 8001\n    \
         NOVAMIND_API_PORT=8001 PYTHONPATH=client python3 THIS_FILE\n\"\"\"\n\
         from novamind import call, next_week\n\n",
        own.id,
        own.version,
        own.days,
        run.last.0,
        run.state_hash,
        new_run(run),
    );
    text += &judge_in_words(run).map(|words| format!("# {words}\n\n")).unwrap_or_default();
    for act in &run.acts {
        match &act.deed {
            Deed::Call { tool, args, answer: Ok(_), .. } => {
                text += &format!("call({}, {})\n", python(&json!(tool.name())), python(args));
            }
            Deed::Week { rationale, forecasts, .. } => {
                let (why, filed) = (python(&json!(rationale)), python(&predictions(forecasts)));
                text += &format!("next_week({why}, {filed})\n");
            }
            Deed::Debugging(command) => {
                return Err(RunError::NotPossible(format!(
                    "day {}: `{command}` is not a tool, so no client program can repeat this run; its plain script \
                     does",
                    act.day
                )));
            }
            Deed::Call { tool, args, answer: Err(refusal), .. } => {
                text += &format!("{}\n", refused_in_words(tool, args, &refusal.code));
            }
            Deed::Query { .. } | Deed::Note(_) => {}
        }
    }
    Ok(text)
}

fn python(value: &Value) -> String {
    let in_order = |parts: Vec<String>| parts.join(", ");
    match value {
        Value::Null => "None".to_owned(),
        Value::Bool(true) => "True".to_owned(),
        Value::Bool(false) => "False".to_owned(),
        // JSON escapes are valid in Python except for surrogate pairs, so other text is not escaped. `/` is not
        // escaped either.
        Value::String(_) | Value::Number(_) => value.to_string(),
        Value::Array(all) => format!("[{}]", in_order(all.iter().map(python).collect())),
        Value::Object(all) => {
            let fields = all.iter().map(|(key, value)| format!("{}: {}", json!(key), python(value)));
            format!("{{{}}}", in_order(fields.collect()))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_written_as_python_reads_them() {
        let value = json!({ "a": [1, 2.5, null, true], "b\"": "two\nlines \\ and “quotes”" });
        assert_eq!(
            python(&value),
            "{\"a\": [1, 2.5, None, True], \"b\\\"\": \"two\\nlines \\\\ and “quotes”\"}"
        );
    }
}
