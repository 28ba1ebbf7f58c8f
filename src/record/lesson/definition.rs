//! The definition of a lesson, `NAME.toml` (docs/lessons/authors-guide.md).

use std::collections::BTreeMap;

use serde::Deserialize;
use toml::Value;

use super::lesson_call::LessonCall;
use super::measurement::{Measurement, MeasurementFile};
use novamind_tools::ToolId;

/// The definition in the file of a lesson.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LessonPlan {
    /// Title for students.
    pub title: String,
    /// Minutes that a student needs for it.
    pub minutes: u32,
    /// Skill or knowledge that the student gains.
    pub learning_goal: String,
    /// Parts of the program that the student can use.
    #[serde(default)]
    pub access: LessonAccess,
    /// Companies, in the order of play.
    #[serde(rename = "part")]
    pub parts: Vec<LessonPart>,
    /// Common mistakes and their explanations.
    #[serde(rename = "pitfall", default)]
    pub pitfalls: Vec<Pitfall>,
    /// The reference play, which reaches every goal.
    pub good: ReferencePlay,
    /// A play that misses a goal and triggers a pitfall.
    pub bad: ReferencePlay,
    /// Figures that the texts name; `novamind lesson check` verifies them.
    #[serde(rename = "measured", default)]
    pub measured: Vec<MeasuredFigure>,
}

/// Parts of the program that a student can use.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct LessonAccess {
    /// Tools; `None` for all.
    pub tools: Option<Vec<ToolId>>,
    /// Screens besides the Overview; `None` for all.
    pub screens: Option<Vec<String>>,
    /// Whether forecasts are required.
    pub forecasts: ForecastRequirement,
    /// Whether a rationale is required.
    pub rationale: RationaleRequirement,
}

impl LessonAccess {
    /// Returns whether the lesson submits naive forecasts.
    pub fn uses_naive_forecasts(&self) -> bool {
        self.forecasts == ForecastRequirement::Naive
    }

    /// Returns whether weeks need no rationale.
    pub fn is_rationale_off(&self) -> bool {
        self.rationale == RationaleRequirement::Off
    }
}

/// Forecasts before a week.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ForecastRequirement {
    /// The student enters them.
    Required,
    /// The lesson fills in naive forecasts.
    #[default]
    Naive,
}

/// Rationale before a week.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum RationaleRequirement {
    /// The student writes it.
    Required,
    /// Not required.
    #[default]
    Off,
}

/// One company of a lesson, with its steps.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LessonPart {
    /// Title.
    #[serde(default)]
    pub title: String,
    /// Scenario.
    #[serde(default = "default_scenario")]
    pub scenario: String,
    /// Seed of the students' runs.
    pub seed: u64,
    /// Cash on day 0, dollars; defaults to that of the scenario.
    pub cash: Option<f64>,
    /// Last day of the company, which affects the mechanics; defaults to that of the scenario. The lesson ends earlier.
    pub days: Option<u32>,
    /// Whether demand surges occur.
    #[serde(default)]
    pub surges: bool,
    /// Control of the capacity tier.
    #[serde(default)]
    pub capacity: CapacityControl,
    /// Parameters in force from day 0, by their full keys.
    #[serde(default)]
    pub parameters: BTreeMap<String, Value>,
    /// Weeks that are simulated before the student sees the company.
    #[serde(default)]
    pub start_weeks: u32,
    /// Calls before the student sees the company.
    #[serde(default)]
    pub start: Vec<ScheduledCalls>,
    /// Steps, in order.
    #[serde(rename = "step")]
    pub steps: Vec<LessonStep>,
}

impl LessonPart {
    /// Returns whether the capacity tier follows usage automatically.
    pub fn has_automatic_capacity(&self) -> bool {
        self.capacity == CapacityControl::FollowsUsage
    }
}

/// Control of the capacity tier.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
pub enum CapacityControl {
    /// The student.
    #[default]
    #[serde(rename = "manual")]
    Student,
    /// Automatic: one tier per week towards the tier that usage needs.
    #[serde(rename = "follows usage")]
    FollowsUsage,
}

fn default_scenario() -> String {
    crate::folder::configuration::DEFAULT_SCENARIO.to_owned()
}

