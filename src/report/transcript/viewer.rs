//! Export to the data folder of the paper's trajectory viewer: a manifest, one file per run, and one file per week.

use std::collections::BTreeMap;
use std::path::Path;

use serde_json::{Map, Value, json};

use super::viewer_files::PlayerFiles;
use super::{Transcript, TranscriptAction, TranscriptStep, WeekResult, forecasts_as_json};
use novamind_base::formatting::{escape_html, json_number};
use novamind_database::{number_at, text_at};
use novamind_record::error::RunError;
use novamind_record::trajectory::record::{CalledTool, RunEndReason};
use novamind_session::identifiers::Group;
use novamind_session::{Session, week_of_day};

/// Maximum number of lines of an exported result. The viewer shows even fewer.
const MAX_RESULT_LINES: usize = 200;
/// Number of digits of the state hash, which is exported in place of a commit hash.
const HASH_DIGITS: usize = 10;

const GROUP_SQL: &str = "SELECT c.group_id, count(*), sum(s.seat_count)
FROM subscriptions s CROSS JOIN customers c
WHERE c.customer_id = s.customer_id AND s.status = 'subscribed' GROUP BY 1";

/// A run in the format of the viewer.
#[derive(Debug)]
pub struct ViewerExport {
    /// Content of the file of the run.
    pub run: Value,
    /// Content of the file of each week, with the number of the week.
    pub weeks: Vec<(u32, Value)>,
    /// Entry of the run in the manifest.
    manifest_entry: Value,
}

/// Active subscriptions and billed seats of each group on a decision day, according to the visible tables.
struct GroupCounts {
    day: u32,
    groups: Vec<(Group, u64, u64)>,
}

impl GroupCounts {
    fn read(session: &mut Session) -> Result<GroupCounts, RunError> {
        let rows = session
            .query_unrecorded(GROUP_SQL)
            .map_err(|error| RunError::InvalidRequest(error.message))?
            .rows;
        let mut groups: Vec<(Group, u64, u64)> = rows
            .iter()
            .filter_map(|row| {
                Some((Group::parse(text_at(row, 0))?, number_at(row, 1) as u64, number_at(row, 2) as u64))
            })
            .collect();
        groups.sort_by_key(|(group, ..)| *group);
        Ok(GroupCounts { day: session.day(), groups })
    }

    fn individuals(&self) -> u64 {
        self.groups.iter().filter(|(group, ..)| !group.is_enterprise()).map(|(_, count, _)| count).sum()
    }

    fn enterprise_seats(&self) -> u64 {
        self.groups.iter().filter(|(group, ..)| group.is_enterprise()).map(|(.., seats)| seats).sum()
    }
}

/// Actions of the player on a day, and the rationale of the week that began on this day.
#[derive(Default)]
struct ViewerDay {
    rationale: Option<String>,
    actions: Vec<Value>,
}

/// Replays the run in a folder and converts it. `progress` is called with each simulated day.
///
/// # Errors
/// Returns the errors of [`Transcript::open`].
pub fn to_viewer(folder: &Path, progress: &mut dyn FnMut(u32)) -> Result<ViewerExport, RunError> {
    let (mut counts, mut cash_by_day, mut interface) = (Vec::new(), Vec::new(), Value::Null);
    let transcript = Transcript::open_observed(folder, progress, &mut |session| {
        counts.push(GroupCounts::read(session));
        cash_by_day = session.cash_by_day().to_vec();
        interface = json!(session.params().fidelity.interface);
    })?;
    let counts = counts.into_iter().collect::<Result<Vec<GroupCounts>, RunError>>()?;
    let id = folder.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let mut days = Days::new(&transcript.opening_dashboard);
    for step in &transcript.steps {
        days.add_step(step);
    }
    let mut summary = run_summary(&transcript, &id, &days, counts.last());
    let manifest_entry = summary.clone().into();
    let details = json!({
        "seed": transcript.manifest.seed,
        "scenario": transcript.manifest.scenario,
        "mode": transcript.manifest.mode.id(),
        "interface": interface,
        "harness": format!("NovaMind console {}", transcript.manifest.version),
        "cash_series": cash_series(&cash_by_day),
        "sub_series": counts.iter().map(|at| json!({ "day": at.day, "subscribers": at.individuals() })).collect::<Value>(),
        "seat_series": counts.iter().map(seats_on_day).collect::<Value>(),
        "seat_series_by_group": counts.iter().flat_map(seats_by_group).collect::<Value>(),
        "days_list": days.days.keys().collect::<Vec<_>>(),
        "weeks_index": days.week_index,
    });
    summary.extend(details.as_object().cloned().unwrap_or_default());
    summary.insert("days".to_owned(), days.days.into_iter().map(day_to_json).collect::<Map<_, _>>().into());
    Ok(ViewerExport { run: summary.into(), weeks: days.weeks, manifest_entry })
}

