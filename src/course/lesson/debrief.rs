//! The debrief of a part of a lesson: compares the student's play with the reference play and the bad play.
//!
//! All plays start like the part and use the same interfaces, in memory. The student's play is re-simulated, too: decisions are
//! compared only if it reproduces the recorded cash of every day.

use serde::{Serialize, Serializer};

use std::thread;

use super::decisions::{PartedDecision, WeekDecisions, parted};
use super::page::{GoalPage, LessonQuestion, pitfalls, question};

use novamind_record::figures::{WeekFigure, WeekFigures};
use novamind_record::lesson::{
    LessonCall, LessonGoal, LessonStanding, NumberSource, Over, ReferencePlay, ScheduledCalls,
};
use novamind_record::trajectory::record::Ended;
use novamind_session::{
    AnswersCompanies, CompanyNames, JournalEntry, PartPlay, Session, lesson_step, play_part_watched,
};
use novamind_tools::{Refusal, ToolId, highest_named};
use novamind_world::params::Params;

/// A finished part of a lesson, from which the debrief is computed.
#[derive(Debug, Clone)]
pub struct PlayedPart {
    standing: LessonStanding,
    run: String,
    participant: Option<String>,
    seed: u64,
    cash_by_day: Vec<f64>,
    weeks: Vec<WeekFigures>,
    days_per_week: u32,
    ended: Option<Ended>,
    own: Vec<ScheduledCalls>,
}

/// The results of a part, with the reference play and the bad play on the same seed.
#[derive(Debug, Clone, PartialEq)]
pub struct Debrief {
    /// Title of the lesson.
    pub title: String,
    /// Learning goal of the lesson.
    pub learning_goal: String,
    /// Title of the part, if the lesson has several parts.
    pub part: Option<String>,
    /// Name of the run.
    pub run: String,
    /// Label of the student, if known.
    pub participant: Option<String>,
    /// Seed of the run.
    pub seed: u64,
    /// How the run ended.
    pub ended: Option<Ended>,
    /// First day on which the student decided.
    pub first_day: u32,
    /// Cash at the end of each day in dollars, from day 0.
    pub own: Vec<f64>,
    /// The reference play; `None` if it cannot be played.
    pub good: Option<ReferenceCurve>,
    /// The bad play; `None` if it cannot be played.
    pub bad: Option<ReferenceCurve>,
    /// The figure by which the part is judged, if it is not cash.
    pub judged_by: Option<JudgedFigure>,
    /// First difference between the student's decisions and the reference play.
    pub comparison: DecisionComparison,
    /// Questions and goals by step.
    pub steps: Vec<DebriefStep>,
    /// Day and text of each pitfall that was met.
    pub pitfalls: Vec<(u32, String)>,
    /// Explanation of the mechanism in Markdown; `None` while a part of the lesson is still to come.
    pub text: Option<String>,
}

impl Debrief {
    /// Returns the names of enterprises, which depend only on the seed.
    pub fn company_names(&self) -> CompanyNames {
        CompanyNames::new(self.seed, &Params::shipped().personas.email)
    }
}

/// The cash curve of the reference play or the bad play.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ReferenceCurve {
    /// Description of the play; `None` while a part of the lesson is still to come, because it would reveal the solution.
    pub text: Option<String>,
    /// Cash at the end of each day in dollars, from day 0.
    pub cash_by_day: Vec<f64>,
}

/// The weekly figure by which a part is judged, from the first goal of its last step. Values are by day, at the end of each week.
#[derive(Debug, Clone, PartialEq)]
pub struct JudgedFigure {
    /// The figure.
    pub figure: WeekFigure,
    /// The student's play.
    pub own: Vec<(u32, f64)>,
    /// The reference play; `None` if it cannot be played.
    pub good: Option<Vec<(u32, f64)>>,
    /// The bad play; `None` if it cannot be played.
    pub bad: Option<Vec<(u32, f64)>>,
}

