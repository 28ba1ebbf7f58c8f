//! Speed of simulation on this machine: one row per operation that users or programs wait for.
//!
//! Each [`BenchCase`] is measured in a separate process, so that its peak memory can be measured. A case returns
//! samples of one or more [`BenchFigure`]s. The value of a figure is the median of its samples. [`CASES`] covers the
//! simulator. Other crates can add cases, for example for the console.
//!
//! **Where the subscribers come from.** All cases play the policy P1a (the paper's best configuration) with
//! seed 42. The 500-day figures play the same company. The company reaches 10,000, 40,000 and 165,000
//! subscribers without intervention. A measured day therefore includes realistic leads, bills, switches,
//! cancellations and support issues, not synthetic subscribers. The default market is too small for a million
//! subscribers, so these cases use a larger market: with `leads.saturation_base` = b, the unused share is b -
//! (N / cap)². In the larger market, the company starts with more cash, because otherwise it could not pay
//! for its faster growth. The larger company is measured only after all its subscribers have been billed
//! once.
//!
//! **What a sample is.** Days are measured in weeks, as they are played. A sample includes the seven days,
//! the figures, the state hash and the lines of the trajectory. The time is divided by seven and scaled from
//! the actual number of subscribers to the number in the figure's name. The two numbers differ by less than a
//! fifth. The decisions of the policy are not measured. If the projection runs in the background, the case
//! waits for it between weeks, as a user who reads the dashboard does. The cost per subscriber is compared on
//! one thread, because the gain from a second thread depends on its wake-up latency, which is the same for
//! small and large companies.
//!
//! # Where the time goes
//!
//! Share of the time of a day by step, on one thread of an EPYC, for P1a (seed 42) with 172,000 subscribers:
//!
//! | share | step |
//! |---|---|
//! | 6 % | usage of all subscribers |
//! | 22 % | first pass over subscribers: support calls (a third of this time draws a random word for every slot of a block), satisfaction, and every seventh day posting weights |
//! | 1 % | resolved issues |
//! | 18 % | second pass: issue updates, renewal decisions of due subscribers, their payments |
//! | 19 % | 3,900 new leads: traits, decisions, rows |
//! | 5 % | bills of new subscribers and enterprises |
//! | 1 % | closing figures |
//! | 10 % | after a day: hash of its facts, texts of posts |
//! | 15 % | state hash, once a week |
//! | 3 % | the rest |
//!
//! On two threads, about 95 % of this work runs in parallel. The following changes made the simulation faster
//! and kept results bit-identical. Several mechanisms process a block in one pass, while the block is in the
//! cache. Work units are as small as two blocks, because subscribers who signed up on one day are adjacent
//! and due on the same day. The state hash is a tree, and each thread hashes the bytes that it collected. The
//! work after a day runs in parallel with the next day, or with the state hash after the last day. Fact
//! buffers are reused after the database writer has processed them. Loops process several rows at a time
//! without branches and without access to shared data, so that the compiler can vectorize them. Vectorization
//! fails if a parameter is read only under a condition through a reference, because the compiler cannot prove
//! that the reference is dereferenceable.
//!
//! The following changes did not make the simulation faster: prefetching the columns of a block, other purge
//! delays and page sizes of the allocator, post weights without a branch, and work units of one block.
//! Keeping a second thread awake between the steps of a day did not help either, on two hardware threads of
//! one core.
//!
//! The first days of a week are slower with a database than in memory, because both threads slept before the week. A
//! company in memory is equally slow if the program sleeps for a second before each week.
//!
//! **Lower bound.** A day reads and writes about 104 bytes of each subscriber's columns (usage 21, calls and
//! satisfaction 65, closing 8, billing days 2, the hash of the facts 8), and a seventh of the 171 bytes of a row for
//! the state hash: 128 bytes. One thread of this machine copies 7 GB/s. A day therefore takes at least 3 ms of one
//! thread with 165,000 subscribers, and 18 ms with a million. The remaining time is spent on arithmetic, signups,
//! payments and cancellations, not on passes over columns.
//!
//! **Streams.** Every lead and every bill opens a stream. Opening a single stream takes 180 ns (BLAKE3, then
//! ChaCha8, each of which is a chain of dependent steps). If eight streams are opened at a time, opening a
//! stream and making one draw takes 50 ns (`world::random`).

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
pub use queries::create_company_for_queries;

/// The unit of a benchmark figure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum BenchUnit {
    /// A time in milliseconds.
    Milliseconds,
    /// A time in seconds.
    Seconds,
    /// A time in nanoseconds per subscriber per simulated day.
    NanosecondsPerSubscriberDay,
    /// Megabytes, 1,000,000 bytes each.
    Megabytes,
    /// A share in percent.
    Percent,
}

