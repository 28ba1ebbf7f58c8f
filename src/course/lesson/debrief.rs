//! The debrief of a part of a lesson: compares the student's play with the reference play and the pitfall play.
//!
//! All plays start from the same state and are simulated in memory. The student's play is also re-simulated.
//! Decisions are compared only if this re-simulation reproduces the recorded cash of every day.

use serde::{Serialize, Serializer};

use std::thread;

use super::decisions::{DifferentDecision, WeekDecisions, different_decisions};
use super::status::{GoalStatus, LessonQuestion, step_question, triggered_pitfalls};

use novamind_record::figures::{WeekFigure, WeekFigures};
use novamind_record::lesson::{
    LessonCall, LessonGoal, LessonProgress, NumberSource, ReferencePlay, ScheduledCalls, WeekAggregation,
};
use novamind_record::trajectory::record::RunEndReason;
use novamind_session::{
    EnterpriseNames, JournalEntry, PartPlay, RuleEvaluator, Session, lesson_step, play_part_with_hooks,
};
use novamind_tools::{Rejection, ToolId, highest_customer};
use novamind_world::params::Params;

/// A finished part of a lesson, from which the debrief is computed.
#[derive(Debug, Clone)]
pub struct FinishedPart {
    lesson_progress: LessonProgress,
    run: String,
    participant: Option<String>,
    seed: u64,
    cash_by_day: Vec<f64>,
    weeks: Vec<WeekFigures>,
    days_per_week: u32,
    ended: Option<RunEndReason>,
    calls: Vec<ScheduledCalls>,
}

/// The results of a part, compared with the reference play and the pitfall play on the same seed.
#[derive(Debug, Clone, PartialEq)]
pub struct Debrief {
    /// Title of the lesson.
    pub title: String,
    /// What the student should learn from the lesson.
    pub learning_goal: String,
    /// Title of the part, if the lesson has several parts.
    pub part: Option<String>,
    /// Name of the student's run.
    pub run: String,
    /// Label of the student, if known.
    pub participant: Option<String>,
    /// Seed of the student's run.
    pub seed: u64,
    /// Reason why the run ended, if it has ended.
    pub ended: Option<RunEndReason>,
    /// First day on which the student decided.
    pub first_day: u32,
    /// Cash of the student's run at the end of each day in dollars, from day 0.
    pub cash_by_day: Vec<f64>,
    /// Cash curve of the reference play; `None` if the play has no calls in the part or cannot be simulated.
    pub reference: Option<ReferenceCurve>,
    /// Cash curve of the pitfall play; `None` if the reference play has no calls in the part or this play cannot be
    /// simulated.
    pub bad_play: Option<ReferenceCurve>,
    /// The figure by which the part is judged; `None` if the part is judged by cash.
    pub judged_by: Option<JudgedFigure>,
    /// Whether and where the student's decisions first differ from the reference play.
    pub comparison: DecisionComparison,
    /// Questions, goals and their results, by step.
    pub steps: Vec<DebriefStep>,
    /// Day and explanation of each pitfall that the student triggered.
    pub pitfalls: Vec<(u32, String)>,
    /// Explanation of the mechanism in Markdown; `None` unless this is the last part of the lesson.
    pub text: Option<String>,
}

impl Debrief {
    /// Returns the names of enterprises. The names depend only on the seed.
    pub fn enterprise_names(&self) -> EnterpriseNames {
        EnterpriseNames::new(self.seed, &Params::bundled().personas.email)
    }
}

/// The cash curve of the reference play or the pitfall play.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ReferenceCurve {
    /// Description of the play; `None` before the last part of the lesson, because the text would reveal the solution.
    pub text: Option<String>,
    /// Cash at the end of each day in dollars, from day 0.
    pub cash_by_day: Vec<f64>,
}

/// The weekly figure by which a part is judged: the figure of the first goal in the last step that has goals.
#[derive(Debug, Clone, PartialEq)]
pub struct JudgedFigure {
    /// Weekly figure that the ranked goal measures.
    pub figure: WeekFigure,
    /// Day and value at the end of each week of the student's run.
    pub actual: Vec<(u32, f64)>,
    /// Values of the reference play; `None` if the play cannot be simulated.
    pub reference: Option<Vec<(u32, f64)>>,
    /// Values of the pitfall play; `None` if the play cannot be simulated.
    pub bad_play: Option<Vec<(u32, f64)>>,
}

