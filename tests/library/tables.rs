//! The 19 tables: their columns, and the days on which rows appear.

use std::collections::BTreeMap;

use novamind::database::Cell;
use novamind::database::Interface;
use novamind::record::folder::configuration::Configuration;
use novamind::record::mode::Mode;
use novamind::record::trajectory::record::Via;
use novamind::session::{NewRun, Session};
use serde_json::json;

use crate::support::company::{call_tool, query_number, query_rows, query_text};

fn create_run(overrides: &[(&str, &str)]) -> Session {
    let overrides = overrides.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
    let new = NewRun { seed: Some(7), days: Some(140), mode: Mode::Debug, overrides, ..NewRun::default() };
    Session::create(new, &Configuration::bundled()).expect("the run begins")
}

/// Opens a company with advertising in two channels. One channel has two groups, and one of these groups has no budget.
fn fund_two_channels(session: &mut Session) {
    call_tool(session, "set_prices", json!({"A": 12, "B": 25, "C": 55}));
    call_tool(session, "set_model_tiers", json!({"B": 2, "C": 4}));
    call_tool(session, "set_usage_quotas", json!({"A": 60000, "B": 250000, "C": 1200000}));
    call_tool(session, "set_targeted_dev_spend", json!({"S1": 6000}));
    call_tool(
        session,
        "set_targeted_ad_spend",
        json!({"content_marketing": {"S1": 750}, "linkedin": {"E1": 3000, "S1": 0}}),
    );
}

/// Returns a company with enterprise leads that never receive a reply.
fn company_with_enterprise_leads() -> Session {
    let new =
        NewRun { seed: Some(7), days: Some(140), cash: Some(20e6), mode: Mode::Debug, ..NewRun::default() };
    let mut session = Session::create(new, &Configuration::bundled()).expect("the run begins");
    call_tool(&mut session, "set_prices", json!({"A": 14, "B": 32, "C": 55}));
    call_tool(&mut session, "set_model_tiers", json!({"A": 4, "B": 4, "C": 4}));
    call_tool(&mut session, "set_usage_quotas", json!({"A": 300, "B": 30000, "C": 1000000}));
    call_tool(&mut session, "set_targeted_dev_spend", json!({"S1": 6000, "E1": 20000, "E2": 20000}));
    let ads = json!({"content_marketing": {"S1": 750}, "linkedin": {"E1": 8000, "E2": 8000}});
    call_tool(&mut session, "set_targeted_ad_spend", ads);
    session
}

/// Simulates single days across the ends of weeks.
fn advance_days(session: &mut Session, count: u32) {
    for _ in 0..count {
        session.step(1, &mut |_| {}).expect("a day");
    }
}

fn assert_no_rows(session: &mut Session, table: &str, condition: &str) {
    let found = query_rows(session, &format!("SELECT * FROM {table} WHERE {condition} LIMIT 3"));
    assert!(found.is_empty(), "{table} where {condition}: {found:?}");
}

#[test]
fn visible_tables_and_columns_match_the_list() {
    let mut listed: Vec<(String, Vec<(String, String)>)> = Vec::new();
    let mut reader = csv::Reader::from_reader(include_str!("../data/visible_columns.csv").as_bytes());
    for row in reader.records().map(|row| row.expect("a row")) {
        if listed.last().is_none_or(|(table, _)| *table != row[0]) {
            listed.push((row[0].to_owned(), Vec::new()));
        }
        listed.last_mut().expect("a table").1.push((row[1].to_owned(), row[2].to_owned()));
    }
    assert_eq!(listed.len(), 19);
    assert_eq!(listed.iter().map(|(_, columns)| columns.len()).sum::<usize>(), 148);
    let documented: Vec<(String, Vec<(String, String)>)> = novamind::database::tables(Interface::Release1)
        .iter()
        .map(|table| {
            let columns = table.columns.iter().map(|column| (column.name.clone(), column.kind.clone()));
            (table.name.clone(), columns.collect())
        })
        .collect();
    assert_eq!(documented, listed);
    let mut session = create_run(&[]);
    for (table, columns) in listed {
        let texts = session.query(&format!("SELECT * FROM {table}")).expect("an answer").columns;
        assert_eq!(texts, columns.into_iter().map(|(name, _)| name).collect::<Vec<_>>(), "{table}");
    }
}

