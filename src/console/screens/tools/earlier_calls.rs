//! Earlier calls of a tool in this run.

use serde_json::Value;

use crate::screens::journal::entries::format_arguments;
use novamind_report::deals::describe_deals;
use novamind_session::JournalEntry;
use novamind_tools::ToolId;
use novamind_worker::company::DisplayedCompany;

pub const MAX_EARLIER_CALLS: usize = 10;

/// Returns the calls of a tool, the newest first, as decision day and arguments. Consecutive duplicates are omitted.
pub fn earlier_calls(tool: ToolId, company: &DisplayedCompany, most: usize) -> Vec<(u32, String)> {
    let calls = company.journal.iter().rev().filter_map(|entry| match entry {
        JournalEntry::Call { day, tool: tool_id, args, .. } if *tool_id == tool => Some((*day, args)),
        _ => None,
    });
    let mut distinct_calls: Vec<(u32, &Value)> = Vec::new();
    for (day, arguments) in calls {
        let full = distinct_calls.len() == most;
        match distinct_calls.last_mut() {
            Some((first, known)) if *known == arguments => *first = day,
            _ if full => break,
            _ => distinct_calls.push((day, arguments)),
        }
    }
    let words = |arguments: &Value| {
        describe_deals(tool, arguments, &company.enterprise_names).unwrap_or_else(|| format_arguments(arguments))
    };
    distinct_calls.into_iter().map(|(day, arguments)| (day, words(arguments))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_kit::played_session;

    #[test]
    fn newest_call_is_first() {
        let mut session = played_session(1);
        for price in [14, 14] {
            let arguments = serde_json::json!({ "A": price });
            session
                .call("set_prices", &arguments, novamind_record::trajectory::record::Via::Form)
                .expect("a price");
        }
        let company = DisplayedCompany::from_session(&session);
        assert_eq!(
            earlier_calls(ToolId::SetPrices, &company, 9),
            [(7, "A 14".to_owned()), (0, "A 12 B 25 C 55".to_owned())]
        );
        assert_eq!(earlier_calls(ToolId::SetPrices, &company, 1).len(), 1);
        assert_eq!(earlier_calls(ToolId::SetPromotion, &company, 9), []);
    }
}
