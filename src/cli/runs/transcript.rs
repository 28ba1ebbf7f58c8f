//! `novamind runs import --transcript`: plays an external transcript in a new run.

use std::path::Path;

use crate::cli::new_run::NewRunOptions;
use crate::cli::run::progress_bar;
use crate::cli::{Context, Failure, print};
use crate::record::mode::Mode;
use crate::report::pluralize;
use crate::server::ForeignTranscript;
use crate::session::{NewRun, Session};

/// Maximum size of a transcript in bytes; a transcript of 500 days has a few megabytes.
const MAX_TRANSCRIPT_BYTES: u64 = 512 << 20;
/// Maximum number of listed tool results that differ from the transcript.
const MAX_LISTED_MISMATCHES: usize = 10;

/// Plays a transcript in a new run. Settings that the options leave out are read from the transcript.
pub fn import_transcript(file: &Path, made_of: &NewRunOptions, context: &Context) -> Result<(), Failure> {
    let named = |why: String| Failure::failed(format!("{}: {why}", file.display()));
    let length = std::fs::metadata(file).map_err(|error| named(error.to_string()))?.len();
    if length > MAX_TRANSCRIPT_BYTES {
        return Err(named(format!(
            "the file has {length} bytes; a transcript has at most {MAX_TRANSCRIPT_BYTES}"
        )));
    }
    let bytes = std::fs::read(file).map_err(|error| named(error.to_string()))?;
    let read = ForeignTranscript::parse(&bytes).map_err(named)?;
    let run_options = made_of.with_participant(read.player.as_deref().unwrap_or("transcript"));
    let new_run = run_options.new_run(Mode::Sandbox, context)?;
    let scenario = read.scenario.clone().filter(|_| !made_of.has_scenario());
    let new = NewRun {
        seed: new_run.seed.or(read.seed),
        days: new_run.days.or(read.days),
        cash: new_run.cash.or(read.cash),
        scenario: scenario.unwrap_or(new_run.scenario.clone()),
        sync_calls: false,
        ..new_run
    };
    if new.seed.is_none() {
        return Err(Failure::usage("the transcript has no seed: give the seed with --seed"));
    }
    let mut session = Session::create(new, &context.configuration)?;
    let bar = progress_bar(read.calls.len() as u64, "calls");
    let played = read.play(&mut session, &mut |made| bar.set_position(made as u64));
    bar.finish_and_clear();
    session.save()?;
    let (run, day, hash) = (session.manifest().id.clone(), session.day(), session.state_hash().0);
    print(&format!("run {run}: {} calls, day {day}, state {hash}\n", played.call_count))?;
    for (place, tool, text) in played.mismatches.iter().take(MAX_LISTED_MISMATCHES) {
        print(&format!("step {place}: the answer to {tool} differs from the transcript: {text}\n"))?;
    }
    if played.not_run > 0 {
        let scripts = pluralize(played.not_run as u32, "script");
        print(&format!("{scripts} in Python not run: scripts of a transcript are never executed\n"))?;
    }
    let ends_otherwise = read.state_hash.as_ref().is_some_and(|recorded_hash| *recorded_hash != hash);
    match played.mismatches.len() as u32 {
        0 if ends_otherwise => Err(Failure::failed(
            "every answer agrees with the transcript, but the final state differs. The transcript is from another program version or other parameters. The run is kept",
        )),
        0 => Ok(()),
        calls => Err(Failure::failed(format!(
            "{} with an answer that differs from the transcript{}; the run is kept",
            pluralize(calls, "call"),
            if ends_otherwise { ", and the final state differs" } else { "" }
        ))),
    }
}