/// Result of comparing the student's decisions with the reference play.
#[derive(Debug, Clone, PartialEq)]
pub enum DecisionComparison {
    /// The decisions differ. Contains the first week in which they do.
    Different(FirstDifference),
    /// The decisions are the same in every week.
    Same,
    /// The part requires no decisions from the student.
    NoDecisions,
    /// One of the plays cannot be re-simulated, or the re-simulation of the student's play has a different result.
    NotComparable,
}

/// The first week in which the student's decisions differ from those of the reference play.
#[derive(Debug, Clone, PartialEq)]
pub struct FirstDifference {
    /// Week of the run, counted from 1.
    pub week: u32,
    /// First day of this week.
    pub day: u32,
    /// The decisions of this week that differ.
    pub decisions: Vec<DifferentDecision>,
    /// Effect of replacing this week's differing decisions with those of the reference play.
    pub effect: DecisionEffect,
}

/// The outcome of applying decisions of the reference play to the student's run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum DecisionEffect {
    /// The student's run was simulated with the decisions of the reference play.
    Simulated(ReferenceEffect),
    /// The decisions of the reference play are rejected in the student's run.
    Rejected,
    /// The effect was not simulated, because later calls refer to customers by number, and the replaced decisions would
    /// change these numbers.
    DifferentCustomers,
}

impl DecisionEffect {
    /// Returns the simulated effect, or `None` if the decisions were not simulated.
    pub fn as_simulated(self) -> Option<ReferenceEffect> {
        match self {
            DecisionEffect::Simulated(effect) => Some(effect),
            DecisionEffect::Rejected | DecisionEffect::DifferentCustomers => None,
        }
    }
}

/// Results of the student's run, as played and with the decisions of the reference play in one week.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ReferenceEffect {
    /// Last day that both simulations reached.
    pub day: u32,
    /// Cash at the end of `day` with the student's decisions, in dollars.
    pub own: f64,
    /// Cash at the end of `day` with the decisions of the reference play in one week, in dollars.
    pub with: f64,
    /// Values of the judged figure with the student's decisions and with those of the reference play; `None` if the
    /// part is judged by cash.
    #[serde(skip)]
    pub judged: Option<(f64, f64)>,
}

/// The question, goals and results of a step.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DebriefStep {
    /// Title of the step.
    pub title: String,
    /// Number of tries of the step.
    pub tries: u32,
    /// Number of hints that the student used, and the number of hints that the step has.
    #[serde(serialize_with = "serialize_hint_usage")]
    pub hints: (usize, usize),
    /// The question with the student's guess and the actual value; `None` if the step has no question.
    pub question: Option<LessonQuestion>,
    /// The goals of the step.
    pub goals: Vec<GoalStatus>,
}

fn serialize_hint_usage<S: Serializer>(
    (used, of): &(usize, usize),
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serde_json::json!({ "used": used, "of": of }).serialize(serializer)
}

/// Returns the student's tool calls by week. Excludes the lesson's own calls: those at the start of the part, and
/// capacity changes.
fn student_calls(session: &Session, lesson_progress: &LessonProgress) -> Vec<ScheduledCalls> {
    let part = lesson_progress.current_part();
    let is_set_by_lesson = |tool: ToolId| part.has_automatic_capacity() && tool == ToolId::SetCapacityTier;
    let starts = part.start.iter().flat_map(|scheduled_calls| &scheduled_calls.calls);
    let starts =
        starts.filter(|call| !matches!(call, LessonCall::Tool(tool, _) if is_set_by_lesson(*tool))).count();
    let days = session.params().run.days_per_week;
    let calls = session.journal().iter().filter_map(|entry| match entry {
        JournalEntry::Call { day, tool, args, .. } if !is_set_by_lesson(*tool) => {
            Some((*day, *tool, args.clone()))
        }
        _ => None,
    });
    let scheduled = |(day, tool, args)| ScheduledCalls {
        part: lesson_progress.part,
        week: day / days,
        every: None,
        until: None,
        calls: vec![LessonCall::Tool(tool, args)],
    };
    calls.skip(starts).map(scheduled).collect()
}

/// Returns the day and the value of a figure at the end of each week. Omits weeks without a value.
fn figure_by_day(figure: WeekFigure, weeks: &[WeekFigures]) -> Vec<(u32, f64)> {
    weeks.iter().filter_map(|week| Some((week.day, figure.company_value(week)?))).collect()
}

/// A simulated play of the part.
struct PlayResult {
    cash_by_day: Vec<f64>,
    figures: Vec<WeekFigures>,
    weeks: Vec<WeekDecisions>,
}

