//! Evidence of a submitted run: re-simulates the run and compares its lesson events with the re-simulation.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use novamind_record::error::RunError;
use novamind_record::figures::WeekFigure;
use novamind_record::lesson::{GuessForm, Lesson, LessonProgress, MeasurementSpec};
use novamind_record::trajectory::record::{Activity, LessonEvent, RecordedLessonEvent};
use novamind_record::trajectory::{Line, Record};
use novamind_session::{Integrity, SealKey, Session, measure, read_origin, setting_values};

/// The results of a submitted run, from its re-simulation.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Evidence {
    /// The part of the lesson that the student played, counted from 1.
    pub part: u32,
    /// Seed of the run, on which the reference play is also simulated.
    pub seed: u64,
    /// Last simulated day of the run.
    pub day: u32,
    /// Whether the run has ended.
    pub is_over: bool,
    /// Highest number of tries of a step, over all steps.
    pub tries: u32,
    /// Number of hints that the student used in all steps.
    pub hints: u32,
    /// Results of the steps of the part.
    pub steps: Vec<StepEvidence>,
    /// Names of the pitfalls, in the order in which the student triggered them.
    pub pitfalls: Vec<String>,
    /// Day and cash in dollars: on day 0 and at the end of each week.
    pub cash: Vec<(u32, f64)>,
    /// Mean value of each setting over the weeks in which the student decided.
    pub decisions: BTreeMap<String, f64>,
    /// Figures of the last simulated week, by name.
    pub figures: BTreeMap<String, f64>,
}

/// The results of a step of a lesson.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct StepEvidence {
    /// The student's guess. For a question with choices, the number of the selected choice, counted from 1.
    pub guess: Option<f64>,
    /// The actual value of the quantity that the student guessed; `None` before it is measured.
    pub outcome: Option<f64>,
    /// Results of the goals of the step; empty until the step has ended.
    pub goals: Vec<GoalEvidence>,
}

/// The result of a goal of a lesson.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct GoalEvidence {
    /// Measured value of the goal; `None` if it could not be measured.
    pub value: Option<f64>,
    /// Whether the value meets the bound of the goal.
    pub met: bool,
}

/// Re-simulates a run and compares every recorded state. Also measures the goals and guessed quantities of its lesson
/// again and compares them with the recorded events.
///
/// # Errors
/// Returns an error that names the first event that does not match. Also returns an error if the run is
/// missing or has another version.
pub(super) fn examine_record(folder: &Path, lesson: Option<&Arc<Lesson>>) -> Result<Evidence, RunError> {
    let (origin, trajectory) = read_origin(folder)?;
    let manifest = &origin.manifest;
    Integrity::read(folder, manifest, &SealKey::default()).check(&origin.path, &trajectory)?;
    let stamp = manifest.lesson.as_ref();
    // The goals of this lesson cannot be measured in a run of a different lesson.
    let lesson = lesson.filter(|lesson| stamp.is_some_and(|stamp| stamp.digest == lesson.digest));
    let part = stamp.map_or(0, |stamp| (stamp.part as usize).wrapping_sub(1));
    if let Some(lesson) = lesson.filter(|lesson| part >= lesson.plan.parts.len()) {
        let message = format!(
            "the first event names a part that does not exist; the lesson has {}",
            lesson.plan.parts.len()
        );
        return Err(RunError::InvalidRequest(message));
    }
    let lesson_progress =
        lesson.map(|lesson| LessonProgress::from_lines(lesson.clone(), part, &trajectory.lines));
    let asks = lesson.is_some_and(|lesson| lesson.needs_database());
    let mut replay = EvidenceCollector { lesson_progress, decisions: BTreeMap::new(), weeks: 0 };
    let session = origin.replay(&trajectory.lines, asks, &mut |session, line| {
        replay.observe_line(session, &origin.path, line)
    })?;
    Ok(Evidence { is_over: trajectory.end_line().is_some(), ..replay.into_evidence(&session, manifest.seed) })
}

/// Results that are collected while a run is re-simulated.
struct EvidenceCollector {
    lesson_progress: Option<LessonProgress>,
    decisions: BTreeMap<String, f64>,
    /// Weeks in which the student decided.
    weeks: u32,
}

impl EvidenceCollector {
    fn observe_line(&mut self, session: &mut Session, path: &Path, line: &Line) -> Result<(), RunError> {
        let days = session.params().run.days_per_week;
        let start = self
            .lesson_progress
            .as_ref()
            .map_or(0, |lesson_progress| lesson_progress.current_part().start_weeks)
            * days;
        if line.closes_days() && session.day() > start {
            self.weeks += 1;
            for (setting, value) in setting_values(session.settings()) {
                *self.decisions.entry(setting.to_string()).or_default() += value;
            }
        }
        let Record::Activity(Activity::Lesson(note)) = &line.record else { return Ok(()) };
        match self.describe_mismatch(session, note) {
            None => Ok(()),
            Some(problem) => Err(RunError::Damaged {
                path: path.to_owned(),
                line: line.seq as usize + 1,
                problem,
                remedy: "The files were not changed; ask for the run again".to_owned(),
            }),
        }
    }

