//! Export to a plain-mode script that repeats the decisions of the run with `novamind play --plain --strict`.

use serde_json::{Value, json};

use super::{Transcript, TranscriptAction, TranscriptStep, forecasts_as_json};
use novamind_record::mode::Mode;
use novamind_record::trajectory::record::CalledTool;

/// Returns the plain-mode script. The first lines contain the command for running the script.
pub fn to_plain_script(run: &Transcript) -> String {
    let manifest = &run.manifest;
    let head = format!(
        "# Run {} of NovaMind console {}, {} days of which {} passed; last state {}.\n\
         # novamind play --plain --strict {}{} < THIS FILE\n",
        manifest.id,
        manifest.version,
        manifest.days,
        run.last_day_and_cash.0,
        run.state_hash,
        new_run_options(run),
        // The label must differ from the original participant's label.
        if manifest.mode == Mode::Baseline { " --participant again" } else { "" },
    );
    let head = head + &describe_unreproducible(run).map(|words| format!("# {words}\n")).unwrap_or_default();
    let lines: String = run.steps.iter().filter_map(step_line).map(|line| line + "\n").collect();
    head + &lines
}

/// Explains why the script may end in a different state. Returns `None` if it ends in the same state.
pub(super) fn describe_unreproducible(run: &Transcript) -> Option<&'static str> {
    let is_judged = run.manifest.voice.as_ref().is_some_and(|model| model.judge);
    is_judged.then_some(
        "A language model judged the posts of the run. This script uses the built-in judge, so the last state can differ.",
    )
}

/// Formats a rejected call as a one-line comment. Escapes the name of an unknown tool, because it can contain any
/// characters.
pub(super) fn rejected_call_comment(tool: &CalledTool, args: &Value, code: &str) -> String {
    let name = tool.tool_id().map_or_else(|| json!(tool.name()).to_string(), |tool| tool.name().to_owned());
    format!("# refused ({code}): {name} {args}")
}

pub(super) fn new_run_options(run: &Transcript) -> String {
    let manifest = &run.manifest;
    let mut options = format!(
        "--seed {} --scenario {} --days {} --cash {} --mode {}",
        manifest.seed,
        manifest.scenario,
        manifest.total_days(),
        manifest.cash,
        manifest.mode.id()
    );
    if manifest.mode == Mode::Debug {
        let mut all = Vec::new();
        collect_parameters("", &manifest.parameters, &mut all);
        options.extend(all.iter().map(|(key, value)| format!(" --set '{key}={value}'")));
        options.extend(manifest.fault.map(|fault| format!(" --fault {}", u32::from(fault))));
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

/// Returns the plain-mode command of an action, or `None` if the action changes nothing.
fn step_line(act: &TranscriptStep) -> Option<String> {
    match &act.action {
        TranscriptAction::Call { tool, args, answer: Ok(_), .. } => Some(format!("{tool} {args}")),
        TranscriptAction::Week { rationale, forecasts, .. } => {
            let filed = json!({ "rationale": rationale, "predictions": forecasts_as_json(forecasts) });
            Some(format!("next {filed}"))
        }
        TranscriptAction::Debugging(command) => Some(command.clone()),
        TranscriptAction::Call { tool, args, answer: Err(rejection), .. } => {
            Some(rejected_call_comment(tool, args, &rejection.code))
        }
        TranscriptAction::Query { .. } | TranscriptAction::Note(_) => None,
    }
}
