//! Reference plays: a part of a lesson played by its file, in memory.

use std::sync::Arc;

use super::conduct::LessonEntry;
use super::definition::{GoalBound, GuessForm, LessonGoal, ScheduledCalls};
use super::lesson_call::LessonCall;
use super::lesson_file::Lesson;
use super::standing::LessonStanding;
use crate::create::NewRun;
use crate::state::{AnswersCompanies, Session};
use novamind_record::error::RunError;
use novamind_record::folder::configuration::Configuration;
use novamind_record::mode::Mode;
use novamind_record::trajectory::record::Via;
use novamind_tools::Refusal;

/// A play of a part that is done by its file.
#[derive(Debug, Clone, PartialEq)]
pub struct PartPlay<'a> {
    /// The lesson.
    pub lesson: &'a Arc<Lesson>,
    /// The part, counted from 0.
    pub part: usize,
    /// The seed; the student's if none is named.
    pub seed: Option<u64>,
    /// What is called, and when.
    pub plays: &'a [ScheduledCalls],
    /// It stops after so many weeks of the company; at the end of the part if none are named.
    pub weeks: Option<u32>,
    /// Whether goals and pitfalls are looked at.
    pub is_judged: bool,
    /// Whether it needs a database.
    pub asks_database: bool,
}

impl PartPlay<'_> {
    /// Whether rules answer companies in it: what waits is asked of the database.
    fn answers_companies(&self) -> bool {
        answers_companies(self.plays)
    }
}

fn answers_companies(plays: &[ScheduledCalls]) -> bool {
    let is_rules = |call: &LessonCall| matches!(call, LessonCall::Rules(_));
    plays.iter().any(|play| play.calls.iter().any(is_rules))
}

/// Plays a part in memory.
///
/// # Errors
/// The part cannot begin, or a call is refused.
pub fn play_part(play: &PartPlay<'_>, answers: AnswersCompanies) -> Result<Session, RunError> {
    play_through(play, answers, &mut |_| {}, &mut |_, _| Ok(()))
}

/// The same, and tells after each week how many weeks of the company have passed.
///
/// # Errors
/// The same, and those of the one who is told.
pub fn play_part_telling(
    play: &PartPlay<'_>,
    answers: AnswersCompanies,
    tell: &mut dyn FnMut(&mut Session, u32) -> Result<(), RunError>,
) -> Result<Session, RunError> {
    play_through(play, answers, &mut |_| {}, tell)
}

/// The same; `watch` sees the company of every week when all is decided, before the week runs.
///
/// # Errors
/// The part cannot begin, or a call is refused.
pub(super) fn play_part_watched(
    play: &PartPlay<'_>,
    answers: AnswersCompanies,
    watch: &mut dyn FnMut(&Session),
) -> Result<Session, RunError> {
    play_through(play, answers, watch, &mut |_, _| Ok(()))
}

fn play_through(
    play: &PartPlay<'_>,
    answers: AnswersCompanies,
    watch: &mut dyn FnMut(&Session),
    tell: &mut dyn FnMut(&mut Session, u32) -> Result<(), RunError>,
) -> Result<Session, RunError> {
    let part = &play.lesson.plan.parts[play.part];
    let entry = LessonEntry { lesson: play.lesson.clone(), part: play.part, is_judged: play.is_judged };
    let new = NewRun {
        mode: Mode::Lesson,
        seed: play.seed,
        lesson: Some(entry),
        projection: play.asks_database || play.answers_companies(),
        ..NewRun::default()
    };
    let mut session = Session::create(new, &Configuration::shipped())?;
    session.company_answers = Some(answers);
    let last = play.weeks.unwrap_or(part.weeks()).min(part.weeks());
    for week in part.start_weeks..last {
        if session.ended().is_some() {
            break;
        }
        let made = play_week(&mut session, play, week, answers, watch);
        made.map_err(|refusal| {
            let name = &play.lesson.name;
            RunError::NotPossible(format!("lesson {name}, part {}, week {week}: {refusal}", play.part + 1))
        })?;
        tell(&mut session, week + 1)?;
    }
    Ok(session)
}

