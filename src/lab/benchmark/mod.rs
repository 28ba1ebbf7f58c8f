//! Speed of simulation on this machine: one row per operation that users or programs wait for.
//!
//! A [`Case`] is measured in a separate process, so that its peak memory is measured too; it
//! yields samples of one or more [`BenchFigure`]s, and a figure's value is their median. New figures, for instance
//! those of the console, are additional cases; [`CASES`] covers the simulator.
//!
//! **Where the subscribers come from.** All cases play the policy P1a (the paper's best configuration) with seed
//! 42, the same company that the 500-day figures play. It passes 10,000, 40,000 and 165,000 subscribers by
//! itself, so a day is measured with the leads, bills, switches, cancellations and support issues that such
//! a company really has, not with synthetic subscribers. A million does not fit into its market,
//! so there the market is larger: with `leads.saturation_base` = b the room left is b - (N / cap)², which fills up
//! where (N / cap)² approaches b. The company is rich there, because it grows faster than it could pay for, and
//! it is measured only after all its subscribers were billed once.
//!
//! **What a sample is.** Days are measured by the week, as they are played: the seven days, the figures, the
//! state hash and the lines of the trajectory, divided by seven, and scaled from the subscribers there are to
//! the number the figure names (they differ by less than a fifth). The policy's own decisions are not counted.
//! If the projection runs in the background, the case waits for it between weeks, as a user who reads the
//! dashboard does. The cost per subscriber is compared on one thread: the gain of a second one depends on how soon
//! the system wakes it, which takes equally long for small and large companies.
//!
//! # Where the time goes
//!
//! Measured between the steps of a day on one thread of an EPYC, P1a (seed 42) at 172,000 subscribers:
//!
//! | share | step |
//! |---|---|
//! | 6 % | usage of all subscribers |
//! | 22 % | first pass over subscribers: support calls (a third of it draws a word for every slot of a block), satisfaction, and every seventh day posting weights |
//! | 1 % | resolved issues |
//! | 18 % | second pass: settle issues, renewal decisions of due subscribers, their payments |
//! | 19 % | 3,900 new leads: traits, decisions, rows |
//! | 5 % | bills of new subscribers and enterprises |
//! | 1 % | closing figures |
//! | 10 % | after a day: hash of its facts, texts of posts |
//! | 15 % | state hash, once a week |
//! | 3 % | the rest |
//!
//! On two threads about 95 % of it runs in parallel. These changes helped and kept results bit-identical: passes in which
//! a block goes through several mechanisms while it is in the cache, instead of a pass each; pieces of work as small
//! as two blocks, because subscribers of one day are due on one day and adjacent; the state hash as a
//! tree, with each thread hashing the bytes it collected; the work after a day in parallel with the next day, and after
//! the last day in parallel with the state hash; reuse of fact buffers that the database writer has finished
//! with; loops over several rows at a time without branches and without access to
//! shared data, which the compiler vectorizes. The obstacle was a parameter read only if a
//! condition is true, through a reference that the compiler cannot prove dereferenceable.
//!
//! These did not help: prefetching the columns of a block; other purge delays and page sizes of the
//! allocator; keeping a second thread awake between the steps of a day on two processors of one core; post weights
//! without a branch; work units of one block.
//!
//! The first days of a week with a database are slower than those in memory because both threads slept: a
//! company in memory that sleeps a second before each week is as slow.
//!
//! **Lower bound.** A day reads and writes about 104 bytes of each subscriber's columns (usage 21, calls and satisfaction
//! 65, closing 8, billing days 2, the hash of the facts 8), and a seventh of the 171 bytes of a row for the hash of the
//! state: 128 bytes. At the 7 GB/s that one thread of this machine copies, a day at 165,000 is at least 3 ms of one
//! thread, at a million 18 ms. The rest is arithmetic and sign-ups, payments and cancellations, not passes over
//! columns.
//!
//! **Streams.** Every lead and every bill opens a stream. That took 180 ns (BLAKE3, then ChaCha8, both a chain
//! of dependent steps); eight at a time take 50 ns each for one draw (`world::random`).