/// Returns the manifest with the run added. `manifest` is the text of the existing manifest, if any.
///
/// # Errors
/// Returns an error if the existing manifest is not valid or already lists a run with the same id.
pub fn add_to_viewer_manifest(manifest: Option<&str>, export: &ViewerExport) -> Result<Value, String> {
    let mut manifest: Value = match manifest {
        Some(text) => {
            serde_json::from_str(text).map_err(|error| format!("the manifest is not valid JSON: {error}"))?
        }
        None => json!({ "models": [] }),
    };
    let entry = &export.manifest_entry;
    let invalid = || "the manifest has no list of models with runs".to_owned();
    let models = manifest.get_mut("models").and_then(Value::as_array_mut).ok_or_else(invalid)?;
    for model in models.iter() {
        let runs = model["runs"].as_array().ok_or_else(invalid)?;
        if runs.iter().any(|run| run["run_id"] == entry["run_id"]) {
            return Err(format!("the manifest already lists run {}", entry["run_id"]));
        }
    }
    let runs = models.iter_mut().find(|model| model["model"] == entry["model"]);
    match runs.and_then(|model| model["runs"].as_array_mut()) {
        Some(runs) => runs.push(entry.clone()),
        None => models.push(
            json!({ "model": entry["model"], "model_display": entry["model_display"], "runs": [entry] }),
        ),
    }
    Ok(manifest)
}

/// Returns the fields that the manifest and the file of the run share.
fn run_summary(run: &Transcript, id: &str, days: &Days, last: Option<&GroupCounts>) -> Map<String, Value> {
    let manifest = &run.manifest;
    let policy = run.policy.as_ref().map(|name| format!("policy {name}"));
    let player = manifest.participant.clone().or(policy).unwrap_or_else(|| run.player_name());
    let (day, cash) = run.last_day_and_cash;
    let status = match run.end.as_ref().map(|end| end.reason) {
        Some(RunEndReason::Bankruptcy) => "bankrupt",
        Some(RunEndReason::Horizon | RunEndReason::Lesson) => "complete",
        // The viewer has no other status for runs that did not reach their last day.
        Some(RunEndReason::Abandoned) | None => "dnf",
    };
    // The viewer inserts the label as HTML.
    let label = format!("{}, seed {}, {}", manifest.scenario, manifest.seed, manifest.mode.id());
    let all = json!({
        "run_id": id,
        "model": player,
        "model_display": player,
        "label": escape_html(&label),
        "status": status,
        "dnf": status == "dnf",
        "bankrupt": status == "bankrupt",
        "total_days": manifest.days,
        "current_day": day,
        "survival_days": day,
        "cash": json_number(cash),
        "final_cash": json_number(cash),
        "subscribers": last.map_or(0, GroupCounts::individuals),
        "action_count": days.action_count,
        "days_count": days.days.len(),
    });
    all.as_object().cloned().unwrap_or_default()
}

fn cash_series(cash_by_day: &[f64]) -> Value {
    (0..)
        .zip(cash_by_day)
        .map(|(day, cash): (u32, _)| json!({ "day": day, "cash": json_number(*cash) }))
        .collect()
}

fn seats_on_day(at: &GroupCounts) -> Value {
    json!({ "day": at.day, "individual": at.individuals(), "enterprise_seats": at.enterprise_seats() })
}

fn seats_by_group(at: &GroupCounts) -> Vec<Value> {
    let group_entry = |(group, _, seats): &(Group, u64, u64)| json!({ "day": at.day, "group_id": group.id(), "count": seats });
    at.groups.iter().map(group_entry).collect()
}

fn day_to_json((day, of_day): (u32, ViewerDay)) -> (String, Value) {
    let mut value = json!({ "actions": of_day.actions });
    if let Some(rationale) = of_day.rationale {
        value["rationale"] = rationale.into();
    }
    (day.to_string(), value)
}

