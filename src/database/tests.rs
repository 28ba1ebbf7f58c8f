//! Tests that project and query a company of a few weeks.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use super::query::QueryLimits;
use super::{
    Cell, DatabaseLocation, ProjectionEntry, ProjectionPosition, Projector, QueryConnection, QueryError,
    QueryResult, Scope, number_at, text_at,
};
use novamind_world::day::step_day;
use novamind_world::events::{
    EndCause, Facts, IssueOpened, SubscriptionEnded, SubscriptionOpened, SubscriptionStatus,
};
use novamind_world::identifiers::{Group, Plan};
use novamind_world::params::{Interface, Params};
use novamind_world::random::Streams;
use novamind_world::state::World;
use novamind_world::test_kit::apply_policy_p;

const LIMITS: QueryLimits = QueryLimits { rows: 5000, time: Duration::from_secs(20), steps: None };

fn entry(facts: Facts) -> ProjectionEntry {
    ProjectionEntry {
        notices: facts.notices.iter().map(|notice| novamind_voice::notice_text(notice, None)).collect(),
        posts: facts.posts.iter().map(|post| format!("text of post {}", post.post)).collect(),
        turns: facts.turns.iter().map(|_| String::new()).collect(),
        readings: facts.readings.iter().map(novamind_voice::reading_text).collect(),
        addresses: facts
            .arrivals
            .iter()
            .filter(|arrival| arrival.group.is_enterprise())
            .map(|arrival| (arrival.customer, format!("{}@example.com", arrival.customer)))
            .collect(),
        facts: facts.into(),
        ..ProjectionEntry::default()
    }
}

fn position(seq: u64) -> ProjectionPosition {
    ProjectionPosition { seq, line_hash: format!("hash {seq}") }
}

/// A company that is run by policy P, and the projector that writes its database with one commit per week.
pub(super) struct Company {
    world: World,
    params: Arc<Params>,
    streams: Streams,
    pub(super) projector: Projector,
}

impl Company {
    fn open(location: DatabaseLocation) -> Company {
        Company::open_with(location, Params::bundled())
    }

    pub(super) fn open_with(location: DatabaseLocation, params: Params) -> Company {
        let params = Arc::new(params);
        let mut facts = Facts::default();
        let mut world = World::new(500, 1_000_000.0, &params, &mut facts);
        let (projector, found) =
            Projector::start(location, 1, params.clone(), |_| false).expect("a database");
        assert_eq!(found, None);
        projector.enqueue(entry(facts));
        projector.commit(position(0));
        apply_policy_p(&mut world);
        Company { world, params, streams: Streams::new(42), projector }
    }

    pub(super) fn simulate_weeks(&mut self, weeks: u32) -> QueryConnection {
        for _ in 0..weeks {
            for _ in 0..7 {
                let mut facts = Facts::default();
                step_day(&mut self.world, &self.params, &self.streams, &mut facts);
                self.projector.enqueue(entry(facts));
            }
            self.projector.commit(position(u64::from(self.world.day)));
        }
        self.projector.flush().expect("everything is written");
        self.projector.connection(Scope::Visible).expect("a connection")
    }
}

pub(super) fn query_rows(connection: &QueryConnection, sql: &str) -> QueryResult {
    connection.query(sql, LIMITS).unwrap_or_else(|error| panic!("{sql}: {} {}", error.code, error.message))
}

fn query_number(connection: &QueryConnection, sql: &str) -> f64 {
    match query_rows(connection, sql).rows.first().and_then(|row| row.first()) {
        Some(Cell::Integer(number)) => *number as f64,
        Some(Cell::Real(number)) => *number,
        other => panic!("{sql}: {other:?}"),
    }
}

pub(super) fn query_error(connection: &QueryConnection, sql: &str) -> QueryError {
    match connection.query(sql, LIMITS) {
        Ok(rows) => panic!("{sql} was answered: {rows:?}"),
        Err(error) => error,
    }
}

