//! Columns of `runs.csv`: a row for each run.

use super::column::{Column, columns};
use super::{
    console_only, format_pairs, format_screen_seconds, format_tool_counts, rounded, score_at_horizon,
    screen_views_only_if_recorded,
};
use crate::logbook::Logbook;
use crate::measures::BestTriedChannelSpend;
use novamind_record::consent::{ConsentDetails, ConsentMeans};
use novamind_session::TimeSpent;

fn scored_forecast_count(run: &Logbook, horizon_days: u32) -> u32 {
    score_at_horizon(&run.measures.forecasts, horizon_days).map_or(0, |score| score.scored)
}

fn forecast_error(run: &Logbook, horizon_days: u32) -> Option<f64> {
    score_at_horizon(&run.measures.forecasts, horizon_days).map(|score| score.mean_error)
}

fn forecast_coverage(run: &Logbook, horizon_days: u32) -> Option<f64> {
    score_at_horizon(&run.measures.forecasts, horizon_days)
        .map(|score| f64::from(score.covered) / f64::from(score.scored))
}

fn first_weeks_error(run: &Logbook, horizon_days: u32) -> Option<f64> {
    score_at_horizon(&run.measures.first_forecasts, horizon_days).map(|score| score.mean_error)
}

/// Returns how the participant gave consent, or `None` if the program did not show the consent text.
fn consent_on_screen(run: &Logbook) -> Option<ConsentDetails> {
    run.consent
        .as_ref()
        .and_then(|consent| consent.given)
        .filter(|consent_given| consent_given.means != ConsentMeans::Paper)
}

const FIRST_ERROR_MEANING: &str = "mean of |point - outcome| / max(|outcome|, 1) over the forecasts that were filed before the first four weeks";
const ERROR_MEANING: &str =
    "mean of |point - outcome| / max(|outcome|, 1) over the due forecasts with this horizon";
const COVERAGE_MEANING: &str =
    "share of the due forecasts with this horizon whose interval contains the outcome";

