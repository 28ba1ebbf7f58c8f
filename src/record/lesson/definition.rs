//! The definition of a lesson, `NAME.toml` (docs/lessons/authors-guide.md).

use std::collections::BTreeMap;

use serde::Deserialize;
use toml::Value;

use super::lesson_call::LessonCall;
use super::measurement::{MeasurementSpec, RawMeasurement};
use novamind_tools::ToolId;

/// The contents of a lesson file.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LessonPlan {
    /// Title of the lesson.
    pub title: String,
    /// Minutes that a student needs for the lesson.
    pub minutes: u32,
    /// Skill or knowledge that the student gains.
    pub learning_goal: String,
    /// Tools and screens that the student can use.
    #[serde(default)]
    pub access: LessonAccess,
    /// Parts of the lesson, in the order of play.
    #[serde(rename = "part")]
    pub parts: Vec<LessonPart>,
    /// Common mistakes and their explanations.
    #[serde(rename = "pitfall", default)]
    pub pitfalls: Vec<Pitfall>,
    /// Reference play that reaches every goal.
    pub good: ReferencePlay,
    /// Reference play that misses a goal and triggers a pitfall.
    pub bad: ReferencePlay,
    /// Figures that the texts name; `novamind lesson check` verifies them.
    #[serde(rename = "measured", default)]
    pub measured: Vec<MeasuredFigure>,
}

/// Tools and screens that a lesson offers, and the submissions that it requires before a week.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct LessonAccess {
    /// Tools that the student can use; `None` for all tools.
    pub tools: Option<Vec<ToolId>>,
    /// Screens that the student can open besides the Overview; `None` for all screens.
    pub screens: Option<Vec<String>>,
    /// Whether the student or the lesson enters the forecasts before a week.
    pub forecasts: ForecastRequirement,
    /// Whether the student has to write a rationale before a week.
    pub rationale: RationaleRequirement,
}

impl LessonAccess {
    /// Returns whether the lesson submits naive forecasts for the student.
    pub fn uses_naive_forecasts(&self) -> bool {
        self.forecasts == ForecastRequirement::Naive
    }

    /// Returns whether the student can submit a week without a rationale.
    pub fn is_rationale_off(&self) -> bool {
        self.rationale == RationaleRequirement::Off
    }
}

/// Requirement for forecasts before a week.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ForecastRequirement {
    /// The student enters the forecasts.
    Required,
    /// The lesson fills in naive forecasts.
    #[default]
    Naive,
}

/// Requirement for a rationale before a week.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum RationaleRequirement {
    /// The student writes a rationale.
    Required,
    /// No rationale is required.
    #[default]
    Off,
}

/// A part of a lesson: one company and the student's steps with this company.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LessonPart {
    /// Title of the part.
    #[serde(default)]
    pub title: String,
    /// Name of the scenario of the part.
    #[serde(default = "default_scenario")]
    pub scenario: String,
    /// Seed of the students' runs.
    pub seed: u64,
    /// Cash on day 0, dollars; defaults to the scenario's starting cash.
    pub cash: Option<f64>,
    /// Last day of the simulated company; defaults to the scenario's last day. The value affects the mechanics, but
    /// the lesson ends earlier.
    pub days: Option<u32>,
    /// Whether demand surges occur during the part.
    #[serde(default)]
    pub surges: bool,
    /// How the capacity tier is set during the part.
    #[serde(default)]
    pub capacity: CapacityControl,
    /// Values of the parameters that the part overrides from day 0, by full key.
    #[serde(default)]
    pub parameters: BTreeMap<String, Value>,
    /// Weeks that are simulated before the student sees the company.
    #[serde(default)]
    pub start_weeks: u32,
    /// Calls that are executed before the student sees the company.
    #[serde(default)]
    pub start: Vec<ScheduledCalls>,
    /// Steps of the part, in order.
    #[serde(rename = "step")]
    pub steps: Vec<LessonStep>,
}

