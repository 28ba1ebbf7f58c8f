//! `novamind runs import --transcript`: plays an external transcript in a new run.

use std::path::Path;

use serde_json::json;

use crate::cli::new_run::NewRunOptions;
use crate::cli::run::progress_bar;
use crate::cli::{Context, Failure, print};
use crate::formatting::{dollars_and_cents, escape_control_characters};
use crate::record::files::read_regular_file;
use crate::record::folder::runs::delete_run;
use crate::record::mode::Mode;
use crate::report::pluralize;
use crate::server::{ForeignTranscript, LineRemark, PlayedHistory, ReleaseHistory};
use crate::session::{NewRun, Session};

/// Maximum size of a transcript in bytes; a transcript of 500 days has a few megabytes.
const MAX_TRANSCRIPT_BYTES: u64 = 512 << 20;
/// Maximum number of listed results that differ from the file.
const MAX_LISTED_MISMATCHES: usize = 10;
const HISTORY_SCENARIO: &str = "release-2";
const HISTORY_PLAYER: &str = "imported history";
const DIFFERENT_STREAMS: &str = "The random draws differ from those of the released simulator, so leads, customers and cash differ even \
     where every request has the same outcome.";

/// Plays a transcript in a new run. Settings that the options leave out are read from the transcript.
pub fn import_transcript(
    file: &Path,
    made_of: &NewRunOptions,
    json: bool,
    context: &Context,
) -> Result<(), Failure> {
    let named = |why: String| Failure::failed(format!("{}: {why}", file.display()));
    let length = std::fs::metadata(file).map_err(|error| named(error.to_string()))?.len();
    if length > MAX_TRANSCRIPT_BYTES {
        return Err(named(format!(
            "the file has {length} bytes; a transcript has at most {MAX_TRANSCRIPT_BYTES}"
        )));
    }
    let bytes = read_regular_file(file).map_err(|error| named(error.to_string()))?;
    if ReleaseHistory::is_history(&bytes) {
        let history = ReleaseHistory::parse(&bytes)
            .map_err(|problem| named(format!("{problem}. Nothing was imported")))?;
        return import_history(&history, made_of, json, context);
    }
    let read = ForeignTranscript::parse(&bytes).map_err(named)?;
    let run_options = made_of.with_participant(read.player.as_deref().unwrap_or("transcript"));
    let new_run = run_options.new_run(Mode::Sandbox, context)?;
    if new_run.mode == Mode::Baseline {
        return Err(Failure::usage(
            "an imported transcript is not a baseline run, because it was not played here; leave out --mode. Nothing \
             was imported",
        ));
    }
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

/// Plays the entries of a history of release 2 in a new sandbox run and prints a summary.
fn import_history(
    history: &ReleaseHistory,
    made_of: &NewRunOptions,
    json: bool,
    context: &Context,
) -> Result<(), Failure> {
    let mut new = made_of.with_participant(HISTORY_PLAYER).new_run(Mode::Sandbox, context)?;
    if new.mode != Mode::Sandbox {
        return Err(Failure::usage(
            "an imported history is a sandbox run; leave out --mode. Nothing was imported",
        ));
    }
    if new.seed.is_none() {
        return Err(Failure::usage(
            "the history has no seed: give the seed with --seed. Nothing was imported",
        ));
    }
    if !made_of.has_scenario() {
        new.scenario = HISTORY_SCENARIO.to_owned();
    }
    new.sync_calls = false;
    let runs = context.runs_folder()?;
    let mut session = Session::create(new, &context.configuration)?;
    let bar = progress_bar(history.entries.len() as u64, "entries");
    let played = history.play(&mut session, &mut |made| bar.set_position(made as u64));
    bar.finish_and_clear();
    let run = session.manifest().id.clone();
    if let Err(error) = session.save() {
        drop(session);
        delete_run(&runs, &run)?;
        return Err(error.into());
    }
    match json {
        true => print(&history_as_json(&played, &session)),
        false => print(&describe_history(&played, &session)),
    }
}

fn history_as_json(played: &PlayedHistory, session: &Session) -> String {
    let mut summary = json!(played);
    summary["run"] = json!(session.manifest().id);
    summary["day"] = json!(session.day());
    summary["cash"] = json!(session.company().observe().cash);
    summary["state_hash"] = json!(session.state_hash().0);
    summary["remark"] = json!(DIFFERENT_STREAMS);
    format!("{summary}\n")
}

fn describe_history(played: &PlayedHistory, session: &Session) -> String {
    let PlayedHistory { entries, executed, skipped, after_end, .. } = played;
    let list = |title: &str, remarks: &[LineRemark]| {
        let shown = remarks.iter().take(MAX_LISTED_MISMATCHES);
        let lines: String = shown
            .map(|remark| format!("  line {}: {}\n", remark.line, escape_control_characters(&remark.reason)))
            .collect();
        let left = remarks.len().saturating_sub(MAX_LISTED_MISMATCHES);
        let rest = if left > 0 { format!("  and {left} more\n") } else { String::new() };
        format!("{title}: {}\n{lines}{rest}", remarks.len())
    };
    let head = format!(
        "run {}: imported from a history of release 2, day {}, cash {}, state {}\n\
         entries: {entries}\nexecuted: {executed}\nafter the end of the run, not executed: {after_end}\n",
        session.manifest().id,
        session.day(),
        dollars_and_cents(session.company().observe().cash),
        session.state_hash().0,
    );
    head + &list("not executed for other reasons", skipped)
        + &list("rejected here, successful in the released simulator", &played.rejected_here)
        + &list("successful here, rejected in the released simulator", &played.accepted_here)
        + &list("followed by another day than in the released simulator", &played.different_days)
        + DIFFERENT_STREAMS
        + "\n"
}
