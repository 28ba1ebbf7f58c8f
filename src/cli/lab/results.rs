//! `novamind lab table`: the results table of the paper for your runs.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use super::output::OutputOptions;
use crate::cli::run::progress_bar;
use crate::cli::{Context, Failure};
use crate::lab::Policy;
use crate::lab::results::{FinishedRun, IDLE_POLICY, ResultsGrouping, ResultsTable, play_idle_company};
use crate::record::error::RunError;
use crate::record::folder::configuration::Configuration;
use crate::record::folder::runs::{RunSummary, all_run_folders, list_runs, run_folder};
use crate::record::trajectory::Trajectory;
use crate::record::trajectory::record::RunEndReason;
use crate::report::ranking_eligibility::{RankingCriteria, RankingObstacle};
use crate::session::Session;
use crate::world::params::Interface;

#[derive(Debug, Args)]
pub struct Options {
    /// Group runs by participant or by policy
    #[arg(long, value_enum, default_value = "participant")]
    by: GroupBy,
    #[command(flatten)]
    output: OutputOptions,
}

/// The criterion by which runs are grouped.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum GroupBy {
    /// Group by participant; runs of a policy are grouped under the name of the policy
    Participant,
    /// Group by policy; runs that people played are left out
    Policy,
}

/// Prints the results table. Does not modify the runs.
pub fn run(options: &Options, context: &Context) -> Result<(), Failure> {
    let runs = context.runs_folder()?;
    // If a participant is given, the table contains only runs in the participant's folder.
    let folders = match context.participant {
        Some(_) => vec![runs],
        None => all_run_folders(&runs),
    };
    let finished = finished_runs(&folders)?;
    let mut left_out: Vec<Vec<RankingObstacle>> = Vec::new();
    let mut comparable = Vec::new();
    for (folder, summary) in &finished {
        let obstacles = RankingCriteria::from_summary(summary).obstacles();
        if is_listed(&obstacles) { comparable.push((folder, summary)) } else { left_out.push(obstacles) }
    }
    let progress = progress_bar(comparable.len() as u64 + 1, "runs");
    let (mut results, mut closed, mut unreadable) = (Vec::new(), 0, Vec::new());
    for (folder, summary) in comparable {
        match context.check_view_allowed(folder) {
            // A damaged run is reported below the table of the other runs.
            Ok(()) => match read_result(folder) {
                Ok(None) => {}
                Ok(Some(result)) => {
                    // The summary names the policy of the last weeks only. A person may have played the weeks
                    // before them.
                    let run_summary = RunSummary { policy: result.policy.clone(), ..summary.clone() };
                    let obstacles = RankingCriteria::from_summary(&run_summary).obstacles();
                    if is_listed(&obstacles) { results.push(result) } else { left_out.push(obstacles) }
                }
                Err(problem) => unreadable.push(problem.to_string()),
            },
            Err(_) => closed += 1,
        }
        progress.inc(1);
    }
    let bundled = Configuration::bundled();
    let policy = Policy::find(IDLE_POLICY, &bundled)?;
    let mut idle = vec![play_idle_company(&policy, Interface::Release1, &bundled)?];
    if results.iter().any(|run| run.generation == Interface::Release2) {
        idle.push(play_idle_company(&policy, Interface::Release2, &bundled)?);
    }
    progress.finish_and_clear();
    let by = match options.by {
        GroupBy::Participant => ResultsGrouping::Participant,
        GroupBy::Policy => ResultsGrouping::Policy,
    };
    let mut exhibit = ResultsTable::new(&results, &left_out, &idle, by).to_lab_report();
    if closed > 0 {
        exhibit.notes.push(format!("Runs left out because their study hides results: {closed}."));
    }
    exhibit
        .notes
        .extend(unreadable.iter().map(|why| format!("Run left out because it cannot be read: {why}.")));
    options.output.show(&exhibit)
}

/// Returns whether a run is listed. A listed run is comparable at least with the runs of its generation.
fn is_listed(obstacles: &[RankingObstacle]) -> bool {
    obstacles.iter().all(|obstacle| matches!(obstacle, RankingObstacle::Generation(_)))
}

/// Returns the finished runs in the folders.
fn finished_runs(folders: &[PathBuf]) -> Result<Vec<(PathBuf, RunSummary)>, Failure> {
    let mut finished = Vec::new();
    for folder in folders {
        // Copies of a run are omitted.
        let is_over = |run: &RunSummary| {
            run.problem.is_none()
                && run.copy_of.is_none()
                && matches!(
                    run.ended,
                    Some(RunEndReason::Horizon | RunEndReason::Bankruptcy | RunEndReason::Lesson)
                )
        };
        let finished_here = list_runs(folder)?.into_iter().filter(is_over);
        finished.extend(finished_here.map(|run| (run_folder(folder, &run.id), run)));
    }
    Ok(finished)
}

fn read_result(folder: &Path) -> Result<Option<FinishedRun>, RunError> {
    let session = Session::open_to_read(folder, false)?;
    let trajectory = Trajectory::read(&folder.join("trajectory.jsonl"))?;
    Ok(FinishedRun::from_session(&session, &trajectory.lines))
}