impl LessonPart {
    /// Returns whether the capacity tier follows usage automatically.
    pub fn has_automatic_capacity(&self) -> bool {
        self.capacity == CapacityControl::FollowsUsage
    }
}

/// How the capacity tier of a company is set.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
pub enum CapacityControl {
    /// The student sets the capacity tier.
    #[default]
    #[serde(rename = "manual")]
    Student,
    /// The lesson moves the capacity tier each week by one tier towards the tier that usage requires.
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
    /// Title of the step.
    pub title: String,
    /// Task description for the student.
    pub text: String,
    /// Duration of the step, in weeks.
    pub weeks: u32,
    /// Values of the parameters that the lesson sets at the start of the step, by full key.
    #[serde(default)]
    pub parameters: BTreeMap<String, Value>,
    /// Question that the student answers before the step is simulated.
    pub guess: Option<Guess>,
    /// Goals that are checked at the end of the step.
    #[serde(rename = "goal", default)]
    pub goals: Vec<LessonGoal>,
    /// Hints in the order in which they are shown, from a vague hint to the almost complete solution.
    #[serde(default)]
    pub hints: Vec<String>,
}

/// A question that the student answers before a step is simulated.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(try_from = "RawGuess")]
pub struct Guess {
    /// Question for the student.
    pub question: String,
    /// Answer format of the question.
    pub form: GuessForm,
    /// Time at which the outcome of the guess is shown.
    pub outcome_timing: OutcomeTiming,
}

/// The time at which the outcome of a guess is measured and shown.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum OutcomeTiming {
    /// The outcome is measured and shown at the end of the step with the guess.
    #[default]
    Step,
    /// The outcome is measured and shown at the end of the part with the guess.
    Part,
}

/// Answer format of a question.
#[derive(Debug, Clone, PartialEq)]
pub enum GuessForm {
    /// A number, which is compared with a measurement at the end of the step.
    Number {
        /// Measurement that returns the actual value.
        outcome: MeasurementSpec,
        /// Unit of the number: `$`, `%`, or a word.
        unit: String,
    },
    /// One of several predefined answers.
    Choice {
        /// Answers from which the student chooses.
        choices: Vec<String>,
        /// Index of the correct answer, from 0.
        answer: usize,
    },
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawGuess {
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

impl TryFrom<RawGuess> for Guess {
    type Error = String;

    fn try_from(file: RawGuess) -> Result<Guess, String> {
        let RawGuess { question, figure, sql, over, unit, choices, answer, told: outcome_timing } = file;
        let form = match (choices, answer) {
            (None, None) => GuessForm::Number {
                outcome: MeasurementSpec::try_from(RawMeasurement { figure, sql, over })?,
                unit: unit.unwrap_or_default(),
            },
            (Some(choices), Some(answer)) if figure.is_none() && sql.is_none() => {
                if choices.len() < 2 || !(1..=choices.len()).contains(&answer) {
                    return Err(
                        "a guess needs at least two `choices`, and `answer` must be the number of a choice"
                            .to_owned(),
                    );
                }
                GuessForm::Choice { choices, answer: answer - 1 }
            }
            _ => return Err("a guess needs `figure`, `sql`, or `choices` with `answer`".to_owned()),
        };
        Ok(Guess { question, form, outcome_timing })
    }
}

/// A goal that the student should reach in a step.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(try_from = "RawGoal")]
pub struct LessonGoal {
    /// Description of the goal for the student.
    pub text: String,
    /// Measurement that returns the value to compare at the end of the step.
    pub measurement: MeasurementSpec,
    /// Bound that the measured value has to reach.
    pub bound: GoalBound,
    /// Whether the measured value is in dollars.
    pub in_dollars: bool,
}

/// Bound that a measured value has to reach.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum GoalBound {
    /// Reached by values of at least this number.
    AtLeast(f64),
    /// Reached by values of at most this number.
    AtMost(f64),
    /// Reached by at least this multiple of the value of the reference play on the same seed.
    RelativeToReferencePlay(f64),
}

impl GoalBound {
    /// Returns whether the bound depends on the reference play.
    pub fn is_relative(self) -> bool {
        matches!(self, GoalBound::RelativeToReferencePlay(_))
    }

