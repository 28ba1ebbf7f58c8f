//! A run as a script of plain mode: the same decisions, played by `novamind play --plain --strict`.

use serde_json::{Value, json};

use super::{Deed, Transcript, TranscriptAct, predictions};
use novamind_record::mode::Mode;
use novamind_record::trajectory::record::CalledTool;

/// The script, with the command that plays it in its first lines.
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
        // Whoever plays it again is not the one who played it.
        if own.mode == Mode::Baseline { " --participant again" } else { "" },
    );
    let head = head + &judge_in_words(run).map(|words| format!("# {words}\n")).unwrap_or_default();
    let lines: String = run.acts.iter().filter_map(line).map(|line| line + "\n").collect();
    head + &lines
}

/// What keeps the run from ending in the same state where it is played again.
pub(super) fn judge_in_words(run: &Transcript) -> Option<&'static str> {
    let is_judged = run.manifest.voice.as_ref().is_some_and(|model| model.judge);
    is_judged.then_some(
        "A language model judged its posts. The built-in judge reads them here, so the last state can be another.",
    )
}

/// A refused call as a comment in one line. The name of an unknown tool can hold any characters, so it is escaped.
pub(super) fn refused_in_words(tool: &CalledTool, args: &Value, code: &str) -> String {
    let name = tool.known().map_or_else(|| json!(tool.name()).to_string(), |tool| tool.name().to_owned());
    format!("# refused ({code}): {name} {args}")
}

/// The options of the new run that this one is to be played on.
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
        options.extend(own.fault.map(|fault| format!(" --planted {}", u32::from(fault))));
    }
    options
}

/// Parameters by their full keys.
fn collect_parameters(above: &str, table: &toml::Table, all: &mut Vec<(String, String)>) {
    for (key, value) in table {
        let key = if above.is_empty() { key.clone() } else { format!("{above}.{key}") };
        match value {
            toml::Value::Table(inner) => collect_parameters(&key, inner, all),
            value => all.push((key, value.to_string())),
        }
    }
}

/// What a deed is in plain mode; nothing of what changes nothing.
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
