//! `NAME.toml`: what a lesson is (docs/lessons/authors-guide.md).

use std::collections::BTreeMap;

use serde::Deserialize;
use toml::Value;

use super::lesson_call::LessonCall;
use super::measurement::{Measurement, MeasurementFile};
use novamind_tools::ToolId;

/// What the file of a lesson says.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LessonPlan {
    /// What a student reads as its title.
    pub title: String,
    /// Minutes that a student needs.
    pub minutes: u32,
    /// What the student can do, or knows, afterwards.
    pub learning_goal: String,
    /// What of the program the student has.
    #[serde(default)]
    pub access: LessonAccess,
    /// Companies, in the order in which they are played.
    #[serde(rename = "part")]
    pub parts: Vec<LessonPart>,
    /// What goes wrong often, and what is said then.
    #[serde(rename = "pitfall", default)]
    pub pitfalls: Vec<Pitfall>,
    /// A play that reaches every goal.
    pub good: ReferencePlay,
    /// A play that misses a goal and meets a pitfall.
    pub bad: ReferencePlay,
    /// Figures that the texts name, each held true by the check.
    #[serde(rename = "measured", default)]
    pub measured: Vec<MeasuredFigure>,
}

/// What of the program a student has.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct LessonAccess {
    /// The tools; all where none are named.
    pub tools: Option<Vec<ToolId>>,
    /// The screens besides the Overview; all where none are named.
    pub screens: Option<Vec<String>>,
    /// What is asked of forecasts before a week.
    pub forecasts: ForecastsAsked,
    /// What is asked of the rationale of a week.
    pub rationale: RationaleAsked,
}

impl LessonAccess {
    /// Whether the lesson fills in the forecasts of a week naively.
    pub fn fills_forecasts(&self) -> bool {
        self.forecasts == ForecastsAsked::Naive
    }

    /// Whether a week runs without a rationale.
    pub fn asks_no_rationale(&self) -> bool {
        self.rationale == RationaleAsked::Off
    }
}

/// What is asked of forecasts before a week.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ForecastsAsked {
    /// The student makes them.
    Required,
    /// They are filled in naively.
    #[default]
    Naive,
}

/// What is asked of the rationale of a week.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum RationaleAsked {
    /// The student writes it.
    Required,
    /// The week runs without.
    #[default]
    Off,
}

/// A company of a lesson, and what is done with it.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LessonPart {
    /// What tells it from the other parts.
    #[serde(default)]
    pub title: String,
    /// Its scenario.
    #[serde(default = "default_scenario")]
    pub scenario: String,
    /// The seed that a student plays.
    pub seed: u64,
    /// Cash on day 0, dollars; as the scenario says if left out.
    pub cash: Option<f64>,
    /// Last day of the company, which enters the mechanics; as the scenario says if left out. The lesson ends before.
    pub days: Option<u32>,
    /// Whether there are demand surges.
    #[serde(default)]
    pub surges: bool,
    /// Who moves the capacity.
    #[serde(default)]
    pub capacity: CapacityMover,
    /// Parameters in force from day 0, by their full keys.
    #[serde(default)]
    pub parameters: BTreeMap<String, Value>,
    /// Weeks that are played before the student sees the company.
    #[serde(default)]
    pub start_weeks: u32,
    /// Calls before the student sees the company.
    #[serde(default)]
    pub start: Vec<ScheduledCalls>,
    /// Steps, in their order.
    #[serde(rename = "step")]
    pub steps: Vec<LessonStep>,
}

impl LessonPart {
    /// Whether the capacity follows usage by itself.
    pub fn moves_capacity(&self) -> bool {
        self.capacity == CapacityMover::FollowsUsage
    }
}

/// Who moves the capacity.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
pub enum CapacityMover {
    /// The student.
    #[default]
    #[serde(rename = "manual")]
    Student,
    /// It moves by itself: one tier a week towards the one that usage needs.
    #[serde(rename = "follows usage")]
    FollowsUsage,
}