mod cases;
mod machine;
mod measured_company;
mod queries;
mod resimulation;

use std::fmt;
use std::path::PathBuf;

use serde::Serialize;

use super::runner::RunError;
use novamind_record::error::RunError as SessionError;
use novamind_record::folder::configuration::Configuration;
use novamind_tools::Rejection;

pub use cases::{CASES, save_large_company};
pub use machine::calibration_seconds;
pub use queries::company_for_queries;

/// Unit of a figure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Unit {
    /// Milliseconds.
    Milliseconds,
    /// Seconds.
    Seconds,
    /// Nanoseconds per subscriber and day.
    NanosecondsPerSubscriberDay,
    /// Millions of bytes.
    Megabytes,
    /// Percent.
    Percent,
}

impl Unit {
    /// Returns the unit symbol.
    pub fn symbol(self) -> &'static str {
        match self {
            Unit::Milliseconds => "ms",
            Unit::Seconds => "s",
            Unit::NanosecondsPerSubscriberDay => "ns",
            Unit::Megabytes => "MB",
            Unit::Percent => "%",
        }
    }

    /// Returns the unit's length in seconds, or `None` if it is not a time.
    pub fn seconds_per_unit(self) -> Option<f64> {
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
    /// Name of the measurement.
    pub name: &'static str,
    /// Unit of the numbers.
    pub unit: Unit,
    /// Maximum allowed value.
    pub target: Option<f64>,
    /// Maximum desired value.
    pub stretch: Option<f64>,
}

/// A measured value compared with its target.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Within the stretch target.
    WithinStretch,
    /// Within the target.
    WithinTarget,
    /// Above the target.
    Over,
    /// The figure has no target.
    NoTarget,
    /// The system does not report it.
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
    /// Returns a figure with a target.
    pub const fn with_target(
        name: &'static str,
        unit: Unit,
        target: f64,
        stretch: Option<f64>,
    ) -> BenchFigure {
        BenchFigure { name, unit, target: Some(target), stretch }
    }

    /// Returns a figure without a target.
    pub const fn without_target(name: &'static str, unit: Unit) -> BenchFigure {
        BenchFigure { name, unit, target: None, stretch: None }
    }

    /// Compares a value with the target.
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

/// Samples of a case's figures in order; empty if the system does not report a figure.
pub type Samples = Vec<Vec<f64>>;

/// A measurement that runs in a separate process.
pub struct Case {
    /// Name for `--only`.
    pub name: &'static str,
    /// Figures that it measures.
    pub figures: &'static [BenchFigure],
    /// Whether every repetition needs a new process; otherwise one process repeats.
    pub needs_new_process: bool,
    /// Whether a quick run skips it because it takes long.
    pub is_slow: bool,
    /// Function that measures.
    pub measure: fn(&BenchContext) -> Result<Samples, BenchError>,
}

/// Options of a measurement.
pub struct BenchContext {
    /// Number of repetitions.
    pub repetitions: usize,
    /// Scratch folder for runs; its contents can be deleted.
    pub scratch_folder: PathBuf,
    /// Configuration of the runs.
    pub configuration: Configuration,
}

/// Reason why a measurement failed.
#[derive(Debug)]
pub struct BenchError(String);

impl BenchError {
    /// Creates an error from a message.
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
    Rejection,
    super::policy::PolicyError,
    std::io::Error,
    rayon::ThreadPoolBuildError
);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn verdict_follows_target_and_stretch() {
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
    fn cases_have_unique_names_and_figures() {
        let mut names: Vec<&str> = CASES.iter().map(|case| case.name).collect();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), CASES.len());
        assert!(CASES.iter().all(|case| !case.figures.is_empty()));
    }
}
