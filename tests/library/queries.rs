//! Bundled queries, whose results are compared with counts of table rows.

use std::collections::BTreeMap;

use novamind::database::{Cell, QueryResult, number_at, text_at};
use novamind::record::folder::configuration::Configuration;
use novamind::record::folder::query_library::QueryLibrary;
use novamind::record::trajectory::record::Via;
use novamind::session::{NewRun, Session};
use serde_json::{Value, json};

use crate::support::company::{call_tool, query_number, query_numbers, query_rows};

/// Returns a company with few individuals and many enterprises, after several weeks of offers at two prices.
fn company_with_offers() -> Session {
    let new = NewRun { seed: Some(11), cash: Some(20_000_000.0), ..NewRun::default() };
    let mut session = Session::create(new, &Configuration::bundled()).expect("the run begins");
    let ads = json!({"S1": 750, "S2": 500, "E1": 4000, "E2": 4000, "E3": 4000});
    for (tool, arguments) in [
        ("set_prices", json!({"A": 12, "B": 25, "C": 55})),
        ("set_model_tiers", json!({"A": 4, "B": 4, "C": 4})),
        ("set_usage_quotas", json!({"A": 60_000, "B": 250_000, "C": 1_200_000})),
        ("set_targeted_dev_spend", json!({"S1": 6000, "E1": 4000, "E2": 5000, "E3": 5000})),
        ("set_targeted_ad_spend", json!({"targeted_spend": {"content_marketing": ads, "linkedin": ads}})),
        ("set_capacity_tier", json!({"tier": 5})),
    ] {
        call_tool(&mut session, tool, arguments);
    }
    while session.day() < 84 {
        let waiting = session.company().observe().waiting;
        // Every third thread receives no reply.
        let offered = waiting.iter().filter(|thread| thread.thread % 3 != 0).map(|thread| {
            let price = if thread.thread % 2 == 0 { 19.5 } else { 130.0 };
            json!([thread.customer, [["C", price], ["B", 12.0]]])
        });
        let offers: Vec<Value> = offered.collect();
        if !offers.is_empty() {
            call_tool(&mut session, "send_enterprise_deal", json!({ "deals": offers }));
        }
        advance_week(&mut session);
    }
    session
}

fn advance_week(session: &mut Session) {
    let forecasts = session.company().naive_forecasts();
    session.advance("as planned", &forecasts, Via::Script, &mut |_| {}).expect("a week");
}

fn run_named_query(session: &mut Session, name: &str) -> QueryResult {
    let library = QueryLibrary::bundled();
    let query = library.find(name).unwrap_or_else(|| panic!("no query {name}"));
    session.query(&query.sql).unwrap_or_else(|refusal| panic!("{name}: {refusal}"))
}

fn column(rows: &QueryResult, name: &str) -> usize {
    rows.columns.iter().position(|text| text == name).unwrap_or_else(|| panic!("no column {name}"))
}

fn sum(rows: &QueryResult, name: &str) -> f64 {
    let at = column(rows, name);
    rows.rows.iter().map(|row| number_at(row, at)).sum()
}

/// Returns all rows of a statement that ends with a condition. The statement is split into several queries because of
/// the row limit.
fn query_in_parts(session: &mut Session, sql: &str) -> Vec<Vec<f64>> {
    (0..8).flat_map(|part| query_numbers(session, &format!("{sql} AND customer_id % 8 = {part}"))).collect()
}

#[test]
fn due_bills_query_matches_payments_of_active_subscribers() {
    let mut session = company_with_offers();
    let due = run_named_query(&mut session, "billing-waves");
    let today = session.day();
    assert_eq!(due.rows.len(), 28);
    let subscribed = "SELECT customer_id, billing_day_mod30, effective_price * seat_count
                      FROM subscriptions WHERE status = 'subscribed'";
    let before = query_in_parts(&mut session, subscribed);
    advance_week(&mut session);
    let terms = format!(
        "SELECT customer_id, effective_price * seat_count FROM subscriptions
         WHERE status IN ('subscribed', 'cancelled') AND coalesce(end_day, 999) > {today}"
    );
    let terms: BTreeMap<u64, f64> =
        query_in_parts(&mut session, &terms).iter().map(|row| (row[0] as u64, row[1])).collect();
    let mut payments = 0;
    for (row, day) in due.rows.iter().zip(today + 1..) {
        assert_eq!(number_at(row, column(&due, "day")), f64::from(day));
        let billed: Vec<&Vec<f64>> =
            before.iter().filter(|values| values[1] == f64::from(day % 30)).collect();
        assert_eq!(number_at(row, column(&due, "customers")), billed.len() as f64, "day {day}");
        let dollars = billed.iter().map(|bill| bill[2]).sum::<f64>();
        assert!((number_at(row, column(&due, "dollars_due")) - dollars).abs() < 0.01, "day {day}");
        // Prices did not change, so subscribers with the same terms pay the same amount.
        let paid = format!(
            "SELECT CAST(replace(note, 'Subscription payment from customer ', '') AS INTEGER), amount
             FROM ledger WHERE category = 'subscription_payment' AND day = {day}"
        );
        let paid: BTreeMap<u64, f64> =
            query_numbers(&mut session, &paid).iter().map(|row| (row[0] as u64, row[1])).collect();
        for bill in billed {
            let (customer, dollars) = (bill[0] as u64, bill[2]);
            if let Some(amount) = paid.get(&customer).filter(|_| terms.get(&customer) == Some(&dollars)) {
                assert_eq!(*amount, dollars, "customer {customer} on day {day}");
                payments += 1;
            }
        }
    }
    assert!(payments > 500, "{payments}");
}