    /// Returns the value to reach. `good` is the value of the reference play. Returns `None` if a relative bound has
    /// no reference value.
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
struct RawGoal {
    text: String,
    figure: Option<String>,
    sql: Option<String>,
    over: Option<String>,
    at_least: Option<f64>,
    at_most: Option<f64>,
    relative: Option<f64>,
    unit: Option<String>,
}

impl TryFrom<RawGoal> for LessonGoal {
    type Error = String;

    fn try_from(file: RawGoal) -> Result<LessonGoal, String> {
        let RawGoal { text, figure, sql, over, at_least, at_most, relative, unit } = file;
        let bounds = [
            at_least.map(GoalBound::AtLeast),
            at_most.map(GoalBound::AtMost),
            relative.map(GoalBound::RelativeToReferencePlay),
        ];
        let mut bounds = bounds.into_iter().flatten();
        let (Some(bound), None) = (bounds.next(), bounds.next()) else {
            return Err("a goal needs exactly one of `at_least`, `at_most` and `relative`".to_owned());
        };
        let measurement = MeasurementSpec::try_from(RawMeasurement { figure, sql, over })?;
        let in_dollars = match unit.as_deref() {
            None => measurement.is_in_dollars(),
            Some("$") if measurement.needs_database() => true,
            Some(_) => return Err("the unit of a goal must be `$`, and requires `sql`".to_owned()),
        };
        Ok(LessonGoal { text, measurement, bound, in_dollars })
    }
}

/// A common mistake that the lesson detects and explains.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(try_from = "RawPitfall")]
pub struct Pitfall {
    /// Name by which the pitfall play and recorded events refer to the pitfall.
    pub name: String,
    /// Part in which the pitfall is checked, from 0.
    pub part: usize,
    /// Measurement that is compared with the bound after every week.
    pub measurement: MeasurementSpec,
    /// Values that trigger the pitfall.
    pub bound: PitfallBound,
    /// Explanation for the student.
    pub say: String,
}

/// Values that trigger a pitfall.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PitfallBound {
    /// Values above this threshold.
    Above(f64),
    /// Values below this threshold.
    Below(f64),
}

impl PitfallBound {
    /// Returns the threshold of the bound.
    pub fn limit(self) -> f64 {
        match self {
            PitfallBound::Above(limit) | PitfallBound::Below(limit) => limit,
        }
    }

    /// Returns whether a value triggers the pitfall.
    pub fn is_triggered_by(self, value: f64) -> bool {
        match self {
            PitfallBound::Above(limit) => value > limit,
            PitfallBound::Below(limit) => value < limit,
        }
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawPitfall {
    name: String,
    part: Option<usize>,
    figure: Option<String>,
    sql: Option<String>,
    above: Option<f64>,
    below: Option<f64>,
    say: String,
}

impl TryFrom<RawPitfall> for Pitfall {
    type Error = String;

    fn try_from(file: RawPitfall) -> Result<Pitfall, String> {
        let RawPitfall { name, part, figure, sql, above, below, say } = file;
        let bound = match (above, below) {
            (Some(above), None) => PitfallBound::Above(above),
            (None, Some(below)) => PitfallBound::Below(below),
            _ => return Err("a pitfall needs either `above` or `below`".to_owned()),
        };
        let measurement = MeasurementSpec::try_from(RawMeasurement { figure, sql, over: None })?;
        Ok(Pitfall { name, part: part_index(part)?, measurement, bound, say })
    }
}

/// A play with scheduled calls. Students' runs are compared with this play.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ReferencePlay {
    /// Description of the play for students.
    pub text: String,
    /// Separate description of each part, if the parts have little in common.
    #[serde(default)]
    pub texts: Vec<String>,
    /// Name of the pitfall that the play triggers; required for the pitfall play.
    pub pitfall: Option<String>,
    /// Calls of the play, by part and week.
    #[serde(rename = "play", default)]
    pub plays: Vec<ScheduledCalls>,
}

impl ReferencePlay {
    /// Returns the description of the play for a part.
    pub fn part_description(&self, part: usize) -> &str {
        self.texts.get(part).unwrap_or(&self.text)
    }