impl BenchUnit {
    /// Returns the symbol of the unit.
    pub fn symbol(self) -> &'static str {
        match self {
            BenchUnit::Milliseconds => "ms",
            BenchUnit::Seconds => "s",
            BenchUnit::NanosecondsPerSubscriberDay => "ns",
            BenchUnit::Megabytes => "MB",
            BenchUnit::Percent => "%",
        }
    }

    /// Returns the length of the unit in seconds, or `None` if the unit is not a time.
    pub fn seconds_per_unit(self) -> Option<f64> {
        match self {
            BenchUnit::Milliseconds => Some(1e-3),
            BenchUnit::Seconds => Some(1.0),
            BenchUnit::NanosecondsPerSubscriberDay => Some(1e-9),
            BenchUnit::Megabytes | BenchUnit::Percent => None,
        }
    }
}

/// A measured quantity: one row of the speed table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BenchFigure {
    /// Name of the figure in the speed table.
    pub name: &'static str,
    /// Unit of the measured values.
    pub unit: BenchUnit,
    /// Maximum allowed value; `None` if the figure has no target.
    pub target: Option<f64>,
    /// Maximum desired value; `None` if the figure has no stretch target.
    pub stretch: Option<f64>,
}

/// Whether a measured value meets its target.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum TargetVerdict {
    /// The value is within the stretch target.
    WithinStretch,
    /// The value is within the target.
    WithinTarget,
    /// The value is above the target.
    Over,
    /// The figure has no target.
    NoTarget,
    /// The system does not report the value.
    NotMeasured,
}

impl fmt::Display for TargetVerdict {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(match self {
            TargetVerdict::WithinStretch => "within stretch",
            TargetVerdict::WithinTarget => "within target",
            TargetVerdict::Over => "over",
            TargetVerdict::NoTarget => "",
            TargetVerdict::NotMeasured => "not measured",
        })
    }
}

impl BenchFigure {
    /// Creates a benchmark figure with a target.
    pub const fn with_target(
        name: &'static str,
        unit: BenchUnit,
        target: f64,
        stretch: Option<f64>,
    ) -> BenchFigure {
        BenchFigure { name, unit, target: Some(target), stretch }
    }

    /// Creates a benchmark figure without a target.
    pub const fn without_target(name: &'static str, unit: BenchUnit) -> BenchFigure {
        BenchFigure { name, unit, target: None, stretch: None }
    }

    /// Compares a measured value with the target of the figure.
    pub fn verdict(&self, value: Option<f64>) -> TargetVerdict {
        match (value, self.target, self.stretch) {
            (None, ..) => TargetVerdict::NotMeasured,
            (Some(value), _, Some(stretch)) if value <= stretch => TargetVerdict::WithinStretch,
            (Some(value), Some(target), _) if value <= target => TargetVerdict::WithinTarget,
            (Some(_), Some(_), _) => TargetVerdict::Over,
            (Some(_), None, _) => TargetVerdict::NoTarget,
        }
    }
}

/// Samples of each figure of a case, in the order of the figures. A list is empty if the system does not
/// report the figure.
pub type Samples = Vec<Vec<f64>>;

/// A benchmark case, which is measured in a separate process.
pub struct BenchCase {
    /// Name of the case for `--only`.
    pub name: &'static str,
    /// Figures that the case measures.
    pub figures: &'static [BenchFigure],
    /// Whether every repetition needs a new process. Otherwise one process measures all repetitions.
    pub needs_new_process: bool,
    /// Whether a quick run skips the case because it takes long.
    pub is_slow: bool,
    /// Function that measures the samples of the case.
    pub measure: fn(&BenchContext) -> Result<Samples, BenchError>,
}

/// Options that every benchmark case receives.
pub struct BenchContext {
    /// Number of repetitions of each measurement.
    pub repetitions: usize,
    /// Scratch folder for runs. Its contents can be deleted.
    pub scratch_folder: PathBuf,
    /// Configuration of the measured runs.
    pub configuration: Configuration,
    /// Scenario of the measured runs; `None` for the scenario of the policy.
    pub scenario: Option<String>,
}

/// The reason why a measurement failed.
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
            |target, stretch| BenchFigure { name: "a day", unit: BenchUnit::Milliseconds, target, stretch };
        let both = figure(Some(10.0), Some(4.0));
        assert_eq!(both.verdict(Some(4.0)), TargetVerdict::WithinStretch);
        assert_eq!(both.verdict(Some(10.0)), TargetVerdict::WithinTarget);
        assert_eq!(both.verdict(Some(10.1)), TargetVerdict::Over);
        assert_eq!(both.verdict(None), TargetVerdict::NotMeasured);
        assert_eq!(figure(Some(10.0), None).verdict(Some(1.0)), TargetVerdict::WithinTarget);
        assert_eq!(figure(None, None).verdict(Some(1.0)), TargetVerdict::NoTarget);
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