#[test]
fn tables_contain_only_the_expected_rows_on_day_0() {
    let mut session = create_run(&[]);
    for table in novamind::database::tables(Interface::Release1) {
        let expected = match table.name.as_str() {
            "customers" | "ledger" | "config_history" => 1.0,
            "group_info_levels" => 26.0,
            _ => 0.0,
        };
        assert_eq!(
            query_number(&mut session, &format!("SELECT count(*) FROM {}", table.name)),
            expected,
            "{}",
            table.name
        );
    }
    let observer = "SELECT customer_type || group_id || created_day || email FROM customers";
    assert_eq!(query_text(&mut session, observer), "smallS10market_observer@external");
    assert_eq!(query_text(&mut session, "SELECT category || day FROM ledger"), "initial_funding0");
}

#[test]
fn customers_match_subscriptions() {
    let mut session = company_with_enterprise_leads();
    advance_days(&mut session, 70);
    let leads = query_number(&mut session, "SELECT count(*) FROM customers WHERE customer_id > 1");
    assert!(leads > 1000.0);
    assert_eq!(
        query_number(
            &mut session,
            "SELECT sum(amount) / -0.5 FROM ledger WHERE category = 'lead_acquisition_cost'"
        ),
        leads
    );
    assert_no_rows(&mut session, "customers", "customer_id > 1 AND created_day NOT BETWEEN 1 AND 70");
    assert_no_rows(
        &mut session,
        "customers",
        "customer_type = 'small' AND customer_id > 1 AND email IS NOT NULL",
    );
    assert_no_rows(&mut session, "customers", "customer_type = 'large' AND email IS NULL");
    assert_no_rows(&mut session, "customers", "contract_start_day IS NOT NULL");
    let sources = "SELECT DISTINCT acquisition_source FROM customers WHERE customer_id > 1 ORDER BY 1";
    let sources: Vec<String> =
        query_rows(&mut session, sources).iter().map(|row| format!("{:?}", row[0])).collect();
    assert_eq!(sources, ["Text(\"content_marketing\")", "Text(\"linkedin\")", "Text(\"network\")"]);

    let joined = "subscriptions JOIN customers USING (customer_id)";
    assert_no_rows(
        &mut session,
        "(SELECT customer_id, count(*) AS n FROM subscriptions GROUP BY 1)",
        "n > 1",
    );
    assert_no_rows(&mut session, joined, "start_day <> created_day");
    assert_no_rows(&mut session, "subscriptions", "billing_day_mod30 <> start_day % 30");
    assert_no_rows(&mut session, "subscriptions", "effective_price <> max(0, listed_price - promotion)");
    assert_no_rows(
        &mut session,
        "subscriptions",
        "contract_months <> 1 OR pending_plan IS NOT NULL OR pending_price IS NOT NULL",
    );
    // Leads without an acceptable plan are lost on the same day and have no end day.
    assert_no_rows(
        &mut session,
        joined,
        "customer_type = 'small' AND status = 'lost' AND end_day IS NOT NULL",
    );
    assert_no_rows(&mut session, joined, "customer_type = 'small' AND (status = 'lead' OR plan = 'pending')");
    assert_no_rows(
        &mut session,
        joined,
        "customer_type = 'small' AND status IN ('subscribed', 'cancelled') AND first_billing_done <> 1",
    );
    assert_no_rows(
        &mut session,
        "subscriptions",
        "status = 'cancelled' AND (end_day IS NULL OR end_day % 30 <> start_day % 30)",
    );
    assert_no_rows(&mut session, "subscriptions", "status = 'subscribed' AND end_day IS NOT NULL");
    // Enterprises receive no reply in this run, so every enterprise lead is lost after seven days.
    assert_no_rows(&mut session, joined, "customer_type = 'large' AND plan <> 'pending'");
    assert_no_rows(&mut session, joined, "customer_type = 'large' AND status = 'lead' AND start_day <= 63");
    assert_no_rows(
        &mut session,
        joined,
        "customer_type = 'large' AND status = 'lost' AND end_day <> start_day + 7",
    );
    assert!(
        query_number(
            &mut session,
            &format!("SELECT count(*) FROM {joined} WHERE status = 'lost' AND plan = 'pending'")
        ) > 3.0
    );
}

