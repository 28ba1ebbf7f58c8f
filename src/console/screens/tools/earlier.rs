//! Earlier calls of a tool in this run.

use serde_json::Value;

use crate::screens::journal::entries::in_words;
use novamind_report::deals::deals_in_words;
use novamind_session::JournalEntry;
use novamind_tools::ToolId;
use novamind_worker::company::Company;

pub const MOST: usize = 10;

/// Calls of a tool, newest first: decision day and arguments, without consecutive duplicates.
pub fn calls(tool: ToolId, company: &Company, most: usize) -> Vec<(u32, String)> {
    let calls = company.journal.iter().rev().filter_map(|entry| match entry {
        JournalEntry::Call { day, tool: own, args, .. } if *own == tool => Some((*day, args)),
        _ => None,
    });
    let mut told: Vec<(u32, &Value)> = Vec::new();
    for (day, arguments) in calls {
        let full = told.len() == most;
        match told.last_mut() {
            Some((first, known)) if *known == arguments => *first = day,
            _ if full => break,
            _ => told.push((day, arguments)),
        }
    }
    let words = |arguments: &Value| {
        deals_in_words(tool, arguments, &company.names).unwrap_or_else(|| in_words(arguments))
    };
    told.into_iter().map(|(day, arguments)| (day, words(arguments))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_kit::played;

    #[test]
    fn calls_stand_with_the_newest_first() {
        let mut session = played(1);
        for price in [14, 14] {
            let arguments = serde_json::json!({ "A": price });
            session
                .call("set_prices", &arguments, novamind_record::trajectory::record::Via::Form)
                .expect("a price");
        }
        let company = Company::of(&session);
        assert_eq!(
            calls(ToolId::SetPrices, &company, 9),
            [(7, "A 14".to_owned()), (0, "A 12 B 25 C 55".to_owned())]
        );
        assert_eq!(calls(ToolId::SetPrices, &company, 1).len(), 1);
        assert_eq!(calls(ToolId::SetPromotion, &company, 9), []);
    }
}
