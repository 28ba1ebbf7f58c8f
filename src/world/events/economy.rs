//! Published readings of the economy.

use serde::Serialize;

use crate::canonical::{canonical, canonical_codes};
use crate::params::MacroEconomy;

canonical! { Reading { measured_day, value, change, trend, phase } }
canonical_codes! {
    Trend { StrongExpansion, Expansion, Neutral, Contraction, SevereContraction }
    Phase { Peak, Declining, Trough, Recovering }
}

/// A reading of the index.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading {
    /// Last of the days whose values the reading averages.
    pub measured_day: u32,
    /// Average, one decimal.
    pub value: f64,
    /// Change since the previous reading, one decimal.
    pub change: f64,
    /// Label of the value.
    pub trend: Trend,
    /// Position in the cycle.
    pub phase: Phase,
}

/// Label of a reading.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[repr(u8)]
pub enum Trend {
    /// 58 and above.
    StrongExpansion,
    /// 52 and above.
    Expansion,
    /// 48 and above.
    Neutral,
    /// 42 and above.
    Contraction,
    /// Below.
    SevereContraction,
}

impl Trend {
    /// Returns the label of an index value.
    pub fn from_index(pmi: f64, economy: &MacroEconomy) -> Trend {
        match pmi {
            _ if pmi >= economy.trend_strong_expansion_min => Trend::StrongExpansion,
            _ if pmi >= economy.trend_expansion_min => Trend::Expansion,
            _ if pmi >= economy.trend_neutral_min => Trend::Neutral,
            _ if pmi >= economy.trend_contraction_min => Trend::Contraction,
            _ => Trend::SevereContraction,
        }
    }

    /// Identifier as stored in tables.
    pub fn id(self) -> &'static str {
        ["strong_expansion", "expansion", "neutral", "contraction", "severe_contraction"][self as usize]
    }
}

/// Position of a reading in the cycle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[repr(u8)]
pub enum Phase {
    /// High and no longer rising.
    Peak,
    /// Falling.
    Declining,
    /// Low and not falling.
    Trough,
    /// Rising, or level in the middle.
    Recovering,
}

impl Phase {
    /// Returns the phase for the value and change of a reading.
    pub fn from_reading(value: f64, change: f64, economy: &MacroEconomy) -> Phase {
        if value >= economy.phase_peak_min_pmi && change <= 0.0 {
            Phase::Peak
        } else if change < 0.0 {
            Phase::Declining
        } else if value < economy.phase_trough_below_pmi {
            Phase::Trough
        } else {
            Phase::Recovering
        }
    }

    /// Identifier as stored in tables.
    pub fn id(self) -> &'static str {
        ["peak", "declining", "trough", "recovering"][self as usize]
    }
}
