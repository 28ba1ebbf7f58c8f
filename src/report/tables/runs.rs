//! The columns of `runs.csv`.

use super::{
    Column, RunColumn, flag, heading, in_console, maybe, number, pairs, rounded, score, screens, seen, tools,
};
use crate::logbook::Logbook;
use crate::measures::ChannelSkill;
use novamind_session::{ConsentGiven, ConsentMeans, StudyStamp, TimeSpent};

fn scored<const DAYS: u32>(run: &Logbook) -> String {
    score(&run.measures.forecasts, DAYS).map_or(0, |score| score.scored).to_string()
}

fn error<const DAYS: u32>(run: &Logbook) -> String {
    maybe(score(&run.measures.forecasts, DAYS).map(|score| score.mean_error))
}

fn coverage<const DAYS: u32>(run: &Logbook) -> String {
    maybe(
        score(&run.measures.forecasts, DAYS).map(|score| f64::from(score.covered) / f64::from(score.scored)),
    )
}

fn first_error<const DAYS: u32>(run: &Logbook) -> String {
    maybe(score(&run.measures.first_forecasts, DAYS).map(|score| score.mean_error))
}

/// Something of the study that a run belongs to; empty if to none.
fn of_study(run: &Logbook, part: fn(&StudyStamp) -> Option<String>) -> String {
    run.study.as_ref().and_then(part).unwrap_or_default()
}

/// How the text for participants was agreed to, where the program showed it.
fn on_screen(run: &Logbook) -> Option<ConsentGiven> {
    run.consent.as_ref().and_then(|consent| consent.given).filter(|given| given.means != ConsentMeans::Paper)
}

const FIRST_ERROR: &str =
    "mean of |point - outcome| / max(|outcome|, 1) of those filed before the first four weeks";
const ERROR: &str = "their mean of |point - outcome| / max(|outcome|, 1)";
const COVERAGE: &str = "share of them whose interval held the outcome";

const fn column(
    name: &'static str,
    unit: &'static str,
    meaning: &'static str,
    cell: fn(&Logbook) -> String,
) -> RunColumn {
    Column { heading: heading(name, unit, meaning), cell }
}

