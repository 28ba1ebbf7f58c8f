//! What a script did, written down by the script itself, in the words of the tables.

use std::collections::BTreeMap;

/// Where time goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Spent {
    Active,
    /// With questions of the study.
    Answering,
    Idle,
    Away,
    /// The clock is stopped.
    Paused,
    /// The program shows what comes after the end.
    After,
}

/// A line that the record has to hold.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Deed {
    /// Milliseconds since the run began.
    pub at: u64,
    /// Week that was being decided.
    pub week: u32,
    /// Kind of the line, what, which and for how many milliseconds, as in `events.csv`.
    pub kind: &'static str,
    pub what: String,
    pub which: String,
    pub for_ms: Option<u64>,
}

/// An answer to a question.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Answered {
    pub occasion: String,
    pub question: &'static str,
    pub value: String,
    pub for_ms: u64,
}

/// Everything one participant did.
#[derive(Debug, Clone, Default)]
pub struct Diary {
    pub label: &'static str,
    pub refused_labels: u32,
    pub deeds: Vec<Deed>,
    pub answers: Vec<Answered>,
    /// Milliseconds by week.
    pub time: BTreeMap<(u32, Spent), u64>,
    pub sittings: u32,
    pub sittings_not_closed: u32,
    /// Reasons of weeks that ran, and whether they were filled naively.
    pub weeks: Vec<(String, bool)>,
    /// Statements.
    pub queries: Vec<String>,
    /// Texts of notes.
    pub notes: Vec<String>,
    /// The run is over.
    pub over: bool,
    /// Nothing of it is left.
    pub erased: bool,
    /// Times are those of a real clock; the script knows bounds.
    pub real: bool,
    /// Least and most milliseconds.
    pub bounds: BTreeMap<Spent, (u64, u64)>,
}

impl Diary {
    /// Week that is being decided; the last one once it is over.
    pub fn week(&self) -> u32 {
        (self.weeks.len() as u32 + 1).min(WEEKS)
    }

    /// Some more time was spent: no less than, and no more than.
    pub fn between(&mut self, spent: Spent, least: u64, most: u64) {
        let bounds = self.bounds.entry(spent).or_default();
        *bounds = (bounds.0 + least, bounds.1 + most);
    }

    /// Milliseconds of the whole run.
    pub fn spent(&self, what: Spent) -> u64 {
        self.time.iter().filter(|((_, own), _)| *own == what).map(|(_, ms)| ms).sum()
    }

    /// A question was answered.
    pub fn answered(&mut self, asked: Asked, value: &str, for_ms: u64) {
        let breaks = self.answers.iter().filter(|answer| answer.question == BREAK.question).count();
        let occasion = match asked.occasion {
            "break" => format!("break {}", breaks + 1),
            other => other.to_owned(),
        };
        self.answers.push(Answered { occasion, question: asked.question, value: value.to_owned(), for_ms });
    }

    /// How many lines of a kind.
    pub fn count(&self, kind: &str) -> usize {
        self.deeds.iter().filter(|deed| deed.kind == kind).count()
    }
}

/// A question of the study.
#[derive(Debug, Clone, Copy)]
pub struct Asked {
    pub occasion: &'static str,
    pub questionnaire: &'static str,
    pub question: &'static str,
}

/// Weeks of a session.
pub const WEEKS: u32 = 4;

/// Before the first week.
pub const BEFORE: Asked = Asked { occasion: "before", questionnaire: "1-before", question: "experience" };
/// After the second week.
pub const WEEK: Asked = Asked { occasion: "week 2", questionnaire: "2-week", question: "check" };
/// After a break.
pub const BREAK: Asked = Asked { occasion: "break", questionnaire: "3-break", question: "spoke" };
/// After the end.
pub const END: Asked = Asked { occasion: "end", questionnaire: "4-end", question: "strategy" };