#[test]
fn database_matches_the_world() {
    let mut company = Company::open(DatabaseLocation::new_in_memory());
    let connection = company.simulate_weeks(16);
    let world = &company.world;
    assert!((query_number(&connection, "SELECT sum(amount) FROM ledger") - world.finance.cash).abs() < 1e-6);
    let active: u32 = world.customers.active_by_group().iter().sum();
    assert_eq!(
        query_number(&connection, "SELECT count(*) FROM subscriptions WHERE status = 'subscribed'"),
        f64::from(active)
    );
    let customers = f64::from(world.customers.next_customer - 1);
    assert_eq!(query_number(&connection, "SELECT count(*) FROM customers"), customers);
    assert_eq!(query_number(&connection, "SELECT count(*) FROM service_day"), 112.0);
    for (group, block) in world.customers.blocks() {
        for at in 0..block.len() {
            let sql = format!(
                "SELECT plan, listed_price, promotion, effective_price, start_day, first_billing_done, group_id \
                 FROM subscriptions JOIN customers USING (customer_id) WHERE customer_id = {}",
                block.customer[at]
            );
            let expected = [
                Cell::Text(block.plan[at].id().to_owned()),
                Cell::Real(block.listed_price[at]),
                Cell::Real(block.promotion[at]),
                Cell::Real(block.effective_price[at]),
                Cell::Integer(i64::from(block.start_day[at])),
                Cell::Integer(1),
                Cell::Text(group.id().to_owned()),
            ];
            assert_eq!(query_rows(&connection, &sql).rows, [expected]);
        }
    }
}

#[test]
fn issues_age_only_on_days_with_issue_work() {
    let params = Arc::new(Params::bundled());
    let (projector, _) =
        Projector::start(DatabaseLocation::new_in_memory(), 1, params, |_| false).expect("a database");
    for (day, opened, aged) in [(1, Some(1), false), (2, None, true), (3, Some(2), false), (4, None, true)] {
        let mut facts = Facts::default();
        facts.start_day(day);
        facts.issues_aged = aged;
        let group = Group::at(0).expect("S1");
        facts.issues_opened.extend(opened.map(|issue| IssueOpened { issue, customer: 7, group }));
        projector.enqueue(entry(facts));
    }
    projector.commit(position(4));
    projector.flush().expect("everything is written");
    let found = query_rows(
        &projector.connection(Scope::Visible).expect("a connection"),
        "SELECT issue_id, open_day, days_open FROM issues ORDER BY 1",
    );
    let expected = [[1, 1, 2], [2, 3, 1]].map(|row| row.map(Cell::Integer).to_vec());
    assert_eq!(found.rows, expected);
}

#[test]
fn subscription_within_one_commit_keeps_its_dates() {
    let params = Arc::new(Params::bundled());
    let (projector, _) =
        Projector::start(DatabaseLocation::new_in_memory(), 1, params, |_| false).expect("a database");
    let mut begins = Facts::default();
    begins.start_day(2);
    begins.openings.push(SubscriptionOpened {
        subscription: 1,
        customer: 7,
        plan: Some(Plan::B),
        status: SubscriptionStatus::Subscribed,
        listed_price: 20.0,
        promotion: 2.0,
        effective_price: 18.0,
        seats: 1,
    });
    let mut ends = Facts::default();
    ends.start_day(5);
    ends.endings.push(SubscriptionEnded {
        subscription: 1,
        customer: 7,
        group: Group::at(0).expect("S1"),
        seats: 1,
        day: 5,
        status: SubscriptionStatus::Cancelled,
        cause: EndCause::Involuntary,
    });
    projector.enqueue(entry(begins));
    projector.enqueue(entry(ends));
    projector.commit(position(5));
    projector.flush().expect("everything is written");
    let sql = "SELECT start_day, end_day, status, effective_price FROM subscriptions";
    let found = query_rows(&projector.connection(Scope::Visible).expect("a connection"), sql);
    let expected =
        [Cell::Integer(2), Cell::Integer(5), Cell::Text("cancelled".to_owned()), Cell::Real(18.0)].to_vec();
    assert_eq!(found.rows, [expected]);
}

#[test]
fn open_issues_agree_with_the_world() {
    let mut company = Company::open(DatabaseLocation::new_in_memory());
    let connection = company.simulate_weeks(12);
    let sql = "SELECT i.customer_id, i.days_open FROM issues i JOIN subscriptions s USING (customer_id) \
               WHERE i.status = 'open' AND s.status = 'subscribed' ORDER BY 1";
    let mut expected: Vec<Vec<Cell>> = Vec::new();
    for (_, block) in company.world.customers.blocks() {
        for at in (0..block.len()).filter(|at| block.open_issue_days[*at] > 0) {
            // On the opening day, the counter of the simulator is 1 and the age in the table is 0.
            let aged = i64::from(block.open_issue_days[at]) - 1;
            expected.push(vec![Cell::Integer(i64::from(block.customer[at])), Cell::Integer(aged)]);
        }
    }
    expected.sort_by_key(|row| match row[0] {
        Cell::Integer(customer) => customer,
        _ => 0,
    });
    let found = query_rows(&connection, sql);
    assert!(!expected.is_empty() && (found.rows == expected || found.truncated));
    let wrong =
        "SELECT count(*) FROM issues WHERE status = 'resolved' AND days_open <> resolved_day - open_day - 1";
    // Issues do not age on days without open issues of active customers; policy P has no such days after a month.
    assert_eq!(query_number(&connection, &format!("{wrong} AND open_day > 30")), 0.0);
}