fn default_scenario() -> String {
    crate::folder::configuration::DEFAULT_SCENARIO.to_owned()
}

/// A step of a lesson: a task over some weeks.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LessonStep {
    /// Its title.
    pub title: String,
    /// What the student reads.
    pub text: String,
    /// Weeks that it takes.
    pub weeks: u32,
    /// Parameters that the lesson sets at its beginning, by their full keys.
    #[serde(default)]
    pub parameters: BTreeMap<String, Value>,
    /// What is asked before its weeks run.
    pub guess: Option<Guess>,
    /// What is to be reached.
    #[serde(rename = "goal", default)]
    pub goals: Vec<LessonGoal>,
    /// Hints, from a nudge to nearly the answer.
    #[serde(default)]
    pub hints: Vec<String>,
}

/// A question that is asked before the weeks of a step run.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(try_from = "GuessFile")]
pub struct Guess {
    /// The question.
    pub question: String,
    /// What kind of answer it takes.
    pub form: GuessForm,
    /// When the outcome is told.
    pub told: GuessTold,
}

/// When what came of a question is measured and told.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum GuessTold {
    /// At the end of its step.
    #[default]
    Step,
    /// At the end of the part.
    Part,
}

/// What kind of answer a question takes.
#[derive(Debug, Clone, PartialEq)]
pub enum GuessForm {
    /// A number; what came of it is measured at the end of the step.
    Number {
        /// What was to be guessed.
        outcome: Measurement,
        /// What it is counted in: `$`, `%`, or a word.
        unit: String,
    },
    /// One of some answers.
    Choice {
        /// What can be chosen.
        choices: Vec<String>,
        /// Number of the right one, counted from 0.
        answer: usize,
    },
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct GuessFile {
    question: String,
    figure: Option<String>,
    sql: Option<String>,
    over: Option<String>,
    unit: Option<String>,
    choices: Option<Vec<String>>,
    answer: Option<usize>,
    #[serde(default)]
    told: GuessTold,
}

impl TryFrom<GuessFile> for Guess {
    type Error = String;

    fn try_from(file: GuessFile) -> Result<Guess, String> {
        let GuessFile { question, figure, sql, over, unit, choices, answer, told } = file;
        let form = match (choices, answer) {
            (None, None) => GuessForm::Number {
                outcome: Measurement::try_from(MeasurementFile { figure, sql, over })?,
                unit: unit.unwrap_or_default(),
            },
            (Some(choices), Some(answer)) if figure.is_none() && sql.is_none() => {
                if choices.len() < 2 || !(1..=choices.len()).contains(&answer) {
                    return Err("choices are two or more, and answer is the number of one of them".to_owned());
                }
                GuessForm::Choice { choices, answer: answer - 1 }
            }
            _ => return Err("a guess has a figure or sql, or choices with an answer".to_owned()),
        };
        Ok(Guess { question, form, told })
    }
}

/// Something to be reached in a step.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(try_from = "GoalFile")]
pub struct LessonGoal {
    /// What the student reads.
    pub text: String,
    /// What is measured at the end of the step.
    pub measurement: Measurement,
    /// How far it has to go.
    pub bound: GoalBound,
    /// Whether it counts dollars.
    pub in_dollars: bool,
}

/// How far a figure has to go.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum GoalBound {
    /// At least so much.
    AtLeast(f64),
    /// At most so much.
    AtMost(f64),
    /// At least this times what the good play has on the same seed.
    OfGoodPlay(f64),
}

impl GoalBound {
    /// Whether it depends on the good play.
    pub fn is_relative(self) -> bool {
        matches!(self, GoalBound::OfGoodPlay(_))
    }

    /// The value to reach, given that of the good play; `None` if it depends on that and there is none.
    pub fn value(self, good: Option<f64>) -> Option<f64> {
        match self {
            GoalBound::AtLeast(bound) | GoalBound::AtMost(bound) => Some(bound),
            GoalBound::OfGoodPlay(share) => good.map(|good| share * good),
        }
    }

