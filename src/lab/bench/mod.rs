//! How fast this machine simulates, a row for each thing that people or programs wait for.
//!
//! A [`Case`] is something that is measured in a process of its own, so that its peak memory is its own too; it
//! yields samples of one or more [`BenchFigure`]s, and a figure's value is their median. New figures, for instance
//! those of the console, are further cases: [`CASES`] are those of the simulator.
//!
//! **Where the subscribers come from.** All cases play the policy P1a (the paper's best configuration) with seed
//! 42, the same company that the 500-day figures play. It passes 10,000, 40,000 and 165,000 subscribers by
//! itself; so a day is measured with the arrivals, bills, switches, cancellations and support issues that such
//! a company really has, and not with a crowd made up for the purpose. A million does not fit into its market,
//! so there the market is larger: with `leads.saturation_base` = b the room left is b - (N / cap)², which fills up
//! where (N / cap)² approaches b. The company is rich there, because it grows faster than it could pay for, and
//! it is measured only when all its subscribers have been billed once.
//!
//! **What a sample is.** Days are measured by the week, as they are played: the seven days, the figures, the
//! state hash and the lines of the trajectory, divided by seven, and scaled from the subscribers there are to
//! the number the figure names (they differ by less than a fifth). The policy's own decisions are not counted.
//! Where the projection works in the background, it is waited for between the weeks, as a person who reads the
//! dashboard does. The cost per subscriber is compared on one thread: what a second one is worth depends on how soon
//! the system wakes it, and that takes as long for a small company as for a large one.
//!
//! # Where the time goes
//!
//! Measured with a clock between the steps of a day on one thread of an EPYC, P1a (seed 42) at 172,000 subscribers:
//!
//! | share | what |
//! |---|---|
//! | 6 % | usage of everybody |
//! | 22 % | the first round among subscribers: who calls for help (a third of it draws a word for every place of a block), satisfaction, and on every seventh day how loud everybody is |
//! | 1 % | which issues are solved |
//! | 18 % | the second round: issues are settled, those who are due decide, and pay if they stay |
//! | 19 % | 3,900 new leads: traits, decision, their rows |
//! | 5 % | bills of newcomers and companies |
//! | 1 % | closing figures |
//! | 10 % | what follows from a day: the hash of its facts, words of posts |
//! | 15 % | the hash of the state, once a week |
//! | 3 % | the rest |
//!
//! On two threads all of it but about a twentieth is shared out. What helped, bit for bit as before: rounds in which
//! a block goes through several mechanisms while it is in the cache, instead of a pass each; pieces of work as small
//! as two blocks, because those who came on one day are due on one day, side by side; the hash of the state as a
//! tree, each thread hashing the bytes it has collected; what follows from a day beside the next day, and what follows
//! from the last one beside the hash of the state; days filled into facts that the writer of the database has done
//! with, instead of fresh memory; loops over some rows at a time without a branch and without a look at anything
//! shared, of which the compiler makes vector instructions: what was in the way was a parameter read only where a
//! condition holds, through a reference that the compiler does not know to be good.
//!
//! What did not: asking for the columns of a block before they are needed; other purge delays and page sizes of the
//! allocator; a second thread kept awake between the steps of a day, where two processors share a core; the weights of
//! posts without a branch; pieces of work of one block.
//!
//! The first days of a week with a database are slower than those in memory because both threads have slept: a
//! company in memory that sleeps a second before each week is as slow.
//!
//! **The floor.** A day reads and writes about 104 bytes of each subscriber's columns (usage 21, calls and satisfaction
//! 65, closing 8, billing days 2, the hash of the facts 8), and a seventh of the 171 bytes of a row for the hash of the
//! state: 128 bytes. At the 7 GB/s that one thread of this machine copies, a day at 165,000 is at least 3 ms of one
//! thread, at a million 18 ms. What is above it is arithmetic and the people who come, pay and leave, not passes over
//! columns.
//!
//! **Streams.** A stream is opened for every lead and every bill. That took 180 ns (BLAKE3, then ChaCha8, both a chain
//! of waiting steps); eight at a time take 50 ns each for one draw (`world::random`).

mod cases;
mod company;
mod machine;
mod queries;
mod resimulation;

use std::fmt;
use std::path::PathBuf;

use serde::Serialize;

use super::runner::RunError;
use novamind_record::error::RunError as SessionError;
use novamind_record::folder::configuration::Configuration;
use novamind_tools::Refusal;

pub use cases::{CASES, keep_a_large_company};
pub use machine::calibrate;
pub use queries::company_to_ask;

/// What a figure counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Unit {
    /// Milliseconds.
    Milliseconds,
    /// Seconds.
    Seconds,
    /// Nanoseconds for one subscriber and day.
    NanosecondsPerSubscriberDay,
    /// Millions of bytes.
    Megabytes,
    /// Percent.
    Percent,
}