#[test]
fn usage_older_than_a_month_is_deleted() {
    let mut company = Company::open(DatabaseLocation::new_in_memory());
    let connection = company.simulate_weeks(16);
    assert_eq!(query_number(&connection, "SELECT min(day) FROM daily_usage"), 80.0);
    assert_eq!(query_number(&connection, "SELECT max(day) FROM daily_usage"), 112.0);
    let total = query_number(&connection, "SELECT sum(usage_units) FROM daily_usage WHERE day = 100");
    assert_eq!(total, query_number(&connection, "SELECT total_usage_units FROM service_day WHERE day = 100"));
    let readings = query_rows(
        &connection,
        "SELECT day, pmi_trend, length(description) > 50 FROM macroeconomic_conditions ORDER BY 1",
    );
    assert_eq!(
        readings.rows.iter().map(|row| row[0].clone()).collect::<Vec<_>>(),
        [1, 31, 61].map(Cell::Integer)
    );
}

#[test]
fn ledger_day_lists_leads_payments_then_costs() {
    let mut company = Company::open(DatabaseLocation::new_in_memory());
    let connection = company.simulate_weeks(1);
    let first = query_rows(&connection, "SELECT id, category, amount, note FROM ledger WHERE day = 0");
    let funding = [
        Cell::Integer(1),
        Cell::Text("initial_funding".to_owned()),
        Cell::Real(1_000_000.0),
        Cell::Text("Initial seed funding".to_owned()),
    ];
    assert_eq!(first.rows, [funding]);
    let order = query_rows(
        &connection,
        "SELECT DISTINCT category FROM (SELECT category FROM ledger WHERE day = 3 ORDER BY id)",
    );
    let order: Vec<String> = order.rows.iter().map(|row| format!("{:?}", row[0])).collect();
    let expected = [
        "lead_acquisition_cost",
        "subscription_payment",
        "capacity",
        "compute",
        "operations",
        "development",
        "advertising",
    ];
    assert_eq!(order, expected.map(|category| format!("{:?}", Cell::Text(category.to_owned()))));
    assert_eq!(query_number(&connection, "SELECT count(*) FROM group_info_levels WHERE info_level = 1"), 6.0);
    assert_eq!(query_number(&connection, "SELECT count(*) FROM config_history"), 1.0);
}

#[test]
fn profiles_are_written_in_words() {
    let mut company = Company::open(DatabaseLocation::new_in_memory());
    let connection = company.simulate_weeks(6);
    let observer = query_rows(&connection, "SELECT * FROM customers WHERE customer_id = 1").rows.remove(0);
    assert_eq!(observer[1], Cell::Text("small".to_owned()));
    assert_eq!(observer.iter().filter(|cell| **cell == Cell::Null).count(), 12);
    let odd = "SELECT count(*) FROM customers WHERE customer_id > 1 AND (persona_description IS NULL \
               OR persona_industry IS NULL OR persona_role IS NULL OR persona_experience IS NULL \
               OR persona_work_style IS NULL OR persona_tech_savvy IS NULL OR acquisition_source IS NULL)";
    assert_eq!(query_number(&connection, odd), 0.0);
    let companies = "SELECT count(*), sum(company_culture = persona_work_style), \
                     sum(persona_experience = 'executive' AND email IS NOT NULL AND company_primary_concern IS NOT NULL \
                     AND persona_description LIKE '% seats, %') FROM customers WHERE customer_type = 'large'";
    let counts = query_rows(&connection, companies).rows.remove(0);
    assert!(counts[0] != Cell::Integer(0) && counts.iter().all(|count| *count == counts[0]), "{counts:?}");
}

