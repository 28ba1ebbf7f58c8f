//! The inbox: one line per notice (chapter 60 §6).

use crate::world::events::Notice;

/// Text of a notice.
pub fn notice(notice: &Notice) -> String {
    match notice {
        Notice::EnterpriseLead => {
            "A company asks for an offer. It waits seven days for an answer.".to_owned()
        }
        Notice::LeadLostByTimeout { days } => {
            format!("A company that asked for an offer got no answer for {days} days and has turned away.")
        }
        Notice::ResearchComplete { tier, number } => format!("R&D complete: t{tier}_{number}"),
        Notice::EconomyUpdate(reading) => {
            let arrow = match reading.change {
                change if change > 0.0 => '\u{2191}',
                change if change < 0.0 => '\u{2193}',
                _ => '\u{2192}',
            };
            let trend = reading.trend.id().replace('_', " ");
            format!("Purchasing managers' index {:.1} {arrow} ({trend})", reading.value)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::market::economy::{Phase, Reading, Trend};

    #[test]
    fn readings_show_value_direction_and_band() {
        let reading = Reading {
            measured_day: 1,
            value: 48.3,
            change: -0.6,
            trend: Trend::Neutral,
            phase: Phase::Declining,
        };
        assert_eq!(
            notice(&Notice::EconomyUpdate(reading)),
            "Purchasing managers' index 48.3 \u{2193} (neutral)"
        );
    }
}
