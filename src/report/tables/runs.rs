//! The columns of `runs.csv`.

use super::column::{Column, columns};
use super::{in_console, pairs, rounded, score, screens, seen, tools};
use crate::logbook::Logbook;
use crate::measures::ChannelSkill;
use novamind_record::consent::{ConsentGiven, ConsentMeans};
use novamind_session::TimeSpent;

fn scored(run: &Logbook, horizon_days: u32) -> u32 {
    score(&run.measures.forecasts, horizon_days).map_or(0, |score| score.scored)
}

fn error(run: &Logbook, horizon_days: u32) -> Option<f64> {
    score(&run.measures.forecasts, horizon_days).map(|score| score.mean_error)
}

fn coverage(run: &Logbook, horizon_days: u32) -> Option<f64> {
    score(&run.measures.forecasts, horizon_days)
        .map(|score| f64::from(score.covered) / f64::from(score.scored))
}

fn first_error(run: &Logbook, horizon_days: u32) -> Option<f64> {
    score(&run.measures.first_forecasts, horizon_days).map(|score| score.mean_error)
}

/// How the text for participants was agreed to, where the program showed it.
fn on_screen(run: &Logbook) -> Option<ConsentGiven> {
    run.consent.as_ref().and_then(|consent| consent.given).filter(|given| given.means != ConsentMeans::Paper)
}

const FIRST_ERROR: &str =
    "mean of |point - outcome| / max(|outcome|, 1) of those filed before the first four weeks";
const ERROR: &str = "their mean of |point - outcome| / max(|outcome|, 1)";
const COVERAGE: &str = "share of them whose interval held the outcome";

