//! Logbook of a run for researchers: times, screens, queries and tool calls by week.
//!
//! The logbook is derived from the lines of the trajectory and from the replayed run. Only
//! [`BehaviorMeasures::truly_best`] uses hidden state, and only for finished runs.

mod effort;
mod summary;
mod timeline;

use serde::Serialize;
use serde_json::{Map, Value};

pub use effort::PlayerEffort;
pub use summary::session_page;
pub use timeline::PlayBreak;

use super::database_figures::{ChannelRow, DatabaseFigures};
use super::decision_periods::describe_change;
use super::measures::{BehaviorMeasures, WordCounts};
use novamind_record::consent::Consent;
use novamind_record::mode::Mode;
use novamind_record::stamp::StudyStamp;
use novamind_record::trajectory::record::{RunEndReason, SubmittedForecast, has_naive_forecasts};
use novamind_record::trajectory::{Line, Record, find_end, find_policy};
use novamind_session::{
    Attendance, Generation, HorizonRule, RecordedModelSettings, ScoredForecast, Session, SessionCount,
    TimeSpent,
};
use timeline::{Timeline, WeekSpan};

/// Log of a run and of the player's actions.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Logbook {
    /// ID of the run.
    pub run: String,
    /// Label of the participant, as the experimenter assigned it.
    pub participant: Option<String>,
    /// Digest of the consent text and time of consent; `None` if no consent was required.
    pub consent: Option<Consent>,
    /// Mode of the run.
    pub mode: Mode,
    /// Name of the scenario.
    pub scenario: String,
    /// Seed of the run.
    pub seed: u64,
    /// Last day that was planned when the run was created.
    pub days: u32,
    /// Rule that derived the last day.
    pub horizon_rule: HorizonRule,
    /// Generation of the released simulator whose rules apply to the run.
    pub generation: Generation,
    /// Cash on day 0, dollars.
    pub start_cash: f64,
    /// Format version of the trajectory file.
    pub format: u32,
    /// Study to which the run belongs, if any.
    pub study: Option<StudyStamp>,
    /// Version of the program that recorded the run.
    pub version: String,
    /// Digest of the parameters in force, after scenario and overrides.
    pub parameters_digest: String,
    /// Whether the parameters differ from the bundled scenario of the same name, or did on some days.
    pub has_own_parameters: bool,
    /// The language model that served as voice; `None` for the built-in voice.
    pub voice: Option<RecordedModelSettings>,
    /// Number of earlier runs with the same seed and scenario in the same runs folder.
    pub earlier_runs: u32,
    /// ID of the parent run, if the run is a branch.
    pub parent: Option<String>,
    /// Name of the policy that decided all weeks; `None` if not all weeks were decided by one policy.
    pub policy: Option<String>,
    /// Time at which the run was created, RFC 3339.
    pub created: String,
    /// Time of the last line of the trajectory, RFC 3339.
    pub last_at: String,
    /// Time at which the run ended, RFC 3339; `None` if it is unfinished.
    pub ended_at: Option<String>,
    /// Reason why the run ended; `None` if it is unfinished.
    pub ended: Option<RunEndReason>,
    /// Last day that was simulated.
    pub day: u32,
    /// Cash after the last simulated day, dollars.
    pub cash: f64,
    /// Final score of the run, dollars; `None` if it is unfinished or has no score.
    pub score: Option<f64>,
    /// Simulated weeks, each with the actions before it.
    pub weeks: Vec<WeekRecord>,
    /// Actions after the last simulated week.
    pub open_week: PlayerEffort,
    /// Gaps of more than ten minutes in play.
    pub breaks: Vec<PlayBreak>,
    /// Number of times that the system clock was set back during the run.
    pub clock_set_back: u32,
    /// Number of times that the run was opened, as counted in its lines.
    pub sittings: SessionCount,
    /// Versions of the player's notes, and words of the last version.
    pub notes: NotesSummary,
    /// Number of weeks that the player decided in less than ten active seconds.
    pub fast_weeks: u32,
    /// Counts and durations of the whole run.
    pub total: PlayerEffort,
    /// Median active time before a week, seconds; `None` before the first week.
    pub median_week_seconds: Option<f64>,
    /// Time from the end of the run to the last line that was recorded after it; `None` before the end.
    pub after_end: Option<TimeSpent>,
    /// Word counts over all rationales.
    pub wording: WordCounts,
    /// Behavior measures of the run.
    pub measures: BehaviorMeasures,
    /// Advertising results by group and channel.
    pub ads: Vec<ChannelRow>,
    /// State hash after the last week; `None` before the first week.
    pub state_hash: Option<String>,
    /// Number of the last line of the trajectory.
    pub last_seq: u64,
    /// Hash of the last line of the trajectory, which identifies the whole trajectory.
    pub last_hash: String,
}

