//! Turns of a negotiation, parsed from database rows.

use super::offer_row::parse_offer;
use novamind_base::formatting::dollars_and_cents;
use novamind_database::{Cell, number_at, text_at};
use novamind_session::identifiers::Plan;

/// One turn of a thread.
#[derive(Debug, Clone, PartialEq)]
pub struct Turn {
    /// Number of the turn in its thread, from 0.
    pub number: u32,
    /// Sender of the message: `customer`, `agent` or `system`.
    pub sender: String,
    /// Text of the message, which is empty for offers.
    pub text: String,
    /// Plans and prices that the player offered, in dollars per seat per month.
    pub offers: Vec<(Plan, f64)>,
    /// Price that the enterprise asked for, in dollars per seat per month.
    pub price: Option<f64>,
    /// Simulated day on which the message was sent.
    pub day: u32,
    /// Reason for closing the thread, which is empty if the turn did not close the thread.
    pub closing_reason: String,
}

impl Turn {
    /// Parses a row. From the fourth column on, the columns are turn number, sender, text, offer, day, seats and reason
    /// for closing.
    pub fn from_row(row: &[Cell]) -> Turn {
        let (offers, price) = parse_offer(text_at(row, 6));
        Turn {
            number: number_at(row, 3) as u32,
            sender: text_at(row, 4).to_owned(),
            text: text_at(row, 5).to_owned(),
            offers,
            price,
            day: number_at(row, 7) as u32,
            closing_reason: text_at(row, 9).to_owned(),
        }
    }
}

/// Formats an offer in short form: `B $38.00 · C $61.00`.
pub fn format_offer_lines(offers: &[(Plan, f64)]) -> String {
    let one = |(plan, price): &(Plan, f64)| format!("{plan} {}", dollars_and_cents(*price));
    offers.iter().map(one).collect::<Vec<_>>().join(" · ")
}