#[test]
fn hidden_tables_cannot_be_queried() {
    let mut company = Company::open(DatabaseLocation::new_in_memory());
    let connection = company.simulate_weeks(2);
    for (sql, code) in [
        // The rejected statements are listed roughly from obvious to advanced attempts.
        ("", "sql_empty"),
        ("  ", "sql_empty"),
        ("SELECT 1\0; SELECT 2", "sql_error"),
        ("SELECT c_max AS x FROM customers", "sql_error"),
        ("SELECT * FROM social_media_posts WHERE sentiment = 'positive'", "sql_error"),
        ("SELECT * FROM _rng_states", "sql_hidden_table"),
        ("SELECT * FROM global_drift_state", "sql_hidden_table"),
        ("SELECT * FROM Customer_State", "sql_hidden_table"),
        ("SELECT * FROM customer_rows", "sql_hidden_table"),
        ("SELECT persona FROM customers", "sql_error"),
        ("SELECT aged FROM issue_clock", "sql_hidden_table"),
        ("SELECT * FROM words", "sql_hidden_table"),
        ("SELECT * FROM projection", "sql_hidden_table"),
        ("SELECT hex(packed) FROM usage_blocks", "sql_hidden_table"),
        ("WITH gone AS (SELECT 1) DELETE FROM ledger", "sql_write"),
        ("-- a comment\nDELETE FROM ledger", "sql_write"),
        ("/* x */ UPDATE service_day SET p95_ms = 0", "sql_write"),
        ("REPLACE INTO service_day VALUES (1, 2, 3, 4, 5, 6, 7)", "sql_write"),
        ("INSERT INTO notifications VALUES (1, 2, 'a', 'b')", "sql_write"),
        ("CREATE TABLE x (a)", "sql_write"),
        ("CREATE TEMP TABLE x AS SELECT 1", "sql_write"),
        ("CREATE TEMP VIEW x AS SELECT 1", "sql_write"),
        ("DROP TABLE service_day", "sql_write"),
        ("ALTER TABLE service_day RENAME TO x", "sql_write"),
        ("ATTACH 'file.db' AS other", "sql_write"),
        ("DETACH main", "sql_write"),
        ("BEGIN", "sql_write"),
        ("COMMIT", "sql_write"),
        ("SAVEPOINT a", "sql_write"),
        ("VACUUM INTO 'copy.db'", "sql_write"),
        ("REINDEX", "sql_write"),
        ("ANALYZE", "sql_write"),
        ("PRAGMA table_info(customers)", "sql_schema"),
        ("PRAGMA query_only = 0", "sql_schema"),
        ("SELECT * FROM sqlite_master", "sql_schema"),
        ("SELECT sql FROM sqlite_schema", "sql_schema"),
        ("SELECT * FROM main.sqlite_master", "sql_schema"),
        ("SELECT * FROM sqlite_temp_schema", "sql_schema"),
        ("SELECT * FROM pragma_table_info('customers')", "sql_schema"),
        ("SELECT * FROM pragma_database_list", "sql_schema"),
        ("EXPLAIN SELECT 1", "sql_schema"),
        ("EXPLAIN QUERY PLAN DELETE FROM customers", "sql_write"),
        ("EXPLAIN QUERY PLAN SELECT * FROM customer_rows", "sql_hidden_table"),
        ("SELECT * FROM temp.customers", "sql_error"),
        ("SELECT 1; SELECT 2", "sql_error"),
        ("SELECT 1; DELETE FROM ledger", "sql_error"),
        ("SELECT load_extension('x')", "sql_write"),
        ("SELECT zeroblob(100000000)", "sql_error"),
        ("SELECT * FROM nothing", "sql_error"),
        ("SELEC 1", "sql_error"),
        ("SELECT day FROM ledger JOIN service_day", "sql_error"),
    ] {
        let error = query_error(&connection, sql);
        assert_eq!(error.code, code, "{sql}: {}", error.message);
        for inside in ["customer_rows", "usage_blocks", "issue_clock", "no such"] {
            assert!(!error.message.contains(inside) || sql.contains(inside), "{sql}: {}", error.message);
        }
    }
    assert_eq!(query_number(&connection, "SELECT count(*) FROM ledger WHERE day = 0"), 1.0);
}

