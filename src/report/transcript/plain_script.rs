//! Export to a script of plain mode: the same decisions, replayed by `novamind play --plain --strict`.

use serde_json::{Value, json};

use super::{Deed, Transcript, TranscriptAct, predictions};
use novamind_record::mode::Mode;
use novamind_record::trajectory::record::CalledTool;

/// Returns the script, with the command that runs it in the first lines.
pub fn plain_script(run: &Transcript) -> String {
    let own = &run.manifest;
    let head = format!(
        "# Run {} of NovaMind console {}, {} days of which {} passed; last state {}.\n\
         # novamind play --plain --strict {}{} < THIS FILE\n",
        own.id,
        own.version,
        own.days,
        run.last.0,
        run.state_hash,
        new_run(run),
        // The label must not be the original participant's.
        if own.mode == Mode::Baseline { " --participant again" } else { "" },
    );
    let head = head + &judge_in_words(run).map(|words| format!("# {words}\n")).unwrap_or_default();
    let lines: String = run.acts.iter().filter_map(line).map(|line| line + "\n").collect();
    head + &lines
}

/// Explains why replaying the run may end in a different state.
pub(super) fn judge_in_words(run: &Transcript) -> Option<&'static str> {
    let is_judged = run.manifest.voice.as_ref().is_some_and(|model| model.judge);
    is_judged.then_some(
        "A language model judged its posts. This script uses the built-in judge, so the last state can differ.",
    )
}

/// Writes a rejected call as a comment in one line. Escapes the name of an unknown tool, which can contain any
/// characters.
pub(super) fn refused_in_words(tool: &CalledTool, args: &Value, code: &str) -> String {
    let name = tool.known().map_or_else(|| json!(tool.name()).to_string(), |tool| tool.name().to_owned());
    format!("# refused ({code}): {name} {args}")
}

pub(super) fn new_run(run: &Transcript) -> String {
    let own = &run.manifest;
    let mut options = format!(
        "--seed {} --scenario {} --days {} --cash {} --mode {}",
        own.seed,
        own.scenario,
        own.days,
        own.cash,
        own.mode.id()
    );
    if own.mode == Mode::Debug {
        let mut all = Vec::new();
        collect_parameters("", &own.parameters, &mut all);
        options.extend(all.iter().map(|(key, value)| format!(" --set '{key}={value}'")));
        options.extend(own.fault.map(|fault| format!(" --fault {}", u32::from(fault))));
    }
    options
}

fn collect_parameters(above: &str, table: &toml::Table, all: &mut Vec<(String, String)>) {
    for (key, value) in table {
        let key = if above.is_empty() { key.clone() } else { format!("{above}.{key}") };
        match value {
            toml::Value::Table(inner) => collect_parameters(&key, inner, all),
            value => all.push((key, value.to_string())),
        }
    }
}

/// Returns the plain-mode line of an action; `None` if it changes nothing.
fn line(act: &TranscriptAct) -> Option<String> {
    match &act.deed {
        Deed::Call { tool, args, answer: Ok(_), .. } => Some(format!("{tool} {args}")),
        Deed::Week { rationale, forecasts, .. } => {
            let filed = json!({ "rationale": rationale, "predictions": predictions(forecasts) });
            Some(format!("next {filed}"))
        }
        Deed::Debugging(command) => Some(command.clone()),
        Deed::Call { tool, args, answer: Err(refusal), .. } => {
            Some(refused_in_words(tool, args, &refusal.code))
        }
        Deed::Query { .. } | Deed::Note(_) => None,
    }
}
