//! What the decisions of a week cost, before it runs: commitments by day and week, one-time costs apart, and how long
//! cash lasts at that.

use super::words::{count, money};
use crate::session::Observation;

/// Lines on the money of a company before its next week.
pub fn money_lines(seen: &Observation) -> Vec<String> {
    let (pace, now) = (seen.pace, seen.pace.committed);
    let change = now - seen.committed_before;
    let changed = match change {
        0.0 => String::new(),
        _ if seen.day == 0 => String::new(),
        change if change > 0.0 => format!(", {} more than last week", money(change * 7.0)),
        change => format!(", {} less than last week", money(-change * 7.0)),
    };
    let mut lines = vec![format!("Committed: {} a day = {} a week{changed}", money(now), money(now * 7.0))];
    let spent = -seen.booked_since.sum();
    if spent > 0.0 {
        lines.push(format!("One-time costs since the last week: {}", money(spent)));
    }
    let weeks = seen.last_week.map_or(0, |_| seen.week.min(4));
    let income = match weeks {
        0 => "No income yet".to_owned(),
        _ => {
            let (income, variable) = (money(pace.income * 7.0), money(pace.variable * 7.0));
            match weeks {
                1 => format!("Last week: income {income}, compute and lead costs {variable}"),
                _ => format!(
                    "Last {}: income {income} a week, compute and lead costs {variable}",
                    count(weeks, "week")
                ),
            }
        }
    };
    let runway = match seen.weeks_of_cash() {
        Some(weeks) => format!("at this pace cash lasts {}", count(weeks, "week")),
        None => "at this pace cash lasts to the last day".to_owned(),
    };
    lines.push(format!("{income}; {runway}"));
    lines
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::report::test_kit;
    use crate::session::Via;

    #[test]
    fn eighteen_changes_have_one_total_and_purchases_stand_apart() {
        let mut session = test_kit::played(0);
        for (tool, arguments) in [
            ("set_prices", json!({"A": 12, "B": 25, "C": 55})),
            ("set_daily_spend", json!({"operations": 300, "development": 200})),
            ("set_targeted_dev_spend", json!({"targeted_spend": {"S1": 4000}})),
            ("set_targeted_ad_spend", json!({"targeted_spend": {"search_ads": {"S1": 1000}}})),
            ("research_market", json!({})),
        ] {
            session.call(tool, &arguments, Via::Script).unwrap_or_else(|refusal| panic!("{tool}: {refusal}"));
        }
        assert_eq!(
            money_lines(&session.observe()),
            [
                "Committed: $5,585 a day = $39,095 a week",
                "One-time costs since the last week: $25,000",
                "No income yet; at this pace cash lasts 24 weeks",
            ]
        );
        let played = test_kit::played(3);
        let lines = money_lines(&played.observe());
        assert!(lines[0].starts_with("Committed: $") && !lines[0].contains("since"), "{lines:?}");
        assert!(lines[1].starts_with("Last 3 weeks: income $"), "{lines:?}");
    }
}
