//! `novamind runs`: list, show, end, recover, delete, export and import runs.

mod formats;
#[cfg(feature = "server")]
mod transcript;
mod transfer;

pub use transfer::{remove_partial_files_on_signals, to_csv, write_tables};

use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};
use serde_json::{Value, json};

use super::{Context, Failure, print};
use crate::formatting::{dollars, escape_control_characters};
use crate::insight::{BranchOrigin, branch_origin};
use crate::record::folder::manifest_check::read_manifest_text;
use crate::record::folder::runs::{
    RunSummary, all_run_folders, delete_run, find_run, find_run_to_read, list_runs,
};
use crate::record::trajectory::{Record, Trajectory};
use crate::report::describe_origin;
use crate::session::{abandon_run, recover};
use crate::world::params::{HorizonRule, Interface};

#[derive(Debug, Args)]
pub struct Options {
    #[command(subcommand)]
    command: Option<RunsCommand>,
    /// List only runs of this participant
    #[arg(long, value_name = "LABEL")]
    participant: Option<String>,
    /// Print as JSON
    // The argument needs a different name, because options of `play` may precede a command, and `play` also
    // has an option `json`.
    #[arg(id = "runs_json", long = "json", global = true)]
    json: bool,
}

#[derive(Debug, Subcommand)]
enum RunsCommand {
    /// List the runs, the most recently played first; `runs` without a subcommand does the same
    List {
        /// List only runs of this participant
        #[arg(long, value_name = "LABEL")]
        participant: Option<String>,
    },
    /// Show the settings and the progress of a run
    Show {
        /// ID of the run, or `latest` for the newest run
        run: String,
    },
    /// Print the folder of a run
    Path {
        /// ID of the run, or `latest` for the newest run
        run: String,
    },
    /// End an unfinished run permanently
    End {
        /// ID of the run, or `latest` for the newest unfinished run
        run: String,
    },
    /// Recover the undamaged prefix of a run as a new branch; the damaged run does not change
    #[command(name = "recover", alias = "rescue")]
    Rescue {
        /// Damaged run
        run: String,
    },
    /// Delete a run with all its files
    Delete {
        /// Run to delete
        run: String,
        /// Confirm the deletion
        #[arg(long)]
        yes: bool,
    },
    /// Export a run to a sealed archive, or all runs together with tables of their data
    Export(transfer::Export),
    /// Import the run of an archive after verifying every byte, or play an external transcript
    Import(transfer::Import),
    /// Explain every column of the tables that `export --all` writes
    Columns,
    /// Print the JSON Schema of a line of a trajectory
    Schema,
}

const SCHEMA: &str = include_str!("../../../assets/trajectory.schema.json");

pub fn run(options: &Options, context: &Context) -> Result<(), Failure> {
    let runs = context.runs_folder()?;
    // With a label, list only the runs of that participant. Without a label, list all runs.
    let folders = match context.participant {
        Some(_) => vec![runs.clone()],
        None => all_run_folders(&runs),
    };
    match &options.command {
        None => print_runs(&runs, &folders, options.participant.as_deref(), options.json),
        Some(RunsCommand::List { participant }) => print_runs(
            &runs,
            &folders,
            participant.as_deref().or(options.participant.as_deref()),
            options.json,
        ),
        Some(RunsCommand::Show { run }) => print_run(&folders, run, options.json),
        Some(RunsCommand::Path { run }) => print(&format!("{}\n", find_run_in(&folders, run)?.display())),
        Some(RunsCommand::End { run }) => {
            let id = run_id(&find_run(&runs, run)?);
            abandon_run(&runs, &id)?;
            print(&format!("ended run {id}; you can still view it\n"))
        }
        Some(RunsCommand::Rescue { run }) => {
            let folder = find_run_to_read(&runs, run)?;
            let (found, whole) = (recover(&folder, &context.seal_key()?)?, run_id(&folder));
            print(&format!(
                "run {} contains lines 1 to {} of run {whole} and is on day {}, mode {}\n\
                 problem: {}\nrun {whole} is unchanged; `novamind play --run {}` continues\n",
                found.run, found.lines, found.day, found.mode, found.problem, found.run
            ))
        }
        Some(RunsCommand::Delete { run, yes }) => {
            if !yes {
                let folder = find_run(&runs, run)?;
                let message = format!("this permanently deletes {}; add --yes to confirm", folder.display());
                return Err(Failure::usage(message));
            }
            let id = run_id(&find_run(&runs, run)?);
            delete_run(&runs, &id)?;
            print(&format!("deleted run {id}\n"))
        }
        Some(RunsCommand::Export(export)) => export.run(&folders, options.json, context),
        Some(RunsCommand::Import(import)) => import.run(&runs, options.json, context),
        Some(RunsCommand::Columns) => transfer::explain_columns(options.json),
        Some(RunsCommand::Schema) => print(SCHEMA),
    }
}

