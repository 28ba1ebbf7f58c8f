//! Faults: mechanisms that are wrong on purpose, for those who learn to find errors with the x-ray
//! (`docs/debugging-walkthrough.md`).
//!
//! A fault is asked for once a day, for a group or for an event, never for a customer, so that a world without one is as
//! fast as if there were none. It is no parameter: no file and no setting reaches it.

use serde::{Deserialize, Serialize};

use super::params::Params;

/// A mechanism that is wrong in a whole run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "u32", into = "u32")]
pub enum Fault {
    /// The economy moves leads against the sensitivity of a group.
    EconomyReversed,
    /// Satisfaction takes demand / quota for quota / demand.
    QuotaInverted,
    /// Rivals make the smaller of their two possible moves.
    SmallerRivalMove,
    /// Spill-over has the wrong sign.
    SpillOverReversed,
    /// Tenure counts days where it should count months.
    TenureInDays,
    /// Group totals of drift are moved twice.
    DriftTwice,
    /// Word of mouth takes the rate from the target to the source.
    ReferralsSwapped,
    /// All compute is paid at the unit cost of plan A.
    ComputeOfOnePlan,
    /// Reputation falls below its floor.
    ReputationWithoutFloor,
    /// Targeted development gains what general development would.
    TargetedGainAsGeneral,
}

impl Fault {
    /// All of them; the number of each is its place, from 1.
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

    /// The fault with this number.
    pub fn numbered(number: u32) -> Option<Fault> {
        Fault::ALL.into_iter().find(|fault| fault.number() == number)
    }

    /// Its number, from 1.
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
        Fault::numbered(number).ok_or_else(unknown)
    }
}

impl Params {
    /// Whether a world with these parameters has this fault.
    #[inline]
    pub fn has_fault(&self, fault: Fault) -> bool {
        self.fault == Some(fault)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_places_in_the_list() {
        for (at, fault) in Fault::ALL.into_iter().enumerate() {
            assert_eq!(fault.number() as usize, at + 1);
            assert_eq!(Fault::try_from(fault.number()), Ok(fault));
        }
        for number in [0, Fault::ALL.len() as u32 + 1, u32::MAX] {
            assert!(Fault::try_from(number).expect_err("none").contains("from 1 to 10"));
        }
    }

    #[test]
    fn a_fault_is_in_the_digest_and_in_no_table() {
        let sound = Params::shipped();
        let faulty = Params { fault: Some(Fault::DriftTwice), ..sound.clone() };
        assert_ne!(sound.digest(), faulty.digest());
        assert!(sound.differences(&faulty).is_empty(), "a setting would name it");
        let set = faulty.with("operations.base_outage_prob", toml::Value::Float(0.5)).expect("it fits");
        assert_eq!(set.fault, faulty.fault, "what is set later keeps it");
        assert!(faulty.value("fault").is_err());
    }
}