impl Unit {
    /// Sign behind a number.
    pub fn sign(self) -> &'static str {
        match self {
            Unit::Milliseconds => "ms",
            Unit::Seconds => "s",
            Unit::NanosecondsPerSubscriberDay => "ns",
            Unit::Megabytes => "MB",
            Unit::Percent => "%",
        }
    }

    /// Seconds that one of it is; none for what is no time.
    pub fn seconds(self) -> Option<f64> {
        match self {
            Unit::Milliseconds => Some(1e-3),
            Unit::Seconds => Some(1.0),
            Unit::NanosecondsPerSubscriberDay => Some(1e-9),
            Unit::Megabytes | Unit::Percent => None,
        }
    }
}

/// One row of the speed table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BenchFigure {
    /// What is measured, as people read it.
    pub name: &'static str,
    /// Unit of the numbers.
    pub unit: Unit,
    /// Not more than this.
    pub target: Option<f64>,
    /// Better not more than this.
    pub stretch: Option<f64>,
}

/// How a measured value stands to its target.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// As good as was hoped for.
    WithinStretch,
    /// As good as was asked for.
    WithinTarget,
    /// Not good enough.
    Over,
    /// No target was set.
    NoTarget,
    /// This system does not tell.
    NotMeasured,
}

impl fmt::Display for Verdict {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(match self {
            Verdict::WithinStretch => "within stretch",
            Verdict::WithinTarget => "within target",
            Verdict::Over => "over",
            Verdict::NoTarget => "",
            Verdict::NotMeasured => "not measured",
        })
    }
}

impl BenchFigure {
    /// One with a target.
    pub const fn aimed(name: &'static str, unit: Unit, target: f64, stretch: Option<f64>) -> BenchFigure {
        BenchFigure { name, unit, target: Some(target), stretch }
    }

    /// One that is only shown.
    pub const fn shown(name: &'static str, unit: Unit) -> BenchFigure {
        BenchFigure { name, unit, target: None, stretch: None }
    }

    /// How a value stands to the target.
    pub fn verdict(&self, value: Option<f64>) -> Verdict {
        match (value, self.target, self.stretch) {
            (None, ..) => Verdict::NotMeasured,
            (Some(value), _, Some(stretch)) if value <= stretch => Verdict::WithinStretch,
            (Some(value), Some(target), _) if value <= target => Verdict::WithinTarget,
            (Some(_), Some(_), _) => Verdict::Over,
            (Some(_), None, _) => Verdict::NoTarget,
        }
    }
}

/// Samples of the figures of a case, in their order; a figure this system does not tell has none.
pub type Samples = Vec<Vec<f64>>;

/// Something that is measured in a process of its own.
pub struct Case {
    /// Name for `--only`.
    pub name: &'static str,
    /// What it yields.
    pub figures: &'static [BenchFigure],
    /// Whether every repetition needs a fresh process; otherwise one process repeats.
    pub fresh: bool,
    /// Whether it takes so long that a quick look leaves it out.
    pub long: bool,
    /// Measures.
    pub measure: fn(&Bench) -> Result<Samples, BenchError>,
}

/// What a measurement needs to know.
pub struct Bench {
    /// How often to measure.
    pub repetitions: usize,
    /// Folder for runs; everything in it may be removed.
    pub scratch: PathBuf,
    /// Configuration to play with.
    pub configuration: Configuration,
}

/// Why something could not be measured.
#[derive(Debug)]
pub struct BenchError(String);

impl BenchError {
    /// An error in words.
    pub fn new(words: String) -> BenchError {
        BenchError(words)
    }
}

impl fmt::Display for BenchError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.0)
    }
}

impl std::error::Error for BenchError {}

macro_rules! from_errors {
    ($($kind:ty),*) => {$(
        impl From<$kind> for BenchError {
            fn from(error: $kind) -> BenchError {
                BenchError(error.to_string())
            }
        }
    )*};
}
from_errors!(
    RunError,
    SessionError,
    Refusal,
    super::policy::PolicyError,
    std::io::Error,
    rayon::ThreadPoolBuildError
);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn verdicts_compare_with_target_and_stretch() {
        let figure =
            |target, stretch| BenchFigure { name: "a day", unit: Unit::Milliseconds, target, stretch };
        let both = figure(Some(10.0), Some(4.0));
        assert_eq!(both.verdict(Some(4.0)), Verdict::WithinStretch);
        assert_eq!(both.verdict(Some(10.0)), Verdict::WithinTarget);
        assert_eq!(both.verdict(Some(10.1)), Verdict::Over);
        assert_eq!(both.verdict(None), Verdict::NotMeasured);
        assert_eq!(figure(Some(10.0), None).verdict(Some(1.0)), Verdict::WithinTarget);
        assert_eq!(figure(None, None).verdict(Some(1.0)), Verdict::NoTarget);
    }

    #[test]
    fn every_case_has_a_name_of_its_own_and_figures() {
        let mut names: Vec<&str> = CASES.iter().map(|case| case.name).collect();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), CASES.len());
        assert!(CASES.iter().all(|case| !case.figures.is_empty()));
    }
}
