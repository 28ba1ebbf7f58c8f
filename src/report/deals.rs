//! Texts for tool calls that make or reject offers to enterprises.

use serde_json::Value;

use super::formatting::pluralize;
use novamind_base::formatting::dollars_and_cents;
use novamind_session::EnterpriseNames;
use novamind_tools::ToolId;

const MAX_LISTED_DEALS: usize = 3;

/// Describes the deals in the arguments of a tool call. Returns `None` if the tool has no deals, or if the arguments
/// contain no deals.
pub fn describe_deals(tool: ToolId, arguments: &Value, names: &EnterpriseNames) -> Option<String> {
    if !matches!(tool, ToolId::SendEnterpriseDeal | ToolId::RejectEnterpriseDeal) {
        return None;
    }
    let deals = arguments.get("deals")?.as_array()?;
    let texts: Option<Vec<String>> =
        deals.iter().take(MAX_LISTED_DEALS).map(|deal| describe_deal(deal, names)).collect();
    let mut words = texts.filter(|text| !text.is_empty())?.join(" · ");
    if deals.len() > MAX_LISTED_DEALS {
        words += &format!(" · {}", pluralize((deals.len() - MAX_LISTED_DEALS) as u32, "more enterprise"));
    }
    Some(words)
}

fn describe_deal(deal: &Value, names: &EnterpriseNames) -> Option<String> {
    let (customer, offerings) = parse_deal(deal)?;
    let company = names.name_with_number(customer);
    if offerings.is_empty() {
        return Some(company);
    }
    let offering = |(plan, price): &(&str, f64)| format!("{plan} {}", dollars_and_cents(*price));
    Some(format!("{company}: {}", offerings.iter().map(offering).collect::<Vec<_>>().join(" or ")))
}

/// Parses one deal of a tool call: the customer, and each plan with its price in dollars per seat per month. A
/// rejection of an enterprise has no plans. Returns `None` if the deal is invalid.
pub fn parse_deal(deal: &Value) -> Option<(u32, Vec<(&str, f64)>)> {
    let part = |name: &str, at: usize| deal.get(name).or_else(|| deal.get(at));
    let customer = u32::try_from(part("customer_id", 0).unwrap_or(deal).as_u64()?).ok()?;
    let Some(offerings) = part("offerings", 1).and_then(Value::as_array) else {
        return Some((customer, Vec::new()));
    };
    let offerings: Option<Vec<(&str, f64)>> = offerings.iter().map(parse_offering).collect();
    Some((customer, offerings?))
}

fn parse_offering(offering: &Value) -> Option<(&str, f64)> {
    let part = |name: &str, at: usize| offering.get(name).or_else(|| offering.get(at));
    let price = part("price_per_seat", 1).or_else(|| offering.get("price"))?.as_f64()?;
    Some((part("plan", 0)?.as_str()?, price))
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use novamind_world::params::Params;

    #[test]
    fn describe_deals_names_enterprises_in_every_argument_form() {
        let names = EnterpriseNames::new(3, &Params::bundled().personas.email);
        let describe = |tool: ToolId, deals: Value| describe_deals(tool, &json!({ "deals": deals }), &names);
        let (one, send) = (names.name_with_number(7), ToolId::SendEnterpriseDeal);
        let offered = Some(format!("{one}: B $35.00 or C $60.50"));
        assert_eq!(describe(send, json!([[7, [["B", 35], ["C", 60.5]]]])), offered);
        let object = json!([{"customer_id": 7, "offerings": [
            {"plan": "B", "price_per_seat": 35.0}, {"plan": "C", "price": 60.5}]}]);
        assert_eq!(describe(send, object), offered);
        for ended in [json!([7]), json!([[7]]), json!([{"customer_id": 7}])] {
            assert_eq!(describe(ToolId::RejectEnterpriseDeal, ended), Some(one.clone()));
        }
        let many: Vec<u32> = (1..=3_569).collect();
        let many = describe(ToolId::RejectEnterpriseDeal, json!(many)).expect("words");
        assert!(many.ends_with(" · 3,566 more enterprises"), "{many}");
        for none in [json!([]), json!(["x"]), json!([[7, [["B"]]]]), json!([-4])] {
            assert_eq!(describe(send, none.clone()), None, "{none}");
        }
        assert_eq!(describe(ToolId::SetPrices, json!([7])), None);
    }
}