/// The columns, in their order.
pub(super) fn columns() -> Vec<Column<Logbook>> {
    columns! { run: Logbook;
        "run", "name", "name of the run" => run.run;
        "participant", "label", "who played, as the experimenter named them" => run.participant;
        "study", "name", "study it belongs to; this and what follows is empty of a run that belongs to none"
            => run.study.as_ref().map(|study| &study.name);
        "study_digest", "hash", "BLAKE3 hash of its protocol" => run.study.as_ref().map(|study| &study.digest);
        "condition", "text", "condition the person was assigned to"
            => run.study.as_ref().and_then(|study| study.condition.as_ref());
        "assigned_order", "number", "place of the person in the assignment, from 1"
            => run.study.as_ref().and_then(|study| study.order);
        "practice", "0 or 1", "1: the practice, not the session" => run.study.as_ref().map(|study| study.practice);
        "refused_labels", "count", "labels that were refused before this one was taken"
            => run.study.as_ref().map(|study| study.refused_labels);
        "mode", "word", "baseline, sandbox, lesson or debug" => run.mode.id();
        "scenario", "name", "scenario of the run" => run.scenario;
        "seed", "number", "seed of all chance" => run.seed;
        "days", "days", "last day of the run as it was planned" => run.days;
        "start_cash", "dollars", "cash on day 0" => run.start_cash;
        "parent", "name", "run it branched from; empty unless it is a branch" => run.parent;
        "earlier_runs", "count", "earlier runs of the same person with this seed and scenario; in format 1 those of all people"
            => run.earlier_runs;
        "consent_at", "RFC 3339", "when the text for participants was agreed to, with --consent when the run was started; \
         empty if none was asked for" => run.consent.as_ref().map(|consent| &consent.at);
        "consent_digest", "hash", "BLAKE3 hash of that text" => run.consent.as_ref().map(|consent| &consent.digest);
        "consent_read_ms", "milliseconds", "from showing that text to agreeing; this and what follows is empty if none was \
         asked for or it was agreed to on paper" => on_screen(run).map(|given| given.read_ms);
        "consent_scrolled_to_end", "0 or 1", "1: its end was shown before it was agreed to"
            => on_screen(run).map(|given| given.scrolled_to_end);
        "format", "number", "format of its trajectory" => run.format;
        "version", "version", "version of the program that recorded it" => run.version;
        "created", "RFC 3339", "when it was created" => run.created;
        "last_at", "RFC 3339", "when its last line was written" => run.last_at;
        "ended_at", "RFC 3339", "when it ended; empty while it is unfinished" => run.ended_at;
        "ended", "word", "horizon, bankruptcy or abandoned; empty while it is unfinished" => run.ended.map(|ended| ended.id());
        "day", "day", "last simulated day" => run.day;
        "cash", "dollars", "cash after that day" => run.cash;
        "score", "dollars", "cash after the last day, 0 after a bankruptcy, empty otherwise" => run.score;
        "survival_days", "days", "days the company has lived" => run.measures.survival_days;
        "weeks", "count", "weeks that ran, a shortened last one included (debug runs: steps too)" => run.weeks.len();
        "calls", "count", "calls of tools that were accepted" => run.total.calls;
        "refused", "count", "calls of tools that were refused, weeks included" => run.total.refused;
        "undone", "count", "accepted calls that took back another" => run.total.undone;
        "queries", "count", "SQL queries" => run.total.queries;
        "queries_failed", "count", "queries that were refused or failed" => run.total.queries_failed;
        "views", "count", "views of screens (console only)" => seen(run, run.total.views);
        "memos", "count", "changes of the notes" => run.total.memos;
        "sittings", "count", "how often the program took up the run; 0 where lines do not tell (format 1, policies)"
            => run.sittings.opened;
        "sittings_not_closed", "count", "of them, those that no line closes: killed, or still open" => run.sittings.not_closed;
        "machines", "count", "machines it was played on, as far as lines tell" => run.sittings.machines;
        "elapsed_seconds", "seconds", "active, answering, idle and away together: from the first line to the last without the \
         time the simulator took" => run.total.time.elapsed_seconds();
        "active_seconds", "seconds", "time played" => run.total.time.active_seconds();
        "answering_seconds", "seconds", "time with questions of the study on the screen" => run.total.time.answering_seconds();
        "idle_seconds", "seconds", "time without a key, the program in front; format 1 does not tell it from the others"
            => run.total.time.idle_seconds();
        "away_seconds", "seconds", "time in which the run was closed, suspended, in the background, or its clock stopped; in \
         format 1 gaps of more than ten minutes between two lines" => run.total.time.away_seconds();
        "paused_seconds", "seconds", "of it, time with the clock stopped" => run.total.time.paused_seconds();
        "active_seconds_after_end", "seconds", "time played from the end to the last line of what was done after it, which is \
         in none of the others; empty before the end" => run.after_end.as_ref().map(TimeSpent::active_seconds);
        "clock_stopped", "count", "how often the person stopped the clock" => run.sittings.clock_stopped;
        "breaks", "count", "times of more than ten minutes in which nobody played" => run.breaks.len();
        "clock_set_back", "count", "times the clock went backwards between two lines; such a gap counts as no time"
            => run.clock_set_back;
        "week_seconds_median", "seconds", "median over the weeks of the active seconds before a week"
            => run.median_week_seconds.map(rounded);
        "implausibly_fast_weeks", "count", "weeks decided in less than ten active seconds" => run.fast_weeks;
        "typed_characters", "count", "characters typed into texts (console only)" => in_console(run, run.total.typed);
        "deleted_characters", "count", "characters deleted from them (console only)" => in_console(run, run.total.deleted);
        "pasted_characters", "count", "characters of them that came from the clipboard (console only)"
            => in_console(run, run.total.pasted);
        "truly_best_channel_share", "share", "share of ad spend on the channel of each group with the highest yield of all \
         five when the run began, which no player sees; by chance 0.2; empty before the end"
            => run.measures.truly_best.as_ref().map(|best| best.share);
        "truly_best_channel_share_by_group", "group=share", "the same by group"
            => pairs(run.measures.truly_best.iter().flat_map(|best| best.groups.iter().map(|(name, own)| (name, *own))));
        "channels_tried", "per group", "mean over the groups that were advertised to of the channels paid for"
            => run.measures.channels.as_ref().map(ChannelSkill::channels_tried);
        "best_tried_channel_share", "share", "share of ad spend on the channel that brought most leads per dollar among those \
         that were paid for, over the groups with two paid channels and three leads or more on the best; what a player could \
         see" => run.measures.channels.as_ref().and_then(|skill| skill.share);
        "targeted_development_share", "share", "targeted share of development spend over the days that ran"
            => run.measures.targeted_development;
        "forecasts_scored_7", "count", "forecasts 7 days ahead whose day has come" => scored(run, 7);
        "forecast_error_7", "share", ERROR => error(run, 7);
        "forecast_coverage_7", "share", COVERAGE => coverage(run, 7);
        "forecasts_scored_28", "count", "forecasts 28 days ahead whose day has come" => scored(run, 28);
        "forecast_error_28", "share", ERROR => error(run, 28);
        "forecast_coverage_28", "share", COVERAGE => coverage(run, 28);
        "forecasts_scored_84", "count", "forecasts 84 days ahead whose day has come" => scored(run, 84);
        "forecast_error_84", "share", ERROR => error(run, 84);
        "forecast_coverage_84", "share", COVERAGE => coverage(run, 84);
        "forecasts_scored_182", "count", "forecasts 182 days ahead whose day has come" => scored(run, 182);
        "forecast_error_182", "share", ERROR => error(run, 182);
        "forecast_coverage_182", "share", COVERAGE => coverage(run, 182);
        "first_forecast_error_7", "share", FIRST_ERROR => first_error(run, 7);
        "first_forecast_error_28", "share", FIRST_ERROR => first_error(run, 28);
        "first_forecast_error_84", "share", FIRST_ERROR => first_error(run, 84);
        "first_forecast_error_182", "share", FIRST_ERROR => first_error(run, 182);
        "weeks_filled_naively", "count", "weeks in which at least one forecast was filled by the naive projection"
            => run.measures.filled_naively.0;
        "weeks_filed_at_limit", "count", "of them, weeks that a time limit filed; their rationale is nobody's and counts no \
         words" => run.weeks.iter().filter(|week| week.filed_at_limit).count();
        "acting_calls", "count", "accepted calls that did something; readings are not among them" => run.measures.tools.calls;
        "acting_calls_per_week", "per week", "the same for each week that ran" => rounded(run.measures.tools.per_week);
        "tools_used", "count", "tools among them" => run.measures.tools.tools.len();
        "tool_evenness", "share", "how evenly they are spread over those tools: entropy of their shares over its largest \
         value; empty below two tools" => run.measures.tools.evenness;
        "tools", "tool=count", "accepted calls by tool, readings among them" => tools(&run.total);
        "screens", "screen=seconds", "active time on each screen (console only)" => screens(&run.total);
        "selects", "count", "objects that were opened: groups, threads, tools, posts, studies" => run.total.selects;
        "dialogs_confirmed", "count", "dialogs whose question was confirmed (console only)"
            => in_console(run, run.total.dialogs_confirmed);
        "dialogs_cancelled", "count", "dialogs that were left (console only)" => in_console(run, run.total.dialogs_cancelled);
        "helps", "count", "terms that were explained" => run.total.helps;
        "drafts_left", "count", "texts that were edited and left behind (console only)"
            => in_console(run, run.total.drafts_left);
        "rationale_words", "count", "words of all rationales" => run.wording.words;
        "planning_words", "count", "words of planning among them: if, unless, until, otherwise, because, therefore, expect, \
         plan, should, would, might, risk, assume, probably, likely, instead" => run.wording.planning;
        "planning_words_per_100", "per 100 words", "the same in a hundred words of rationale"
            => run.wording.planning_per_hundred().map(rounded);
        "if_words", "count", "how often the rationales say \"if\"" => run.wording.ifs;
        "note_versions", "count", "how often the notes were kept before the end" => run.notes.versions;
        "note_words", "count", "words of the notes that were kept last; this and what follows is empty where lines do not hold \
         their text" => run.notes.wording.map(|own| own.words);
        "note_planning_words", "count", "words of planning among them" => run.notes.wording.map(|own| own.planning);
        "note_if_words", "count", "how often they say \"if\"" => run.notes.wording.map(|own| own.ifs);
        "parameters_digest", "digest", "names the effective parameters" => run.parameters_digest;
        "state_hash", "hash", "state after the last week" => run.state_hash;
        "last_seq", "number", "number of the last line of the trajectory" => run.last_seq;
        "last_hash", "hash", "its hash: names the whole trajectory" => run.last_hash;
        "problem", "text", "why the run could not be read; everything but its name is empty then" => "";
    }
}