impl FinishedPart {
    /// Reads the part that a session has finished.
    ///
    /// # Errors
    /// `not_in_a_lesson`, `lesson_not_over`.
    pub fn from_session(session: &Session) -> Result<FinishedPart, Rejection> {
        let Some(lesson_progress) = session.lesson() else {
            let message = "this run is not part of a lesson; `novamind lesson list` lists the lessons";
            return Err(Rejection::new("not_in_a_lesson", message));
        };
        if lesson_step(session).is_some() {
            let message =
                "the debrief is available after this part of the lesson has ended; `lesson` shows the task";
            return Err(Rejection::new("lesson_not_over", message));
        }
        let manifest = session.manifest();
        Ok(FinishedPart {
            lesson_progress: lesson_progress.clone(),
            run: manifest.id.clone(),
            participant: manifest.participant.clone(),
            seed: manifest.seed,
            cash_by_day: session.cash_by_day().to_vec(),
            weeks: session.weeks().to_vec(),
            days_per_week: session.params().run.days_per_week,
            ended: session.ended(),
            calls: student_calls(session, lesson_progress),
        })
    }

    /// Computes the debrief of the part. The part is simulated up to four times in memory. `answers` evaluates the
    /// rules that plays use to answer enterprises.
    pub fn debrief(&self, answers: RuleEvaluator) -> Debrief {
        let plan = &self.lesson_progress.lesson.plan;
        let [good, bad, play_result] = thread::scope(|scope| {
            let plays = [&plan.good.plays, &plan.bad.plays, &self.calls];
            let started = plays.map(|calls| scope.spawn(move || self.simulate_calls(calls, answers)));
            started.map(|play| play.join().ok().flatten())
        });
        let (part, decides) =
            (self.lesson_progress.part, plan.good.has_calls_for_part(self.lesson_progress.part));
        let both = good.as_ref().zip(play_result.as_ref());
        let comparison = match both {
            _ if !decides => DecisionComparison::NoDecisions,
            Some((good, result)) => self.compare_decisions(good, result, answers),
            None => DecisionComparison::NotComparable,
        };
        let judged_by = self.judged_figure().map(|figure| {
            let of = |played: &Option<PlayResult>| {
                played.as_ref().filter(|_| decides).map(|result| figure_by_day(figure, &result.figures))
            };
            JudgedFigure {
                figure,
                actual: figure_by_day(figure, &self.weeks),
                reference: of(&good),
                bad_play: of(&bad),
            }
        });
        let is_last = self.lesson_progress.part + 1 == plan.parts.len();
        let curve = |played: Option<PlayResult>, play: &ReferencePlay| {
            let text = is_last.then(|| play.part_description(part).to_owned());
            let played = played.filter(|_| decides);
            played.map(|result| ReferenceCurve { text, cash_by_day: result.cash_by_day })
        };
        let part = self.lesson_progress.current_part();
        Debrief {
            title: plan.title.clone(),
            learning_goal: plan.learning_goal.clone(),
            part: (plan.parts.len() > 1).then(|| part.title.clone()),
            run: self.run.clone(),
            participant: self.participant.clone(),
            seed: self.seed,
            ended: self.ended,
            first_day: part.start_weeks * self.days_per_week,
            cash_by_day: self.cash_by_day.clone(),
            reference: curve(good, &plan.good),
            bad_play: curve(bad, &plan.bad),
            judged_by,
            comparison,
            steps: self.step_results(),
            pitfalls: triggered_pitfalls(&self.lesson_progress),
            text: is_last
                .then(|| self.lesson_progress.lesson.fill_figures(&self.lesson_progress.lesson.debrief)),
        }
    }

    /// Returns the figure of the first goal in the last step that has goals. Returns `None` if this goal is
    /// not about the last value of a weekly figure.
    fn judged_figure(&self) -> Option<WeekFigure> {
        let steps = &self.lesson_progress.current_part().steps;
        let goal = steps.iter().rev().find_map(|step| step.goals.first())?;
        match (&goal.measurement.source, goal.measurement.aggregation) {
            (NumberSource::Figure(figure), WeekAggregation::Last) => Some(*figure),
            _ => None,
        }
    }

    fn simulate_calls(&self, calls: &[ScheduledCalls], answers: RuleEvaluator) -> Option<PlayResult> {
        let play = PartPlay {
            lesson: &self.lesson_progress.lesson,
            part: self.lesson_progress.part,
            seed: Some(self.seed),
            scheduled_calls: calls,
            weeks: Some((self.cash_by_day.len() as u32).saturating_sub(1).div_ceil(self.days_per_week)),
            is_judged: false,
            needs_database: false,
        };
        let mut weeks = Vec::new();
        let mut watch = |session: &Session| weeks.push(WeekDecisions::from_session(session));
        let played = play_part_with_hooks(&play, answers, &mut watch, &mut |_, _| Ok(())).ok()?;
        let (cash_by_day, figures) = (played.cash_by_day().to_vec(), played.weeks().to_vec());
        Some(PlayResult { cash_by_day, figures, weeks })
    }

