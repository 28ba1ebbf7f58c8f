//! What a run of a class shows: simulated again from its lines, and what they say of the lesson held against that.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use novamind_record::error::RunError;
use novamind_record::figures::WeekFigure;
use novamind_record::lesson::{GuessForm, Lesson, LessonStanding, Measurement};
use novamind_record::trajectory::record::{Activity, LessonEvent, LessonNote};
use novamind_record::trajectory::{Line, Record};
use novamind_session::{Integrity, SealKey, Session, measure, read_recorded, setting_values};

/// What a run of a class shows.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Evidence {
    /// The part of the lesson, counted from 1.
    pub part: u32,
    /// Seed.
    pub seed: u64,
    /// Last day.
    pub day: u32,
    /// Whether it is over.
    pub is_over: bool,
    /// Which try it is: the highest of its steps.
    pub tries: u32,
    /// How many hints were asked for.
    pub hints: u32,
    /// The steps of the part.
    pub steps: Vec<StepEvidence>,
    /// Names of the pitfalls that were met, in their order.
    pub pitfalls: Vec<String>,
    /// Day and cash after each week, from day 0 on, dollars.
    pub cash: Vec<(u32, f64)>,
    /// Mean of every number that was set, over the weeks in which the student decided.
    pub decisions: BTreeMap<String, f64>,
    /// Figures of the last week.
    pub figures: BTreeMap<String, f64>,
}

/// What a step came to.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct StepEvidence {
    /// What was guessed; of choices the number of the one taken, counted from 1.
    pub guess: Option<f64>,
    /// What came of it.
    pub outcome: Option<f64>,
    /// Its goals; empty before it is over.
    pub goals: Vec<GoalEvidence>,
}

/// What a goal came to.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct GoalEvidence {
    /// What was measured.
    pub value: Option<f64>,
    /// Whether it was reached.
    pub met: bool,
}

/// Simulates a run again, compares every recorded state, and measures the goals and outcomes that its lines name.
///
/// # Errors
/// The first line that does not fit; or the run is missing or of another version.
pub(super) fn examine(folder: &Path, lesson: Option<&Arc<Lesson>>) -> Result<Evidence, RunError> {
    let (origin, trajectory) = read_recorded(folder)?;
    let manifest = &origin.manifest;
    Integrity::of(folder, manifest, &SealKey::default()).check(&origin.path, &trajectory)?;
    let stamp = manifest.lesson.as_ref();
    // By another lesson nothing of this one can be measured.
    let lesson = lesson.filter(|lesson| stamp.is_some_and(|stamp| stamp.digest == lesson.digest));
    let part = stamp.map_or(0, |stamp| (stamp.part as usize).wrapping_sub(1));
    if let Some(lesson) = lesson.filter(|lesson| part >= lesson.plan.parts.len()) {
        let message =
            format!("its first line names no part of the lesson, which has {}", lesson.plan.parts.len());
        return Err(RunError::NotPossible(message));
    }
    let standing = lesson.map(|lesson| LessonStanding::of(lesson.clone(), part, &trajectory.lines));
    let asks = lesson.is_some_and(|lesson| lesson.asks_database());
    let mut replay = Replay { standing, decisions: BTreeMap::new(), weeks: 0 };
    let session = origin
        .replay(&trajectory.lines, asks, &mut |session, line| replay.look(session, &origin.path, line))?;
    Ok(Evidence { is_over: trajectory.end().is_some(), ..replay.evidence(&session, manifest.seed) })
}

/// A run that is simulated again, and what was seen of it.
struct Replay {
    standing: Option<LessonStanding>,
    decisions: BTreeMap<String, f64>,
    /// Weeks in which the student decided.
    weeks: u32,
}

impl Replay {
    fn look(&mut self, session: &mut Session, path: &Path, line: &Line) -> Result<(), RunError> {
        let days = session.params().run.days_per_week;
        let start = self.standing.as_ref().map_or(0, |own| own.own_part().start_weeks) * days;
        if line.closes_days() && session.day() > start {
            self.weeks += 1;
            for (setting, value) in setting_values(session.settings()) {
                *self.decisions.entry(setting.to_string()).or_default() += value;
            }
        }
        let Record::Activity(Activity::Lesson(note)) = &line.record else { return Ok(()) };
        match self.differs(session, note) {
            None => Ok(()),
            Some(problem) => Err(RunError::Damaged {
                path: path.to_owned(),
                line: line.seq as usize + 1,
                problem,
                safe: "The files were not touched; ask for the run again".to_owned(),
            }),
        }
    }