    /// Returns whether the play has calls in a part.
    pub fn has_calls_for_part(&self, part: usize) -> bool {
        self.plays.iter().any(|scheduled_calls| scheduled_calls.part == part)
    }
}

/// Seeds over which each measured figure is averaged.
pub const MEASURED_SEEDS: std::ops::RangeInclusive<u64> = 1..=6;

/// A figure that lesson texts insert with `{name}`: the mean of a measurement over [`MEASURED_SEEDS`].
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(try_from = "RawMeasuredFigure")]
pub struct MeasuredFigure {
    /// Name of the figure in lesson texts.
    pub name: String,
    /// Part that is simulated for the measurement, from 0.
    pub part: usize,
    /// Description of the figure.
    pub text: String,
    /// Measurement of the figure after the week.
    pub measurement: MeasurementSpec,
    /// Week of the company after which the figure is measured; defaults to the last week of the part.
    pub week: Option<u32>,
    /// Value that the lesson texts state.
    pub value: f64,
    /// Unit of the number that an SQL statement returns: `$`, `%` (for a share), `day`, or empty.
    pub unit: String,
    /// Calls that are executed after the start of the part.
    pub plays: Vec<ScheduledCalls>,
    /// Name of the scenario, if it differs from the scenario of the part.
    pub scenario: Option<String>,
    /// Values of additional parameters that are overridden from day 0, by full key.
    pub parameters: BTreeMap<String, Value>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawMeasuredFigure {
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

impl TryFrom<RawMeasuredFigure> for MeasuredFigure {
    type Error = String;

    fn try_from(file: RawMeasuredFigure) -> Result<MeasuredFigure, String> {
        let RawMeasuredFigure { name, part, text, week, value, unit, play, scenario, parameters, .. } = file;
        let RawMeasuredFigure { figure, sql, over, .. } = file;
        let measurement = MeasurementSpec::try_from(RawMeasurement { figure, sql, over })?;
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
#[serde(try_from = "RawScheduledCalls")]
pub struct ScheduledCalls {
    /// Part in which the calls are executed, from 0.
    pub part: usize,
    /// First week in which the calls are executed, counted from 0.
    pub week: u32,
    /// Weeks between repetitions of the calls.
    pub every: Option<u32>,
    /// Last week in which the calls may be repeated.
    pub until: Option<u32>,
    /// Calls, in the order of execution.
    pub calls: Vec<LessonCall>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawScheduledCalls {
    part: Option<usize>,
    week: u32,
    every: Option<u32>,
    until: Option<u32>,
    calls: Vec<LessonCall>,
}

impl TryFrom<RawScheduledCalls> for ScheduledCalls {
    type Error = String;

    fn try_from(file: RawScheduledCalls) -> Result<ScheduledCalls, String> {
        let RawScheduledCalls { part, week, every, until, calls } = file;
        if every == Some(0) || (every.is_none() && until.is_some()) {
            return Err("`every` must be at least 1 week, and `until` requires `every`".to_owned());
        }
        Ok(ScheduledCalls { part: part_index(part)?, week, every, until, calls })
    }
}

impl ScheduledCalls {
    /// Returns whether the calls are executed at the start of a week of a part.
    pub fn are_due(&self, part: usize, week: u32) -> bool {
        let repeats = |every| week >= self.week && (week - self.week).is_multiple_of(every);
        let in_time = self.until.is_none_or(|until| week <= until);
        self.part == part && in_time && self.every.map_or(week == self.week, repeats)
    }
}

/// Converts a part number, which files count from 1, to an index. Defaults to the first part.
fn part_index(part: Option<usize>) -> Result<usize, String> {
    part.unwrap_or(1).checked_sub(1).ok_or_else(|| "parts are numbered from 1".to_owned())
}
