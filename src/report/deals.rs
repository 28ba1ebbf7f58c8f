//! Text for tool calls that make or reject offers to enterprises.

use serde_json::Value;

use super::words::count;
use novamind_base::notation::cents;
use novamind_session::CompanyNames;
use novamind_tools::ToolId;

const TOLD: usize = 3;

/// Describes the deals of a call. `None` for other tools and for arguments without deals.
pub fn deals_in_words(tool: ToolId, arguments: &Value, names: &CompanyNames) -> Option<String> {
    if !matches!(tool, ToolId::SendEnterpriseDeal | ToolId::RejectEnterpriseDeal) {
        return None;
    }
    let deals = arguments.get("deals")?.as_array()?;
    let told: Option<Vec<String>> = deals.iter().take(TOLD).map(|deal| deal_in_words(deal, names)).collect();
    let mut words = told.filter(|told| !told.is_empty())?.join(" · ");
    if deals.len() > TOLD {
        words += &format!(" · {} more", count((deals.len() - TOLD) as u32, "enterprise"));
    }
    Some(words)
}

fn deal_in_words(deal: &Value, names: &CompanyNames) -> Option<String> {
    let part = |name: &str, at: usize| deal.get(name).or_else(|| deal.get(at));
    let customer = part("customer_id", 0).unwrap_or(deal).as_u64()?;
    let company = names.with_number(u32::try_from(customer).ok()?);
    let Some(offerings) = part("offerings", 1).and_then(Value::as_array) else { return Some(company) };
    let offering = |offering: &Value| {
        let part = |name: &str, at: usize| offering.get(name).or_else(|| offering.get(at));
        let price = part("price_per_seat", 1).or_else(|| offering.get("price"))?.as_f64()?;
        Some(format!("{} {}", part("plan", 0)?.as_str()?, cents(price)))
    };
    let offerings: Option<Vec<String>> = offerings.iter().map(offering).collect();
    Some(format!("{company}: {}", offerings?.join(" or ")))
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use novamind_world::params::Params;

    #[test]
    fn deals_name_their_companies_in_every_form_of_a_call() {
        let names = CompanyNames::new(3, &Params::shipped().personas.email);
        let told = |tool: ToolId, deals: Value| deals_in_words(tool, &json!({ "deals": deals }), &names);
        let (one, send) = (names.with_number(7), ToolId::SendEnterpriseDeal);
        let offered = Some(format!("{one}: B $35.00 or C $60.50"));
        assert_eq!(told(send, json!([[7, [["B", 35], ["C", 60.5]]]])), offered);
        let object = json!([{"customer_id": 7, "offerings": [
            {"plan": "B", "price_per_seat": 35.0}, {"plan": "C", "price": 60.5}]}]);
        assert_eq!(told(send, object), offered);
        for ended in [json!([7]), json!([[7]]), json!([{"customer_id": 7}])] {
            assert_eq!(told(ToolId::RejectEnterpriseDeal, ended), Some(one.clone()));
        }
        let many: Vec<u32> = (1..=3_569).collect();
        let many = told(ToolId::RejectEnterpriseDeal, json!(many)).expect("words");
        assert!(many.ends_with(" · 3,566 enterprises more"), "{many}");
        for none in [json!([]), json!(["x"]), json!([[7, [["B"]]]]), json!([-4])] {
            assert_eq!(told(send, none.clone()), None, "{none}");
        }
        assert_eq!(told(ToolId::SetPrices, json!([7])), None);
    }
}