/// A step of a lesson: a task of one or more weeks.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LessonStep {
    /// Title.
    pub title: String,
    /// Text for the student.
    pub text: String,
    /// Duration in weeks.
    pub weeks: u32,
    /// Parameters that the lesson sets at the start of the step, by their full keys.
    #[serde(default)]
    pub parameters: BTreeMap<String, Value>,
    /// Question before the step is simulated.
    pub guess: Option<Guess>,
    /// Goals.
    #[serde(rename = "goal", default)]
    pub goals: Vec<LessonGoal>,
    /// Hints, from vague to nearly the solution.
    #[serde(default)]
    pub hints: Vec<String>,
}

/// A question before a step is simulated.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(try_from = "GuessFile")]
pub struct Guess {
    /// The question.
    pub question: String,
    /// Kind of the answer.
    pub form: GuessForm,
    /// When the outcome is shown.
    pub told: OutcomeTiming,
}

/// When the outcome of a guess is measured and shown.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum OutcomeTiming {
    /// At the end of its step.
    #[default]
    Step,
    /// At the end of the part.
    Part,
}

/// Kind of the answer to a question.
#[derive(Debug, Clone, PartialEq)]
pub enum GuessForm {
    /// A number; its outcome is measured at the end of the step.
    Number {
        /// Measurement of the outcome.
        outcome: Measurement,
        /// Unit: `$`, `%`, or a word.
        unit: String,
    },
    /// One of several answers.
    Choice {
        /// Answers.
        choices: Vec<String>,
        /// Index of the correct answer, from 0.
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
    told: OutcomeTiming,
}

impl TryFrom<GuessFile> for Guess {
    type Error = String;

    fn try_from(file: GuessFile) -> Result<Guess, String> {
        let GuessFile { question, figure, sql, over, unit, choices, answer, told: outcome_timing } = file;
        let form = match (choices, answer) {
            (None, None) => GuessForm::Number {
                outcome: Measurement::try_from(MeasurementFile { figure, sql, over })?,
                unit: unit.unwrap_or_default(),
            },
            (Some(choices), Some(answer)) if figure.is_none() && sql.is_none() => {
                if choices.len() < 2 || !(1..=choices.len()).contains(&answer) {
                    return Err(
                        "a guess needs at least two choices, and answer must be the number of one of them"
                            .to_owned(),
                    );
                }
                GuessForm::Choice { choices, answer: answer - 1 }
            }
            _ => return Err("a guess needs a figure, sql, or choices with an answer".to_owned()),
        };
        Ok(Guess { question, form, told: outcome_timing })
    }
}

/// A goal of a step.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(try_from = "GoalFile")]
pub struct LessonGoal {
    /// Text for the student.
    pub text: String,
    /// Measurement at the end of the step.
    pub measurement: Measurement,
    /// Bound to reach.
    pub bound: GoalBound,
    /// Whether the value is in dollars.
    pub in_dollars: bool,
}

/// Bound of a goal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum GoalBound {
    /// At least this value.
    AtLeast(f64),
    /// At most this value.
    AtMost(f64),
    /// At least this multiple of the reference play's value on the same seed.
    RelativeToReferencePlay(f64),
}

impl GoalBound {
    /// Returns whether the bound depends on the reference play.
    pub fn is_relative(self) -> bool {
        matches!(self, GoalBound::RelativeToReferencePlay(_))
    }

    /// Returns the value to reach, given that of the reference play. Returns `None` if that is needed and missing.
    pub fn value(self, good: Option<f64>) -> Option<f64> {
        match self {
            GoalBound::AtLeast(bound) | GoalBound::AtMost(bound) => Some(bound),
            GoalBound::RelativeToReferencePlay(share) => good.map(|good| share * good),
        }
    }

    /// Returns whether a value reaches the bound.
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
            relative.map(GoalBound::RelativeToReferencePlay),
        ];
        let mut bounds = bounds.into_iter().flatten();
        let (Some(bound), None) = (bounds.next(), bounds.next()) else {
            return Err("a goal needs exactly one of at_least, at_most and relative".to_owned());
        };
        let measurement = Measurement::try_from(MeasurementFile { figure, sql, over })?;
        let in_dollars = match unit.as_deref() {
            None => measurement.is_in_dollars(),
            Some("$") if measurement.needs_database() => true,
            Some(_) => return Err("the unit of a goal must be $, and needs sql".to_owned()),
        };
        Ok(LessonGoal { text, measurement, bound, in_dollars })
    }
}