    /// Whether a value reaches a bound.
    pub fn is_reached(self, value: f64, bound: f64) -> bool {
        if matches!(self, GoalBound::AtMost(_)) { value <= bound } else { value >= bound }
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct GoalFile {
    text: String,
    figure: Option<String>,
    sql: Option<String>,
    over: Option<String>,
    at_least: Option<f64>,
    at_most: Option<f64>,
    relative: Option<f64>,
    unit: Option<String>,
}

impl TryFrom<GoalFile> for LessonGoal {
    type Error = String;

    fn try_from(file: GoalFile) -> Result<LessonGoal, String> {
        let GoalFile { text, figure, sql, over, at_least, at_most, relative, unit } = file;
        let bounds = [
            at_least.map(GoalBound::AtLeast),
            at_most.map(GoalBound::AtMost),
            relative.map(GoalBound::OfGoodPlay),
        ];
        let mut bounds = bounds.into_iter().flatten();
        let (Some(bound), None) = (bounds.next(), bounds.next()) else {
            return Err("a goal has one of at_least, at_most and relative".to_owned());
        };
        let measurement = Measurement::try_from(MeasurementFile { figure, sql, over })?;
        let in_dollars = match unit.as_deref() {
            None => measurement.counts_dollars(),
            Some("$") if measurement.needs_database() => true,
            Some(_) => return Err("the unit of a goal is $, beside sql".to_owned()),
        };
        Ok(LessonGoal { text, measurement, bound, in_dollars })
    }
}

/// Something that goes wrong often.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(try_from = "PitfallFile")]
pub struct Pitfall {
    /// Its name.
    pub name: String,
    /// The part in which it is looked for, counted from 0.
    pub part: usize,
    /// What is measured after every week.
    pub measurement: Measurement,
    /// Where it begins.
    pub bound: PitfallBound,
    /// What is said when it is met.
    pub say: String,
}

/// Where a pitfall begins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PitfallBound {
    /// Above this.
    Above(f64),
    /// Below this.
    Below(f64),
}

impl PitfallBound {
    /// The bound itself.
    pub fn limit(self) -> f64 {
        match self {
            PitfallBound::Above(limit) | PitfallBound::Below(limit) => limit,
        }
    }

    /// Whether a value is beyond it.
    pub fn is_met_by(self, value: f64) -> bool {
        match self {
            PitfallBound::Above(limit) => value > limit,
            PitfallBound::Below(limit) => value < limit,
        }
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PitfallFile {
    name: String,
    part: Option<usize>,
    figure: Option<String>,
    sql: Option<String>,
    above: Option<f64>,
    below: Option<f64>,
    say: String,
}

impl TryFrom<PitfallFile> for Pitfall {
    type Error = String;

    fn try_from(file: PitfallFile) -> Result<Pitfall, String> {
        let PitfallFile { name, part, figure, sql, above, below, say } = file;
        let bound = match (above, below) {
            (Some(above), None) => PitfallBound::Above(above),
            (None, Some(below)) => PitfallBound::Below(below),
            _ => return Err("a pitfall has either above or below".to_owned()),
        };
        let measurement = Measurement::try_from(MeasurementFile { figure, sql, over: None })?;
        Ok(Pitfall { name, part: from_one(part)?, measurement, bound, say })
    }
}

/// A play that others are held against.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ReferencePlay {
    /// What it does, in words.
    pub text: String,
    /// What it does in each part, in words, where the parts have little in common.
    #[serde(default)]
    pub texts: Vec<String>,
    /// The pitfall that it meets; the bad play names one.
    pub pitfall: Option<String>,
    /// Its calls.
    #[serde(rename = "play", default)]
    pub plays: Vec<ScheduledCalls>,
}

impl ReferencePlay {
    /// What it does in a part, in words.
    pub fn text_of(&self, part: usize) -> &str {
        self.texts.get(part).unwrap_or(&self.text)
    }