pub(super) fn columns() -> Vec<Column<Logbook>> {
    columns! { run: Logbook;
        "run", "name", "name of the run" => run.run;
        "participant", "label", "label of the participant, assigned by the experimenter" => run.participant;
        "study", "name", "study of the run; this and the next five columns are empty if the run belongs to no study"
            => run.study.as_ref().map(|study| &study.name);
        "study_digest", "hash", "BLAKE3 hash of the study's protocol" => run.study.as_ref().map(|study| &study.digest);
        "condition", "text", "condition assigned to the participant"
            => run.study.as_ref().and_then(|study| study.condition.as_ref());
        "assigned_order", "number", "position of the participant in the assignment, from 1"
            => run.study.as_ref().and_then(|study| study.order);
        "practice", "0 or 1", "1: practice run; 0: session" => run.study.as_ref().map(|study| study.practice);
        "refused_labels", "count", "labels that were rejected before this label was accepted"
            => run.study.as_ref().map(|study| study.refused_labels);
        "mode", "word", "baseline, sandbox, lesson or debug" => run.mode.id();
        "scenario", "name", "scenario of the run" => run.scenario;
        "generation", "word", "generation of the released simulator whose rules the run has: release_1 or release_2"
            => run.generation.id();
        "seed", "number", "seed of all random draws" => run.seed;
        "days", "days", "planned last day of the run" => run.days;
        "horizon_rule", "word", "rule that derived the last day: exact, whole_weeks_below or whole_weeks_above"
            => run.horizon_rule.name();
        "start_cash", "dollars", "cash on day 0" => run.start_cash;
        "parent", "name", "parent run; empty unless the run is a branch" => run.parent;
        "earlier_runs", "count", "earlier runs of the same participant with this seed and scenario; in format 1, of all participants"
            => run.earlier_runs;
        "consent_at", "RFC 3339", "time of consent; with --consent, time at which the run started; empty if no \
         consent was required" => run.consent.as_ref().map(|consent| &consent.at);
        "consent_digest", "hash", "BLAKE3 hash of the consent text" => run.consent.as_ref().map(|consent| &consent.digest);
        "consent_read_ms", "milliseconds", "time from display of the consent text to consent; this and the next \
         column are empty if no consent was required or consent was given on \
         paper" => consent_on_screen(run).map(|consent_given| consent_given.read_ms);
        "consent_scrolled_to_end", "0 or 1", "1: the end of the consent text was shown before consent"
            => consent_on_screen(run).map(|given| given.scrolled_to_end);
        "format", "number", "format of the trajectory" => run.format;
        "version", "version", "version of the program that recorded the run" => run.version;
        "created", "RFC 3339", "time of creation" => run.created;
        "last_at", "RFC 3339", "time of the last line" => run.last_at;
        "ended_at", "RFC 3339", "time of the end; empty for unfinished runs" => run.ended_at;
        "ended", "word", "horizon, bankruptcy or abandoned; empty for unfinished runs" => run.ended.map(|ended| ended.id());
        "day", "day", "last simulated day" => run.day;
        "cash", "dollars", "cash after the last simulated day" => run.cash;
        "score", "dollars", "score: cash after the planned last day, or 0 after a bankruptcy; otherwise empty" => run.score;
        "survival_days", "days", "days that the company survived" => run.measures.survival_days;
        "weeks", "count", "simulated weeks, including a shortened last week (debug runs: also steps)" => run.weeks.len();
        "calls", "count", "accepted tool calls" => run.total.calls;
        "refused", "count", "rejected tool calls, including rejected weeks" => run.total.refused;
        "undone", "count", "accepted calls that undid an earlier call" => run.total.undone;
        "queries", "count", "SQL queries" => run.total.queries;
        "queries_failed", "count", "queries that were rejected or failed" => run.total.queries_failed;
        "views", "count", "views of screens (console only)" => screen_views_only_if_recorded(run, run.total.views);
        "memos", "count", "changes to the notes" => run.total.memos;
        "sittings", "count", "number of times the program opened the run; 0 if not recorded (format 1, policies)"
            => run.sittings.opened;
        "sittings_not_closed", "count", "sessions without a closing line, which were killed or are still open" => run.sittings.not_closed;
        "machines", "count", "machines on which the run was played, if recorded" => run.sittings.machines;
        "elapsed_seconds", "seconds", "sum of active, answering, idle and away time, from the first line to the \
         last, without simulation time" => run.total.time.elapsed_seconds();
        "active_seconds", "seconds", "active time" => run.total.time.active_seconds();
        "answering_seconds", "seconds", "time with questions of the study on the screen" => run.total.time.answering_seconds();
        "idle_seconds", "seconds", "time without a key press while the program is in front; not distinguished in format 1"
            => run.total.time.idle_seconds();
        "away_seconds", "seconds", "time in which the run was closed, suspended or in the background, or its clock \
         was stopped; in format 1, gaps of more than ten minutes between two lines" => run.total.time.away_seconds();
        "paused_seconds", "seconds", "part of away_seconds: time with the clock stopped" => run.total.time.paused_seconds();
        "active_seconds_after_end", "seconds", "active time from the end of the run to the last line, not included \
         in the other columns; empty before the end" => run.after_end.as_ref().map(TimeSpent::active_seconds);
        "clock_stopped", "count", "number of times that the player stopped the clock" => run.sittings.clock_stopped;
        "breaks", "count", "breaks: gaps of more than ten minutes in play" => run.breaks.len();
        "clock_set_back", "count", "number of times that the clock went backwards between two lines; these gaps count as zero"
            => run.clock_set_back;
        "week_seconds_median", "seconds", "median over the weeks of the active seconds before a week"
            => run.median_week_seconds.map(rounded);
        "implausibly_fast_weeks", "count", "weeks decided in less than ten active seconds" => run.fast_weeks;
        "typed_characters", "count", "characters typed into texts (console only)" => console_only(run, run.total.typed);
        "deleted_characters", "count", "characters deleted from texts (console only)" => console_only(run, run.total.deleted);
        "pasted_characters", "count", "typed characters that came from the clipboard (console only)"
            => console_only(run, run.total.pasted);
        "truly_best_channel_share", "share", "share of advertising on the channel of each group with the highest yield of all \
         five at the start of the run, which is hidden from players; random spending reaches 0.2; empty before the end"
            => run.measures.truly_best.as_ref().map(|best| best.share);
        "truly_best_channel_share_by_group", "group=share", "share of advertising on the channel with the highest yield, by group"
            => format_pairs(run.measures.truly_best.iter().flat_map(|best| best.groups.iter().map(|(name, value)| (name, *value))));
        "channels_tried", "per group", "mean number of paid channels over the advertised groups"
            => run.measures.channels.as_ref().map(BestTriedChannelSpend::mean_channels_tried);
        "best_tried_channel_share", "share", "share of advertising on the paid channel with the most leads per dollar, \
         over the groups with two paid channels and at least three leads from the best channel; visible to \
         players" => run.measures.channels.as_ref().and_then(|skill| skill.share);
        "targeted_development_share", "share", "targeted share of development spending over the simulated days"
            => run.measures.targeted_development;
        "forecasts_scored_7", "count", "due forecasts with a horizon of 7 days" => scored_forecast_count(run, 7);
        "forecast_error_7", "share", ERROR_MEANING => forecast_error(run, 7);
        "forecast_coverage_7", "share", COVERAGE_MEANING => forecast_coverage(run, 7);
        "forecasts_scored_28", "count", "due forecasts with a horizon of 28 days" => scored_forecast_count(run, 28);
        "forecast_error_28", "share", ERROR_MEANING => forecast_error(run, 28);
        "forecast_coverage_28", "share", COVERAGE_MEANING => forecast_coverage(run, 28);
        "forecasts_scored_84", "count", "due forecasts with a horizon of 84 days" => scored_forecast_count(run, 84);
        "forecast_error_84", "share", ERROR_MEANING => forecast_error(run, 84);
        "forecast_coverage_84", "share", COVERAGE_MEANING => forecast_coverage(run, 84);
        "forecasts_scored_182", "count", "due forecasts with a horizon of 182 days" => scored_forecast_count(run, 182);
        "forecast_error_182", "share", ERROR_MEANING => forecast_error(run, 182);
        "forecast_coverage_182", "share", COVERAGE_MEANING => forecast_coverage(run, 182);
        "first_forecast_error_7", "share", FIRST_ERROR_MEANING => first_weeks_error(run, 7);
        "first_forecast_error_28", "share", FIRST_ERROR_MEANING => first_weeks_error(run, 28);
        "first_forecast_error_84", "share", FIRST_ERROR_MEANING => first_weeks_error(run, 84);
        "first_forecast_error_182", "share", FIRST_ERROR_MEANING => first_weeks_error(run, 182);
        "weeks_filled_naively", "count", "weeks with at least one naive forecast"
            => run.measures.filled_naively.0;
        "weeks_filed_at_limit", "count", "weeks filed automatically at a time limit; words of their rationales are not counted, because the player did not write them" => run.weeks.iter().filter(|week| week.filed_at_limit).count();
        "acting_calls", "count", "accepted calls that changed the run; excludes read-only calls" => run.measures.tools.calls;
        "acting_calls_per_week", "per week", "accepted calls that changed the run, per simulated week" => rounded(run.measures.tools.per_week);
        "tools_used", "count", "number of different tools used in accepted calls that changed the run" => run.measures.tools.tools.len();
        "tool_evenness", "share", "evenness of tool use in accepted calls that changed the run: entropy of the tools' shares divided by \
         its maximum; empty if fewer than two tools were used" => run.measures.tools.evenness;
        "tools", "tool=count", "accepted calls by tool, including read-only calls" => format_tool_counts(&run.total);
        "screens", "screen=seconds", "active time on each screen (console only)" => format_screen_seconds(&run.total);
        "selects", "count", "objects opened: groups, threads, tools, posts, studies" => run.total.selects;
        "dialogs_confirmed", "count", "dialogs confirmed (console only)"
            => console_only(run, run.total.dialogs_confirmed);
        "dialogs_cancelled", "count", "dialogs cancelled (console only)" => console_only(run, run.total.dialogs_cancelled);
        "helps", "count", "explanations of terms opened" => run.total.helps;
        "drafts_left", "count", "texts edited and not submitted (console only)"
            => console_only(run, run.total.drafts_left);
        "rationale_words", "count", "words of all rationales" => run.wording.words;
        "planning_words", "count", "planning words of all rationales: if, unless, until, otherwise, because, therefore, expect, \
         plan, should, would, might, risk, assume, probably, likely, instead" => run.wording.planning;
        "planning_words_per_100", "per 100 words", "planning words per hundred words of rationale"
            => run.wording.planning_per_hundred().map(rounded);
        "if_words", "count", "occurrences of \"if\" in rationales" => run.wording.ifs;
        "note_versions", "count", "number of saved versions of the notes before the end" => run.notes.versions;
        "note_words", "count", "words of the last saved notes; this and the next two columns are empty if the \
         lines do not contain the text of the notes" => run.notes.wording.map(|word_counts| word_counts.words);
        "note_planning_words", "count", "planning words of the last saved notes" => run.notes.wording.map(|word_counts| word_counts.planning);
        "note_if_words", "count", "occurrences of \"if\" in the last saved notes" => run.notes.wording.map(|word_counts| word_counts.ifs);
        "parameters_digest", "digest", "digest of the effective parameters" => run.parameters_digest;
        "state_hash", "hash", "state hash after the last week" => run.state_hash;
        "last_seq", "number", "number of the last line of the trajectory" => run.last_seq;
        "last_hash", "hash", "hash of the last line, which identifies the trajectory" => run.last_hash;
        "problem", "text", "reason why the run could not be read; all columns except the name are then empty" => "";
    }
}