/// Summary of the notes of a run.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct NotesSummary {
    /// Number of times that the player saved the notes.
    pub versions: u32,
    /// Word counts of the last saved text; `None` if the record does not contain the text.
    pub wording: Option<WordCounts>,
}

/// A simulated week, or days that were simulated one by one, with the actions before it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct WeekRecord {
    /// Number of the week, from 1.
    pub week: u32,
    /// Day on which the week was decided.
    pub decision_day: u32,
    /// Last simulated day of the week.
    pub day: u32,
    /// Number of days that were simulated in the week.
    pub days_run: u32,
    /// Whether the week was copied from the parent run, so that it was not played in this run.
    pub inherited: bool,
    /// Whether the week was decided in this run, in less than ten active seconds.
    pub implausibly_fast: bool,
    /// Earliest time at which the player could decide, RFC 3339.
    pub began_at: String,
    /// Time at which the decisions were submitted, RFC 3339.
    pub decided_at: String,
    /// Counts and durations of the actions before the week.
    #[serde(flatten)]
    pub effort: PlayerEffort,
    /// Word counts of the rationale.
    pub wording: WordCounts,
    /// Descriptions of the decisions before the week.
    pub decisions: Vec<String>,
    /// Forecasts that the player filed before the week, with their scores if they are due.
    pub forecasts: Vec<ScoredForecast>,
    /// For each of `forecasts`, whether it is naive.
    pub naive_forecasts: Vec<bool>,
    /// Whether at least one forecast is naive; `None` if no forecast was filed.
    pub filled_naively: Option<bool>,
    /// Whether the week was filed automatically because a time limit was reached.
    pub filed_at_limit: bool,
    /// Figures of the week, as recorded in its line of the trajectory.
    pub figures: Map<String, Value>,
    /// State hash after the week.
    pub state_hash: String,
}

impl Logbook {
    /// Returns the label of the participant or the name of the policy, or `None` for an unnamed player.
    pub fn player_name(&self) -> Option<String> {
        let policy = || self.policy.as_ref().map(|name| format!("policy {name}"));
        self.participant.clone().or_else(policy)
    }

    /// Builds the logbook from the lines of a run, the lines that were recorded after its end, and the replayed
    /// session. Queries the database for advertising results.
    pub fn new(session: &Session, lines: &[Line], afterwards: &[Line]) -> Logbook {
        let timeline = Timeline::from_lines(lines);
        let weeks: Vec<WeekRecord> =
            timeline.spans.iter().enumerate().map(|(at, span)| week_record(session, span, at)).collect();
        let mut total = timeline.open.effort.clone();
        let mut wording = WordCounts::default();
        for week in &weeks {
            total.add(&week.effort);
            wording += week.wording;
        }
        let active_seconds =
            weeks.iter().filter(|week| !week.inherited).map(|week| week.effort.time.active_seconds());
        let ads = DatabaseFigures::load_channels(session);
        let (manifest, last) = (session.manifest(), lines.last());
        let end = find_end(lines);
        Logbook {
            run: manifest.id.clone(),
            participant: manifest.participant.clone(),
            consent: manifest.consent.clone(),
            mode: manifest.mode,
            scenario: manifest.scenario.clone(),
            seed: manifest.seed,
            days: manifest.days,
            horizon_rule: manifest.horizon_rule(),
            generation: manifest.generation(),
            start_cash: manifest.cash,
            version: manifest.version.clone(),
            parameters_digest: manifest.parameters_digest.clone(),
            has_own_parameters: session.company().observe().has_own_parameters,
            voice: manifest.voice.clone(),
            earlier_runs: manifest.earlier_runs,
            parent: manifest.parent.as_ref().map(|parent| parent.run.clone()),
            policy: find_policy(lines).map(str::to_owned),
            created: lines.first().map_or_else(|| manifest.created.clone(), |line| line.at.clone()),
            last_at: last.map(|line| line.at.clone()).unwrap_or_default(),
            ended_at: end.map(|line| line.at.clone()),
            ended: session.ended(),
            day: session.day(),
            cash: session.cash_by_day().last().copied().unwrap_or(manifest.cash),
            score: session.score(),
            median_week_seconds: median(active_seconds.collect()),
            open_week: timeline.open.effort,
            format: manifest.format,
            study: manifest.study.clone(),
            sittings: SessionCount::from_lines(lines),
            notes: NotesSummary::from_lines(lines),
            fast_weeks: weeks.iter().filter(|week| week.implausibly_fast).count() as u32,
            after_end: end.map(|_| time_after_end(lines, afterwards)),
            breaks: timeline.breaks,
            clock_set_back: timeline.clock_set_back,
            total,
            wording,
            measures: BehaviorMeasures::from_session(session, &ads),
            ads,
            state_hash: weeks.last().map(|week| week.state_hash.clone()),
            weeks,
            last_seq: last.map_or(0, |line| line.seq),
            last_hash: last.map(|line| line.hash.clone()).unwrap_or_default(),
        }
    }
}

