//! Shards of a study: the assignment of runs to shards, and the first line of a shard file.

use std::fmt;

use serde::{Deserialize, Serialize};

use super::StudyPlan;
use crate::experiment::ExperimentError;
use novamind_record::folder::configuration::Configuration;
use novamind_world::MECHANICS;

/// Prefix of the first line of a shard file.
const SHARD_PREFIX: &str = "# novamind study shard ";

/// A shard: one of several parts of a study.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Shard {
    /// Number of the shard, from 1.
    pub shard: usize,
    /// Total number of shards of the study.
    pub of: usize,
}

impl fmt::Display for Shard {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{} of {}", self.shard, self.of)
    }
}

const MAX_SHARDS: usize = 100_000;

/// Parses a shard: `2/4` is the second of four shards.
///
/// # Errors
/// Fails if the text is not a valid shard.
pub fn parse_shard(text: &str) -> Result<Shard, String> {
    let wrong = || format!("{text} is not a shard: write the second of four as 2/4");
    let (shard, of) = text.split_once('/').ok_or_else(wrong)?;
    let number = |text: &str| text.trim().parse::<usize>().map_err(|_| wrong());
    let shard = Shard { shard: number(shard)?, of: number(of)? };
    if shard.shard == 0 || shard.shard > shard.of || shard.of > MAX_SHARDS { Err(wrong()) } else { Ok(shard) }
}

impl Shard {
    /// Returns the indices of the runs that belong to the shard.
    pub fn run_numbers(self, runs: usize) -> Vec<usize> {
        (self.shard - 1..runs).step_by(self.of).collect()
    }
}

/// The description of a shard in the first line of its file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ShardHeader {
    /// Name of the study to which the shard belongs.
    pub study: String,
    /// Digest of everything on which the rows depend: program, mechanics, parameters, policies, seeds and columns.
    pub digest: String,
    /// Shard whose rows the file contains.
    #[serde(flatten)]
    pub part: Shard,
    /// BLAKE3 hash of the lines after the first line.
    pub checksum: String,
}

impl ShardHeader {
    /// Returns the content of a shard file: first line, header and rows.
    pub fn with_checksum(study: &str, digest: &str, part: Shard, rows: &str) -> String {
        let head = ShardHeader {
            study: study.to_owned(),
            digest: digest.to_owned(),
            part,
            checksum: blake3::hash(rows.as_bytes()).to_hex()[..32].to_owned(),
        };
        format!("{SHARD_PREFIX}{}\n{rows}", serde_json::to_string(&head).expect("plain values"))
    }

    /// Parses the first line of a shard file. Returns `None` if the line has another format.
    pub(super) fn parse(line: &str) -> Option<ShardHeader> {
        let head: ShardHeader = serde_json::from_str(line.strip_prefix(SHARD_PREFIX)?).ok()?;
        (head.part.shard >= 1 && head.part.shard <= head.part.of && head.part.of <= MAX_SHARDS)
            .then_some(head)
    }

    /// Returns the file name of a shard of a study.
    pub fn file_name(study: &str, part: Shard) -> String {
        format!("{study}.{}-of-{}.csv", part.shard, part.of)
    }
}

impl StudyPlan {
    /// Returns the digest of everything on which the rows of the study depend.
    ///
    /// # Errors
    /// Fails if an arm cannot start.
    pub fn digest(&self, configuration: &Configuration) -> Result<String, ExperimentError> {
        let mut hasher = blake3::Hasher::new();
        let labels = serde_json::json!([env!("CARGO_PKG_VERSION"), MECHANICS, self.factors, self.levels]);
        hasher.update(labels.to_string().as_bytes());
        for key in self.experiment.run_keys(configuration)? {
            hasher.update(key.as_bytes());
        }
        Ok(hasher.finalize().to_hex()[..32].to_owned())
    }
}