#[test]
fn lead_choices_query_counts_every_lead_once() {
    let mut session = company_with_offers();
    let chosen = run_named_query(&mut session, "choices-of-new-leads");
    let since = session.day() - 7;
    let leads = format!(
        "FROM customers LEFT JOIN subscriptions USING (customer_id)
         WHERE created_day > {since} AND acquisition_source IS NOT NULL"
    );
    let conditions = [
        ("leads", "1"),
        ("plan_A", "plan = 'A' AND status IN ('subscribed', 'cancelled')"),
        ("plan_B", "plan = 'B' AND status IN ('subscribed', 'cancelled')"),
        ("plan_C", "plan = 'C' AND status IN ('subscribed', 'cancelled')"),
        ("lost", "status = 'lost'"),
        ("negotiating", "status = 'lead'"),
        ("no_thread", "status IS NULL"),
    ];
    for (name, condition) in conditions {
        let counted = query_number(&mut session, &format!("SELECT count(*) {leads} AND {condition}"));
        assert_eq!(sum(&chosen, name), counted, "{name}");
    }
    let parts: f64 = conditions[1..].iter().map(|(name, _)| sum(&chosen, name)).sum();
    assert_eq!(parts, sum(&chosen, "leads"), "every lead is counted once");
    let signed = ["plan_A", "plan_B", "plan_C"].iter().map(|name| sum(&chosen, name)).sum::<f64>();
    assert!(signed > 0.0 && sum(&chosen, "lost") > 0.0 && sum(&chosen, "negotiating") > 0.0, "{chosen:?}");
    for row in &chosen.rows {
        let of = |name| number_at(row, column(&chosen, name));
        assert_eq!(of("lost_percent"), (1000.0 * of("lost") / of("leads")).round() / 10.0);
    }
}

#[test]
fn first_offers_query_matches_the_turns() {
    let mut session = company_with_offers();
    let offers = run_named_query(&mut session, "first-offers");
    let turns = query_rows(
        &mut session,
        "SELECT thread_id, customer_id, day FROM enterprise_turns t WHERE thread_type = 'new_lead' AND sender = 'agent'
         AND message_id = (SELECT min(message_id) FROM enterprise_turns WHERE thread_id = t.thread_id AND sender = 'agent')",
    );
    assert_eq!(sum(&offers, "threads"), turns.len() as f64);
    let [signed, lost, waiting] = ["signed", "lost", "waiting"].map(|name| sum(&offers, name));
    assert_eq!(signed + lost + waiting, turns.len() as f64);
    assert!(signed > 0.0 && lost > 0.0 && waiting > 0.0, "{signed} {lost} {waiting}");
    for row in &offers.rows {
        let price = [column(&offers, "price_from"), column(&offers, "price_below")].map(|at| row[at].clone());
        assert!(price == [15, 20].map(Cell::Integer) || price == [100, 150].map(Cell::Integer), "{price:?}");
        assert_eq!(text_at(row, column(&offers, "plan")), "C+B", "all plans, the first one first");
    }
    let deals = "SELECT count(DISTINCT thread_id) FROM enterprise_turns WHERE thread_type = 'new_lead'
                 AND close_reason = 'accepted'";
    assert_eq!(signed, query_number(&mut session, deals));
    let open =
        "SELECT count(DISTINCT t.thread_id) FROM enterprise_turns t JOIN subscriptions s USING (customer_id)
                WHERE t.thread_type = 'new_lead' AND t.sender = 'agent' AND s.status = 'lead'";
    assert_eq!(waiting, query_number(&mut session, open));
}