impl NotesSummary {
    fn from_lines(lines: &[Line]) -> NotesSummary {
        let kept = lines.iter().filter(|line| line.record.notes_digest().is_some());
        let text = kept.clone().next_back().and_then(|line| match &line.record {
            Record::Note(note) => note.text.as_deref(),
            _ => None,
        });
        NotesSummary { versions: kept.count() as u32, wording: text.map(WordCounts::from_text) }
    }
}

fn week_record(session: &Session, span: &WeekSpan, at: usize) -> WeekRecord {
    let decided = session.company().decisions().get(at);
    let mut decisions: Vec<String> = decided
        .iter()
        .flat_map(|week_decisions| week_decisions.changes.iter().map(describe_change))
        .collect();
    decisions.extend(decided.iter().flat_map(|week_decisions| week_decisions.purchases.iter().cloned()));
    let own_rationale = span.rationale.as_deref().filter(|_| !span.filed_at_limit);
    let scored = |filed: &SubmittedForecast| {
        ScoredForecast::new(span.decision_day, &filed.to_forecast(), session.weeks())
    };
    WeekRecord {
        week: novamind_session::week_of_day(span.day),
        decision_day: span.decision_day,
        day: span.day,
        days_run: span.days_run,
        inherited: span.attended.is_inherited,
        implausibly_fast: span.attended.is_implausibly_fast(&span.effort.time),
        began_at: span.began_at.clone(),
        decided_at: span.decided_at.clone(),
        effort: span.effort.clone(),
        wording: own_rationale.map(WordCounts::from_text).unwrap_or_default(),
        decisions,
        forecasts: span.forecasts.iter().map(scored).collect(),
        naive_forecasts: span.forecasts.iter().map(|forecast| forecast.filled_naively).collect(),
        filled_naively: has_naive_forecasts(
            &span.forecasts,
            session.manifest().days.saturating_sub(span.decision_day),
        ),
        filed_at_limit: span.filed_at_limit,
        figures: span.figures.clone(),
        state_hash: span.state_hash.clone(),
    }
}

/// Returns the time between the last line of a run and the last line that was recorded after its end.
fn time_after_end(lines: &[Line], afterwards: &[Line]) -> TimeSpent {
    let mut attendance = Attendance::from_lines(lines);
    let end = attendance.end_ns();
    afterwards.iter().for_each(|line| attendance.add_line(line.at_nanoseconds(), &line.record));
    attendance.spent_between(end, attendance.end_ns())
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    match values.len() {
        0 => None,
        count if count % 2 == 1 => Some(values[middle]),
        _ => Some((values[middle - 1] + values[middle]) / 2.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_kit;

    #[test]
    fn logbook_counts_player_actions() {
        let (session, lines) = test_kit::recorded_run();
        let book = Logbook::new(&session, &lines, &[]);
        assert_eq!((book.weeks.len(), book.day, book.participant.as_deref()), (2, 14, Some("P 07")));
        let first = &book.weeks[0];
        let effort = &first.effort;
        assert_eq!((effort.calls, effort.refused, effort.queries, effort.queries_failed), (1, 1, 2, 1));
        assert_eq!((effort.views, effort.screens.len()), (2, 1));
        assert_eq!((first.wording.words, first.wording.ifs, first.wording.planning), (6, 1, 1));
        assert_eq!(first.decisions.len(), 3, "{:?}", first.decisions);
        assert_eq!((first.filled_naively, first.forecasts.len()), (Some(true), 4));
        assert_eq!(first.forecasts[0].outcome, Some(session.cash_by_day()[7]));
        assert_eq!(first.forecasts[3].outcome, None);
        assert_eq!(book.open_week.memos, 1);
        assert_eq!(book.weeks[1].effort.calls, 0);
        assert_eq!(book.total.queries, 2);
        assert_eq!(book.last_hash, lines.last().expect("a line").hash);
        assert_eq!(book.measures.planning.rationales, 2);
        let value = serde_json::to_value(&book).expect("it is JSON");
        assert_eq!(value["weeks"][0]["queries"], 2);
    }

    #[test]
    fn median_of_seconds_is_computed() {
        assert_eq!(median(vec![]), None);
        assert_eq!(median(vec![3.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(median(vec![4.0, 1.0]), Some(2.5));
    }
}
