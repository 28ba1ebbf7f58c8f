//! Shards: which runs are played where, and the first line of a file of rows, which says what the rest is.

use std::fmt;

use serde::{Deserialize, Serialize};

use super::StudyPlan;
use crate::experiment::ExperimentError;
use novamind_record::folder::configuration::Configuration;
use novamind_world::MECHANICS;

/// What the first line of a shard begins with.
const MARK: &str = "# novamind study shard ";

/// One of several parts of a study.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Shard {
    /// Which, from 1.
    pub shard: usize,
    /// Of how many.
    pub of: usize,
}

impl fmt::Display for Shard {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{} of {}", self.shard, self.of)
    }
}

/// Most shards of a study.
const MOST_SHARDS: usize = 100_000;

/// Reads `2/4`.
///
/// # Errors
/// It is no shard.
pub fn parse_shard(text: &str) -> Result<Shard, String> {
    let wrong = || format!("{text} is no shard: the second of four is 2/4, from 1/N to N/N");
    let (shard, of) = text.split_once('/').ok_or_else(wrong)?;
    let number = |text: &str| text.trim().parse::<usize>().map_err(|_| wrong());
    let own = Shard { shard: number(shard)?, of: number(of)? };
    if own.shard == 0 || own.shard > own.of || own.of > MOST_SHARDS { Err(wrong()) } else { Ok(own) }
}

impl Shard {
    /// Its runs among so many, by their numbers from 0.
    pub fn numbers(self, runs: usize) -> Vec<usize> {
        (self.shard - 1..runs).step_by(self.of).collect()
    }
}

/// What a shard says of itself in its first line.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ShardHead {
    /// Name of the study.
    pub study: String,
    /// Names everything its rows depend on: program, mechanics, parameters, policies, seeds, columns.
    pub digest: String,
    /// Which part of it.
    #[serde(flatten)]
    pub part: Shard,
    /// blake3 of the lines that follow.
    pub checksum: String,
}

impl ShardHead {
    /// The file of a shard: its first line, then its rows under the names of their columns.
    pub fn sealed(study: &str, digest: &str, part: Shard, rows: &str) -> String {
        let head = ShardHead {
            study: study.to_owned(),
            digest: digest.to_owned(),
            part,
            checksum: blake3::hash(rows.as_bytes()).to_hex()[..32].to_owned(),
        };
        format!("{MARK}{}\n{rows}", serde_json::to_string(&head).expect("plain values"))
    }

    /// Of the first line of a file; none if it is no shard.
    pub(super) fn of_line(line: &str) -> Option<ShardHead> {
        let head: ShardHead = serde_json::from_str(line.strip_prefix(MARK)?).ok()?;
        (head.part.shard >= 1 && head.part.shard <= head.part.of && head.part.of <= MOST_SHARDS)
            .then_some(head)
    }

    /// The name under which a shard is written.
    pub fn file_name(study: &str, part: Shard) -> String {
        format!("{study}.{}-of-{}.csv", part.shard, part.of)
    }
}

impl StudyPlan {
    /// Names everything that the rows of the study depend on.
    ///
    /// # Errors
    /// An arm could not begin.
    pub fn digest(&self, configuration: &Configuration) -> Result<String, ExperimentError> {
        let mut hasher = blake3::Hasher::new();
        let labels = serde_json::json!([env!("CARGO_PKG_VERSION"), MECHANICS, self.factors, self.levels]);
        hasher.update(labels.to_string().as_bytes());
        for key in self.experiment.keys(configuration)? {
            hasher.update(key.as_bytes());
        }
        Ok(hasher.finalize().to_hex()[..32].to_owned())
    }
}
