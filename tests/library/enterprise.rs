//! Negotiations: a company negotiates with enterprises for several weeks, and the rows of its tables are checked.

use std::path::Path;

use novamind::database::text_at;
use novamind::record::folder::configuration::Configuration;
use novamind::record::trajectory::record::Via;
use novamind::record::trajectory::{Record, Trajectory};
use novamind::rules::ThreadContext;
use novamind::session::{Access, NewRun, Session, Storage, WaitingThread, verify};
use serde_json::{Value, json};

use crate::support::company::{call_tool, query_column, query_number};

fn create_run(storage: Storage) -> Session {
    let new = NewRun { seed: Some(11), cash: Some(20_000_000.0), storage, ..NewRun::default() };
    let mut session = Session::create(new, &Configuration::bundled()).expect("the run begins");
    let ads = json!({"E1": 4000, "E2": 4000, "E3": 4000});
    let channels = ["social_media", "search_ads", "linkedin", "content_marketing", "referral_program"];
    let ads: serde_json::Map<String, Value> =
        channels.iter().map(|channel| ((*channel).to_owned(), ads.clone())).collect();
    for (tool, arguments) in [
        ("set_prices", json!({"A": 14, "B": 32, "C": 55})),
        ("set_model_tiers", json!({"A": 4, "B": 4, "C": 4})),
        ("set_usage_quotas", json!({"A": 300, "B": 30_000, "C": 1_000_000})),
        ("set_daily_spend", json!({"operations": 500})),
        ("set_targeted_ops_spend", json!({"by_group": {"E1": 1500, "E2": 1500, "E3": 1500}})),
        ("set_targeted_dev_spend", json!({"E1": 4000, "E2": 5000, "E3": 5000})),
        ("set_targeted_ad_spend", json!({ "targeted_spend": ads })),
        ("set_capacity_tier", json!({"tier": 5})),
    ] {
        call_tool(&mut session, tool, arguments);
    }
    session
}

/// Replies in some threads, ends some threads, ignores some threads, and offers a subscriber a different price.
fn answer_threads(session: &mut Session) {
    let seen = session.company().observe();
    let has_remainder = |thread: &&WaitingThread, rest: u32| {
        thread.thread % 7 != 6 && (thread.thread % 5 == 4) == (rest == 1)
    };
    let offers: Vec<Value> = seen
        .waiting
        .iter()
        .filter(|thread| has_remainder(thread, 0))
        .map(|thread| {
            let price = thread.asked.unwrap_or(34.0);
            json!([thread.customer, [["C", price * 1.2], ["B", price], ["A", price / 3.0]]])
        })
        .collect();
    let ended: Vec<Value> = seen
        .waiting
        .iter()
        .filter(|thread| has_remainder(thread, 1))
        .map(|thread| json!(thread.customer))
        .collect();
    for (tool, deals) in [("send_enterprise_deal", offers), ("reject_enterprise_deal", ended)] {
        if !deals.is_empty() {
            call_tool(session, tool, json!({ "deals": deals }));
        }
    }
    if session.day() % 21 == 14 {
        let sql = "SELECT customer_id FROM subscriptions JOIN customers USING (customer_id) \
                   WHERE status = 'subscribed' AND customer_type = 'large' ORDER BY 1";
        for customer in query_column(session, sql).into_iter().step_by(9) {
            let deal = json!({"deals": [[customer, [["B", 30]]]]});
            // If the player has just replied in an open thread, the thread has an additional turn.
            session.call("send_enterprise_deal", &deal, Via::Script).expect("a subscriber accepts messages");
        }
    }
}

fn advance_week(session: &mut Session) {
    answer_threads(session);
    let forecasts = session.company().naive_forecasts();
    session.advance("as planned", &forecasts, Via::Script, &mut |_| {}).expect("a week");
}

