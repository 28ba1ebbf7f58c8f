//! `novamind lab opponents`: what the strong policies make of the world of a run.

use clap::Args;

use crate::cli::{Context, Failure, print};
use crate::database::text::aligned;
use crate::lab::play_opponents;
use crate::notation::dollars;
use crate::report::opponents::{Opponent, Opponents};
use crate::session::find_run_to_read;

/// Options of `lab opponents`.
#[derive(Debug, Args)]
pub struct Options {
    /// Run, or `latest`: the newest; one that is over, or a debug run.
    #[arg(value_name = "RUN")]
    run: String,
    /// Print as JSON.
    #[arg(long)]
    json: bool,
}

/// Runs the command; nothing of the run is changed.
pub fn run(options: &Options, context: &Context) -> Result<(), Failure> {
    let folder = find_run_to_read(&context.runs()?, &options.run)?;
    context.check_look(&folder)?;
    let found = play_opponents(&folder, &context.configuration, &|| true);
    let found = found.map_err(|refusal| Failure::failed(refusal.message))?;
    let opponents = found.ok_or_else(|| Failure::failed("stopped"))?;
    if options.json {
        let text =
            serde_json::to_string_pretty(&opponents).map_err(|error| Failure::failed(error.to_string()))?;
        return print(&format!("{text}\n"));
    }
    print(&as_text(&opponents))
}

fn as_text(opponents: &Opponents) -> String {
    let row = |own: &Opponent| vec![own.policy.clone(), dollars(own.score()), own.in_words()];
    let rows: Vec<Vec<String>> = opponents.policies.iter().map(row).collect();
    let headers = ["policy", "score", "how it ended"].map(str::to_owned);
    format!("{}\n\n{}", opponents.in_words(), aligned(&headers, &rows))
}