/// The comparison of the student's decisions with the reference play.
#[derive(Debug, Clone, PartialEq)]
pub enum DecisionComparison {
    /// The decisions differ.
    Parted(FirstDifference),
    /// The decisions are the same in every week.
    Same,
    /// The part requires no decision.
    Nothing,
    /// One of the plays cannot be re-simulated, or the student's play has a different result.
    Unknown,
}

/// The first week in which the decisions differ from the reference play.
#[derive(Debug, Clone, PartialEq)]
pub struct FirstDifference {
    /// Week of the company, counted from 1.
    pub week: u32,
    /// First day of the week.
    pub day: u32,
    /// The decisions that differ.
    pub decisions: Vec<PartedDecision>,
    /// Effect of these decisions of the reference play in the student's run.
    pub effect: DecisionEffect,
}

/// The outcome of applying decisions of the reference play to the student's run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum DecisionEffect {
    /// The decisions were simulated.
    Simulated(PartingEffect),
    /// The decisions are rejected in the student's run.
    Refused,
    /// Later calls name customers, which would have different numbers.
    OtherCustomers,
}

impl DecisionEffect {
    /// Returns the effect, or `None` if it was not simulated.
    pub fn simulated(self) -> Option<PartingEffect> {
        match self {
            DecisionEffect::Simulated(effect) => Some(effect),
            DecisionEffect::Refused | DecisionEffect::OtherCustomers => None,
        }
    }
}

/// The result of the run with the decisions of the reference play in one week and all other decisions unchanged.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PartingEffect {
    /// Last day of both simulations.
    pub day: u32,
    /// Cash of the run, dollars.
    pub own: f64,
    /// Cash with the decisions of the reference play, dollars.
    pub with: f64,
    /// Both values of the figure by which the part is judged, if it is not cash.
    #[serde(skip)]
    pub judged: Option<(f64, f64)>,
}

/// The questions, goals and results of a step.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DebriefStep {
    /// Title of the step.
    pub title: String,
    /// Number of tries.
    pub tries: u32,
    /// Number of hints taken, and of all hints.
    #[serde(serialize_with = "used_of")]
    pub hints: (usize, usize),
    /// The question with guess and outcome.
    pub question: Option<LessonQuestion>,
    /// The goals of the step.
    pub goals: Vec<GoalPage>,
}

fn used_of<S: Serializer>((used, of): &(usize, usize), serializer: S) -> Result<S::Ok, S::Error> {
    serde_json::json!({ "used": used, "of": of }).serialize(serializer)
}

/// Returns the student's calls by week, without those of the start and of the lesson itself.
fn own_calls(session: &Session, standing: &LessonStanding) -> Vec<ScheduledCalls> {
    let part = standing.own_part();
    let of_lesson = |tool: ToolId| part.moves_capacity() && tool == ToolId::SetCapacityTier;
    let starts = part.start.iter().flat_map(|own| &own.calls);
    let starts = starts.filter(|call| !matches!(call, LessonCall::Tool(tool, _) if of_lesson(*tool))).count();
    let days = session.params().run.days_per_week;
    let calls = session.journal().iter().filter_map(|entry| match entry {
        JournalEntry::Call { day, tool, args, .. } if !of_lesson(*tool) => Some((*day, *tool, args.clone())),
        _ => None,
    });
    let scheduled = |(day, tool, args)| ScheduledCalls {
        part: standing.part,
        week: day / days,
        every: None,
        until: None,
        calls: vec![LessonCall::Tool(tool, args)],
    };
    calls.skip(starts).map(scheduled).collect()
}

/// Returns a figure at the end of each week that has a value.
fn by_day(figure: WeekFigure, weeks: &[WeekFigures]) -> Vec<(u32, f64)> {
    weeks.iter().filter_map(|week| Some((week.day, figure.of_week(week)?))).collect()
}

/// A simulated play of the part.
struct Played {
    cash_by_day: Vec<f64>,
    figures: Vec<WeekFigures>,
    weeks: Vec<WeekDecisions>,
}