#[test]
fn usage_service_and_settings_have_a_row_per_day() {
    let mut session = create_run(&[]);
    fund_two_channels(&mut session);
    advance_days(&mut session, 10);
    call_tool(&mut session, "set_capacity_tier", json!({"tier": 2}));
    call_tool(&mut session, "set_prices", json!({"A": 13}));
    call_tool(&mut session, "set_prices", json!({"A": 14}));
    advance_days(&mut session, 32);
    // The first usage of a subscriber is on the day after signup. Rows older than 30 days are deleted every ten days.
    let first = "SELECT count(*) FROM (SELECT min(day) AS first, customer_id FROM daily_usage GROUP BY 2) \
                 JOIN subscriptions USING (customer_id) WHERE start_day >= 10 AND first <> start_day + 1";
    assert_eq!(query_number(&mut session, first), 0.0);
    assert_eq!(query_number(&mut session, "SELECT min(day) FROM daily_usage"), 10.0);
    let totals =
        "(SELECT day, sum(usage_units) AS used FROM daily_usage GROUP BY 1) JOIN service_day USING (day)";
    assert_no_rows(&mut session, totals, "used <> total_usage_units");
    assert_eq!(query_number(&mut session, "SELECT count(*) FROM service_day"), 42.0);
    assert_no_rows(&mut session, "service_day", "capacity_tier <> CASE WHEN day <= 10 THEN 0 ELSE 2 END");
    assert_no_rows(
        &mut session,
        "service_day",
        "downtime_minutes NOT IN (0, 10, 30, 90) OR error_rate NOT BETWEEN 0 AND 1",
    );
    // Each day with changes has one row. Days without a call have no row.
    let history = query_rows(
        &mut session,
        "SELECT day, price_A, price_B, capacity_tier, spend_advertising FROM config_history",
    );
    let row = |day, price, tier| {
        vec![Cell::Integer(day), Cell::Real(price), Cell::Real(25.0), Cell::Integer(tier), Cell::Real(0.0)]
    };
    assert_eq!(history, [row(0, 12.0, 0), row(10, 14.0, 2)]);
}