/// The days and weeks of the run, built step by step.
struct Days {
    days: BTreeMap<u32, ViewerDay>,
    action_count: usize,
    files: PlayerFiles,
    week_index: Vec<Value>,
    weeks: Vec<(u32, Value)>,
}

impl Days {
    fn new(opening_dashboard: &str) -> Days {
        let mut days = Days {
            days: BTreeMap::new(),
            action_count: 0,
            files: PlayerFiles::default(),
            week_index: Vec::new(),
            weeks: Vec::new(),
        };
        days.add_dashboard(0, opening_dashboard);
        days
    }

    fn add_dashboard(&mut self, day: u32, dashboard: &str) {
        let action =
            json!({ "turn": self.action_count, "tool": "_dashboard", "arguments": {}, "result": dashboard });
        self.days.entry(day).or_default().actions.push(action);
    }

    fn add_step(&mut self, step: &TranscriptStep) {
        let Some((tool, arguments, result)) = describe_action(&step.action) else { return };
        self.files.add_action(step);
        self.action_count += 1;
        let day = self.days.entry(step.day).or_default();
        day.actions.push(json!({
            "turn": self.action_count,
            "timestamp": step.at,
            "tool": tool,
            "arguments": arguments,
            "result": shorten(&result),
        }));
        if let TranscriptAction::Week { rationale, result, .. } = &step.action {
            day.rationale = Some(rationale.clone());
            if let Some(week) = result {
                self.close_week(week);
            }
        }
    }

    fn close_week(&mut self, week: &WeekResult) {
        self.add_dashboard(week.day, &week.dashboard);
        let number = week_of_day(week.day);
        let (files, size) = self.files.take_changes();
        let hash: String = week.state_hash.chars().take(HASH_DIGITS).collect();
        self.week_index.push(json!({
            "week": number, "day": week.day, "hash": hash, "file_count": files.len(), "size_bytes": size,
        }));
        let subject = format!("Week {number} (day {})", week.day);
        let content =
            json!({ "week": number, "day": week.day, "hash": hash, "subject": subject, "files": files });
        self.weeks.push((number, content));
    }
}

/// Returns the tool, the arguments and the result of an action, or `None` for an action that only debug runs have.
fn describe_action(action: &TranscriptAction) -> Option<(String, Value, String)> {
    let shown = |value: &Value| serde_json::to_string_pretty(value).unwrap_or_default();
    let rejected = |code: &str, message: &str| format!("rejected ({code}): {message}");
    Some(match action {
        TranscriptAction::Call { tool, args, answer, .. } => {
            let name = match tool {
                CalledTool::Known(tool) => tool.name().to_owned(),
                // The prefix distinguishes the tool from the tools of the viewer's agents, for which the viewer expects
                // certain arguments.
                CalledTool::Unknown(name) => format!("unknown tool {name}"),
            };
            let result = match answer {
                Ok(data) => shown(data),
                Err(rejection) => rejected(&rejection.code, &rejection.message),
            };
            (name, args.clone(), result)
        }
        TranscriptAction::Query { sql, answer, .. } => {
            let result = match answer {
                Ok(rows) => shown(rows),
                Err((code, message)) => rejected(code, message),
            };
            ("query".to_owned(), json!({ "sql": sql }), result)
        }
        // The viewer shows saved texts as written files.
        TranscriptAction::Note(text) => {
            let result = if text.is_some() { "" } else { "the text is not recorded" };
            (
                "write_file".to_owned(),
                json!({ "path": PlayerFiles::NOTES, "content": text }),
                result.to_owned(),
            )
        }
        TranscriptAction::Week { forecasts, result, .. } => {
            let result = match result {
                Some(week) => format!("day {}, cash {}", week.day, json_number(week.cash)),
                None => "the week did not end".to_owned(),
            };
            ("next_week".to_owned(), json!({ "predictions": forecasts_as_json(forecasts) }), result)
        }
        TranscriptAction::Debugging(_) => return None,
    })
}

/// Truncates a result to the maximum number of lines.
fn shorten(text: &str) -> String {
    let count = text.lines().count();
    if count <= MAX_RESULT_LINES {
        return text.to_owned();
    }
    let first: Vec<&str> = text.lines().take(MAX_RESULT_LINES).collect();
    format!("{}\n… {} more lines", first.join("\n"), count - MAX_RESULT_LINES)
}
