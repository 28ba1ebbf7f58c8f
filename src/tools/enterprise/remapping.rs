//! Finds and replaces the customer numbers in the arguments of deals.

use serde_json::Value;

use super::super::ToolId;
use super::parsing::{ElementError, parse_deal_customer};

/// Replaces the enterprises in the arguments of a call with their counterparts in another run. Removes elements whose
/// enterprise has no counterpart. Returns `None` if no element remains. Elements without an enterprise and calls to
/// other tools do not change.
pub fn remap_customers(
    tool: ToolId,
    args: &Value,
    find_counterpart: &mut dyn FnMut(u32) -> Option<u32>,
) -> Option<Value> {
    let mut args = args.clone();
    if !matches!(tool, ToolId::SendEnterpriseDeal | ToolId::RejectEnterpriseDeal) {
        return Some(args);
    }
    let is_named = args.get("deals").is_some();
    let deals = if is_named { args.get_mut("deals")? } else { &mut args };
    let is_left = match deals {
        Value::Array(list) => {
            let count = list.len();
            list.retain_mut(|element| remap_element(element, find_counterpart));
            list.len() == count || !list.is_empty()
        }
        single => remap_element(single, find_counterpart),
    };
    is_left.then_some(args)
}

/// Returns the highest customer number in the arguments of a call.
pub fn highest_customer(tool: ToolId, args: &Value) -> Option<u32> {
    let mut highest = None;
    remap_customers(tool, args, &mut |customer| {
        highest = highest.max(Some(customer));
        Some(customer)
    });
    highest
}

/// Replaces the enterprise of an element. Returns false if the enterprise has no counterpart.
fn remap_element(element: &mut Value, find_counterpart: &mut dyn FnMut(u32) -> Option<u32>) -> bool {
    let named = match element {
        Value::Object(map) => map.get_mut("customer_id"),
        Value::Array(list) => list.first_mut(),
        single => Some(single),
    };
    let Some(named) = named else { return true };
    let number = match parse_deal_customer(Some(named), "") {
        Ok(number) => u32::try_from(number).ok(),
        Err(ElementError::Call(_) | ElementError::Element(_)) => None,
    };
    match number.map(find_counterpart) {
        Some(Some(other)) => *named = other.into(),
        Some(None) => return false,
        None => {}
    }
    true
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn remap_customers_handles_every_notation() {
        let moved = |tool, args| {
            remap_customers(tool, &args, &mut |customer| (customer != 13).then_some(customer + 100))
        };
        let send = ToolId::SendEnterpriseDeal;
        let given = json!({"deals": [[7, [["B", 20]]], {"customer_id": "8", "offerings": [["C", 9]]}, [13, []], 5.5]});
        let expected =
            json!({"deals": [[107, [["B", 20]]], {"customer_id": 108, "offerings": [["C", 9]]}, 5.5]});
        assert_eq!(moved(send, given), Some(expected));
        let reject = ToolId::RejectEnterpriseDeal;
        let ended = moved(reject, json!({"deals": [9, [10], "x"]}));
        assert_eq!(ended, Some(json!({"deals": [109, [110], "x"]})));
        assert_eq!(
            [moved(reject, json!({"deals": 13})), moved(reject, json!({"deals": [[13]]}))],
            [None, None]
        );
        assert_eq!(moved(reject, json!({"customer_id": 3})), Some(json!({"customer_id": 103})));
        for (tool, args) in [(ToolId::SetPrices, json!({"A": 7})), (reject, json!({"deals": []}))] {
            assert_eq!(moved(tool, args.clone()), Some(args));
        }
    }
}
