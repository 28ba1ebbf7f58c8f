//! What a student sees of a lesson: the task, the goals with what they stand at, hints, pitfalls.

use serde::Serialize;

use super::debrief::{DebriefStep, result_of_step};

use novamind_record::lesson::{GoalBound, GuessForm, GuessTold, LessonGoal, LessonStanding};
use novamind_record::trajectory::record::LessonNote;
use novamind_session::{Session, lesson_step, measure, weeks_passed};
use novamind_tools::ToolId;

/// What a student sees of a lesson.
#[derive(Debug, Clone, PartialEq)]
pub struct LessonPage {
    /// Title of the lesson.
    pub title: String,
    /// Title of the part, where there are several.
    pub part: Option<String>,
    /// The step that goes on, or the last one.
    pub step: usize,
    /// How many steps the part has.
    pub steps: usize,
    /// Title of the step.
    pub step_title: String,
    /// What the student reads.
    pub text: String,
    /// Weeks of the step that have passed, and how many it takes.
    pub weeks: (u32, u32),
    /// Which try of the step it is.
    pub try_number: u32,
    /// The question of the step.
    pub question: Option<LessonQuestion>,
    /// The goals of the step.
    pub goals: Vec<GoalPage>,
    /// Hints that were given.
    pub hints: Vec<String>,
    /// How many hints the step has.
    pub hints_in_all: usize,
    /// What was said of the pitfalls that were met, with the day.
    pub pitfalls: Vec<(u32, String)>,
    /// What the step before came to, until a week of this one has passed.
    pub before: Option<DebriefStep>,
    /// Whether the part is over.
    pub is_over: bool,
    /// Number of the next part, counted from 1, once this one is over and there is one.
    pub next_part: Option<u32>,
    /// Whether others can play its world from day 0: the lesson is over, and nothing was played or set for the student.
    pub has_opponents: bool,
    /// Names of the screens that the lesson has besides the Overview; all where none are named.
    pub screens: Option<Vec<String>>,
    /// The tools that the lesson has; all where none are named.
    pub tools: Option<Vec<ToolId>>,
    /// Whether a week runs without forecasts and rationale of the student.
    pub runs_at_once: bool,
}

/// The question of a step.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LessonQuestion {
    /// The question.
    pub text: String,
    /// What can be chosen; empty where a number is asked for.
    pub choices: Vec<String>,
    /// What a number is counted in.
    pub unit: String,
    /// What was guessed; of choices the number of the one taken, counted from 1.
    pub guess: Option<f64>,
    /// What came of it, once that is known.
    pub outcome: Option<f64>,
    /// Whether that is told at the end of the part, and not of the step.
    #[serde(skip)]
    pub told_at_end: bool,
}

/// A goal and what it stands at.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct GoalPage {
    /// Its text.
    pub text: String,
    /// What it stands at; none where there is nothing yet.
    pub value: Option<f64>,
    /// What is to be reached; none where it is relative to the good play, and not judged yet.
    pub bound: Option<f64>,
    /// Whether the least is wanted.
    #[serde(skip)]
    pub wants_least: bool,
    /// What share of the good play's value is to be reached, where it is relative to that.
    #[serde(skip)]
    pub of_good_play: Option<f64>,
    /// Whether it counts dollars.
    #[serde(skip)]
    pub in_dollars: bool,
    /// Whether it was reached, once it is judged.
    pub met: Option<bool>,
}