fn play_week(
    session: &mut Session,
    play: &PartPlay<'_>,
    week: u32,
    answers: AnswersCompanies,
    watch: &mut dyn FnMut(&Session),
) -> Result<(), Refusal> {
    let due = play.plays.iter().filter(|own| own.are_due(play.part, week));
    for call in due.flat_map(|own| &own.calls) {
        match call {
            LessonCall::Tool(tool, args) => {
                session.call(tool, args, Via::Script)?;
            }
            LessonCall::Rules(rules) => {
                for (tool, args) in answers(rules, session)? {
                    session.call(tool, &args, Via::Script)?;
                }
            }
        }
    }
    watch(session);
    let asked =
        session.lesson_step().is_some_and(|step| session.lesson().is_some_and(|own| own.awaits_guess(step)));
    if asked {
        session.guess_in_lesson(1.0)?;
    }
    let forecasts = session.naive_forecasts();
    session.advance("reference play", &forecasts, Via::Script, &mut |_| {}).map(|_| ())
}

impl Lesson {
    /// Whether a goal, a guess or a pitfall is measured by a statement.
    pub fn asks_database(&self) -> bool {
        let steps = self.plan.parts.iter().flat_map(|part| &part.steps);
        let goals = steps.clone().flat_map(|step| step.goals.iter().map(|goal| &goal.measurement));
        let guesses = steps.filter_map(|step| match &step.guess.as_ref()?.form {
            GuessForm::Number { outcome, .. } => Some(outcome),
            GuessForm::Choice { .. } => None,
        });
        let pitfalls = self.plan.pitfalls.iter().map(|pitfall| &pitfall.measurement);
        goals.chain(guesses).chain(pitfalls).any(|own| own.needs_database())
    }
}

impl Session {
    /// Says how rules answer companies: goals that are relative to a good play with rules are held against that. A step that
    /// has waited for it is judged now.
    pub fn answer_companies_by(&mut self, answers: AnswersCompanies) {
        self.company_answers = Some(answers);
        if self.recorder.is_some() && self.awaits_judgement() {
            self.settle_lesson();
        }
    }

    /// Whether the weeks of a step are over, and the next one has not begun.
    fn awaits_judgement(&self) -> bool {
        let Some(standing) = self.lesson.as_deref().filter(|_| self.history.ended.is_none()) else {
            return false;
        };
        let (part, weeks) = (standing.own_part(), self.weeks_passed());
        let step = weeks.checked_sub(1).and_then(|before| part.step_after(before));
        step.is_some_and(|step| {
            standing.has_begun(step) && !standing.has_begun(step + 1) && weeks == part.weeks_of(step).1
        })
    }

    /// Whether a step can be judged only by somebody who says how rules answer companies.
    pub(super) fn lacks_answers(&self, standing: &LessonStanding, step: usize) -> bool {
        let is_relative = |goal: &LessonGoal| matches!(goal.bound, GoalBound::OfGoodPlay(_));
        self.company_answers.is_none()
            && standing.step(step).is_some_and(|own| own.goals.iter().any(is_relative))
            && answers_companies(&standing.lesson.plan.good.plays)
    }

    /// What the good play has on the seed of this run for the goals of a step that are relative to it; none for the others,
    /// and where it cannot be played.
    pub(super) fn good_play_values(&self, standing: &LessonStanding, step: usize) -> Vec<Option<f64>> {
        let part = standing.own_part();
        let relative = |goal: &LessonGoal| matches!(goal.bound, GoalBound::OfGoodPlay(_));
        let goals = part.steps.get(step).map(|own| own.goals.as_slice()).unwrap_or_default();
        let (begin, end) = part.weeks_of(step);
        let play = PartPlay {
            lesson: &standing.lesson,
            part: standing.part,
            seed: Some(self.manifest.seed),
            plays: &standing.lesson.plan.good.plays,
            weeks: Some(end),
            // Its own goals would ask for the good play again.
            is_judged: false,
            asks_database: goals.iter().any(|goal| relative(goal) && goal.measurement.needs_database()),
        };
        let refuses: AnswersCompanies = |_, _| Err(Refusal::new("not_possible", "no rules"));
        let answers = self.company_answers.unwrap_or(refuses);
        let mut played = goals.iter().any(relative).then(|| play_part(&play, answers)).and_then(Result::ok);
        let from = begin * self.simulation.params.run.days_per_week;
        let mut value = |goal: &LessonGoal| {
            let played = played.as_mut().filter(|_| relative(goal))?;
            goal.measurement.of(played, from).ok().flatten()
        };
        goals.iter().map(&mut value).collect()
    }
}