    /// Describes how the recorded result of a goal or a guess differs from the re-simulated result. Returns `None` if
    /// they match.
    fn describe_mismatch(&self, session: &mut Session, note: &RecordedLessonEvent) -> Option<String> {
        let lesson_progress = self.lesson_progress.clone()?;
        let step = (note.step as usize).checked_sub(1)?;
        let lesson_step = lesson_progress.step(step)?;
        let number = || (note.number.unwrap_or(1) as usize).checked_sub(1);
        let measurement: MeasurementSpec =
            match (note.event, lesson_step.guess.as_ref().map(|guess| &guess.form)) {
                (LessonEvent::Goal, _) => lesson_step.goals.get(number()?)?.measurement.clone(),
                (LessonEvent::Outcome, Some(GuessForm::Number { outcome, .. })) => outcome.clone(),
                _ => return None,
            };
        let from = lesson_progress.current_part().step_weeks(step).0 * session.params().run.days_per_week;
        let measured = measure(&measurement, session, from).ok().flatten();
        let is_same = match (measured, note.value) {
            (Some(one), Some(other)) => (one - other).abs() <= 1e-9 * one.abs().max(1.0),
            (one, other) => one == other,
        };
        let shown = |value: Option<f64>| value.map_or("nothing".to_owned(), |value| value.to_string());
        (!is_same).then(|| {
            format!(
                "the event has {} for step {}, but the re-simulation has {}",
                shown(note.value),
                note.step,
                shown(measured)
            )
        })
    }

    fn into_evidence(self, session: &Session, seed: u64) -> Evidence {
        let EvidenceCollector { lesson_progress, decisions, weeks } = self;
        let means = decisions.into_iter().map(|(name, sum)| (name, sum / f64::from(weeks.max(1))));
        // An unlimited quota is infinite.
        let decisions = means.filter(|(_, mean)| mean.is_finite()).collect();
        Evidence { decisions, ..session_evidence(session, lesson_progress.as_ref(), seed) }
    }
}

/// Returns the results of a session that was played or re-simulated.
pub(super) fn session_evidence(
    session: &Session,
    lesson_progress: Option<&LessonProgress>,
    seed: u64,
) -> Evidence {
    let steps = lesson_progress.map_or(0, |lesson_progress| lesson_progress.current_part().steps.len());
    let numbers: BTreeSet<usize> = (0..steps).collect();
    let of_step =
        |step: &usize| lesson_progress.map(|progress| step_evidence(progress, *step)).unwrap_or_default();
    let tries =
        numbers.iter().filter_map(|step| lesson_progress.map(|progress| progress.attempt(*step))).max();
    let hints = numbers
        .iter()
        .filter_map(|step| lesson_progress.map(|progress| progress.hint_count(*step) as u32))
        .sum();
    let pitfalls = lesson_progress
        .map(|progress| progress.triggered_pitfall_names().into_iter().map(str::to_owned).collect());
    let opening = session.cash_by_day().first().map(|cash| (0, *cash));
    let weeks = session.weeks().iter().map(|week| (week.day, week.cash));
    Evidence {
        part: lesson_progress.map_or(1, |progress| progress.part as u32 + 1),
        seed,
        day: session.day(),
        is_over: session.ended().is_some(),
        tries: tries.unwrap_or(1).max(1),
        hints,
        steps: numbers.iter().map(of_step).collect(),
        pitfalls: pitfalls.unwrap_or_default(),
        cash: opening.into_iter().chain(weeks).collect(),
        decisions: BTreeMap::new(),
        figures: last_week_figures(session),
    }
}

fn step_evidence(lesson_progress: &LessonProgress, step: usize) -> StepEvidence {
    let goal = |note: &&RecordedLessonEvent| GoalEvidence { value: note.value, met: note.met == Some(true) };
    StepEvidence {
        guess: lesson_progress.guess(step),
        outcome: lesson_progress.outcome(step).and_then(|note| note.value),
        goals: lesson_progress.goal_results(step).iter().map(goal).collect(),
    }
}

fn last_week_figures(session: &Session) -> BTreeMap<String, f64> {
    let Some(last) = session.weeks().last() else { return BTreeMap::new() };
    let measured = WeekFigure::ALL
        .iter()
        .filter_map(|figure| Some((figure.name().to_owned(), figure.company_value(last)?)));
    let all = measured.chain([("cash".to_owned(), last.cash)]);
    all.filter(|(_, value)| value.is_finite()).collect()
}

/// A submitted run with its verdict.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ClassRun {
    /// Label in the first event of the run, otherwise the label in the run's path; empty if neither contains a label.
    pub label: String,
    /// ID of the run, from its manifest.
    pub run: String,
    /// Time at which the run started, in RFC 3339 format.
    pub created: String,
    /// Path of the record in the searched folders, or of the archive that contains it.
    pub source: PathBuf,
    /// Whether the run counts, and why not.
    pub verdict: RunVerdict,
    /// Results of the run. The results of an altered run contain only its part and seed.
    pub evidence: Evidence,
}

/// Whether a submitted run counts, with the reason if it does not.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RunVerdict {
    /// The run has ended and matches the re-simulation.
    Finished,
    /// The run is valid but has not ended.
    NotFinished,
    /// The events of the run do not match the re-simulation.
    Altered,
    /// Several valid records of the run contradict each other.
    Conflicting,
    /// The run used a different lesson, or a different version of the lesson.
    OtherLesson,
    /// The run started from the handout of a different student, or its events before the handout differ from those in
    /// the handout.
    OtherHandout,
    /// The run did not start from a handout of this class.
    Unknown,
}

impl RunVerdict {
    /// Returns the name of the verdict for tables.
    pub fn label(self) -> &'static str {
        match self {
            RunVerdict::Finished => "finished",
            RunVerdict::NotFinished => "not finished",
            RunVerdict::Altered => "altered",
            RunVerdict::Conflicting => "twice",
            RunVerdict::OtherLesson => "other lesson",
            RunVerdict::OtherHandout => "other hand-out",
            RunVerdict::Unknown => "unknown",
        }
    }
}
