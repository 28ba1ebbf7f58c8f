//! Seeded faults: deliberate errors in mechanisms, for debugging exercises with the x-ray
//! (`docs/debugging-walkthrough.md`).
//!
//! The simulation checks faults once per day, group or event and never per customer, so a fault does not slow the
//! simulation. A fault is not a parameter: no file and no setting can change it.

use serde::{Deserialize, Serialize};

use super::params::Params;

/// A deliberate error in one mechanism, present for the whole run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "u32", into = "u32")]
pub enum Fault {
    /// The effect of the economy on leads has the wrong sign.
    EconomyReversed,
    /// Satisfaction uses demand / quota instead of quota / demand.
    QuotaInverted,
    /// Competitors make the smaller of their two possible moves.
    SmallerRivalMove,
    /// Spillover has the wrong sign.
    SpillOverReversed,
    /// Tenure bonuses count days as months.
    TenureInDays,
    /// The drift of each group is applied twice.
    DriftTwice,
    /// Word of mouth uses the rate in the opposite direction, from the target group to the source group.
    ReferralsSwapped,
    /// Compute for all plans costs as much per unit as for plan A.
    ComputeOfOnePlan,
    /// Reputation can fall below its minimum.
    ReputationWithoutFloor,
    /// Targeted development uses the gain of general development.
    TargetedGainAsGeneral,
}

impl Fault {
    /// All faults. The number of a fault is its position in this list, from 1.
    pub const ALL: [Fault; 10] = [
        Fault::EconomyReversed,
        Fault::QuotaInverted,
        Fault::SmallerRivalMove,
        Fault::SpillOverReversed,
        Fault::TenureInDays,
        Fault::DriftTwice,
        Fault::ReferralsSwapped,
        Fault::ComputeOfOnePlan,
        Fault::ReputationWithoutFloor,
        Fault::TargetedGainAsGeneral,
    ];

    /// Returns the fault with this number, or `None` if there is none. Fault 1 is the first fault of [`Fault::ALL`].
    pub fn from_number(number: u32) -> Option<Fault> {
        Fault::ALL.into_iter().find(|fault| fault.number() == number)
    }

    /// Returns the number of the fault, from 1.
    pub fn number(self) -> u32 {
        self as u32 + 1
    }
}

impl From<Fault> for u32 {
    fn from(fault: Fault) -> u32 {
        fault.number()
    }
}

impl TryFrom<u32> for Fault {
    type Error = String;

    fn try_from(number: u32) -> Result<Fault, String> {
        let unknown =
            || format!("there is no fault {number}; choose a number from 1 to {}", Fault::ALL.len());
        Fault::from_number(number).ok_or_else(unknown)
    }
}

impl Params {
    /// Returns whether a run with these parameters has the given fault.
    #[inline]
    pub fn has_fault(&self, fault: Fault) -> bool {
        self.fault == Some(fault)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fault_numbers_match_list_positions() {
        for (at, fault) in Fault::ALL.into_iter().enumerate() {
            assert_eq!(fault.number() as usize, at + 1);
            assert_eq!(Fault::try_from(fault.number()), Ok(fault));
        }
        for number in [0, Fault::ALL.len() as u32 + 1, u32::MAX] {
            assert!(Fault::try_from(number).expect_err("none").contains("from 1 to 10"));
        }
    }

    #[test]
    fn fault_changes_the_digest_but_no_table() {
        let sound = Params::bundled();
        let faulty = Params { fault: Some(Fault::DriftTwice), ..sound.clone() };
        assert_ne!(sound.digest(), faulty.digest());
        assert!(sound.differences(&faulty).is_empty(), "a fault is not a parameter");
        let set = faulty.with("operations.base_outage_prob", toml::Value::Float(0.5)).expect("it fits");
        assert_eq!(set.fault, faulty.fault, "setting a parameter keeps the fault");
        assert!(faulty.value("fault").is_err());
    }
}