#[track_caller]
fn assert_no_rows(session: &mut Session, wrong: &str) {
    let rows = session.query(wrong).unwrap_or_else(|refusal| panic!("{wrong}: {refusal}")).rows;
    assert!(rows.is_empty(), "{wrong}\n{:?}", &rows[..rows.len().min(5)]);
}

#[test]
fn run_with_deals_resumes_and_verifies() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut uninterrupted_session = create_run(Storage::Memory);
    (0..15).for_each(|_| advance_week(&mut uninterrupted_session));

    let mut session = create_run(Storage::Runs(folder.path().to_owned()));
    let place = session.folder().expect("a folder").to_owned();
    for at in 0..15 {
        advance_week(&mut session);
        if at % 4 == 2 {
            drop(session);
            session = Session::open(&place, Access::Write, true).expect("it opens");
        }
    }
    assert_eq!(session.state_hash(), uninterrupted_session.state_hash());
    for sql in [
        "SELECT count(*) FROM enterprise_turns",
        "SELECT sum(message_id * turn_number * length(message_text)) FROM enterprise_turns",
        "SELECT sum(listed_price * seat_count * contract_end_day) FROM subscriptions",
        "SELECT sum(amount) FROM ledger",
        "SELECT count(*) FROM notifications WHERE type = 'deal_won'",
    ] {
        assert_eq!(query_number(&mut session, sql), query_number(&mut uninterrupted_session, sql), "{sql}");
    }
    assert!(query_number(&mut session, "SELECT count(*) FROM notifications WHERE type = 'deal_won'") > 20.0);
    assert_eq!(session.company().observe().waiting, uninterrupted_session.company().observe().waiting);
    drop(session);
    assert_eq!(verify(&place).expect("it verifies").states, 15);
    check_forged_price_is_detected(&place);
}

/// A trajectory with a changed offer does not verify, because the hash chain is broken.
fn check_forged_price_is_detected(place: &Path) {
    let path = place.join("trajectory.jsonl");
    let text = std::fs::read_to_string(&path).expect("a trajectory");
    let lines = Trajectory::read(&path).expect("it is whole").lines;
    assert!(
        lines
            .iter()
            .any(|line| matches!(&line.record, Record::Call(call) if call.tool == novamind::tools::ToolId::SendEnterpriseDeal))
    );
    std::fs::write(&path, text.replacen("[\"B\",34", "[\"B\",33", 1)).expect("written");
    assert!(verify(place).is_err());
}