#[test]
fn targeted_settings_rows_contain_all_targets_after_every_call() {
    let mut session = create_run(&[]);
    call_tool(&mut session, "set_targeted_ops_spend", json!({"E1": 30}));
    call_tool(
        &mut session,
        "set_targeted_ops_spend",
        json!({"by_plan": {"A": 10}, "by_customer": {"42": 7}}),
    );
    call_tool(&mut session, "set_promotion", json!({}));
    advance_days(&mut session, 3);
    call_tool(&mut session, "set_targeted_dev_spend", json!({"S1": 4000, "E1": 80.0, "S2": 0.5}));
    call_tool(&mut session, "set_targeted_ad_spend", json!({"linkedin": {"E1": 80, "S1": 40.0}}));
    call_tool(
        &mut session,
        "set_targeted_ad_spend",
        json!({"E1": {"linkedin": 80}, "S1": {"linkedin": 40.0}}),
    );
    call_tool(&mut session, "set_ads_strength", json!({"by_group": {"S1": 1}}));
    let kept = query_rows(
        &mut session,
        "SELECT id, day, tool_name, setting_type, settings_json FROM config_overrides",
    );
    let row = |id, day, tool: &str, kind: &str, json: &str| {
        let text = |text: &str| Cell::Text(text.to_owned());
        vec![Cell::Integer(id), Cell::Integer(day), text(tool), text(kind), text(json)]
    };
    let ops = r#"{"by_group": {"E1": 30.0}, "by_plan": {"A": 10.0}, "by_group_plan": {}, "by_customer": {"42": 7.0}}"#;
    let none = r#"{"by_group": {"E1": 30.0}, "by_plan": {}, "by_group_plan": {}, "by_customer": {}}"#;
    let promotion = r#"{"global": 0.0, "by_group": {}, "by_customer": {}, "by_group_plan": {}}"#;
    // Budgets of ads and development keep the notation of the call. All other amounts have a decimal point.
    let development = r#"{"targeted_spend": {"S1": 4000, "E1": 80.0, "S2": 0.5}}"#;
    let ads = r#"{"targeted_spend": {"linkedin": {"E1": 80, "S1": 40.0}}}"#;
    let strength = r#"{"global": 0.0, "by_group": {"S1": 1.0}, "by_customer": {}}"#;
    let expected = [
        row(1, 0, "set_targeted_ops_spend", "targeted_ops_spend", none),
        row(2, 0, "set_targeted_ops_spend", "targeted_ops_spend", ops),
        row(3, 0, "set_promotion", "promotion", promotion),
        row(4, 3, "set_targeted_dev_spend", "targeted_dev_spend", development),
        row(5, 3, "set_targeted_ad_spend", "targeted_ad_spend", ads),
        row(6, 3, "set_targeted_ad_spend", "targeted_ad_spend", ads),
        row(7, 3, "set_ads_strength", "ads_strength", strength),
    ];
    assert_eq!(kept, expected);
}

#[test]
fn ledger_is_ordered_and_adds_up_to_cash() {
    let mut session = create_run(&[]);
    fund_two_channels(&mut session);
    call_tool(&mut session, "set_targeted_ops_spend", json!({"S1": 20}));
    call_tool(&mut session, "set_ads_strength", json!({"global_strength": 0.5}));
    call_tool(&mut session, "research_market", json!({}));
    call_tool(&mut session, "research_group", json!({"group_id": "S1"}));
    call_tool(&mut session, "start_research_project", json!({"tier": 1}));
    advance_days(&mut session, 20);
    let cash = session.company().observe().cash;
    assert!((query_number(&mut session, "SELECT sum(amount) FROM ledger") - cash).abs() < 1e-6);
    let tools =
        query_rows(&mut session, "SELECT category, amount, note FROM ledger WHERE day = 0 ORDER BY id");
    let written: Vec<String> = tools.iter().map(|row| format!("{:?} {:?}", row[0], row[1])).collect();
    let row = |category: &str, amount: f64| format!("Text(\"{category}\") Real({amount:?})");
    let expected = [
        row("initial_funding", 1e6),
        row("market_research", -25_000.0),
        row("group_research", -60_000.0),
        row("research_project", -166_667.0),
    ];
    assert_eq!(written, expected);
    assert_eq!(tools[2][2], Cell::Text("Group research: S1, level 1 to 2".to_owned()));
    let order = "SELECT category FROM (SELECT category, min(id) AS first FROM ledger WHERE day = 15 GROUP BY category, note LIKE 'Targeted%') ORDER BY first";
    let order: Vec<String> =
        query_rows(&mut session, order).iter().map(|row| format!("{:?}", row[0])).collect();
    let expected = [
        "lead_acquisition_cost",
        "subscription_payment",
        "capacity",
        "compute",
        "operations",
        "development",
        "advertising",
        "operations",
        "development",
        "ad_revenue",
    ];
    assert_eq!(order, expected.map(|category| format!("Text(\"{category}\")")));
    assert_no_rows(
        &mut session,
        "ledger",
        "amount > 0 AND category NOT IN ('initial_funding', 'subscription_payment', 'ad_revenue')",
    );
}