#[test]
fn query_plan_names_no_internal_table() {
    let mut company = Company::open(DatabaseLocation::new_in_memory());
    let connection = company.simulate_weeks(1);
    let plan = |sql: &str| -> Vec<String> {
        let all = query_rows(&connection, &format!("EXPLAIN QUERY PLAN {sql}"));
        assert_eq!(all.columns, ["id", "parent", "notused", "detail"]);
        all.rows.iter().map(|row| text_at(row, 3).to_owned()).collect()
    };
    assert_eq!(plan("SELECT * FROM customers"), ["SCAN customers"]);
    let lookup = "SELECT customer_id, (SELECT count(*) FROM enterprise_turns t WHERE t.customer_id = c.customer_id) FROM customers c";
    let expected =
        ["SCAN customers", "CORRELATED SCALAR SUBQUERY 1", "SEARCH t USING COVERING INDEX (customer_id=?)"];
    assert_eq!(plan(lookup), expected);
    assert_eq!(
        plan("SELECT * FROM main.service_day WHERE rowid = 5"),
        ["SEARCH service_day USING INTEGER PRIMARY KEY (rowid=?)"]
    );
    assert_eq!(plan("SELECT day FROM daily_usage u WHERE u.day = 3"), ["SCAN u"]);
    for table in super::tables(Interface::Release1) {
        let text = plan(&format!("SELECT DISTINCT * FROM {} ORDER BY 2 DESC", table.name)).join("\n");
        for inside in ["_rows", "words", "axis", "inner_", "clock", "_by_", "blocks", "autoindex"] {
            assert!(!text.contains(inside), "{text}");
        }
    }
}

#[test]
fn rowid_and_schema_names_are_accepted() {
    let mut company = Company::open(DatabaseLocation::new_in_memory());
    let connection = company.simulate_weeks(2);
    for table in super::tables(Interface::Release1) {
        let name = &table.name;
        for number in ["rowid", "oid", "_rowid_", "\"rowid\"", "[OID]", "`_RowId_`"] {
            let both =
                query_rows(&connection, &format!("SELECT {number}, t.{number}, t.* FROM {name} t LIMIT 0"));
            assert_eq!(both.columns.len(), 2 + table.columns.len());
        }
        let key = table.row_number_column().unwrap_or("rowid");
        let numbers =
            query_rows(&connection, &format!("SELECT rowid, {key} FROM main.{name} ORDER BY oid LIMIT 50"));
        assert_eq!(numbers.columns, [key, key]);
        assert!(numbers.rows.iter().all(|row| row[0] == row[1]));
    }
    for (sql, columns) in [
        (
            "SELECT main.ledger.rowid + 1, main.ledger.amount FROM main.ledger",
            "main.ledger.rowid + 1, amount",
        ),
        ("SELECT rowid AS n, rowid FROM customers ORDER BY n LIMIT 1", "n, customer_id"),
        ("WITH rowid AS (SELECT 1 AS oid) SELECT oid, rowid.oid FROM rowid", "oid, oid"),
        ("SELECT c._rowid_ FROM customers c JOIN subscriptions s ON s.rowid = c.rowid", "customer_id"),
        ("SELECT rowid FROM customers, (SELECT customer_id FROM subscriptions LIMIT 1)", "customer_id"),
        (
            "SELECT max(rowid) FROM issues WHERE rowid < (SELECT rowid FROM ledger ORDER BY rowid DESC)",
            "max(rowid)",
        ),
    ] {
        assert_eq!(query_rows(&connection, sql).columns.join(", "), columns, "{sql}");
    }
    let error = query_error(&connection, "SELECT rowid FROM ledger JOIN issues");
    assert_eq!(error.code, "sql_error");
    assert!(error.message.contains("ambiguous"), "{}", error.message);
    let error = query_error(&connection, "SELECT 1 FROM temp.ledger");
    assert!(
        error.message.starts_with("there is no table temp.ledger; write ledger alone;"),
        "{}",
        error.message
    );
}

#[test]
fn ordinary_queries_succeed() {
    let mut company = Company::open(DatabaseLocation::new_in_memory());
    let connection = company.simulate_weeks(2);
    for sql in [
        "WITH RECURSIVE n(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM n WHERE x < 10) SELECT sum(x) FROM n",
        "SELECT day, amount, sum(amount) OVER (ORDER BY id) FROM ledger LIMIT 3",
        "SELECT 'events', 'pragmatic', 'sqlite_master'",
        "SELECT count(*) FROM customers, service_day",
        "SELECT group_id, count(*) FROM customers GROUP BY 1 HAVING count(*) > 0;",
        "SELECT json_extract('{\"a\": 1}', '$.a'), date('now'), printf('%d', 3)",
        "SELECT * FROM (SELECT customer_id FROM daily_usage WHERE day = 9) JOIN subscriptions USING (customer_id)",
        "VALUES (1, 2), (3, 4)",
        "SELECT max(length(name)) FROM json_each('[1]'), (SELECT 'a' AS name)",
        "-- just looking\nSELECT 1",
    ] {
        query_rows(&connection, sql);
    }
    for table in super::tables(Interface::Release1) {
        let all = query_rows(&connection, &format!("SELECT * FROM {}", table.name));
        let columns: Vec<&str> = table.columns.iter().map(|column| column.name.as_str()).collect();
        assert_eq!(all.columns, columns, "{}", table.name);
    }
}

