//! Descriptions of published PMI readings, in three or four sentences.

use novamind_world::events::{Reading, Trend};

/// Returns the description of a PMI reading.
pub fn reading_text(reading: &Reading) -> String {
    let change = reading.change;
    let movement = match change {
        _ if change > 0.0 => format!("up {change:.1} points from the month before"),
        _ if change < 0.0 => format!("down {:.1} points from the month before", change.abs()),
        _ => "unchanged from the month before".to_owned(),
    };
    let side = match reading.value {
        value if value > 50.0 => "above 50, so more firms grow than shrink",
        value if value < 50.0 => "below 50, so more firms shrink than grow",
        _ => "at 50, where growing and shrinking firms balance",
    };
    let mood = match reading.trend {
        Trend::StrongExpansion => {
            "Order books are full and firms hire wherever they can. Budgets for software are approved quickly."
        }
        Trend::Expansion => "Firms add staff and buy ahead of demand. Budgets for software grow with them.",
        Trend::Neutral => "Hiring is steady and purchases replace what wears out. Budgets for software hold.",
        Trend::Contraction => {
            "Firms postpone hiring and buy only what they need. New software has to show that it saves money."
        }
        Trend::SevereContraction => {
            "Firms cut staff and freeze purchases. Software contracts are among the first to be reviewed."
        }
    };
    format!("The purchasing managers' index stands at {:.1}, {movement}. It is {side}. {mood}", reading.value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use novamind_world::events::Phase;

    #[test]
    fn reading_text_states_value_change_position_and_mood() {
        for (value, change, trend, words) in [
            (60.0, 1.2, Trend::StrongExpansion, ["60.0", "up 1.2", "above 50", "hire"]),
            (53.0, 0.0, Trend::Expansion, ["53.0", "unchanged", "above 50", "Budgets"]),
            (50.0, -0.3, Trend::Neutral, ["50.0", "down 0.3", "at 50", "steady"]),
            (45.0, -2.0, Trend::Contraction, ["45.0", "down 2.0", "below 50", "postpone"]),
            (38.0, 0.1, Trend::SevereContraction, ["38.0", "up 0.1", "below 50", "freeze"]),
        ] {
            let text =
                reading_text(&Reading { measured_day: 31, value, change, trend, phase: Phase::Declining });
            assert!(words.iter().all(|word| text.contains(word)), "{text}");
        }
    }
}
