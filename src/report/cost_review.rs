//! Review before a week is simulated: committed costs by day and week, one-time costs, expected income and runway.

use super::formatting::{describe_runway, format_money, pluralize};
use novamind_base::formatting::{capitalize, dollars, price_to_cents, signed_dollars};
use novamind_session::{IdenticalPlans, Level, Observation, Preview};

/// Describes income, committed costs and runway before the next week, one line per topic.
pub fn income_and_cost_lines(seen: &Observation) -> Vec<String> {
    let now = seen.committed;
    let change = now - seen.committed_before;
    let changed = match change {
        0.0 => String::new(),
        _ if seen.day == 0 => String::new(),
        change if change > 0.0 => format!(", {} more than last week", format_money(change * 7.0)),
        change => format!(", {} less than last week", format_money(-change * 7.0)),
    };
    let mut lines =
        vec![format!("Committed: {} a day = {} a week{changed}", format_money(now), format_money(now * 7.0))];
    let spent = -seen.booked_since.sum();
    if spent > 0.0 {
        lines.push(format!("One-time costs since the last week: {}", format_money(spent)));
    }
    let days = seen.expected_days();
    let (low, high) = seen.outlook.range(days, Level::Central80);
    if seen.last_week.is_none() {
        lines.push("No income yet".to_owned());
    } else if days > 0 {
        lines.push(format!(
            "Cash in {} at these costs{}: {} expected, 80% range {} to {}",
            pluralize(days.div_ceil(7), "week"),
            // The range was measured without large changes of advertising.
            seen.outlook.advertising_change.map_or("", |_| ", without the effect of the changed ads"),
            format_money(seen.outlook.expected_cash(days)),
            format_money(low),
            format_money(high)
        ));
    }
    let premise = match seen.outlook.advertising_change {
        Some(change) if change.added() > 0.0 => ", if the added ads bring no signups",
        _ => "",
    };
    lines.push(format!("{}{premise}", capitalize(&describe_runway(&seen.runway))));
    lines
}

/// Returns a line for each pair of plans that are identical or have different prices only.
pub fn identical_plan_lines(seen: &Observation) -> Vec<String> {
    seen.alike_plans.iter().map(describe_identical_plans).collect()
}

fn describe_identical_plans(plans: &IdenticalPlans) -> String {
    let IdenticalPlans { cheap, expensive, .. } = plans;
    let since = if plans.before { "still" } else { "now" };
    let (low, high) = (price_to_cents(plans.cheap_price), price_to_cents(plans.expensive_price));
    if low == high {
        return format!("{cheap} and {expensive} are {since} identical: both cost {low}");
    }
    let payers = match plans.subscribers {
        0 => format!("no one has {expensive}"),
        1 => format!("1 subscriber has {expensive}"),
        more => format!("{} have {expensive}", pluralize(more, "subscriber")),
    };
    format!("{cheap} and {expensive} {since} differ only in price ({low} and {high}); {payers}")
}

/// Describes the cost of a tool call and the day on which it takes effect. Returns `None` if the call has neither cost
/// nor delay.
pub fn cost_line(preview: &Preview) -> Option<String> {
    let parts = [
        (preview.cost_now > 0.0).then(|| format!("costs {} at once", dollars(preview.cost_now))),
        (preview.cost_per_day != 0.0).then(|| format!("{} a day", signed_dollars(preview.cost_per_day))),
        preview.effect_day.map(|day| format!("from day {day}")),
    ];
    let parts: Vec<String> = parts.into_iter().flatten().collect();
    (!parts.is_empty()).then(|| parts.join(" · "))
}

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};

    use super::*;
    use crate::test_kit;
    use novamind_database::number_at;
    use novamind_record::trajectory::record::Via;
    use novamind_session::Session;

    #[test]
    fn income_and_cost_lines_list_purchases_separately() {
        let mut session = test_kit::play_weeks(0);
        for (tool, arguments) in [
            ("set_prices", json!({"A": 12, "B": 25, "C": 55})),
            ("set_daily_spend", json!({"operations": 300, "development": 200})),
            ("set_targeted_dev_spend", json!({"targeted_spend": {"S1": 4000}})),
            ("set_targeted_ad_spend", json!({"targeted_spend": {"search_ads": {"S1": 1000}}})),
            ("research_market", json!({})),
        ] {
            session
                .call(tool, &arguments, Via::Script)
                .unwrap_or_else(|rejection| panic!("{tool}: {rejection}"));
        }
        let lines = income_and_cost_lines(&session.company().observe());
        let expected = [
            "Committed: $5,585 a day = $39,095 a week",
            "One-time costs since the last week: $25,000",
            "No income yet",
        ];
        assert_eq!(lines[..3], expected);
        assert!(lines[3].starts_with("Cash should last at least "), "{lines:?}");
        let played = test_kit::play_weeks(3);
        let lines = income_and_cost_lines(&played.company().observe());
        assert!(lines[0].starts_with("Committed: $") && !lines[0].contains("since"), "{lines:?}");
        assert!(lines[1].starts_with("Cash in 4 weeks at these costs: $"), "{lines:?}");
    }

    #[test]
    fn identical_plan_lines_count_the_subscribers_who_pay_more() {
        let mut session = test_kit::play_weeks(4);
        assert_eq!(identical_plan_lines(&session.company().observe()), [""; 0]);
        let call = |session: &mut Session, tool: &str, arguments: Value| {
            session
                .call(tool, &arguments, Via::Script)
                .unwrap_or_else(|rejection| panic!("{tool}: {rejection}"));
        };
        call(&mut session, "set_model_tiers", json!({"A": 2, "B": 2}));
        call(&mut session, "set_usage_quotas", json!({"A": 60_000, "B": 60_000, "C": 1_200_000}));
        let sql = "SELECT count(*) FROM subscriptions WHERE plan = 'B' AND status = 'subscribed'";
        let on_b = number_at(&session.query(sql).expect("a count").rows[0], 0);
        let payers = format!("{} have B", pluralize(on_b as u32, "subscriber"));
        assert!(on_b > 1.0, "{payers}");
        let text = format!("A and B now differ only in price ($12 and $22); {payers}");
        assert_eq!(identical_plan_lines(&session.company().observe()), [text]);
        // The more expensive plan is found by its price, not by its letter.
        call(&mut session, "set_prices", json!({"A": 30.5}));
        let turned = identical_plan_lines(&session.company().observe());
        assert!(turned[0].starts_with("B and A now differ only in price ($22 and $30.50); "), "{turned:?}");
        call(&mut session, "set_prices", json!({"A": 22}));
        assert_eq!(
            identical_plan_lines(&session.company().observe()),
            ["A and B are now identical: both cost $22"]
        );
        call(&mut session, "set_prices", json!({"A": 12}));
        session
            .advance_with_json(
                &json!("why"),
                &session.company().naive_forecasts().to_predictions(),
                [true; 4],
                Via::Script,
                &mut |_| {},
            )
            .unwrap_or_else(|rejection| panic!("{rejection}"));
        assert!(identical_plan_lines(&session.company().observe())[0].contains("A and B still differ"));
    }
}
