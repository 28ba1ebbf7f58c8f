//! The lesson page that a student sees: task, goals with current values, hints and pitfalls.

use serde::Serialize;

use super::debrief::{DebriefStep, step_result};

use novamind_record::lesson::{GoalBound, GuessForm, LessonGoal, LessonProgress, OutcomeTiming};
use novamind_record::trajectory::record::RecordedLessonEvent;
use novamind_session::{Session, lesson_step, measure, weeks_passed};
use novamind_tools::ToolId;

/// The lesson page of a student.
#[derive(Debug, Clone, PartialEq)]
pub struct LessonStatus {
    /// Title of the lesson.
    pub title: String,
    /// Title of the part, if the lesson has several parts.
    pub part: Option<String>,
    /// The current step, counted from 0. After the part has ended, the last step that was started.
    pub step: usize,
    /// Number of steps of the part.
    pub steps: usize,
    /// Title of the step.
    pub step_title: String,
    /// Task of the step.
    pub text: String,
    /// Number of completed weeks of the step, and total number of its weeks.
    pub weeks: (u32, u32),
    /// Number of the current try of the step, counted from 1.
    pub try_number: u32,
    /// The question of the step, if any.
    pub question: Option<LessonQuestion>,
    /// The goals of the step, with their current values.
    pub goals: Vec<GoalStatus>,
    /// Texts of the hints that the student has used.
    pub hints: Vec<String>,
    /// Number of hints that the step has.
    pub hint_count: usize,
    /// Day and explanation of each pitfall that the student triggered.
    pub pitfalls: Vec<(u32, String)>,
    /// Results of the previous step, until one week of the current step has been completed.
    pub previous_step: Option<DebriefStep>,
    /// Whether the part has ended.
    pub is_finished: bool,
    /// Number of the next part, counted from 1; `None` unless this part has ended and is not the last part.
    pub next_part: Option<u32>,
    /// Whether the student can compare the run with opponents that play the same seed from day 0. `true` if the lesson
    /// has ended and its last part started with an empty company and sets no parameters.
    pub has_opponents: bool,
    /// Names of the screens that are available in addition to the overview; `None` if all screens are available.
    pub screens: Option<Vec<String>>,
    /// Tools that the student can use; `None` if all tools are available.
    pub tools: Option<Vec<ToolId>>,
    /// Whether the lesson sets the capacity tier, so that the student cannot set it.
    pub has_automatic_capacity: bool,
    /// Whether the student can run a week without entering forecasts or a rationale.
    pub skips_forecasts: bool,
}

/// The question of a step of a lesson.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LessonQuestion {
    /// Text of the question.
    pub text: String,
    /// The possible answers; empty if the question asks for a number.
    pub choices: Vec<String>,
    /// Unit of the guessed number; empty if the question has choices.
    pub unit: String,
    /// The student's guess. For a question with choices, the number of the selected choice, counted from 1.
    pub guess: Option<f64>,
    /// The actual value that the student had to guess; `None` before the value is known.
    pub outcome: Option<f64>,
    /// Whether the outcome is shown at the end of the part instead of the end of the step.
    #[serde(skip)]
    pub is_shown_at_part_end: bool,
}

/// A goal of a step and its current value.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct GoalStatus {
    /// Text that states the goal for the student.
    pub text: String,
    /// Current value; `None` if the goal cannot be measured yet.
    pub value: Option<f64>,
    /// Target value; `None` if the goal is relative to the reference play and has not been judged yet.
    pub bound: Option<f64>,
    /// Whether `bound` is a maximum.
    #[serde(skip)]
    pub is_bound_maximum: bool,
    /// Share of the reference play's value that the student must reach; `None` if the goal is an absolute value.
    #[serde(skip)]
    pub required_reference_share: Option<f64>,
    /// Whether the value is in dollars.
    #[serde(skip)]
    pub in_dollars: bool,
    /// Whether the goal was reached; `None` before the goal is judged.
    pub met: Option<bool>,
}