#[test]
fn turn_rows_are_consistent() {
    let mut session = create_run(Storage::Memory);
    (0..16).for_each(|_| advance_week(&mut session));
    let run = &mut session;
    for kind in ["new_lead", "churn_prevention", "plan_change", "renegotiation"] {
        let sql = format!("SELECT count(*) FROM enterprise_turns WHERE thread_type = '{kind}'");
        assert!(query_number(run, &sql) > 0.0, "{kind}");
    }
    // The turns of a thread are numbered without gaps or duplicates. Only several offers in one call share a number.
    assert_no_rows(
        run,
        "SELECT thread_id, count(*) AS n, max(turn_number) AS m FROM enterprise_turns GROUP BY 1 HAVING m <> n - 1",
    );
    assert_no_rows(
        run,
        "SELECT * FROM enterprise_turns WHERE message_id > (SELECT count(*) FROM enterprise_turns)",
    );
    // Only turns of enterprises have email addresses. Only these turns, and turns of the market at the end of a deal,
    // have texts.
    assert_no_rows(run, "SELECT * FROM enterprise_turns WHERE (sender = 'customer') <> (email LIKE '%@%.%')");
    assert_no_rows(
        run,
        "SELECT * FROM enterprise_turns WHERE (message_text <> '') <> (sender = 'customer' OR (sender = 'system' AND closed))",
    );
    assert_no_rows(
        run,
        "SELECT t.email FROM enterprise_turns t JOIN customers c USING (customer_id) WHERE sender = 'customer' AND t.email <> c.email",
    );
    // Checks the rows of offers.
    assert_no_rows(
        run,
        "SELECT * FROM enterprise_turns WHERE sender = 'agent' AND close_reason = '' \
         AND (json_array_length(offer_json) NOT BETWEEN 1 AND 3 OR json_extract(offer_json, '$[0].contract_months') <> 1)",
    );
    assert_no_rows(
        run,
        "SELECT * FROM enterprise_turns WHERE sender = 'agent' AND turn_number > 0 AND seat_count <> 1",
    );
    assert_no_rows(
        run,
        "SELECT * FROM enterprise_turns WHERE sender = 'agent' AND turn_number = 0 AND (seat_count < 30 OR thread_type <> 'renegotiation')",
    );
    // The last rows of a closed thread are the acceptance and the row of the market, or a rejection. Unanswered threads have no
    // closing row.
    assert_no_rows(
        run,
        "SELECT * FROM enterprise_turns WHERE closed <> (close_reason IN ('accepted', 'agent_rejected'))",
    );
    assert_no_rows(
        run,
        "SELECT thread_id, group_concat(sender) AS who FROM enterprise_turns WHERE closed GROUP BY 1 \
         HAVING who NOT IN ('customer,system', 'agent')",
    );
    assert_no_rows(
        run,
        "SELECT * FROM enterprise_turns a JOIN enterprise_turns b ON a.thread_id = b.thread_id \
         WHERE a.close_reason = 'agent_rejected' AND b.message_id > a.message_id",
    );
    let silent = "SELECT count(DISTINCT thread_id) FROM enterprise_turns WHERE thread_id NOT IN \
                  (SELECT thread_id FROM enterprise_turns WHERE closed) AND customer_id IN \
                  (SELECT customer_id FROM subscriptions WHERE status IN ('lost', 'cancelled'))";
    assert!(query_number(run, silent) > 5.0);
    // No column has hidden values.
    let columns = run.query("SELECT * FROM enterprise_turns LIMIT 1").expect("a row").columns;
    let visible = [
        "message_id",
        "thread_id",
        "customer_id",
        "thread_type",
        "turn_number",
        "sender",
        "message_text",
        "offer_json",
        "day",
        "email",
        "seat_count",
        "closed",
        "close_reason",
    ];
    assert_eq!(columns, visible);
}