impl LessonPage {
    /// The page of a run; `None` outside lessons.
    pub fn of(session: &mut Session) -> Option<LessonPage> {
        let standing = session.lesson()?.clone();
        let part = standing.own_part();
        let going = lesson_step(session);
        let step = going.unwrap_or_else(|| standing.last_begun());
        let own = part.steps.get(step)?;
        let (begin, end) = part.weeks_of(step);
        let passed = weeks_passed(session).clamp(begin, end) - begin;
        let plan = &standing.lesson.plan;
        let filled = |text: &String| standing.lesson.filled(text);
        let next_part = (standing.part as u32 + 2, plan.parts.len() as u32);
        Some(LessonPage {
            title: plan.title.clone(),
            part: (plan.parts.len() > 1).then(|| part.title.clone()),
            step,
            steps: part.steps.len(),
            step_title: own.title.clone(),
            text: filled(&own.text),
            weeks: (passed, own.weeks),
            try_number: standing.tries(step),
            question: question(&standing, step),
            goals: goal_pages(session, &standing, step, (begin, passed)),
            hints: own.hints.iter().take(standing.hints(step)).map(filled).collect(),
            hints_in_all: own.hints.len(),
            pitfalls: pitfalls(&standing),
            before: step
                .checked_sub(1)
                .filter(|_| passed == 0)
                .and_then(|before| result_of_step(&standing, before)),
            is_over: going.is_none(),
            has_opponents: going.is_none() && next_part.0 > next_part.1 && standing.own_part().begins_empty(),
            next_part: (going.is_none() && next_part.0 <= next_part.1).then_some(next_part.0),
            screens: plan.access.screens.clone(),
            tools: plan.access.tools.clone(),
            runs_at_once: plan.access.fills_forecasts() && plan.access.asks_no_rationale(),
        })
    }
}

/// The goals of a step. Those that are not judged yet have the value up to the present week.
fn goal_pages(
    session: &mut Session,
    standing: &LessonStanding,
    step: usize,
    (begin, passed): (u32, u32),
) -> Vec<GoalPage> {
    let from = begin * session.params().run.days_per_week;
    let goals = standing.step(step).map(|own| own.goals.clone()).unwrap_or_default();
    let judged = standing.goals(step);
    let page = |(at, goal): (usize, LessonGoal)| {
        let note = judged.get(at).copied();
        let page = GoalPage::of(standing, &goal, note);
        // What is not judged yet stands where the weeks so far have brought it.
        let is_open = note.is_none() && passed > 0;
        let so_far = is_open.then(|| measure(&goal.measurement, session, from).ok().flatten()).flatten();
        GoalPage { value: page.value.or(so_far), ..page }
    };
    goals.into_iter().enumerate().map(page).collect()
}

impl GoalPage {
    /// A goal, and its result if it is judged.
    pub(super) fn of(standing: &LessonStanding, goal: &LessonGoal, judged: Option<&LessonNote>) -> GoalPage {
        let of_good_play = match goal.bound {
            GoalBound::OfGoodPlay(share) => Some(share),
            GoalBound::AtLeast(_) | GoalBound::AtMost(_) => None,
        };
        GoalPage {
            text: standing.lesson.filled(&goal.text),
            value: judged.and_then(|note| note.value),
            bound: goal.bound.value(None).or(judged.and_then(|note| note.bound)),
            wants_least: matches!(goal.bound, GoalBound::AtMost(_)),
            of_good_play,
            in_dollars: goal.in_dollars,
            met: judged.and_then(|note| note.met),
        }
    }
}

pub(super) fn question(standing: &LessonStanding, step: usize) -> Option<LessonQuestion> {
    let guess = standing.step(step)?.guess.as_ref()?;
    let (choices, unit) = match &guess.form {
        GuessForm::Number { unit, .. } => (Vec::new(), unit.clone()),
        GuessForm::Choice { choices, .. } => (choices.clone(), String::new()),
    };
    let outcome = standing.outcome(step).and_then(|note| note.value);
    Some(LessonQuestion {
        text: guess.question.clone(),
        choices,
        unit,
        guess: standing.guess(step),
        outcome,
        told_at_end: guess.told == GuessTold::Part,
    })
}

pub(super) fn pitfalls(standing: &LessonStanding) -> Vec<(u32, String)> {
    let said = |(day, note): &(u32, LessonNote)| {
        let name = note.name.as_deref()?;
        let pitfall = standing.lesson.plan.pitfalls.iter().find(|own| own.name == name)?;
        Some((*day, standing.lesson.filled(&pitfall.say)))
    };
    standing.notes.iter().filter_map(said).collect()
}
