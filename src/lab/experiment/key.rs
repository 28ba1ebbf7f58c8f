//! What names a run of an experiment: everything its result depends on.

use super::{Arm, Wanted};
use novamind_record::error::RunError;
use novamind_record::folder::configuration::Configuration;
use novamind_world::MECHANICS;

/// What the runs of an arm have in common.
pub(super) struct ArmKey {
    /// Everything but the seed, as a hash that it completes.
    hasher: blake3::Hasher,
    /// Cash on day 0, dollars.
    pub(super) start_cash: f64,
}

impl ArmKey {
    /// The key of an arm. Its name is not part of it: the same run under another name is the same run.
    ///
    /// # Errors
    /// There is no such scenario, or a parameter is wrong.
    pub(super) fn of(arm: &Arm, wanted: &Wanted, configuration: &Configuration) -> Result<ArmKey, RunError> {
        let (days, cash, params) = arm.terms(configuration)?;
        let policy = &arm.policy;
        let plays = (&policy.rule_based, &policy.calls, &policy.enterprise);
        let mut hasher = blake3::Hasher::new();
        for part in [
            format!("{} {MECHANICS}", env!("CARGO_PKG_VERSION")),
            params.digest(),
            format!("{plays:?}"),
            format!("{days} {:?} {}", arm.spec.until, cash.to_bits()),
            format!("{wanted:?}"),
        ] {
            hasher.update(&(part.len() as u64).to_le_bytes());
            hasher.update(part.as_bytes());
        }
        Ok(ArmKey { hasher, start_cash: cash })
    }

    /// The key of a run.
    pub(super) fn of_seed(&self, seed: u64) -> String {
        let mut hasher = self.hasher.clone();
        hasher.update(&seed.to_le_bytes());
        hasher.finalize().to_hex()[..32].to_owned()
    }
}