impl PlayedPart {
    /// Reads the part that a session has finished.
    ///
    /// # Errors
    /// `not_in_a_lesson`, `lesson_not_over`.
    pub fn of(session: &Session) -> Result<PlayedPart, Refusal> {
        let Some(standing) = session.lesson() else {
            let message = "this run does not belong to a lesson; novamind lesson list shows all lessons";
            return Err(Refusal::new("not_in_a_lesson", message));
        };
        if lesson_step(session).is_some() {
            let message =
                "the debrief is available when this part of the lesson has ended; lesson shows the task";
            return Err(Refusal::new("lesson_not_over", message));
        }
        let manifest = session.manifest();
        Ok(PlayedPart {
            standing: standing.clone(),
            run: manifest.id.clone(),
            participant: manifest.participant.clone(),
            seed: manifest.seed,
            cash_by_day: session.cash_by_day().to_vec(),
            weeks: session.weeks().to_vec(),
            days_per_week: session.params().run.days_per_week,
            ended: session.ended(),
            own: own_calls(session, standing),
        })
    }

    /// Computes the debrief. Simulates the part up to four times in memory; `answers` answers enterprises in plays that use rules.
    pub fn debrief(&self, answers: AnswersCompanies) -> Debrief {
        let plan = &self.standing.lesson.plan;
        let [good, bad, own] = thread::scope(|scope| {
            let plays = [&plan.good.plays, &plan.bad.plays, &self.own];
            let begun = plays.map(|calls| scope.spawn(move || self.play(calls, answers)));
            begun.map(|play| play.join().ok().flatten())
        });
        let (part, decides) = (self.standing.part, plan.good.plays_in(self.standing.part));
        let both = good.as_ref().zip(own.as_ref());
        let comparison = match both {
            _ if !decides => DecisionComparison::Nothing,
            Some((good, own)) => self.compared(good, own, answers),
            None => DecisionComparison::Unknown,
        };
        let judged_by = self.judged_by().map(|figure| {
            let of = |played: &Option<Played>| {
                played.as_ref().filter(|_| decides).map(|own| by_day(figure, &own.figures))
            };
            JudgedFigure { figure, own: by_day(figure, &self.weeks), good: of(&good), bad: of(&bad) }
        });
        let is_last = self.standing.part + 1 == plan.parts.len();
        let curve = |played: Option<Played>, play: &ReferencePlay| {
            let text = is_last.then(|| play.text_of(part).to_owned());
            let played = played.filter(|_| decides);
            played.map(|own| ReferenceCurve { text, cash_by_day: own.cash_by_day })
        };
        let part = self.standing.own_part();
        Debrief {
            title: plan.title.clone(),
            learning_goal: plan.learning_goal.clone(),
            part: (plan.parts.len() > 1).then(|| part.title.clone()),
            run: self.run.clone(),
            participant: self.participant.clone(),
            seed: self.seed,
            ended: self.ended,
            first_day: part.start_weeks * self.days_per_week,
            own: self.cash_by_day.clone(),
            good: curve(good, &plan.good),
            bad: curve(bad, &plan.bad),
            judged_by,
            comparison,
            steps: self.steps(),
            pitfalls: pitfalls(&self.standing),
            text: is_last.then(|| self.standing.lesson.filled(&self.standing.lesson.debrief)),
        }
    }

    /// Returns the figure of the first goal of the last step with goals, if it is a figure of the last week other than cash.
    fn judged_by(&self) -> Option<WeekFigure> {
        let steps = &self.standing.own_part().steps;
        let goal = steps.iter().rev().find_map(|step| step.goals.first())?;
        match (&goal.measurement.source, goal.measurement.over) {
            (NumberSource::Figure(figure), Over::End) => Some(*figure),
            _ => None,
        }
    }

    fn play(&self, calls: &[ScheduledCalls], answers: AnswersCompanies) -> Option<Played> {
        let play = PartPlay {
            lesson: &self.standing.lesson,
            part: self.standing.part,
            seed: Some(self.seed),
            plays: calls,
            weeks: Some((self.cash_by_day.len() as u32).saturating_sub(1).div_ceil(self.days_per_week)),
            is_judged: false,
            asks_database: false,
        };
        let mut weeks = Vec::new();
        let mut watch = |session: &Session| weeks.push(WeekDecisions::of(session));
        let played = play_part_watched(&play, answers, &mut watch, &mut |_, _| Ok(())).ok()?;
        let (cash_by_day, figures) = (played.cash_by_day().to_vec(), played.weeks().to_vec());
        Some(Played { cash_by_day, figures, weeks })
    }