/// A common mistake.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(try_from = "PitfallFile")]
pub struct Pitfall {
    /// Name.
    pub name: String,
    /// Part in which it is checked, from 0.
    pub part: usize,
    /// Measurement after every week.
    pub measurement: Measurement,
    /// Values that trigger it.
    pub bound: PitfallBound,
    /// Explanation for the student.
    pub say: String,
}

/// Values that trigger a pitfall.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PitfallBound {
    /// Above this.
    Above(f64),
    /// Below this.
    Below(f64),
}

impl PitfallBound {
    /// Returns the threshold.
    pub fn limit(self) -> f64 {
        match self {
            PitfallBound::Above(limit) | PitfallBound::Below(limit) => limit,
        }
    }

    /// Returns whether a value triggers the pitfall.
    pub fn is_exceeded_by(self, value: f64) -> bool {
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
            _ => return Err("a pitfall needs either above or below".to_owned()),
        };
        let measurement = Measurement::try_from(MeasurementFile { figure, sql, over: None })?;
        Ok(Pitfall { name, part: part_index(part)?, measurement, bound, say })
    }
}

/// A play with which students' runs are compared.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ReferencePlay {
    /// Description.
    pub text: String,
    /// Description of each part, if the parts have little in common.
    #[serde(default)]
    pub texts: Vec<String>,
    /// The pitfall that it triggers; the pitfall play names one.
    pub pitfall: Option<String>,
    /// Calls.
    #[serde(rename = "play", default)]
    pub plays: Vec<ScheduledCalls>,
}

impl ReferencePlay {
    /// Returns the description of a part.
    pub fn text_of(&self, part: usize) -> &str {
        self.texts.get(part).unwrap_or(&self.text)
    }

    /// Returns whether it has calls in a part.
    pub fn has_calls_in(&self, part: usize) -> bool {
        self.plays.iter().any(|scheduled_calls| scheduled_calls.part == part)
    }
}

/// Seeds over which measured figures are averaged.
pub const MEASURED_SEEDS: std::ops::RangeInclusive<u64> = 1..=6;

/// A figure that texts name as `{name}`: its mean over [`MEASURED_SEEDS`].
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(try_from = "MeasuredFile")]
pub struct MeasuredFigure {
    /// Name in texts.
    pub name: String,
    /// Part that is played, from 0.
    pub part: usize,
    /// Description.
    pub text: String,
    /// Measurement.
    pub measurement: Measurement,
    /// Week of the company after which it is measured; defaults to the last of the part.
    pub week: Option<u32>,
    /// Value.
    pub value: f64,
    /// Unit of a statement's number: `$`, `%` of a share, `day`, or empty.
    pub unit: String,
    /// Calls after the start of the part.
    pub plays: Vec<ScheduledCalls>,
    /// Scenario, if it differs from that of the part.
    pub scenario: Option<String>,
    /// Additional parameters in force from day 0, by their full keys.
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
        let (part, unit) = (part_index(part)?, unit.unwrap_or_default());
        if !matches!(unit.as_str(), "" | "$" | "%" | "day") {
            return Err(format!("the unit must be $, % or day, not {unit}"));
        }
        let plays = play;
        Ok(MeasuredFigure { name, part, text, measurement, week, value, unit, plays, scenario, parameters })
    }
}

/// Calls at the start of certain weeks of a company.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(try_from = "ScheduleFile")]
pub struct ScheduledCalls {
    /// Part, from 0.
    pub part: usize,
    /// First week, from 0: the number of weeks that have passed.
    pub week: u32,
    /// Weeks between repetitions.
    pub every: Option<u32>,
    /// Last week of the repetitions.
    pub until: Option<u32>,
    /// Calls, in order.
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
            return Err("every must be at least 1 week, and until needs every".to_owned());
        }
        Ok(ScheduledCalls { part: part_index(part)?, week, every, until, calls })
    }
}

impl ScheduledCalls {
    /// Returns whether the calls are made at the start of a week of a part.
    pub fn are_due(&self, part: usize, week: u32) -> bool {
        let repeats = |every| week >= self.week && (week - self.week).is_multiple_of(every);
        let in_time = self.until.is_none_or(|until| week <= until);
        self.part == part && in_time && self.every.map_or(week == self.week, repeats)
    }
}

/// Returns the index of a part, which files count from 1; defaults to the first.
fn part_index(part: Option<usize>) -> Result<usize, String> {
    part.unwrap_or(1).checked_sub(1).ok_or_else(|| "parts are counted from 1".to_owned())
}