#[test]
fn query_limits_are_enforced() {
    let mut company = Company::open(DatabaseLocation::new_in_memory());
    let connection = company.simulate_weeks(1);
    let counting = |most: u32| {
        format!(
            "WITH RECURSIVE n(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM n WHERE x < {most}) SELECT x FROM n"
        )
    };
    let full = query_rows(&connection, &counting(5000));
    assert_eq!((full.rows.len(), full.truncated), (5000, false));
    let cut = query_rows(&connection, &format!("{} LIMIT 5500", counting(6000)));
    assert_eq!((cut.rows.len(), cut.truncated), (5000, true));
    assert!(cut.warning.is_some());
    let endless = "WITH RECURSIVE n(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM n) SELECT count(*) FROM n";
    let error = connection
        .query(endless, QueryLimits { rows: 10, time: Duration::from_millis(50), steps: None })
        .expect_err("too slow");
    assert_eq!(error.code, "sql_timeout");
    let interrupt = connection.interrupt();
    let ticket = interrupt.issue_ticket();
    let stopper = std::thread::spawn(move || {
        std::thread::sleep(Duration::from_millis(50));
        interrupt.stop();
    });
    let error = connection.query_with_ticket(ticket, endless, LIMITS).expect_err("cancelled");
    assert_eq!((error.code, error.message.as_str()), ("sql_cancelled", "the query was cancelled"));
    stopper.join().expect("the stopper ends");
    query_rows(&connection, "SELECT 1");
}

#[test]
fn stop_cancels_pending_queries_and_no_later_ones() {
    let mut company = Company::open(DatabaseLocation::new_in_memory());
    let connection = company.simulate_weeks(1);
    let interrupt = connection.interrupt();
    let endless = "WITH RECURSIVE n(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM n) SELECT count(*) FROM n";
    let ticket = interrupt.issue_ticket();
    interrupt.stop();
    for sql in [endless, "SELECT 1"] {
        let error = connection.query_with_ticket(ticket, sql, LIMITS).expect_err("stopped before it began");
        assert_eq!((error.code, error.message.as_str()), ("sql_cancelled", "the query was cancelled"));
    }
    query_rows(&connection, "SELECT 1");
}

#[test]
fn query_stopped_during_table_copy_is_cancelled() {
    let mut company = Company::open(DatabaseLocation::new_in_memory());
    let connection = company.simulate_weeks(6);
    let sql = "SELECT count(*) FROM issues RIGHT JOIN customers USING (customer_id)";
    let all = query_number(&connection, sql);
    let mut stopped = 0;
    for steps in (250..60_000).step_by(1250) {
        match connection.query(sql, QueryLimits { steps: Some(steps), ..LIMITS }) {
            Ok(rows) => assert_eq!(super::number_at(&rows.rows[0], 0), all, "after {steps} steps"),
            Err(error) => {
                assert_eq!(error.code, "sql_timeout", "after {steps} steps: {}", error.message);
                stopped += 1;
            }
        }
        assert_eq!(query_number(&connection, "SELECT 1"), 1.0, "the connection still answers");
        assert!(connection.query("DELETE FROM ledger", LIMITS).is_err_and(|error| error.code == "sql_write"));
    }
    assert!(stopped > 0);
}

#[test]
fn empty_results_have_hints() {
    let mut company = Company::open(DatabaseLocation::new_in_memory());
    let connection = company.simulate_weeks(1);
    let empty = query_rows(&connection, "SELECT * FROM subscriptions WHERE status = 'active'");
    assert!(empty.hint.is_some_and(|hint| hint.contains("'subscribed'")));
    assert_eq!(
        query_rows(&connection, "SELECT count(*) FROM subscriptions WHERE status = 'active'").hint,
        None
    );
    let in_double_quotes = query_rows(&connection, "SELECT * FROM subscriptions WHERE status = \"active\"");
    assert!(in_double_quotes.hint.is_some_and(|hint| hint.contains("'subscribed'")));
}

