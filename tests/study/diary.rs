//! The actions of a script, recorded by the script itself in the format of the tables.

use std::collections::BTreeMap;

/// Category of a participant's time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum TimeCategory {
    Active,
    /// Time for answering questions of the study.
    Answering,
    Idle,
    Away,
    /// Time with the clock stopped.
    Paused,
    /// Time after the end of the run.
    After,
}

/// A line that the record must contain.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ExpectedLine {
    /// Milliseconds since the start of the run.
    pub at: u64,
    /// Week that was being decided.
    pub week: u32,
    /// Kind, object, outcome and duration of the line, as in the columns `kind`, `what`, `which` and `for_ms` of `events.csv`.
    pub kind: &'static str,
    pub what: String,
    pub which: String,
    pub for_ms: Option<u64>,
}

/// An answer to a question.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ExpectedAnswer {
    pub occasion: String,
    pub question: &'static str,
    pub value: String,
    pub for_ms: u64,
}

/// All actions of a scripted participant.
#[derive(Debug, Clone, Default)]
pub struct Diary {
    pub label: &'static str,
    pub refused_labels: u32,
    pub lines: Vec<ExpectedLine>,
    pub answers: Vec<ExpectedAnswer>,
    /// Milliseconds by week and category of time.
    pub time: BTreeMap<(u32, TimeCategory), u64>,
    pub sittings: u32,
    pub sittings_not_closed: u32,
    /// Rationales of simulated weeks, and whether forecasts were filled naively.
    pub weeks: Vec<(String, bool)>,
    pub queries: Vec<String>,
    pub notes: Vec<String>,
    /// Whether the run has ended.
    pub over: bool,
    /// Whether the run was erased or never created.
    pub erased: bool,
    /// Whether times come from a real clock, so that only bounds are known.
    pub is_real_time: bool,
    /// Minimum and maximum milliseconds by category of time.
    pub bounds: BTreeMap<TimeCategory, (u64, u64)>,
}

impl Diary {
    /// Returns the week that is being decided or, after the end of the run, the last week.
    pub fn week(&self) -> u32 {
        (self.weeks.len() as u32 + 1).min(WEEKS)
    }

    /// Adds time with a lower and an upper bound.
    pub fn add_bounds(&mut self, spent: TimeCategory, least: u64, most: u64) {
        let bounds = self.bounds.entry(spent).or_default();
        *bounds = (bounds.0 + least, bounds.1 + most);
    }

    pub fn total_ms(&self, what: TimeCategory) -> u64 {
        self.time.iter().filter(|((_, time_category), _)| *time_category == what).map(|(_, ms)| ms).sum()
    }

    pub fn add_answer(&mut self, study_question: StudyQuestion, value: &str, for_ms: u64) {
        let breaks = self.answers.iter().filter(|answer| answer.question == BREAK.question).count();
        let occasion = match study_question.occasion {
            "break" => format!("break {}", breaks + 1),
            other => other.to_owned(),
        };
        self.answers.push(ExpectedAnswer {
            occasion,
            question: study_question.question,
            value: value.to_owned(),
            for_ms,
        });
    }

    pub fn count(&self, kind: &str) -> usize {
        self.lines.iter().filter(|line| line.kind == kind).count()
    }
}

/// A question of the study.
#[derive(Debug, Clone, Copy)]
pub struct StudyQuestion {
    pub occasion: &'static str,
    pub questionnaire: &'static str,
    pub question: &'static str,
}

/// Number of weeks of a session.
pub const WEEKS: u32 = 4;

/// Question that is asked before the first week.
pub const QUESTION_BEFORE_FIRST_WEEK: StudyQuestion =
    StudyQuestion { occasion: "before", questionnaire: "1-before", question: "experience" };
/// Question that is asked after the second week.
pub const WEEK: StudyQuestion =
    StudyQuestion { occasion: "week 2", questionnaire: "2-week", question: "check" };
/// Question that is asked after a break.
pub const BREAK: StudyQuestion =
    StudyQuestion { occasion: "break", questionnaire: "3-break", question: "spoke" };
/// Question that is asked after the end of the run.
pub const END: StudyQuestion =
    StudyQuestion { occasion: "end", questionnaire: "4-end", question: "strategy" };
