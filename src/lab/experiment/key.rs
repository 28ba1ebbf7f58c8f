//! Keys of experiment runs. A key is a hash of everything on which the result depends.

use super::{Arm, RecordedFigures};
use novamind_record::error::RunError;
use novamind_record::folder::configuration::Configuration;
use novamind_world::MECHANICS;

/// The part of a run key that all runs of an arm have in common.
pub(super) struct ArmKey {
    /// Hasher that has read everything except the seed.
    hasher: blake3::Hasher,
    /// Cash on day 0, dollars.
    pub(super) start_cash: f64,
}

impl ArmKey {
    /// Creates the key of an arm. The key does not depend on the arm's name.
    ///
    /// # Errors
    /// Fails if the scenario is unknown or a parameter is invalid.
    pub(super) fn new(
        arm: &Arm,
        wanted: &RecordedFigures,
        configuration: &Configuration,
    ) -> Result<ArmKey, RunError> {
        let (horizon, cash, params) = arm.run_conditions(configuration)?;
        let policy = &arm.policy;
        let plays = (&policy.rule_based, &policy.calls, &policy.enterprise);
        let mut hasher = blake3::Hasher::new();
        for part in [
            format!("{} {MECHANICS}", env!("CARGO_PKG_VERSION")),
            params.digest(),
            format!("{plays:?}"),
            format!("{} {:?} {}", horizon.total_days, arm.spec.stop_after_day, cash.to_bits()),
            format!("{wanted:?}"),
        ] {
            hasher.update(&(part.len() as u64).to_le_bytes());
            hasher.update(part.as_bytes());
        }
        Ok(ArmKey { hasher, start_cash: cash })
    }

    /// Returns the key of the arm's run with a seed.
    pub(super) fn run_key(&self, seed: u64) -> String {
        let mut hasher = self.hasher.clone();
        hasher.update(&seed.to_le_bytes());
        hasher.finalize().to_hex()[..32].to_owned()
    }
}