    /// Compares the student's decisions with those of the reference play.
    fn compared(&self, good: &Played, own: &Played, answers: AnswersCompanies) -> DecisionComparison {
        if own.cash_by_day != self.cash_by_day {
            return DecisionComparison::Unknown;
        }
        let both = own.weeks.iter().zip(&good.weeks);
        let mut parts = both.map(|(own, good)| parted(own, good)).enumerate();
        let Some((at, decisions)) = parts.find(|(_, parted)| !parted.is_empty()) else {
            return DecisionComparison::Same;
        };
        let before = self.standing.own_part().start_weeks + at as u32;
        let with = self.with_decisions(before, &decisions, &good.weeks[at]);
        let effect = match self.names_customers_after(before) {
            true => DecisionEffect::OtherCustomers,
            false => self
                .play(&with, answers)
                .and_then(|played| self.effect_of(&played))
                .map_or(DecisionEffect::Refused, DecisionEffect::Simulated),
        };
        let day = before * self.days_per_week;
        DecisionComparison::Parted(FirstDifference { week: before + 1, day, decisions, effect })
    }

    /// Whether calls of later weeks name customers, whose numbers depend on earlier decisions.
    fn names_customers_after(&self, week: u32) -> bool {
        let later = self.own.iter().filter(|own| own.week > week).flat_map(|own| &own.calls);
        later.into_iter().any(|call| match call {
            LessonCall::Tool(tool, args) => highest_named(*tool, args).is_some(),
            _ => false,
        })
    }

    fn effect_of(&self, played: &Played) -> Option<PartingEffect> {
        let (own, with) = (*self.cash_by_day.last()?, *played.cash_by_day.last()?);
        let judged = self.judged_by().and_then(|figure| {
            let last = |weeks: &[WeekFigures]| figure.of_week(weeks.last()?);
            last(&self.weeks).zip(last(&played.figures))
        });
        Some(PartingEffect { day: played.cash_by_day.len() as u32 - 1, own, with, judged })
    }

    /// Returns the student's calls, with the differing calls of one week replaced by those of the reference play.
    fn with_decisions(
        &self,
        week: u32,
        decisions: &[PartedDecision],
        good: &WeekDecisions,
    ) -> Vec<ScheduledCalls> {
        let differs = |tool: &ToolId| decisions.iter().any(|decision| decision.tool == *tool);
        let is_other = |own: &&ScheduledCalls| {
            let call = own.calls.first();
            own.week == week && matches!(call, Some(LessonCall::Tool(tool, _)) if differs(tool))
        };
        let mut calls: Vec<ScheduledCalls> = self.own.iter().filter(|own| !is_other(own)).cloned().collect();
        let made = good.calls_of(&differs).into_iter().map(|(tool, args)| LessonCall::Tool(tool, args));
        calls.push(ScheduledCalls {
            part: self.standing.part,
            week,
            every: None,
            until: None,
            calls: made.collect(),
        });
        calls
    }

    fn steps(&self) -> Vec<DebriefStep> {
        let standing = &self.standing;
        let begun = (0..standing.own_part().steps.len()).filter(|step| standing.has_begun(*step));
        begun.filter_map(|step| result_of_step(standing, step)).collect()
    }
}

/// Returns the question, the goals and the results of a step, or `None` if the step does not exist.
pub(super) fn result_of_step(standing: &LessonStanding, step: usize) -> Option<DebriefStep> {
    let own = standing.step(step)?;
    let judged = standing.goals(step);
    let page = |(at, goal): (usize, &LessonGoal)| GoalPage::of(standing, goal, judged.get(at).copied());
    Some(DebriefStep {
        title: own.title.clone(),
        tries: standing.tries(step),
        hints: (standing.hints(step), own.hints.len()),
        question: question(standing, step),
        goals: own.goals.iter().enumerate().map(page).collect(),
    })
}
