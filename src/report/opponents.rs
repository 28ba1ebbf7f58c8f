//! Results of strong policies on the seed and scenario of a finished run.

use std::path::Path;

use serde::Serialize;

use novamind_base::formatting::dollars;
use novamind_record::folder::configuration::Configuration;
use novamind_tools::Rejection;

/// Result of a policy on the seed and scenario of a run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OpponentResult {
    /// Name of the policy.
    pub policy: String,
    /// Last day that the policy played.
    pub day: u32,
    /// Cash at the end of this day, dollars. The score is 0 after a bankruptcy.
    pub cash: f64,
    /// Whether the company went bankrupt on this day.
    pub is_bankrupt: bool,
    /// The rejection that stopped the policy on this day, if any.
    pub stopped: Option<String>,
}

/// Results of all opponents of a run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OpponentResults {
    /// Day on which the results are compared: the planned last day of the run or, in a lesson, of its part.
    pub day: u32,
    /// Results of the policies, highest score first.
    pub policies: Vec<OpponentResult>,
}

/// Function that plays the opponents of the run in a folder while the callback returns `true`. It returns `None` if the
/// callback stopped it.
pub type PlayOpponentsFn =
    fn(&Path, &Configuration, &(dyn Fn() -> bool + Sync)) -> Result<Option<OpponentResults>, Rejection>;

impl OpponentResult {
    /// Returns the final cash in dollars; 0 after a bankruptcy.
    pub fn score(&self) -> f64 {
        if self.is_bankrupt { 0.0 } else { self.cash }
    }

    /// Describes the final cash of the policy, or why the policy ended early.
    pub fn describe(&self) -> String {
        match &self.stopped {
            Some(why) => format!("{} when it stopped on day {}: {why}", dollars(self.cash), self.day),
            None if self.is_bankrupt => format!("bankrupt on day {}", self.day),
            None => dollars(self.cash),
        }
    }
}

impl OpponentResults {
    /// Describes how the opponents are compared with the run.
    pub fn describe(&self) -> String {
        format!("each policy plays this run's world from day 0 to day {}, with the same seed", self.day)
    }

    /// Returns the number of opponents with a higher score.
    pub fn count_ahead_of(&self, score: f64) -> usize {
        self.policies.iter().filter(|opponent_result| opponent_result.score() > score).count()
    }
}