#[test]
fn deal_rows_match_the_session() {
    let mut session = create_run(Storage::Memory);
    (0..16).for_each(|_| advance_week(&mut session));
    let seen = session.company().observe();
    let run = &mut session;
    let companies = "FROM subscriptions s JOIN customers c USING (customer_id) WHERE customer_type = 'large'";
    assert_eq!(
        query_number(run, &format!("SELECT count(*) {companies} AND status = 'subscribed'")),
        f64::from(seen.companies)
    );
    assert!(seen.companies > 10 && seen.seats > 1000, "{} {}", seen.companies, seen.seats);
    // The billing day depends only on the day on which the lead was created. All other columns depend on the deal.
    assert_no_rows(run, &format!("SELECT * {companies} AND billing_day_mod30 <> created_day % 30"));
    assert_no_rows(
        run,
        &format!(
            "SELECT * {companies} AND status IN ('lead', 'lost') AND (plan <> 'pending' OR start_day <> created_day)"
        ),
    );
    assert_no_rows(
        run,
        &format!(
            "SELECT * {companies} AND status = 'subscribed' AND contract_end_day <> contract_start_day + 30"
        ),
    );
    let accepted = "SELECT customer_id, min(day) AS first, max(day) AS last, max(message_id) AS message \
                    FROM enterprise_turns WHERE sender = 'customer' AND closed GROUP BY 1";
    assert_no_rows(
        run,
        &format!(
            "WITH a AS ({accepted}) SELECT * FROM a JOIN subscriptions s USING (customer_id) \
             JOIN customers c USING (customer_id) JOIN enterprise_turns t ON t.message_id = a.message \
             WHERE start_day <> first OR contract_start_day <> last \
             OR abs(listed_price - json_extract(t.offer_json, '$.price')) > 1e-9"
        ),
    );
    assert_no_rows(
        run,
        &format!(
            "SELECT * {companies} AND status IN ('subscribed', 'cancelled') AND c.contract_start_day IS NULL"
        ),
    );
    // Subscriptions that were cancelled without a reply end at the end of the agreed month.
    assert!(query_number(run, &format!("SELECT count(*) {companies} AND status = 'cancelled'")) > 0.0);
    assert_no_rows(
        run,
        &format!("SELECT * {companies} AND status IN ('cancelled', 'lost') AND end_day IS NULL"),
    );
    // Every bill is a price times whole seats on the billing day.
    let bills = "SELECT l.day, l.amount FROM ledger l JOIN customers c ON l.note = \
                 'Subscription payment from customer ' || c.customer_id JOIN subscriptions s USING (customer_id) \
                 WHERE customer_type = 'large'";
    assert!(query_number(run, &format!("SELECT count(*) FROM ({bills})")) > 20.0);
    assert_no_rows(run, &format!("{bills} AND l.day % 30 <> s.billing_day_mod30"));
    assert_no_rows(run, &format!("{bills} AND l.day < s.start_day"));
    assert_no_rows(
        run,
        &format!(
            "{bills} AND status = 'subscribed' AND contract_start_day < l.day - 30 AND l.day > 100 \
                  AND abs(l.amount - s.effective_price * s.seat_count) > 0.5"
        ),
    );
    // Each row of the inbox names an enterprise.
    assert_no_rows(
        run,
        "SELECT day, count(*) AS n FROM notifications WHERE type = 'deal_won' GROUP BY 1 \
         HAVING n <> (SELECT count(*) FROM enterprise_turns t WHERE t.day = notifications.day AND sender = 'customer' AND closed)",
    );
}

#[test]
fn week_figures_match_the_turns() {
    let mut session = create_run(Storage::Memory);
    (0..12).for_each(|_| advance_week(&mut session));
    let seen = session.company().observe();
    let figures = seen.last_week.expect("a week");
    let run = &mut session;
    let from = "day BETWEEN 78 AND 84";
    let opened = format!("SELECT count(*) FROM enterprise_turns WHERE turn_number = 0 AND {from}");
    assert_eq!(query_number(run, &opened), f64::from(figures.threads_opened));
    let replies = format!(
        "SELECT count(*) FROM enterprise_turns WHERE sender = 'customer' AND turn_number > 0 AND {from}"
    );
    assert_eq!(query_number(run, &replies), f64::from(figures.replies));
    assert!(figures.replies > 0 && figures.threads_opened > 0);
    assert!(seen.dashboard.contains(&format!("- {} new replies", figures.replies)));
    assert!(seen.dashboard.contains("awaiting your response"));
    assert!(seen.waiting.iter().all(|thread| (1..=7).contains(&thread.days_left) && thread.seats >= 30));
    for thread in &seen.waiting {
        let sql = format!(
            "SELECT count(*) FROM enterprise_turns WHERE thread_id = {} AND sender = 'agent'",
            thread.thread
        );
        assert_eq!(query_number(run, &sql), f64::from(thread.offers_so_far));
    }
    check_rules_match_tables(run);
    // The change review lists the offers since the last week. Equal offers of a call are listed in one sentence, and
    // offers cannot be undone.
    answer_threads(run);
    let done = run.company().observe().purchases;
    let offers = done.iter().filter(|line| line.starts_with("offered C at $"));
    let companies =
        offers.filter_map(|line| line.split(" to ").last()?.split(' ').next()?.parse::<f64>().ok());
    let offered =
        "SELECT count(*) FROM enterprise_turns WHERE sender = 'agent' AND offer_json <> '{}' AND day = 84";
    assert!(companies.clone().count() > 0, "{done:?}");
    assert_eq!(companies.sum::<f64>(), query_number(run, offered), "{done:?}");
    assert_eq!(run.undo(Via::Script).expect_err("nothing was set").code, "nothing_to_undo");
}