impl LessonStatus {
    /// Returns the lesson page of a run, or `None` if the run does not belong to a lesson.
    pub fn from_session(session: &mut Session) -> Option<LessonStatus> {
        let lesson_progress = session.lesson()?.clone();
        let part = lesson_progress.current_part();
        let current_step = lesson_step(session);
        let step = current_step.unwrap_or_else(|| lesson_progress.last_started_step());
        let planned_step = part.steps.get(step)?;
        let (begin, end) = part.step_weeks(step);
        let passed = weeks_passed(session).clamp(begin, end) - begin;
        let plan = &lesson_progress.lesson.plan;
        let filled = |text: &String| lesson_progress.lesson.fill_figures(text);
        let next_part = (lesson_progress.part as u32 + 2, plan.parts.len() as u32);
        Some(LessonStatus {
            title: plan.title.clone(),
            part: (plan.parts.len() > 1).then(|| part.title.clone()),
            step,
            steps: part.steps.len(),
            step_title: planned_step.title.clone(),
            text: filled(&planned_step.text),
            weeks: (passed, planned_step.weeks),
            try_number: lesson_progress.attempt(step),
            question: step_question(&lesson_progress, step),
            goals: goal_statuses(session, &lesson_progress, step, (begin, passed)),
            hints: planned_step.hints.iter().take(lesson_progress.hint_count(step)).map(filled).collect(),
            hint_count: planned_step.hints.len(),
            pitfalls: triggered_pitfalls(&lesson_progress),
            previous_step: step
                .checked_sub(1)
                .filter(|_| passed == 0)
                .and_then(|before| step_result(&lesson_progress, before)),
            is_finished: current_step.is_none(),
            has_opponents: current_step.is_none()
                && next_part.0 > next_part.1
                && lesson_progress.current_part().starts_empty(),
            next_part: (current_step.is_none() && next_part.0 <= next_part.1).then_some(next_part.0),
            screens: plan.access.screens.clone(),
            tools: plan.access.tools.clone(),
            has_automatic_capacity: part.has_automatic_capacity(),
            skips_forecasts: plan.access.uses_naive_forecasts() && plan.access.is_rationale_off(),
        })
    }
}

/// Returns the goals of a step. Goals that are not judged yet show their value up to the current week.
fn goal_statuses(
    session: &mut Session,
    lesson_progress: &LessonProgress,
    step: usize,
    (begin, passed): (u32, u32),
) -> Vec<GoalStatus> {
    let from = begin * session.params().run.days_per_week;
    let goals = lesson_progress.step(step).map(|lesson_step| lesson_step.goals.clone()).unwrap_or_default();
    let judged = lesson_progress.goal_results(step);
    let page = |(at, goal): (usize, LessonGoal)| {
        let note = judged.get(at).copied();
        let page = GoalStatus::new(lesson_progress, &goal, note);
        let is_open = note.is_none() && passed > 0;
        let so_far = is_open.then(|| measure(&goal.measurement, session, from).ok().flatten()).flatten();
        GoalStatus { value: page.value.or(so_far), ..page }
    };
    goals.into_iter().enumerate().map(page).collect()
}

impl GoalStatus {
    /// Creates the status of a goal, with its result if it has been judged.
    pub(super) fn new(
        lesson_progress: &LessonProgress,
        goal: &LessonGoal,
        judged: Option<&RecordedLessonEvent>,
    ) -> GoalStatus {
        let required_reference_share = match goal.bound {
            GoalBound::RelativeToReferencePlay(share) => Some(share),
            GoalBound::AtLeast(_) | GoalBound::AtMost(_) => None,
        };
        GoalStatus {
            text: lesson_progress.lesson.fill_figures(&goal.text),
            value: judged.and_then(|note| note.value),
            bound: goal.bound.value(None).or(judged.and_then(|note| note.bound)),
            is_bound_maximum: matches!(goal.bound, GoalBound::AtMost(_)),
            required_reference_share,
            in_dollars: goal.in_dollars,
            met: judged.and_then(|note| note.met),
        }
    }
}

pub(super) fn step_question(lesson_progress: &LessonProgress, step: usize) -> Option<LessonQuestion> {
    let guess = lesson_progress.step(step)?.guess.as_ref()?;
    let (choices, unit) = match &guess.form {
        GuessForm::Number { unit, .. } => (Vec::new(), unit.clone()),
        GuessForm::Choice { choices, .. } => (choices.clone(), String::new()),
    };
    let outcome = lesson_progress.outcome(step).and_then(|note| note.value);
    Some(LessonQuestion {
        text: guess.question.clone(),
        choices,
        unit,
        guess: lesson_progress.guess(step),
        outcome,
        is_shown_at_part_end: guess.outcome_timing == OutcomeTiming::Part,
    })
}

pub(super) fn triggered_pitfalls(lesson_progress: &LessonProgress) -> Vec<(u32, String)> {
    let triggered = |(day, note): &(u32, RecordedLessonEvent)| {
        let name = note.name.as_deref()?;
        let pitfall = lesson_progress.lesson.plan.pitfalls.iter().find(|pitfall| pitfall.name == name)?;
        Some((*day, lesson_progress.lesson.fill_figures(&pitfall.say)))
    };
    lesson_progress.events.iter().filter_map(triggered).collect()
}