    /// Compares the student's decisions with the decisions of the reference play.
    fn compare_decisions(
        &self,
        good: &PlayResult,
        play_result: &PlayResult,
        answers: RuleEvaluator,
    ) -> DecisionComparison {
        if play_result.cash_by_day != self.cash_by_day {
            return DecisionComparison::NotComparable;
        }
        let both = play_result.weeks.iter().zip(&good.weeks);
        let mut parts =
            both.map(|(week_decisions, good)| different_decisions(week_decisions, good)).enumerate();
        let Some((at, decisions)) = parts.find(|(_, parted)| !parted.is_empty()) else {
            return DecisionComparison::Same;
        };
        let before = self.lesson_progress.current_part().start_weeks + at as u32;
        let with = self.calls_with_decisions(before, &decisions, &good.weeks[at]);
        let effect = match self.refers_to_customers_after(before) {
            true => DecisionEffect::DifferentCustomers,
            false => self
                .simulate_calls(&with, answers)
                .and_then(|played| self.measure_effect(&played))
                .map_or(DecisionEffect::Rejected, DecisionEffect::Simulated),
        };
        let day = before * self.days_per_week;
        DecisionComparison::Different(FirstDifference { week: before + 1, day, decisions, effect })
    }

    /// Returns whether tool calls of later weeks refer to customers by number. These numbers depend on earlier
    /// decisions.
    fn refers_to_customers_after(&self, week: u32) -> bool {
        let later = self
            .calls
            .iter()
            .filter(|scheduled_calls| scheduled_calls.week > week)
            .flat_map(|calls| &calls.calls);
        later.into_iter().any(|call| match call {
            LessonCall::Tool(tool, args) => highest_customer(*tool, args).is_some(),
            _ => false,
        })
    }

    fn measure_effect(&self, played: &PlayResult) -> Option<ReferenceEffect> {
        let (value, with) = (*self.cash_by_day.last()?, *played.cash_by_day.last()?);
        let judged = self.judged_figure().and_then(|figure| {
            let last = |weeks: &[WeekFigures]| figure.company_value(weeks.last()?);
            last(&self.weeks).zip(last(&played.figures))
        });
        Some(ReferenceEffect { day: played.cash_by_day.len() as u32 - 1, own: value, with, judged })
    }

    /// Returns the student's tool calls, in which the reference play's calls replace the differing calls of one week.
    fn calls_with_decisions(
        &self,
        week: u32,
        decisions: &[DifferentDecision],
        good: &WeekDecisions,
    ) -> Vec<ScheduledCalls> {
        let differs = |tool: &ToolId| decisions.iter().any(|decision| decision.tool == *tool);
        let is_other = |scheduled_calls: &&ScheduledCalls| {
            let call = scheduled_calls.calls.first();
            scheduled_calls.week == week && matches!(call, Some(LessonCall::Tool(tool, _)) if differs(tool))
        };
        let mut calls: Vec<ScheduledCalls> =
            self.calls.iter().filter(|scheduled_calls| !is_other(scheduled_calls)).cloned().collect();
        let made =
            good.calls_for_tools(&differs).into_iter().map(|(tool, args)| LessonCall::Tool(tool, args));
        calls.push(ScheduledCalls {
            part: self.lesson_progress.part,
            week,
            every: None,
            until: None,
            calls: made.collect(),
        });
        calls
    }

    fn step_results(&self) -> Vec<DebriefStep> {
        let lesson_progress = &self.lesson_progress;
        let started =
            (0..lesson_progress.current_part().steps.len()).filter(|step| lesson_progress.has_started(*step));
        started.filter_map(|step| step_result(lesson_progress, step)).collect()
    }
}

/// Returns the question, the goals and the results of a step, or `None` if the step does not exist.
pub(super) fn step_result(lesson_progress: &LessonProgress, step: usize) -> Option<DebriefStep> {
    let lesson_step = lesson_progress.step(step)?;
    let judged = lesson_progress.goal_results(step);
    let page =
        |(at, goal): (usize, &LessonGoal)| GoalStatus::new(lesson_progress, goal, judged.get(at).copied());
    Some(DebriefStep {
        title: lesson_step.title.clone(),
        tries: lesson_progress.attempt(step),
        hints: (lesson_progress.hint_count(step), lesson_step.hints.len()),
        question: step_question(lesson_progress, step),
        goals: lesson_step.goals.iter().enumerate().map(page).collect(),
    })
}