/// An enterprise that asks for the price of another plan names the plan in its message.
fn check_plan_request_text(run: &mut Session, thread: &ThreadContext) {
    let sql = format!(
        "SELECT t.message_text, s.plan FROM enterprise_turns t JOIN subscriptions s USING (customer_id)
         WHERE t.thread_id = {} AND t.sender = 'customer'",
        thread.waiting.thread
    );
    let rows = run.query(&sql).expect("a message").rows;
    let plan = thread.asked_plan.expect("a plan").id();
    assert_ne!(plan, text_at(&rows[0], 1));
    assert!(text_at(&rows[0], 0).to_lowercase().contains(&format!("plan {}", plan.to_lowercase())));
}

/// Checks the rows of subscribers that ask for a different plan: they contain the plan before a price is named.
#[test]
fn plan_request_rows_contain_the_plan_before_a_price_is_named() {
    let mut session = create_run(Storage::Memory);
    let mut plan_request_count = 0;
    for _ in 0..20 {
        advance_week(&mut session);
        let (threads, _) = ThreadContext::read_all(&mut session).expect("threads");
        let is_plan_request = |thread_context: &&ThreadContext| {
            thread_context.waiting.kind == "plan_change" && thread_context.waiting.asked.is_none()
        };
        for thread in threads.iter().filter(is_plan_request) {
            check_plan_request_text(&mut session, thread);
            plan_request_count += 1;
        }
    }
    assert!(plan_request_count > 0, "no subscriber asked for another plan");
}

/// Checks that the tables contain the fields that rules use: the price and plan that an enterprise named, and the last offer.
fn check_rules_match_tables(run: &mut Session) {
    let (threads, _) = ThreadContext::read_all(run).expect("threads");
    let mut asked = 0;
    for thread in &threads {
        let newest = |sender: &str| {
            format!(
                "SELECT message_text, offer_json FROM enterprise_turns WHERE thread_id = {} AND sender = '{sender}' \
                 AND offer_json <> '{{}}' ORDER BY message_id DESC LIMIT 1",
                thread.waiting.thread
            )
        };
        let customer_messages = run.query(&newest("customer")).expect("rows").rows;
        let agent_messages = run.query(&newest("agent")).expect("rows").rows;
        let price = customer_messages
            .first()
            .map(|row| serde_json::from_str::<Value>(text_at(row, 1)).expect("an offer"));
        let price = price.and_then(|offer| offer["price"].as_f64());
        assert_eq!(price, thread.waiting.asked);
        if let Some(row) = customer_messages.first() {
            let plan = thread.asked_plan.expect("a plan").id();
            assert!(text_at(row, 0).to_lowercase().contains(&format!("plan {}", plan.to_lowercase())));
            asked += 1;
        } else if thread.waiting.kind == "plan_change" {
            check_plan_request_text(run, thread);
        }
        let last: Vec<Value> =
            thread.waiting.last_offer.iter().map(|(plan, price)| json!([plan.id(), price])).collect();
        let value = agent_messages
            .first()
            .map_or(json!([]), |row| serde_json::from_str(text_at(row, 1)).expect("offers"));
        let offers = value.as_array().expect("a list").iter();
        assert_eq!(
            last,
            offers.map(|offer| json!([offer["plan"], offer["price_per_seat"]])).collect::<Vec<_>>()
        );
    }
    assert!(asked > 3, "{asked} enterprises asked");
    let row = threads[0].to_json(run.company().enterprise_names());
    for field in ["company", "customer", "asked_plan", "last_offer", "offers_so_far", "needed_quota"] {
        assert!(row.get(field).is_some(), "{field}: {row}");
    }
}