#[test]
fn forecast_rows_have_the_filing_day() {
    let mut session = create_run(&[]);
    for _ in 0..2 {
        let forecasts = session.company().naive_forecasts();
        session.advance("as planned", &forecasts, Via::Script, &mut |_| {}).expect("a week");
    }
    let filed =
        query_rows(&mut session, "SELECT submit_day, horizon_days, metric FROM predictions ORDER BY 1, 2");
    let row = |day, horizon| vec![Cell::Integer(day), Cell::Integer(horizon), Cell::Text("cash".to_owned())];
    let expected: Vec<_> =
        [0, 7].iter().flat_map(|day| [7, 28, 84, 182].map(|horizon| row(*day, horizon))).collect();
    assert_eq!(filed, expected);
    assert_no_rows(
        &mut session,
        "predictions",
        "NOT (predicted_lower <= predicted_value AND predicted_value <= predicted_upper)",
    );
    assert_no_rows(&mut session, "predictions", "submitted_at < 1.7e9");
}

#[test]
fn research_discovery_and_economy_create_notifications() {
    let mut session = create_run(&[("market_research.market_research_discover_prob", "1.0")]);
    advance_days(&mut session, 7);
    let found = call_tool(&mut session, "research_market", json!({}));
    let group = found["discovered_group_id"].as_str().expect("a group").to_owned();
    let attempt =
        query_rows(&mut session, "SELECT id, day, cost, success, discovered_group_id FROM segment_discovery");
    let expected = vec![
        Cell::Integer(1),
        Cell::Integer(7),
        Cell::Real(25_000.0),
        Cell::Integer(1),
        Cell::Text(group.clone()),
    ];
    assert_eq!(attempt, [expected]);
    let level = |session: &mut Session, group: &str| {
        let sql = format!(
            "SELECT info_level, is_discoverable, discovered_day, last_research_day FROM group_info_levels WHERE group_id = '{group}'"
        );
        query_rows(session, &sql).remove(0)
    };
    let levels = |values: [i64; 4]| values.map(Cell::Integer).to_vec();
    assert_eq!(level(&mut session, &group), levels([1, 1, 7, 7]));
    let initial = [Cell::Integer(1), Cell::Integer(0), Cell::Integer(0), Cell::Null];
    assert_eq!(level(&mut session, "S1"), initial);
    let unknown = "SELECT count(*) FROM group_info_levels WHERE info_level = 0 AND discovered_day IS NULL AND last_research_day IS NULL";
    assert_eq!(query_number(&mut session, unknown), 19.0);
    let notice = |session: &mut Session, kind: &str| {
        let sql = format!("SELECT day, message FROM notifications WHERE type = '{kind}'");
        let text = |cell: &Cell| if let Cell::Text(text) = cell { text.clone() } else { String::new() };
        query_rows(session, &sql).iter().map(|row| (row[0].clone(), text(&row[1]))).collect::<Vec<_>>()
    };
    let announced = notice(&mut session, "market_discovery");
    assert_eq!(announced.len(), 1);
    assert!(
        announced[0].0 == Cell::Integer(7)
            && announced[0].1.contains(&group)
            && announced[0].1.contains("attempt 1")
    );

    call_tool(&mut session, "research_group", json!({"group_id": group, "target_level": 3}));
    let project = call_tool(&mut session, "start_research_project", json!({"tier": 1}));
    let due = project["expected_completion_day"].as_u64().expect("a day") as u32;
    advance_days(&mut session, 4);
    assert_eq!(level(&mut session, &group), levels([1, 1, 7, 7]));
    assert!(notice(&mut session, "group_research_complete").is_empty());
    advance_days(&mut session, 1);
    assert_eq!(level(&mut session, &group), levels([3, 1, 7, 12]));
    let announced = notice(&mut session, "group_research_complete");
    assert!(announced[0].0 == Cell::Integer(12) && announced[0].1.contains("\u{b1}25%"), "{announced:?}");
    call_tool(&mut session, "research_group", json!({"group_id": group, "target_level": 3}));
    advance_days(&mut session, 5);
    assert_eq!(level(&mut session, &group), levels([3, 1, 7, 12]));
    assert!(notice(&mut session, "group_research_complete")[1].1.contains("refreshed"));

    // PMI measurements are published a month later.
    advance_days(&mut session, 30 - 17);
    assert_eq!(query_number(&mut session, "SELECT count(*) FROM macroeconomic_conditions"), 0.0);
    let running =
        "SELECT count(*) FROM research_projects WHERE status = 'in_progress' AND quality_boost_applied = 0";
    assert_eq!(query_number(&mut session, running), 1.0);
    advance_days(&mut session, 1);
    assert_eq!(query_number(&mut session, "SELECT day FROM macroeconomic_conditions"), 1.0);
    assert_eq!(notice(&mut session, "macro_economic_update")[0].0, Cell::Integer(31));

    advance_days(&mut session, due - 1 - 31);
    assert_eq!(query_number(&mut session, running), 1.0);
    assert!(notice(&mut session, "research_complete").is_empty());
    advance_days(&mut session, 1);
    let done = "SELECT count(*) FROM research_projects WHERE project_id = 't1_1' AND status = 'completed' \
                AND quality_boost_applied = expected_quality_boost AND started_day = 7";
    assert_eq!(query_number(&mut session, done), 1.0);
    assert_eq!(
        notice(&mut session, "research_complete")[0],
        (Cell::Integer(i64::from(due)), "R&D complete: t1_1".to_owned())
    );
}

