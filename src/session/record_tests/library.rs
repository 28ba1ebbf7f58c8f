use crate::create::NewRun;
use crate::play::Session;
use novamind_database::text_at;
use novamind_record::folder::configuration::Configuration;
use novamind_record::folder::query_library::*;
use novamind_record::trajectory::record::Via;
use serde_json::json;

fn run_all_queries(session: &mut Session) {
    for query in QueryLibrary::bundled().queries() {
        let rows =
            session.query(&query.sql).unwrap_or_else(|rejection| panic!("{}: {rejection}", query.name));
        assert!(!rows.truncated, "{} is truncated", query.name);
        let head = QueryHeader::parse(&query.sql);
        assert!(head.title.is_some(), "{}", query.name);
        assert!(head.description.is_some_and(|what| what.ends_with('.')), "{}", query.name);
        for column in head.chart.iter().flat_map(|chart| chart.y_columns.iter().chain([&chart.x_column])) {
            assert!(rows.columns.contains(column), "{} has no column {column}", query.name);
        }
    }
}

fn play_weeks(session: &mut Session, weeks: usize) {
    for _ in 0..weeks {
        let forecasts = session.company().naive_forecasts();
        session.advance("as planned", &forecasts, Via::Script, &mut |_| {}).expect("a week");
    }
}

#[test]
fn bundled_queries_run_in_every_phase() {
    let mut session = run_queries_in_every_phase(NewRun::default());
    // The bundled queries derive first bills from the columns that both releases publish.
    let first_bills = |session: &mut Session, of: &str| {
        let sql =
            format!("SELECT customer_id FROM subscriptions JOIN customers c USING (customer_id) WHERE {of}");
        session.query(&(sql + " ORDER BY 1")).expect("customers").rows
    };
    let billed = first_bills(&mut session, "first_billing_done = 1");
    let derived = "status IN ('subscribed', 'cancelled') AND (c.customer_type = 'small' OR \
                   'Subscription payment from customer ' || c.customer_id IN \
                   (SELECT note FROM ledger WHERE category = 'subscription_payment'))";
    assert!(!billed.is_empty());
    assert_eq!(first_bills(&mut session, derived), billed);
    let (notice, _) = post_notice(&mut session);
    assert!(notice.starts_with("Your post was seen ") && notice.contains("Reaction "), "{notice}");
}

/// Returns the notification about the only post, and the views of the post.
fn post_notice(session: &mut Session) -> (String, String) {
    let sql = "SELECT n.message, printf('%,d', a.views) FROM notifications n JOIN agent_social_media_posts a \
               WHERE n.message LIKE '%We are here.%'";
    let rows = session.query(sql).expect("a notification").rows;
    assert_eq!(rows.len(), 1);
    (text_at(&rows[0], 0).to_owned(), text_at(&rows[0], 1).to_owned())
}

#[test]
fn bundled_queries_run_in_every_phase_under_release_2() {
    let new = NewRun { scenario: "release-2".to_owned(), ..NewRun::default() };
    let mut session = run_queries_in_every_phase(new);
    let (notice, views) = post_notice(&mut session);
    let expected = format!(
        "Your post received {views} views: \"We are here.\". The comments of customers show the public reaction."
    );
    assert_eq!(notice, expected);
}

fn run_queries_in_every_phase(new: NewRun) -> Session {
    let new = NewRun { seed: Some(11), cash: Some(20_000_000.0), ..new };
    let mut session = Session::create(new, &Configuration::bundled()).expect("a run");
    run_all_queries(&mut session);
    let ads = json!({"S1": 750, "E1": 4000, "E2": 4000, "E3": 4000});
    for (tool, arguments) in [
        ("set_prices", json!({"A": 14, "B": 32, "C": 55})),
        ("set_model_tiers", json!({"A": 4, "B": 4, "C": 4})),
        ("set_usage_quotas", json!({"A": 60_000, "B": 250_000, "C": 1_200_000})),
        ("set_targeted_dev_spend", json!({"E1": 4000, "E2": 5000, "E3": 5000})),
        ("set_targeted_ad_spend", json!({"targeted_spend": {"content_marketing": ads, "linkedin": ads}})),
        ("set_capacity_tier", json!({"tier": 5})),
        ("set_ads_strength", json!({"global_strength": 0.2})),
        ("post_social_media", json!({"content": "We are here."})),
    ] {
        session.call(tool, &arguments, Via::Script).unwrap_or_else(|rejection| panic!("{tool}: {rejection}"));
    }
    play_weeks(&mut session, 3);
    run_all_queries(&mut session);
    while session.company().observe().waiting.is_empty() && session.day() < 140 {
        play_weeks(&mut session, 1);
    }
    let waiting = session.company().observe().waiting;
    assert!(!waiting.is_empty(), "there must be threads");
    let deals = json!({"deals": [[waiting[0].customer, [["C", 30.0], ["B", 20.0]]]]});
    session.call("send_enterprise_deal", &deals, Via::Script).expect("an offer");
    play_weeks(&mut session, 1);
    run_all_queries(&mut session);
    session
}