    /// Whether it does anything in a part.
    pub fn plays_in(&self, part: usize) -> bool {
        self.plays.iter().any(|own| own.part == part)
    }
}

/// Seeds over which measured figures are means.
pub const MEASURED_SEEDS: std::ops::RangeInclusive<u64> = 1..=6;

/// A figure that texts name as `{name}`: its mean over the seeds of the check.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(try_from = "MeasuredFile")]
pub struct MeasuredFigure {
    /// Its name in texts.
    pub name: String,
    /// The part that is played, counted from 0.
    pub part: usize,
    /// What it is.
    pub text: String,
    /// What is measured.
    pub measurement: Measurement,
    /// The week of the company after which it is measured; the last of the part if left out.
    pub week: Option<u32>,
    /// Its value.
    pub value: f64,
    /// What a statement counts: `$`, `%` of a share, the number of a `day`, or nothing.
    pub unit: String,
    /// What is played after the start of the part.
    pub plays: Vec<ScheduledCalls>,
    /// Its scenario, where it is measured in another world than the part is played in.
    pub scenario: Option<String>,
    /// Parameters in force from day 0 besides those of the part, by their full keys.
    pub parameters: BTreeMap<String, Value>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct MeasuredFile {
    name: String,
    part: Option<usize>,
    text: String,
    figure: Option<String>,
    sql: Option<String>,
    over: Option<String>,
    week: Option<u32>,
    value: f64,
    unit: Option<String>,
    #[serde(default)]
    play: Vec<ScheduledCalls>,
    scenario: Option<String>,
    #[serde(default)]
    parameters: BTreeMap<String, Value>,
}

impl TryFrom<MeasuredFile> for MeasuredFigure {
    type Error = String;

    fn try_from(file: MeasuredFile) -> Result<MeasuredFigure, String> {
        let MeasuredFile { name, part, text, week, value, unit, play, scenario, parameters, .. } = file;
        let MeasuredFile { figure, sql, over, .. } = file;
        let measurement = Measurement::try_from(MeasurementFile { figure, sql, over })?;
        let (part, unit) = (from_one(part)?, unit.unwrap_or_default());
        if !matches!(unit.as_str(), "" | "$" | "%" | "day") {
            return Err(format!("a unit is $, % or day, not {unit}"));
        }
        let plays = play;
        Ok(MeasuredFigure { name, part, text, measurement, week, value, unit, plays, scenario, parameters })
    }
}

/// Calls at the beginning of some weeks of a company.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(try_from = "ScheduleFile")]
pub struct ScheduledCalls {
    /// The part, counted from 0.
    pub part: usize,
    /// The first week, counted from 0: so many weeks have passed.
    pub week: u32,
    /// They are repeated every so many weeks.
    pub every: Option<u32>,
    /// The last week in which they are repeated.
    pub until: Option<u32>,
    /// The calls, in their order.
    pub calls: Vec<LessonCall>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ScheduleFile {
    part: Option<usize>,
    week: u32,
    every: Option<u32>,
    until: Option<u32>,
    calls: Vec<LessonCall>,
}

impl TryFrom<ScheduleFile> for ScheduledCalls {
    type Error = String;

    fn try_from(file: ScheduleFile) -> Result<ScheduledCalls, String> {
        let ScheduleFile { part, week, every, until, calls } = file;
        if every == Some(0) || (every.is_none() && until.is_some()) {
            return Err("every is a number of weeks from 1 on, and until stands beside it".to_owned());
        }
        Ok(ScheduledCalls { part: from_one(part)?, week, every, until, calls })
    }
}

impl ScheduledCalls {
    /// Whether they are made at the beginning of a week of a part.
    pub fn are_due(&self, part: usize, week: u32) -> bool {
        let repeats = |every| week >= self.week && (week - self.week).is_multiple_of(every);
        let in_time = self.until.is_none_or(|until| week <= until);
        self.part == part && in_time && self.every.map_or(week == self.week, repeats)
    }
}

/// The index of a part that is counted from 1 in files; the first if none is named.
fn from_one(part: Option<usize>) -> Result<usize, String> {
    part.unwrap_or(1).checked_sub(1).ok_or_else(|| "parts are counted from 1".to_owned())
}
