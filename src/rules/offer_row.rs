//! Parses the offer in a negotiation row of the database.

use serde_json::Value;

use novamind_session::identifiers::Plan;

/// Parses the JSON of a row. Returns the plans and prices that the player offered, and the price that the enterprise
/// asked for, in dollars per seat per month.
pub fn parse_offer(json: &str) -> (Vec<(Plan, f64)>, Option<f64>) {
    let value: Value = serde_json::from_str(json).unwrap_or(Value::Null);
    let one = |offer: &Value| {
        Some((Plan::parse(offer.get("plan")?.as_str()?)?, offer.get("price_per_seat")?.as_f64()?))
    };
    let offers = value.as_array().into_iter().flatten().filter_map(one).collect();
    (offers, value.get("price").and_then(Value::as_f64))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parse_offer_reads_plans_and_prices() {
        let two = r#"[{"plan": "A", "price_per_seat": 18.5, "contract_months": 1}, {"plan": "Z", "price_per_seat": 1}]"#;
        assert_eq!(parse_offer(two), (vec![(Plan::A, 18.5)], None));
        assert_eq!(parse_offer(r#"{"price": 27.34}"#), (vec![], Some(27.34)));
        assert_eq!(parse_offer("{}"), (vec![], None));
        assert_eq!(parse_offer("broken"), (vec![], None));
    }
}
