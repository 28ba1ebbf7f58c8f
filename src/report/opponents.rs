//! Results of strong policies in the same world as a finished run.

use std::path::Path;

use serde::Serialize;

use novamind_base::formatting::dollars;
use novamind_record::folder::configuration::Configuration;
use novamind_tools::Rejection;

/// Result of a policy in the world of a run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OpponentResult {
    /// Policy name.
    pub policy: String,
    /// Last simulated day.
    pub day: u32,
    /// Cash on that day, dollars; the score is 0 after a bankruptcy.
    pub cash: f64,
    /// Whether it went bankrupt on that day.
    pub is_bankrupt: bool,
    /// The rejection that stopped it on that day, if any.
    pub stopped: Option<String>,
}

/// A run and its opponents.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OpponentResults {
    /// Day of comparison: the last day of the run's world, or of a lesson's part.
    pub day: u32,
    /// The policies, highest score first.
    pub policies: Vec<OpponentResult>,
}

/// Plays the opponents of the run in a folder while the callback returns true. Returns `None` if it was stopped.
pub type PlayOpponentsFn =
    fn(&Path, &Configuration, &(dyn Fn() -> bool + Sync)) -> Result<Option<OpponentResults>, Rejection>;

impl OpponentResult {
    /// Returns the final cash in dollars; 0 after a bankruptcy.
    pub fn score(&self) -> f64 {
        if self.is_bankrupt { 0.0 } else { self.cash }
    }

    /// Describes the end.
    pub fn describe(&self) -> String {
        match &self.stopped {
            Some(why) => format!("{} when it stopped on day {}: {why}", dollars(self.cash), self.day),
            None if self.is_bankrupt => format!("bankrupt on day {}", self.day),
            None => dollars(self.cash),
        }
    }
}

impl OpponentResults {
    /// Describes the comparison.
    pub fn describe(&self) -> String {
        format!("each policy plays this run's world from day 0 to day {}, with the same seed", self.day)
    }

    /// Returns how many have a higher score.
    pub fn count_ahead_of(&self, score: f64) -> usize {
        self.policies.iter().filter(|opponent_result| opponent_result.score() > score).count()
    }
}
