//! `novamind lab opponents`: plays the strong policies with the seed and parameters of a run.

use clap::Args;
use serde_json::json;

use crate::cli::{Context, Failure, print};
use crate::database::text::align_columns;
use crate::formatting::dollars;
use crate::lab::play_opponents;
use crate::record::folder::runs::find_run_to_read;
use crate::record::trajectory::record::RunEndReason;
use crate::report::opponents::{OpponentResult, OpponentResults};
use crate::session::Session;

#[derive(Debug, Args)]
pub struct Options {
    /// ID of the run, or `latest` for the newest run; must be a debug run or a finished run
    #[arg(value_name = "RUN")]
    run: String,
    /// Print as JSON
    #[arg(long)]
    json: bool,
}

/// Prints the scores of the policies, compared with the score of the run. Does not modify the run.
pub fn run(options: &Options, context: &Context) -> Result<(), Failure> {
    let folder = find_run_to_read(&context.runs_folder()?, &options.run)?;
    context.check_view_allowed(&folder)?;
    let found = play_opponents(&folder, &context.configuration, &|| true);
    let found = found.map_err(|rejection| Failure::failed(rejection.message))?;
    let opponents = found.ok_or_else(|| Failure::failed("stopped"))?;
    let run = Session::open_to_read(&folder, false)?;
    if options.json {
        let manifest = run.manifest();
        let object = json!({
            "run": { "id": manifest.id, "seed": manifest.seed, "scenario": manifest.scenario, "score": run.score() },
            "day": opponents.day,
            "policies": opponents.policies,
        });
        return print(&format!("{object:#}\n"));
    }
    print(&to_text(&opponents, &run))
}

/// Formats the scores of the policies and of the run, highest first.
fn to_text(opponents: &OpponentResults, run: &Session) -> String {
    let policy = |opponent_result: &OpponentResult| {
        (opponent_result.score(), opponent_result.policy.clone(), describe_opponent_end(opponent_result))
    };
    let mut places: Vec<(f64, String, String)> = opponents.policies.iter().map(policy).collect();
    let (name, day) = (format!("this run, {}", run.manifest().id), run.day());
    // Cash is a score only after the last day.
    let not_over = match run.score() {
        Some(score) => {
            places.push((score, name, describe_end(run.ended() == Some(RunEndReason::Bankruptcy), day)));
            String::new()
        }
        None => {
            format!("\n{name}: {} on day {day}, no score yet\n", dollars(run.company().observe().cash))
        }
    };
    places.sort_by(|one, other| other.0.total_cmp(&one.0));
    let row =
        |(score, name, ended): &(f64, String, String)| vec![name.clone(), dollars(*score), ended.clone()];
    let rows: Vec<Vec<String>> = places.iter().map(row).collect();
    let headers = ["policy", "score", "end of the run"].map(str::to_owned);
    format!("{}\n\n{}{not_over}", opponents.describe(), align_columns(&headers, &rows))
}

fn describe_opponent_end(opponent_result: &OpponentResult) -> String {
    match &opponent_result.stopped {
        Some(why) => format!("stopped on day {}: {why}", opponent_result.day),
        None => describe_end(opponent_result.is_bankrupt, opponent_result.day),
    }
}

fn describe_end(is_bankrupt: bool, day: u32) -> String {
    let end = if is_bankrupt { "bankrupt" } else { "alive" };
    format!("{end} on day {day}")
}
