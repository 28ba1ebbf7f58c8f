//! The columns of `runs.csv`.

use super::{RunColumn, maybe, number, pairs, rounded, score};
use crate::report::logbook::Logbook;

fn scored<const DAYS: u32>(run: &Logbook) -> String {
    score(run, DAYS).map_or(0, |score| score.scored).to_string()
}

fn error<const DAYS: u32>(run: &Logbook) -> String {
    maybe(score(run, DAYS).map(|score| score.mean_error))
}

fn coverage<const DAYS: u32>(run: &Logbook) -> String {
    maybe(score(run, DAYS).map(|score| f64::from(score.covered) / f64::from(score.scored)))
}

const ERROR: &str = "their mean of |point - outcome| / |outcome|";
const COVERAGE: &str = "share of them whose interval held the outcome";

const fn column(
    name: &'static str,
    unit: &'static str,
    meaning: &'static str,
    cell: fn(&Logbook) -> String,
) -> RunColumn {
    RunColumn { name, unit, meaning, cell }
}

/// The columns, in their order.
pub const RUNS: &[RunColumn] = &[
    column("run", "name", "name of the run", |run| run.run.clone()),
    column("participant", "label", "who played, as the experimenter named them", |run| {
        run.participant.clone().unwrap_or_default()
    }),
    column("mode", "word", "baseline, sandbox, lesson or debug", |run| run.mode.id().to_owned()),
    column("scenario", "name", "scenario of the run", |run| run.scenario.clone()),
    column("seed", "number", "seed of all chance", |run| run.seed.to_string()),
    column("days", "days", "last day of the run as it was planned", |run| run.days.to_string()),
    column("start_cash", "dollars", "cash on day 0", |run| number(run.start_cash)),
    column("parent", "name", "run it branched from; empty unless it is a branch", |run| {
        run.parent.clone().unwrap_or_default()
    }),
    column(
        "earlier_runs",
        "count",
        "runs of the same seed and scenario that its folder of runs held before it",
        |run| run.earlier_runs.to_string(),
    ),
    column(
        "consent_at",
        "RFC 3339",
        "when the text for participants was agreed to; empty if none was asked for",
        |run| run.consent.as_ref().map(|consent| consent.at.clone()).unwrap_or_default(),
    ),
    column("consent_digest", "hash", "BLAKE3 hash of that text", |run| {
        run.consent.as_ref().map(|consent| consent.digest.clone()).unwrap_or_default()
    }),
    column("version", "version", "version of the program that recorded it", |run| run.version.clone()),
    column("created", "RFC 3339", "when it was created", |run| run.created.clone()),
    column("last_at", "RFC 3339", "when its last line was written", |run| run.last_at.clone()),
    column("ended_at", "RFC 3339", "when it ended; empty while it is unfinished", |run| {
        run.ended_at.clone().unwrap_or_default()
    }),
    column("ended", "word", "horizon, bankruptcy or abandoned; empty while it is unfinished", |run| {
        run.ended.map(|ended| ended.id().to_owned()).unwrap_or_default()
    }),
    column("day", "day", "last simulated day", |run| run.day.to_string()),
    column("cash", "dollars", "cash after that day", |run| number(run.cash)),
    column("score", "dollars", "cash after the last day, 0 after a bankruptcy, empty otherwise", |run| {
        maybe(run.score)
    }),
    column("survival_days", "days", "days the company has lived", |run| {
        run.measures.survival_days.to_string()
    }),
    column(
        "weeks",
        "count",
        "weeks that ran, a shortened last one included (debug runs: steps too)",
        |run| run.weeks.len().to_string(),
    ),
    column("calls", "count", "calls of tools that were accepted", |run| run.total.calls.to_string()),
    column("refused", "count", "calls of tools that were refused, weeks included", |run| {
        run.total.refused.to_string()
    }),
    column("undone", "count", "accepted calls that took back another", |run| run.total.undone.to_string()),
    column("queries", "count", "SQL queries", |run| run.total.queries.to_string()),
    column("queries_failed", "count", "queries that were refused or failed", |run| {
        run.total.queries_failed.to_string()
    }),
    column("views", "count", "views of screens (console only)", |run| run.total.views.to_string()),
    column("memos", "count", "changes of the notes", |run| run.total.memos.to_string()),
    column(
        "minutes_elapsed",
        "minutes",
        "from the first line to the last without the time the simulator took, breaks included",
        |run| rounded(run.total.elapsed_seconds / 60.0),
    ),
    column(
        "minutes_played",
        "minutes",
        "the same without breaks (more than ten minutes without a line)",
        |run| rounded(run.total.active_seconds / 60.0),
    ),
    column("breaks", "count", "breaks", |run| run.breaks.len().to_string()),
    column(
        "clock_set_back",
        "count",
        "times the clock went backwards between two lines; such a gap counts as no time",
        |run| run.clock_set_back.to_string(),
    ),
    column(
        "week_seconds_median",
        "seconds",
        "median over the weeks of the seconds a decision took, breaks left out",
        |run| run.median_week_seconds.map(rounded).unwrap_or_default(),
    ),
    column(
        "best_channel_share",
        "share",
        "share of ad spend on the channel that brought most leads per dollar, over the groups with two paid channels and three \
         leads or more on the best",
        |run| maybe(run.measures.channels.as_ref().and_then(|skill| skill.share)),
    ),
    column(
        "targeted_development_share",
        "share",
        "targeted share of development spend over the days that ran",
        |run| maybe(run.measures.targeted_development),
    ),
    column("forecasts_scored_7", "count", "forecasts 7 days ahead whose day has come", scored::<7>),
    column("forecast_error_7", "share", ERROR, error::<7>),
    column("forecast_coverage_7", "share", COVERAGE, coverage::<7>),
    column("forecasts_scored_28", "count", "forecasts 28 days ahead whose day has come", scored::<28>),
    column("forecast_error_28", "share", ERROR, error::<28>),
    column("forecast_coverage_28", "share", COVERAGE, coverage::<28>),
    column("forecasts_scored_84", "count", "forecasts 84 days ahead whose day has come", scored::<84>),
    column("forecast_error_84", "share", ERROR, error::<84>),
    column("forecast_coverage_84", "share", COVERAGE, coverage::<84>),
    column("forecasts_scored_182", "count", "forecasts 182 days ahead whose day has come", scored::<182>),
    column("forecast_error_182", "share", ERROR, error::<182>),
    column("forecast_coverage_182", "share", COVERAGE, coverage::<182>),
    column(
        "weeks_filled_naively",
        "count",
        "weeks in which at least one forecast was filled by the naive projection",
        |run| run.measures.filled_naively.0.to_string(),
    ),
    column(
        "acting_calls",
        "count",
        "accepted calls that did something; readings are not among them",
        |run| run.measures.tools.calls.to_string(),
    ),
    column("acting_calls_per_week", "per week", "the same for each week that ran", |run| {
        rounded(run.measures.tools.per_week)
    }),
    column("tools", "tool=count", "accepted calls by tool", |run| pairs(&run.total.tools)),
    column("screens", "screen=seconds", "time on each screen, breaks left out (console only)", |run| {
        pairs(&run.total.screens)
    }),
    column("rationale_words", "count", "words of all rationales", |run| run.wording.words.to_string()),
    column(
        "planning_words",
        "count",
        "words of planning among them: if, unless, until, otherwise, because, therefore, expect, plan, should, would, might, risk, assume, probably, likely, instead",
        |run| run.wording.planning.to_string(),
    ),
    column("planning_words_per_100", "per 100 words", "the same in a hundred words of rationale", |run| {
        run.wording.planning_per_hundred().map(rounded).unwrap_or_default()
    }),
    column("if_words", "count", "how often the rationales say \"if\"", |run| run.wording.ifs.to_string()),
    column("parameters_digest", "digest", "names the effective parameters", |run| {
        run.parameters_digest.clone()
    }),
    column("state_hash", "hash", "state after the last week", |run| {
        run.state_hash.clone().unwrap_or_default()
    }),
    column("last_seq", "number", "number of the last line of the trajectory", |run| run.last_seq.to_string()),
    column("last_hash", "hash", "its hash: names the whole trajectory", |run| run.last_hash.clone()),
    column("problem", "text", "why the run could not be read; everything but its name is empty then", |_| {
        String::new()
    }),
];
