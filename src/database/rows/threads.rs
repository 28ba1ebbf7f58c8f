//! Writes the rows of negotiations with enterprises.

use rusqlite::{Transaction, params};

use super::ProjectionEntry;
use novamind_base::formatting::decimal_literal;
use novamind_world::events::{Facts, Offering, Sender, ThreadTurn, TurnContent};

/// Writes the turns of an entry with their texts.
pub(super) fn insert_turns(transaction: &Transaction<'_>, entry: &ProjectionEntry) -> rusqlite::Result<()> {
    let mut insert = transaction.prepare_cached(
        "INSERT INTO enterprise_turns VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13)",
    )?;
    for (turn, words) in entry.facts.turns.iter().zip(&entry.turns) {
        let address = entry.addresses.get(&turn.customer).filter(|_| turn.sender == Sender::Customer);
        let reason = close_reason(turn);
        insert.execute(params![
            turn.message,
            turn.thread,
            turn.customer,
            turn.kind.id(),
            turn.number,
            turn.sender.id(),
            words,
            offer_json(&turn.content),
            entry.facts.day,
            address.map_or("", String::as_str),
            turn.seats,
            !reason.is_empty(),
            reason,
        ])?;
    }
    Ok(())
}

/// Writes the contract start of each deal to the row of the customer.
pub(super) fn update_contract_starts(transaction: &Transaction<'_>, facts: &Facts) -> rusqlite::Result<()> {
    let mut update = transaction
        .prepare_cached("UPDATE customer_rows SET contract_start_day = ?2 WHERE customer_id = ?1")?;
    for deal in &facts.deals {
        update.execute(params![deal.customer, facts.day])?;
    }
    Ok(())
}

/// Returns the reason why a thread ends with this turn. Returns an empty text if the thread continues or ends
/// unanswered.
fn close_reason(turn: &ThreadTurn) -> &'static str {
    match turn.content {
        TurnContent::Acceptance(_) | TurnContent::Closing(_) => "accepted",
        TurnContent::Rejection => "agent_rejected",
        _ => "",
    }
}

/// Returns the offer of a turn as JSON. Spaces are the same as in the released simulator, because users search this
/// text.
fn offer_json(content: &TurnContent) -> String {
    match content {
        TurnContent::Offer(offerings) => {
            let one = |offering: &Offering| {
                format!(
                    "{{\"plan\": \"{}\", \"price_per_seat\": {}, \"contract_months\": 1}}",
                    offering.plan,
                    decimal_literal(offering.price)
                )
            };
            format!("[{}]", offerings.iter().map(one).collect::<Vec<_>>().join(", "))
        }
        TurnContent::Counter { asked: offering, .. } | TurnContent::Acceptance(offering)
            if offering.price != 0.0 =>
        {
            format!("{{\"price\": {}}}", decimal_literal(offering.price))
        }
        _ => "{}".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use novamind_world::identifiers::Plan;

    #[test]
    fn offer_json_is_spaced_with_decimal_points() {
        let offering = |plan, price| Offering { plan, price };
        for (content, json) in [
            (
                TurnContent::Offer(vec![offering(Plan::A, 18.5)]),
                r#"[{"plan": "A", "price_per_seat": 18.5, "contract_months": 1}]"#,
            ),
            (
                TurnContent::Offer(vec![offering(Plan::C, 48.0), offering(Plan::B, 0.1)]),
                r#"[{"plan": "C", "price_per_seat": 48.0, "contract_months": 1}, {"plan": "B", "price_per_seat": 0.1, "contract_months": 1}]"#,
            ),
            (TurnContent::Counter { asked: offering(Plan::B, 27.34), offered: 40.0 }, r#"{"price": 27.34}"#),
            (TurnContent::Acceptance(offering(Plan::B, 35.0)), r#"{"price": 35.0}"#),
            (TurnContent::Acceptance(offering(Plan::B, 0.0)), "{}"),
            (TurnContent::Closing(offering(Plan::B, 35.0)), "{}"),
            (TurnContent::Rejection, "{}"),
            (TurnContent::Opening, "{}"),
            (TurnContent::Threat, "{}"),
        ] {
            let text = offer_json(&content);
            assert_eq!(text, json);
            assert!(serde_json::from_str::<serde_json::Value>(&text).is_ok());
        }
    }
}