#[test]
fn mathematical_functions_are_registered() {
    let connection = Company::open(DatabaseLocation::new_in_memory()).simulate_weeks(0);
    let sql = "SELECT ceil(1.2), ceiling(1.2), floor(-1.2), sqrt(9), pow(2, 3), power(2, 3), ln(1), log(100), log(2, 8), \
               log10(1000), log2(8), exp(0), trunc(-1.7), mod(7, 4), pi(), sin(0), cos(0), tan(0), asin(0), acos(1), \
               atan(0), atan2(0, 1), sinh(0), cosh(0), tanh(0), asinh(0), acosh(1), atanh(0), degrees(0), radians(0), \
               sign(-3), sqrt(-1), floor('x')";
    let row = query_rows(&connection, sql).rows.remove(0);
    let numbers: Vec<f64> = (0..row.len()).map(|at| number_at(&row, at)).collect();
    let expected = [
        2.0,
        2.0,
        -2.0,
        3.0,
        8.0,
        8.0,
        0.0,
        2.0,
        3.0,
        3.0,
        3.0,
        1.0,
        -1.0,
        3.0,
        std::f64::consts::PI,
        0.0,
        1.0,
        0.0,
        0.0,
        0.0,
        0.0,
        0.0,
        0.0,
        1.0,
        0.0,
        0.0,
        0.0,
        0.0,
        0.0,
        0.0,
        -1.0,
        0.0,
        0.0,
    ];
    assert_eq!(numbers, expected);
    assert_eq!(row[31..], [Cell::Null, Cell::Null]);
}

#[test]
fn numbers_and_texts_compare_as_in_ordinary_tables() {
    let mut company = Company::open(DatabaseLocation::new_in_memory());
    let connection = company.simulate_weeks(10);
    for (text, number) in [
        ("subscriptions WHERE effective_price = '9'", "subscriptions WHERE effective_price = 9"),
        ("subscriptions WHERE contract_months = '1'", "subscriptions"),
        ("subscriptions WHERE '9.0' = effective_price", "subscriptions WHERE effective_price = 9"),
        (
            "subscriptions WHERE effective_price IN ('9', '18')",
            "subscriptions WHERE effective_price IN (9, 18)",
        ),
        ("issues WHERE days_open >= '1'", "issues WHERE days_open >= 1"),
        ("customers WHERE customer_type > 5", "customers"),
    ] {
        let (left, right) = (
            query_number(&connection, &format!("SELECT count(*) FROM {text}")),
            query_number(&connection, &format!("SELECT count(*) FROM {number}")),
        );
        assert!(left == right && left > 0.0, "{text}: {left}, {right}");
    }
    assert_eq!(
        query_number(
            &connection,
            "SELECT count(*) FROM subscriptions WHERE pending_price IS NULL AND pending_plan IS NULL"
        ),
        query_number(&connection, "SELECT count(*) FROM subscriptions")
    );
}

#[test]
fn database_with_another_layout_is_rebuilt() {
    let folder = tempfile::tempdir().expect("a folder");
    let location = DatabaseLocation::File(folder.path().join("world.db"));
    drop(Company::open(location.clone()).simulate_weeks(1));
    assert!(super::has_current_layout(&location));
    let file = rusqlite::Connection::open(folder.path().join("world.db")).expect("a file");
    file.execute_batch("DROP INDEX enterprise_turns_by_thread; PRAGMA user_version = 0")
        .expect("an older layout");
    drop(file);
    assert!(!super::has_current_layout(&location));
    assert!(super::query_connection(&location, Interface::Release1, Scope::Visible).is_err());
    let (projector, found) =
        Projector::start(location.clone(), 1, Arc::new(Params::bundled()), |_| true).expect("it opens");
    assert_eq!(found, None);
    drop(projector);
    assert!(super::has_current_layout(&location));
}

