//! `novamind runs`: list, show, end, delete.

use clap::{Args, Subcommand};

use super::{Context, Failure, print};
use crate::notation::dollars;
use crate::session::{RunSummary, delete_run, end_run, find_run, find_run_to_read, list_runs, rescue};

/// Options of `runs`.
#[derive(Debug, Args)]
pub struct Options {
    #[command(subcommand)]
    command: Option<Choice>,
    /// As JSON.
    #[arg(long, global = true)]
    json: bool,
}

#[derive(Debug, Subcommand)]
enum Choice {
    /// Show what a run is and how far it has come.
    Show {
        /// Run, or `latest`: the newest.
        run: String,
    },
    /// Print the folder of a run.
    Path {
        /// Run, or `latest`: the newest.
        run: String,
    },
    /// End an unfinished run for good.
    End {
        /// Run, or `latest`: the newest unfinished one.
        run: String,
    },
    /// Open the good beginning of a damaged run as a branch; the run itself is not touched.
    Rescue {
        /// Run.
        run: String,
    },
    /// Delete a run with all its files.
    Delete {
        /// Run.
        run: String,
        /// Do it without asking.
        #[arg(long)]
        yes: bool,
    },
}

/// Runs the command.
pub fn run(options: &Options, context: &Context) -> Result<(), Failure> {
    let runs = context.runs()?;
    match &options.command {
        None => {
            let list = list_runs(&runs)?;
            if options.json {
                return print(&(serde_json::to_string_pretty(&list).unwrap_or_default() + "\n"));
            }
            if list.is_empty() {
                return print(&format!(
                    "There are no runs in {} yet; `novamind` starts one.\n",
                    runs.display()
                ));
            }
            print(&list.iter().map(line).collect::<String>())
        }
        Some(Choice::Show { run }) => {
            let folder = find_run_to_read(&runs, run)?;
            let text = std::fs::read_to_string(folder.join("run.toml"))
                .map_err(|error| Failure::unreadable(format!("{}: {error}", folder.display())))?;
            let id = folder.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
            let summary = list_runs(&runs)?.into_iter().find(|summary| summary.id == id);
            if options.json {
                return print(&(serde_json::to_string_pretty(&summary).unwrap_or_default() + "\n"));
            }
            print(&format!("{}\n{text}", summary.as_ref().map(line).unwrap_or_default()))
        }
        Some(Choice::Path { run }) => print(&format!("{}\n", find_run_to_read(&runs, run)?.display())),
        Some(Choice::End { run }) => {
            end_run(&runs, run)?;
            print(&format!("run {run} is ended; it can still be read\n"))
        }
        Some(Choice::Rescue { run }) => {
            let found = rescue(&find_run_to_read(&runs, run)?)?;
            print(&format!(
                "run {} holds lines 1 to {} of run {run} and stands at day {}, mode {}\n\
                 what was wrong: {}\nrun {run} is as it was; `novamind play --run {}` goes on\n",
                found.run, found.lines, found.day, found.mode, found.problem, found.run
            ))
        }
        Some(Choice::Delete { run, yes }) => {
            if !yes {
                let folder = find_run(&runs, run)?;
                let message = format!("this deletes {} for good; add --yes to do it", folder.display());
                return Err(Failure::usage(message));
            }
            delete_run(&runs, run)?;
            print(&format!("run {run} is deleted\n"))
        }
    }
}

fn line(run: &RunSummary) -> String {
    if let Some(problem) = &run.problem {
        return format!("{}  cannot be read: {problem}\n", run.id);
    }
    let state = run.ended.map_or("open", |ended| ended.id());
    let who = run.participant.as_deref().map(|who| format!("  {who}")).unwrap_or_default();
    format!(
        "{}  {}  {:<8}  {:<10}  day {:>3}/{}  {:>14}  seed {:<6} {}{who}\n",
        run.id,
        run.played.get(..16).unwrap_or(&run.played).replace('T', " "),
        run.mode.map_or("", |mode| mode.id()),
        state,
        run.day,
        run.days,
        dollars(run.cash),
        run.seed,
        run.scenario
    )
}
