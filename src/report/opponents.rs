//! What the strong policies make of the world of a run that is over, beside the run itself.

use std::path::Path;

use serde::Serialize;

use novamind_base::notation::dollars;
use novamind_record::folder::configuration::Configuration;
use novamind_tools::Refusal;

/// What became of a policy in the world of a run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Opponent {
    /// Its name.
    pub policy: String,
    /// Last simulated day.
    pub day: u32,
    /// Cash on that day, dollars; the score is 0 after a bankruptcy.
    pub cash: f64,
    /// It went bankrupt on that day.
    pub is_bankrupt: bool,
    /// Why it stopped on that day, if a tool refused what it called.
    pub stopped: Option<String>,
}

/// A run and its opponents.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Opponents {
    /// The day on which scores are compared: the last of the run's world, or of a lesson's part.
    pub day: u32,
    /// The policies, the one with the highest score first.
    pub policies: Vec<Opponent>,
}

/// Plays the opponents of the run in a folder, as long as it is to go on; none if it was stopped.
pub type PlayOpponents =
    fn(&Path, &Configuration, &(dyn Fn() -> bool + Sync)) -> Result<Option<Opponents>, Refusal>;

impl Opponent {
    /// What it ends with: its cash, nothing after a bankruptcy.
    pub fn score(&self) -> f64 {
        if self.is_bankrupt { 0.0 } else { self.cash }
    }

    /// How it ended, in words.
    pub fn in_words(&self) -> String {
        match &self.stopped {
            Some(why) => format!("{} when it stopped on day {}: {why}", dollars(self.cash), self.day),
            None if self.is_bankrupt => format!("bankrupt on day {}", self.day),
            None => dollars(self.cash),
        }
    }
}

impl Opponents {
    /// What they are, in words.
    pub fn in_words(&self) -> String {
        format!("each policy plays the world of this run from day 0 to day {}, with the same luck", self.day)
    }

    /// How many end with more than a score.
    pub fn ahead_of(&self, score: f64) -> usize {
        self.policies.iter().filter(|own| own.score() > score).count()
    }
}