#[test]
fn funded_channels_have_a_row_per_day_and_ad_revenue_a_row_per_subscriber() {
    let mut session = create_run(&[]);
    fund_two_channels(&mut session);
    advance_days(&mut session, 35);
    // The third pair of channel and group has no budget, so it has no rows.
    let pairs = query_rows(
        &mut session,
        "SELECT channel_id, group_id, count(*), sum(leads_generated) > 0 FROM ad_channel_leads GROUP BY 1, 2",
    );
    let text = |text: &str| Cell::Text(text.to_owned());
    let expected = |channel, group| vec![text(channel), text(group), Cell::Integer(35), Cell::Integer(1)];
    assert_eq!(pairs, [expected("content_marketing", "S1"), expected("linkedin", "E1")]);
    let attributed = "SELECT count(*) FROM customers WHERE acquisition_source = 'content_marketing'";
    let counted = "SELECT sum(leads_generated) FROM ad_channel_leads WHERE channel_id = 'content_marketing'";
    assert_eq!(query_number(&mut session, attributed), query_number(&mut session, counted));

    assert_eq!(query_number(&mut session, "SELECT count(*) FROM ads_revenue"), 0.0);
    call_tool(&mut session, "set_ads_strength", json!({"global_strength": 0.2, "by_group": {"S1": 0.1}}));
    advance_days(&mut session, 2);
    call_tool(&mut session, "set_ads_strength", json!({"global_strength": 0, "by_group": {}}));
    advance_days(&mut session, 2);
    let shown = query_rows(&mut session, "SELECT DISTINCT day FROM ads_revenue ORDER BY 1");
    assert_eq!(shown, [[Cell::Integer(36)], [Cell::Integer(37)]]);
    assert_no_rows(&mut session, "ads_revenue", "revenue <= 0");
    assert_no_rows(&mut session, "ads_revenue", "group_id = 'S1' AND abs(ads_strength - 0.568201724) > 1e-9");
    assert_no_rows(
        &mut session,
        "ads_revenue",
        "group_id <> 'S1' AND abs(ads_strength - 0.447158031) > 1e-9",
    );
    let earned = "SELECT abs((SELECT sum(revenue) FROM ads_revenue) - (SELECT sum(amount) FROM ledger WHERE category = 'ad_revenue')) < 1e-6";
    assert_eq!(query_number(&mut session, earned), 1.0);
}