/// The columns, in their order.
pub const RUNS: &[RunColumn] = &[
    column("run", "name", "name of the run", |run| run.run.clone()),
    column("participant", "label", "who played, as the experimenter named them", |run| {
        run.participant.clone().unwrap_or_default()
    }),
    column(
        "study",
        "name",
        "study it belongs to; this and what follows is empty of a run that belongs to none",
        |run| of_study(run, |study| Some(study.name.clone())),
    ),
    column("study_digest", "hash", "BLAKE3 hash of its protocol", |run| {
        of_study(run, |study| Some(study.digest.clone()))
    }),
    column("condition", "text", "condition the person was assigned to", |run| {
        of_study(run, |study| study.condition.clone())
    }),
    column("assigned_order", "number", "place of the person in the assignment, from 1", |run| {
        of_study(run, |study| study.order.map(|order| order.to_string()))
    }),
    column("practice", "0 or 1", "1: the practice, not the session", |run| {
        of_study(run, |study| Some(flag(study.practice)))
    }),
    column("refused_labels", "count", "labels that were refused before this one was taken", |run| {
        of_study(run, |study| Some(study.refused_labels.to_string()))
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
        "earlier runs of the same person with this seed and scenario; in format 1 those of all people",
        |run| run.earlier_runs.to_string(),
    ),
    column(
        "consent_at",
        "RFC 3339",
        "when the text for participants was agreed to, with --consent when the run was started; empty if none was asked for",
        |run| run.consent.as_ref().map(|consent| consent.at.clone()).unwrap_or_default(),
    ),
    column("consent_digest", "hash", "BLAKE3 hash of that text", |run| {
        run.consent.as_ref().map(|consent| consent.digest.clone()).unwrap_or_default()
    }),
    column(
        "consent_read_ms",
        "milliseconds",
        "from showing that text to agreeing; this and what follows is empty if none was asked for or it was agreed to on paper",
        |run| on_screen(run).map(|given| given.read_ms.to_string()).unwrap_or_default(),
    ),
    column("consent_scrolled_to_end", "0 or 1", "1: its end was shown before it was agreed to", |run| {
        on_screen(run).map(|given| flag(given.scrolled_to_end)).unwrap_or_default()
    }),
    column("format", "number", "format of its trajectory", |run| run.format.to_string()),
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
    column("views", "count", "views of screens (console only)", |run| seen(run, run.total.views)),
    column("memos", "count", "changes of the notes", |run| run.total.memos.to_string()),
    column(
        "sittings",
        "count",
        "how often the program took up the run; 0 where lines do not tell (format 1, policies)",
        |run| run.sittings.opened.to_string(),
    ),
    column(
        "sittings_not_closed",
        "count",
        "of them, those that no line closes: killed, or still open",
        |run| run.sittings.not_closed.to_string(),
    ),
    column("machines", "count", "machines it was played on, as far as lines tell", |run| {
        run.sittings.machines.to_string()
    }),
    column(
        "elapsed_seconds",
        "seconds",
        "active, answering, idle and away together: from the first line to the last without the time the simulator took",
        |run| number(run.total.time.elapsed_seconds()),
    ),
    column("active_seconds", "seconds", "time played", |run| number(run.total.time.active_seconds())),
    column("answering_seconds", "seconds", "time with questions of the study on the screen", |run| {
        number(run.total.time.answering_seconds())
    }),
    column(
        "idle_seconds",
        "seconds",
        "time without a key, the program in front; format 1 does not tell it from the others",
        |run| number(run.total.time.idle_seconds()),
    ),
    column(
        "away_seconds",
        "seconds",
        "time in which the run was closed, suspended, in the background, or its clock stopped; in format 1 gaps of more than \
         ten minutes between two lines",
        |run| number(run.total.time.away_seconds()),
    ),
    column("paused_seconds", "seconds", "of it, time with the clock stopped", |run| {
        number(run.total.time.paused_seconds())
    }),
    column(
        "active_seconds_after_end",
        "seconds",
        "time played from the end to the last line of what was done after it, which is in none of the others; empty before the \
         end",
        |run| maybe(run.after_end.as_ref().map(TimeSpent::active_seconds)),
    ),
    column("clock_stopped", "count", "how often the person stopped the clock", |run| {
        run.sittings.clock_stopped.to_string()
    }),
    column("breaks", "count", "times of more than ten minutes in which nobody played", |run| {
        run.breaks.len().to_string()
    }),
    column(
        "clock_set_back",
        "count",
        "times the clock went backwards between two lines; such a gap counts as no time",
        |run| run.clock_set_back.to_string(),
    ),
    column(
        "week_seconds_median",
        "seconds",
        "median over the weeks of the active seconds before a week",
        |run| run.median_week_seconds.map(rounded).unwrap_or_default(),
    ),
    column("implausibly_fast_weeks", "count", "weeks decided in less than ten active seconds", |run| {
        run.fast_weeks.to_string()
    }),
    column("typed_characters", "count", "characters typed into texts (console only)", |run| {
        in_console(run, run.total.typed)
    }),
    column("deleted_characters", "count", "characters deleted from them (console only)", |run| {
        in_console(run, run.total.deleted)
    }),
    column(
        "pasted_characters",
        "count",
        "characters of them that came from the clipboard (console only)",
        |run| in_console(run, run.total.pasted),
    ),
    column(
        "truly_best_channel_share",
        "share",
        "share of ad spend on the channel of each group with the highest yield of all five when the run began, which no player \
         sees; by chance 0.2; empty before the end",
        |run| maybe(run.measures.truly_best.as_ref().map(|best| best.share)),
    ),
    column("truly_best_channel_share_by_group", "group=share", "the same by group", |run| {
        pairs(
            run.measures
                .truly_best
                .iter()
                .flat_map(|best| best.groups.iter().map(|(name, own)| (name, *own))),
        )
    }),
    column(
        "channels_tried",
        "per group",
        "mean over the groups that were advertised to of the channels paid for",
        |run| maybe(run.measures.channels.as_ref().map(ChannelSkill::channels_tried)),
    ),
    column(
        "best_tried_channel_share",
        "share",
        "share of ad spend on the channel that brought most leads per dollar among those that were paid for, over the groups \
         with two paid channels and three leads or more on the best; what a player could see",
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
    column("first_forecast_error_7", "share", FIRST_ERROR, first_error::<7>),
    column("first_forecast_error_28", "share", FIRST_ERROR, first_error::<28>),
    column("first_forecast_error_84", "share", FIRST_ERROR, first_error::<84>),
    column("first_forecast_error_182", "share", FIRST_ERROR, first_error::<182>),
    column(
        "weeks_filled_naively",
        "count",
        "weeks in which at least one forecast was filled by the naive projection",
        |run| run.measures.filled_naively.0.to_string(),
    ),
    column(
        "weeks_filed_at_limit",
        "count",
        "of them, weeks that a time limit filed; their rationale is nobody's and counts no words",
        |run| run.weeks.iter().filter(|week| week.filed_at_limit).count().to_string(),
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
    column("tools_used", "count", "tools among them", |run| run.measures.tools.tools.len().to_string()),
    column(
        "tool_evenness",
        "share",
        "how evenly they are spread over those tools: entropy of their shares over its largest value; empty below two tools",
        |run| maybe(run.measures.tools.evenness),
    ),
    column("tools", "tool=count", "accepted calls by tool, readings among them", |run| tools(&run.total)),
    column("screens", "screen=seconds", "active time on each screen (console only)", |run| {
        screens(&run.total)
    }),
    column("selects", "count", "objects that were opened: groups, threads, tools, posts, studies", |run| {
        run.total.selects.to_string()
    }),
    column("dialogs_confirmed", "count", "dialogs whose question was confirmed (console only)", |run| {
        in_console(run, run.total.dialogs_confirmed)
    }),
    column("dialogs_cancelled", "count", "dialogs that were left (console only)", |run| {
        in_console(run, run.total.dialogs_cancelled)
    }),
    column("helps", "count", "terms that were explained", |run| run.total.helps.to_string()),
    column("drafts_left", "count", "texts that were edited and left behind (console only)", |run| {
        in_console(run, run.total.drafts_left)
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
    column("note_versions", "count", "how often the notes were kept before the end", |run| {
        run.notes.versions.to_string()
    }),
    column(
        "note_words",
        "count",
        "words of the notes that were kept last; this and what follows is empty where lines do not hold their text",
        |run| run.notes.wording.map(|own| own.words.to_string()).unwrap_or_default(),
    ),
    column("note_planning_words", "count", "words of planning among them", |run| {
        run.notes.wording.map(|own| own.planning.to_string()).unwrap_or_default()
    }),
    column("note_if_words", "count", "how often they say \"if\"", |run| {
        run.notes.wording.map(|own| own.ifs.to_string()).unwrap_or_default()
    }),
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