    /// In what a note about a goal, or about what was to be guessed, differs from the company simulated again.
    fn differs(&self, session: &mut Session, note: &LessonNote) -> Option<String> {
        let standing = self.standing.clone()?;
        let step = (note.step as usize).checked_sub(1)?;
        let own = standing.step(step)?;
        let number = || (note.number.unwrap_or(1) as usize).checked_sub(1);
        let measurement: Measurement = match (note.event, own.guess.as_ref().map(|guess| &guess.form)) {
            (LessonEvent::Goal, _) => own.goals.get(number()?)?.measurement.clone(),
            (LessonEvent::Outcome, Some(GuessForm::Number { outcome, .. })) => outcome.clone(),
            _ => return None,
        };
        let from = standing.own_part().weeks_of(step).0 * session.params().run.days_per_week;
        let measured = measure(&measurement, session, from).ok().flatten();
        let is_same = match (measured, note.value) {
            (Some(one), Some(other)) => (one - other).abs() <= 1e-9 * one.abs().max(1.0),
            (one, other) => one == other,
        };
        let shown = |value: Option<f64>| value.map_or("nothing".to_owned(), |value| value.to_string());
        (!is_same).then(|| {
            format!(
                "the line says {} for step {}, and the company simulated again has {}",
                shown(note.value),
                note.step,
                shown(measured)
            )
        })
    }

    fn evidence(self, session: &Session, seed: u64) -> Evidence {
        let Replay { standing, decisions, weeks } = self;
        let means = decisions.into_iter().map(|(name, sum)| (name, sum / f64::from(weeks.max(1))));
        // A quota without a limit is no number.
        let decisions = means.filter(|(_, mean)| mean.is_finite()).collect();
        Evidence { decisions, ..evidence_of(session, standing.as_ref(), seed) }
    }
}

/// What a session that was played, or simulated again, shows.
pub(super) fn evidence_of(session: &Session, standing: Option<&LessonStanding>, seed: u64) -> Evidence {
    let steps = standing.map_or(0, |own| own.own_part().steps.len());
    let numbers: BTreeSet<usize> = (0..steps).collect();
    let of_step = |step: &usize| standing.map(|own| step_of(own, *step)).unwrap_or_default();
    let tries = numbers.iter().filter_map(|step| standing.map(|own| own.tries(*step))).max();
    let hints = numbers.iter().filter_map(|step| standing.map(|own| own.hints(*step) as u32)).sum();
    let pitfalls = standing.map(|own| own.pitfalls().into_iter().map(str::to_owned).collect());
    let opening = session.cash_by_day().first().map(|cash| (0, *cash));
    let weeks = session.weeks().iter().map(|week| (week.day, week.cash));
    Evidence {
        part: standing.map_or(1, |own| own.part as u32 + 1),
        seed,
        day: session.day(),
        is_over: session.ended().is_some(),
        tries: tries.unwrap_or(1).max(1),
        hints,
        steps: numbers.iter().map(of_step).collect(),
        pitfalls: pitfalls.unwrap_or_default(),
        cash: opening.into_iter().chain(weeks).collect(),
        decisions: BTreeMap::new(),
        figures: figures_of(session),
    }
}

fn step_of(standing: &LessonStanding, step: usize) -> StepEvidence {
    let goal = |note: &&LessonNote| GoalEvidence { value: note.value, met: note.met == Some(true) };
    StepEvidence {
        guess: standing.guess(step),
        outcome: standing.outcome(step).and_then(|note| note.value),
        goals: standing.goals(step).iter().map(goal).collect(),
    }
}

fn figures_of(session: &Session) -> BTreeMap<String, f64> {
    let Some(last) = session.weeks().last() else { return BTreeMap::new() };
    let measured =
        WeekFigure::ALL.iter().filter_map(|figure| Some((figure.name().to_owned(), figure.of_week(last)?)));
    let all = measured.chain([("cash".to_owned(), last.cash)]);
    all.filter(|(_, value)| value.is_finite()).collect()
}

/// A run that came back, and what is to be thought of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ClassRun {
    /// Label in its first line; else that of the class which its place names; else empty.
    pub label: String,
    /// Name.
    pub run: String,
    /// When it was begun, RFC 3339.
    pub created: String,
    /// Where it was found.
    pub source: PathBuf,
    /// Whether it counts.
    pub verdict: RunVerdict,
    /// What it shows; nothing where it was altered.
    pub evidence: Evidence,
}

/// Whether a run of a class counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RunVerdict {
    /// It is over, and what its lines say is what the simulation says.
    Finished,
    /// It is whole and goes on.
    NotFinished,
    /// Its lines are not what the simulation makes of them.
    Altered,
    /// Two records of it contradict each other.
    Twice,
    /// It was played by another lesson, or another version of it.
    OtherLesson,
    /// It began with the hand-out of somebody else, or with another past than was handed out.
    OtherHandout,
    /// It did not begin with a hand-out of this class.
    Unknown,
}

impl RunVerdict {
    /// Its word in tables.
    pub fn id(self) -> &'static str {
        match self {
            RunVerdict::Finished => "finished",
            RunVerdict::NotFinished => "not finished",
            RunVerdict::Altered => "altered",
            RunVerdict::Twice => "twice",
            RunVerdict::OtherLesson => "other lesson",
            RunVerdict::OtherHandout => "other hand-out",
            RunVerdict::Unknown => "unknown",
        }
    }
}