#[test]
fn file_blocks_load_on_first_use_and_detect_damage() {
    let folder = tempfile::tempdir().expect("a folder");
    let location = DatabaseLocation::File(folder.path().join("world.db"));
    let mut company = Company::open(location.clone());
    let usage = "SELECT count(*), sum(usage_units) FROM daily_usage";
    let ledger = "SELECT count(*), sum(amount) FROM ledger";
    let connection = company.simulate_weeks(6);
    let before = [usage, ledger].map(|sql| query_rows(&connection, sql));
    drop((connection, company));
    let file = rusqlite::Connection::open(folder.path().join("world.db")).expect("a file");
    let (reader, _) =
        super::query_connection(&location, Interface::Release1, Scope::Visible).expect("a connection");
    assert_eq!([usage, ledger].map(|sql| query_rows(&reader, sql)), before);
    let damaged = file.execute("UPDATE usage_blocks SET packed = x'ff' WHERE day = 30", []);
    assert_eq!(damaged, Ok(1));
    assert_eq!(query_rows(&reader, ledger), before[1], "other tables still answer");
    assert!(!reader.has_found_damage());
    let refused = reader.query(usage, LIMITS).expect_err("the file has changed since it was read");
    assert!(refused.message.starts_with("world.db is damaged") && reader.has_found_damage(), "{refused:?}");
    for sql in
        ["SELECT 1 WHERE EXISTS (SELECT 1 FROM daily_usage)", "SELECT (SELECT count(*) FROM daily_usage)"]
    {
        assert!(reader.query(sql, LIMITS).is_err(), "{sql}");
    }
}

#[test]
fn database_is_continued_or_rebuilt() {
    let folder = tempfile::tempdir().expect("a folder");
    let location = DatabaseLocation::File(folder.path().join("world.db"));
    let mut company = Company::open(location.clone());
    let usage = "SELECT count(*), sum(usage_units), sum(day * customer_id) FROM daily_usage";
    let before = query_rows(&company.simulate_weeks(6), usage);
    drop(company);
    let params = Arc::new(Params::bundled());
    let known = |found: &ProjectionPosition| *found == position(42);
    let (projector, found) = Projector::start(location.clone(), 1, params.clone(), known).expect("it opens");
    assert_eq!(found, Some(position(42)));
    assert_eq!(query_rows(&projector.connection(Scope::Visible).expect("a connection"), usage), before);
    drop(projector);
    let (projector, found) =
        Projector::start(location.clone(), 1, params.clone(), |_| false).expect("it opens");
    assert_eq!(found, None);
    assert_eq!(
        query_number(
            &projector.connection(Scope::Visible).expect("a connection"),
            "SELECT count(*) FROM ledger"
        ),
        0.0
    );
    drop(projector);
    std::fs::write(folder.path().join("world.db"), b"not a database at all, but long enough to look")
        .expect("a file");
    let (projector, found) = Projector::start(location, 1, params, |_| true).expect("it is rebuilt");
    assert_eq!(found, None);
    drop(projector);
}

#[test]
fn queries_during_a_week_see_the_state_before_it() {
    let folder = tempfile::tempdir().expect("a folder");
    for location in
        [DatabaseLocation::new_in_memory(), DatabaseLocation::File(folder.path().join("world.db"))]
    {
        let mut company = Company::open(location);
        let connection = company.simulate_weeks(1);
        let mut facts = Facts::default();
        step_day(&mut company.world, &company.params, &company.streams, &mut facts);
        company.projector.enqueue(entry(facts));
        let state = "SELECT (SELECT max(day) FROM service_day), (SELECT max(day) FROM daily_usage)";
        assert_eq!(query_rows(&connection, state).rows, [[Cell::Integer(7), Cell::Integer(7)]]);
        company.projector.commit(position(8));
        company.projector.flush().expect("written");
        assert_eq!(query_rows(&connection, state).rows, [[Cell::Integer(8), Cell::Integer(8)]]);
    }
}

#[test]
fn readers_and_writer_do_not_block_each_other() {
    let mut company = Company::open(DatabaseLocation::new_in_memory());
    let connection = company.projector.connection(Scope::Visible).expect("a connection");
    let over = Arc::new(AtomicBool::new(false));
    let is_over = over.clone();
    // The reader queries without a pause, so that some queries run during transactions.
    let reader = std::thread::spawn(move || {
        while !is_over.load(Ordering::Relaxed) {
            let answer = connection.query("SELECT count(*) FROM ledger", LIMITS);
            assert!(answer.is_ok(), "{answer:?}");
        }
    });
    company.simulate_weeks(30);
    over.store(true, Ordering::Relaxed);
    reader.join().expect("every question is answered");
}

#[test]
fn missing_or_mistyped_cells_read_as_defaults() {
    let row = [Cell::Null, Cell::Integer(2), Cell::Text("x".to_owned())];
    assert_eq!([0, 1, 2, 3].map(|at| number_at(&row, at)), [0.0, 2.0, 0.0, 0.0]);
    assert_eq!([0, 2, 3].map(|at| text_at(&row, at)), ["", "x", ""]);
}