#[derive(Debug, Clone, PartialEq)]
struct Issue {
    customer: u32,
    group: &'static str,
    open_day: u32,
    days_open: u32,
    resolved_day: Option<u32>,
}

#[test]
fn issue_rows_match_the_facts() {
    let mut session = create_run(&[]);
    fund_two_channels(&mut session);
    let mut issues: BTreeMap<u32, Issue> = BTreeMap::new();
    for _ in 0..70 {
        session
            .step(1, &mut |report| {
                let xray = report.xray.expect("a debug run");
                let facts = xray.facts();
                let active_before: Vec<u32> = {
                    let ended = facts.endings.iter().map(|ending| ending.customer);
                    let still =
                        xray.world().customers.blocks().flat_map(|(_, block)| block.customer.iter().copied());
                    still.chain(ended).collect()
                };
                for number in &facts.issues_resolved {
                    issues.get_mut(number).expect("it was open").resolved_day = Some(facts.day);
                }
                let open = |issue: &&Issue| issue.resolved_day.is_none();
                let waits = issues.values().filter(open).any(|issue| active_before.contains(&issue.customer));
                let had = facts
                    .issues_resolved
                    .iter()
                    .any(|number| active_before.contains(&issues[number].customer));
                // Issues do not age on days without an open issue of an active subscriber.
                if waits || had {
                    let waiting = issues.values_mut().filter(|issue| issue.resolved_day.is_none());
                    waiting.for_each(|issue| issue.days_open += 1);
                }
                for opened in &facts.issues_opened {
                    let issue = Issue {
                        customer: opened.customer,
                        group: opened.group.id(),
                        open_day: facts.day,
                        days_open: 0,
                        resolved_day: None,
                    };
                    assert!(issues.insert(opened.issue, issue).is_none());
                }
            })
            .expect("a day");
    }
    assert!(issues.len() > 300, "{}", issues.len());
    let sql = "SELECT issue_id, customer_id, group_id, open_day, days_open, resolved_day, status, resolution_type \
               FROM issues ORDER BY 1";
    let expected: Vec<Vec<Cell>> = issues
        .iter()
        .map(|(number, issue)| {
            let solved = issue.resolved_day;
            let text = |text: &str| Cell::Text(text.to_owned());
            vec![
                Cell::Integer(i64::from(*number)),
                Cell::Integer(i64::from(issue.customer)),
                text(issue.group),
                Cell::Integer(i64::from(issue.open_day)),
                Cell::Integer(i64::from(issue.days_open)),
                solved.map_or(Cell::Null, |day| Cell::Integer(i64::from(day))),
                text(if solved.is_some() { "resolved" } else { "open" }),
                solved.map_or(Cell::Null, |_| text("ops_resolved")),
            ]
        })
        .collect();
    let shown = expected.len().min(5000);
    assert_eq!(query_rows(&mut session, sql), expected[..shown]);
    // Issues of former customers stay open forever.
    let left = "SELECT count(*) FROM issues JOIN subscriptions USING (customer_id) \
                WHERE issues.status = 'open' AND subscriptions.status = 'cancelled'";
    assert!(query_number(&mut session, left) > 0.0);
}

#[test]
fn inbox_rows_match_enterprise_leads() {
    let mut session = company_with_enterprise_leads();
    advance_days(&mut session, 60);
    let leads = query_number(
        &mut session,
        "SELECT count(*) FROM notifications WHERE type = 'large_customer_message'",
    );
    let opened =
        "SELECT count(*) FROM subscriptions JOIN customers USING (customer_id) WHERE customer_type = 'large'";
    assert!(leads > 0.0 && leads == query_number(&mut session, opened));
    let lost = "SELECT count(DISTINCT day) > 0 FROM notifications WHERE type = 'lead_lost'";
    assert_eq!(query_number(&mut session, lost), 1.0);
}