/// Prints the summary of a run. The JSON output also contains the score and the last recorded state hash.
fn print_run(folders: &[PathBuf], run: &str, json: bool) -> Result<(), Failure> {
    let folder = find_run_in(folders, run)?;
    let text = read_manifest_text(&folder)?;
    let id = run_id(&folder);
    let summary = list_all(folders)?.into_iter().map(|(_, run)| run).find(|run| run.id == id);
    if json {
        let mut shown = serde_json::to_value(&summary).unwrap_or_default();
        // If the trajectory cannot be read, the summary reports the damage.
        let trajectory = Trajectory::read(&folder.join("trajectory.jsonl")).ok();
        let lines = trajectory.iter().flat_map(|trajectory| trajectory.lines.iter().rev());
        let mut hashes = lines.filter_map(|line| match &line.record {
            Record::Week(closing) | Record::Step(closing) => Some(&closing.state_hash),
            _ => None,
        });
        shown["state_hash"] = json!(hashes.next());
        shown["score"] =
            json!(trajectory.as_ref().and_then(|trajectory| match &trajectory.end_line()?.record {
                Record::End(end) => end.score,
                _ => None,
            }));
        return print(&(serde_json::to_string_pretty(&shown).unwrap_or_default() + "\n"));
    }
    let origin = branch_origin(&folder);
    print(&format!(
        "{}\n{}",
        summary.as_ref().map(|run| format_run(run, origin.as_ref())).unwrap_or_default(),
        escape_control_characters(&text)
    ))
}

/// Returns the folder and the summary of every run in the folders.
pub(super) fn list_all(folders: &[PathBuf]) -> Result<Vec<(PathBuf, RunSummary)>, Failure> {
    let mut all = Vec::new();
    for folder in folders {
        all.extend(list_runs(folder)?.into_iter().map(|run| (folder.join(&run.id), run)));
    }
    all.sort_by(|(_, left), (_, right)| right.played.cmp(&left.played).then_with(|| left.id.cmp(&right.id)));
    Ok(all)
}

/// Returns the id of a run, which is the name of its folder.
fn run_id(folder: &Path) -> String {
    folder.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
}

/// Searches several folders of runs for a run, and returns the folder of the run.
pub(super) fn find_run_in(folders: &[PathBuf], run: &str) -> Result<PathBuf, Failure> {
    let mut found = folders.iter().map(|folder| find_run_to_read(folder, run));
    let first = found.next().ok_or_else(|| Failure::usage("there is no folder of runs"))?;
    // If no folder contains the run, the error for the first folder is the most useful.
    first.or_else(|error| found.find_map(Result::ok).ok_or(error)).map_err(Failure::from)
}

fn print_runs(
    runs: &Path,
    folders: &[PathBuf],
    participant: Option<&str>,
    json: bool,
) -> Result<(), Failure> {
    let mut list: Vec<(RunSummary, Option<BranchOrigin>)> =
        list_all(folders)?.into_iter().map(|(folder, run)| (run, branch_origin(&folder))).collect();
    list.retain(|(run, _)| participant.is_none_or(|label| run.participant.as_deref() == Some(label)));
    if json {
        let listed: Vec<Value> = list
            .iter()
            .map(|(run, origin)| {
                let mut listed = serde_json::to_value(run).unwrap_or_default();
                listed["branch_of"] = serde_json::to_value(origin).unwrap_or_default();
                listed
            })
            .collect();
        return print(&(serde_json::to_string_pretty(&listed).unwrap_or_default() + "\n"));
    }
    match participant {
        Some(label) if list.is_empty() => {
            print(&format!("There are no runs of {label} in {}.\n", runs.display()))
        }
        None if list.is_empty() => {
            print(&format!("There are no runs in {} yet; `novamind` starts one.\n", runs.display()))
        }
        _ => print(&list.iter().map(|(run, origin)| format_run(run, origin.as_ref())).collect::<String>()),
    }
}

fn format_run(run: &RunSummary, origin: Option<&BranchOrigin>) -> String {
    if let Some(problem) = &run.problem {
        return format!(
            "{}  cannot be read: {}\n",
            escape_control_characters(&run.id),
            escape_control_characters(problem)
        );
    }
    let state = run.ended.map_or("open", |ended| ended.id());
    let policy = run.policy.as_ref().map(|name| format!("policy {name}"));
    let who = run.participant.clone().or(policy);
    let who = who.map(|who| format!("  {}", escape_control_characters(&who))).unwrap_or_default();
    let origin = origin
        .map(|origin| format!("  {}", escape_control_characters(&describe_origin(origin))))
        .unwrap_or_default();
    let served = if run.is_served { "  played by a program" } else { "" };
    let copy = run.copy_of.as_ref();
    let copy =
        copy.map(|text| format!("  a copy of run {}", escape_control_characters(text))).unwrap_or_default();
    format!(
        "{}  {}  {:<8}  {:<10}  day {:>3}/{}  {:>14}  seed {:<6} {}{who}{served}{origin}{copy}\n",
        run.id,
        run.played.get(..16).unwrap_or(&run.played).replace('T', " "),
        run.mode.map_or("", |mode| mode.id()),
        state,
        run.day,
        run.days,
        dollars(run.cash),
        run.seed,
        describe_scenario(run)
    )
}

/// Describes the scenario of a run, with the generation and the horizon rule if they are not those of scenario `default`.
fn describe_scenario(run: &RunSummary) -> String {
    let generation = (run.generation != Interface::Release1).then(|| run.generation.name());
    let rule = (run.horizon_rule != HorizonRule::Exact).then(|| run.horizon_rule.name());
    let added: Vec<&str> = generation.into_iter().chain(rule).collect();
    if added.is_empty() { run.scenario.clone() } else { format!("{} ({})", run.scenario, added.join(", ")) }
}
