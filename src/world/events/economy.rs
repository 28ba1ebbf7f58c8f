//! Readings of the PMI that are published to the player.

use serde::Serialize;

use crate::canonical::{canonical, canonical_codes};
use crate::params::MacroEconomy;

canonical! { Reading { measured_day, value, change, trend, phase } }
canonical_codes! {
    Trend { StrongExpansion, Expansion, Neutral, Contraction, SevereContraction }
    Phase { Peak, Declining, Trough, Recovering }
}

/// A monthly reading of the PMI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading {
    /// Last day of the period over which the reading averages the daily PMI.
    pub measured_day: u32,
    /// Average PMI, rounded to one decimal.
    pub value: f64,
    /// Change since the previous reading, rounded to one decimal.
    pub change: f64,
    /// Trend label of the value.
    pub trend: Trend,
    /// Position of the reading in the economic cycle.
    pub phase: Phase,
}

/// Trend label of a PMI value.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[repr(u8)]
pub enum Trend {
    /// PMI of 58 or more.
    StrongExpansion,
    /// PMI of 52 or more, below 58.
    Expansion,
    /// PMI of 48 or more, below 52.
    Neutral,
    /// PMI of 42 or more, below 48.
    Contraction,
    /// PMI below 42.
    SevereContraction,
}

impl Trend {
    /// Returns the trend label of a PMI value.
    pub fn from_index(pmi: f64, economy: &MacroEconomy) -> Trend {
        match pmi {
            _ if pmi >= economy.trend_strong_expansion_min => Trend::StrongExpansion,
            _ if pmi >= economy.trend_expansion_min => Trend::Expansion,
            _ if pmi >= economy.trend_neutral_min => Trend::Neutral,
            _ if pmi >= economy.trend_contraction_min => Trend::Contraction,
            _ => Trend::SevereContraction,
        }
    }

    /// Returns the identifier that tables use for the trend.
    pub fn id(self) -> &'static str {
        ["strong_expansion", "expansion", "neutral", "contraction", "severe_contraction"][self as usize]
    }
}

/// Position of a reading in the economic cycle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[repr(u8)]
pub enum Phase {
    /// A high PMI that is no longer rising.
    Peak,
    /// A falling PMI.
    Declining,
    /// A low PMI that is not falling.
    Trough,
    /// A PMI that is neither low nor falling, and not at its peak.
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

    /// Returns the identifier that tables use for the phase.
    pub fn id(self) -> &'static str {
        ["peak", "declining", "trough", "recovering"][self as usize]
    }
}
