//! Tests of the tables and statements of release 2.

use super::tests::{Company, query_error, query_rows};
use super::{DatabaseLocation, QueryConnection, Scope, tables};
use novamind_world::params::{Interface, Params};

/// Returns a company that was simulated for three weeks under an interface, and a connection to its database.
fn company(interface: Interface) -> (Company, QueryConnection) {
    let mut params = Params::bundled();
    params.fidelity.interface = interface;
    let mut company = Company::open_with(DatabaseLocation::new_in_memory(), params);
    let connection = company.simulate_weeks(3);
    (company, connection)
}

/// The columns that release 2 publishes, in the order of `SELECT *`.
const PUBLISHED: [(&str, &str); 19] = [
    (
        "customers",
        "customer_id customer_type created_day persona_industry persona_role persona_experience \
         persona_work_style persona_tech_savvy company_size_descriptor company_culture \
         company_decision_style company_primary_concern persona_description email contract_start_day \
         acquisition_source group_id",
    ),
    (
        "subscriptions",
        "subscription_id customer_id plan listed_price promotion effective_price start_day end_day status \
         billing_day_mod30 seat_count pending_plan pending_price contract_months contract_end_day",
    ),
    ("daily_usage", "day customer_id usage_units"),
    ("ledger", "id day category amount note"),
    ("service_day", "day total_usage_units p95_ms error_rate downtime_minutes capacity_tier capacity_units"),
    (
        "config_history",
        "day price_A price_B price_C tier_A tier_B tier_C spend_advertising spend_operations \
         spend_development capacity_tier ad_spend_social_media ad_spend_search_ads ad_spend_linkedin \
         ad_spend_content_marketing ad_spend_referral_program quota_A quota_B quota_C",
    ),
    ("social_media_posts", "post_id day reply_to_agent_post_id content"),
    ("agent_social_media_posts", "agent_post_id day content reply_to_post_id views comment_post_ids"),
    (
        "predictions",
        "submit_day horizon_days metric predicted_value predicted_lower predicted_upper submitted_at",
    ),
    (
        "enterprise_turns",
        "message_id thread_id customer_id thread_type turn_number sender message_text offer_json day email \
         seat_count closed close_reason",
    ),
    ("notifications", "notification_id day type message"),
    (
        "research_projects",
        "project_id tier status started_day expected_completion_day expected_quality_boost \
         quality_boost_applied",
    ),
    ("macroeconomic_conditions", "day pmi_value pmi_trend pmi_change cycle_phase description"),
    ("ad_channel_leads", "id day channel_id group_id leads_generated spend"),
    ("group_info_levels", "group_id info_level is_discoverable discovered_day last_research_day"),
    ("segment_discovery", "id day cost success discovered_group_id"),
    ("issues", "issue_id customer_id group_id open_day days_open status resolved_day resolution_type"),
    ("ads_revenue", "day customer_id group_id ads_strength revenue"),
    ("config_overrides", "id day tool_name setting_type settings_json"),
];

#[test]
fn release_2_publishes_exactly_its_columns() {
    let (_company, connection) = company(Interface::Release2);
    assert_eq!(tables(Interface::Release2).len(), PUBLISHED.len());
    for (name, columns) in PUBLISHED {
        let columns: Vec<&str> = columns.split_whitespace().collect();
        for table in [name.to_owned(), format!("temp.{name}"), format!("TEMP . \"{name}\"")] {
            let result = query_rows(&connection, &format!("SELECT * FROM {table}"));
            assert_eq!(result.columns, columns, "{table}");
            let count = query_rows(&connection, &format!("SELECT min(count(*), 5000) FROM {table}"));
            assert_eq!(count.rows[0][0], super::Cell::Integer(result.rows.len() as i64), "{table}");
        }
        let described = super::table(Interface::Release2, name).expect(name);
        assert_eq!(described.column_names(), columns);
    }
}

#[test]
fn columns_of_release_2_have_the_values_of_release_1() {
    let (_one, of_release_1) = company(Interface::Release1);
    let (_two, of_release_2) = company(Interface::Release2);
    for (name, columns) in PUBLISHED {
        let columns = columns.split_whitespace().collect::<Vec<_>>().join(", ");
        let sql = format!("SELECT {columns} FROM {name} ORDER BY 1, 2");
        let expected = query_rows(&of_release_1, &sql);
        assert_eq!(query_rows(&of_release_2, &sql), expected, "{name}");
        assert_eq!(query_rows(&of_release_2, &format!("SELECT * FROM {name} ORDER BY 1, 2")), expected);
    }
    let posts =
        query_rows(&of_release_2, "SELECT count(*) FROM social_media_posts WHERE length(content) > 9");
    assert_ne!(posts.rows[0][0], super::Cell::Integer(0));
}

#[test]
fn release_2_allows_the_statements_of_its_boundary() {
    let (_company, connection) = company(Interface::Release2);
    for sql in [
        "SELECT customer_id, GROUP_ID FROM main.customers ORDER BY created_day LIMIT 3",
        "SELECT Price_A, TIER_b, quota_c FROM config_history",
        "SELECT count(*) FROM main.customers",
        "SELECT count(*) FROM temp.customers",
        "SELECT * FROM main.ledger LIMIT 2",
        "SELECT c.customer_id, s.seat_count FROM customers c JOIN subscriptions s USING (customer_id) LIMIT 3",
        "SELECT t.seat_count, c.group_id FROM enterprise_turns t JOIN customers c USING (customer_id) LIMIT 3",
        "SELECT 'x' AS c_max, day AS source_group_id FROM ledger ORDER BY c_max LIMIT 1",
        "SELECT 'sqlite_master', 'events'",
        "WITH RECURSIVE n(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM n WHERE x < 5) SELECT sum(x) FROM n",
        "VALUES (1, 2), (3, 4)",
        "SELECT day, sum(amount) OVER (ORDER BY day, id) FROM ledger LIMIT 3",
        "SELECT json_extract(settings_json, '$.targeted_spend') FROM config_overrides",
        "EXPLAIN QUERY PLAN SELECT * FROM customers",
        "SELECT * FROM temp.social_media_posts RIGHT JOIN main.service_day USING (day)",
    ] {
        query_rows(&connection, sql);
    }
    let program = query_rows(&connection, "EXPLAIN SELECT plan FROM subscriptions");
    assert_eq!(program.columns[..2], ["addr", "opcode"]);
    let text = format!("{:?}", program.rows);
    assert!(text.contains("Column") && !text.contains("subscription_rows") && !text.contains("inner_"));
}

#[test]
fn release_2_rejects_what_its_boundary_rejects() {
    let (_company, connection) = company(Interface::Release2);
    for (sql, code) in [
        ("DELETE FROM ledger", "sql_write"),
        ("REPLACE INTO ledger VALUES (1, 2, 'x', 3, '')", "sql_write"),
        ("EXPLAIN DELETE FROM ledger", "sql_write"),
        ("BEGIN", "sql_write"),
        ("ATTACH ':memory:' AS x", "sql_write"),
        ("PRAGMA table_info(customers)", "sql_schema"),
        ("SELECT * FROM pragma_table_info('customers')", "sql_schema"),
        ("SELECT * FROM sqlite_master", "sql_schema"),
        ("SELECT load_extension('x')", "sql_write"),
        ("SELECT value FROM json_each('[1, 2]')", "sql_hidden_table"),
        ("SELECT c.plan, j.key FROM subscriptions c, json_tree('{}') j", "sql_hidden_table"),
        ("SELECT rowid FROM ledger", "sql_error"),
        ("SELECT customers.oid FROM main.customers", "sql_error"),
        ("SELECT * FROM main.customers", "sql_hidden_table"),
        ("SELECT p.* FROM main.social_media_posts p", "sql_hidden_table"),
        ("SELECT * FROM main.\"subscriptions\"", "sql_hidden_table"),
        ("SELECT first_billing_done FROM subscriptions", "sql_error"),
        ("SELECT 1 FROM customers WHERE c_max > 0", "sql_error"),
        ("SELECT day FROM social_media_posts ORDER BY source_group_id", "sql_error"),
        ("SELECT max(day) FROM agent_social_media_posts HAVING max(views_by_group) > 0", "sql_error"),
        ("WITH x AS (SELECT effect_by_group FROM agent_social_media_posts) SELECT * FROM x", "sql_error"),
        ("SELECT hidden_columns_of_customers FROM main.customers", "sql_hidden_table"),
        ("SELECT * FROM group_insight_snapshots", "sql_hidden_table"),
        ("SELECT * FROM _rng_states", "sql_hidden_table"),
        ("SELECT 1; SELECT 2", "sql_error"),
    ] {
        let error = query_error(&connection, sql);
        assert_eq!(error.code, code, "{sql}: {}", error.message);
        let is_named = |name: &str| !sql.contains(name) && error.message.contains(name);
        assert!(!is_named("first_billing_done") && !is_named("hidden_columns_of_"), "{}", error.message);
    }
}

#[test]
fn release_1_keeps_its_statements() {
    let (_company, connection) = company(Interface::Release1);
    for sql in [
        "SELECT rowid, first_billing_done FROM subscriptions LIMIT 1",
        "SELECT * FROM main.customers LIMIT 1",
        "SELECT value FROM json_each('[1, 2]')",
        "SELECT s.seat_count FROM customers c JOIN subscriptions s USING (customer_id) LIMIT 1",
    ] {
        query_rows(&connection, sql);
    }
    for (sql, code) in [("EXPLAIN SELECT 1", "sql_schema"), ("SELECT * FROM temp.customers", "sql_error")] {
        assert_eq!(query_error(&connection, sql).code, code, "{sql}");
    }
    let posts = query_rows(&connection, "SELECT * FROM social_media_posts LIMIT 1");
    assert_eq!(posts.columns, ["post_id", "day", "content", "reply_to_agent_post_id"]);
}

#[test]
fn exported_file_has_the_columns_of_release_2() {
    let (company, connection) = company(Interface::Release2);
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("world.db");
    company.projector.export_sqlite(&file).expect("a file");
    let copy = rusqlite::Connection::open(&file).expect("a database");
    for (name, columns) in PUBLISHED {
        let statement = copy.prepare(&format!("SELECT * FROM {name}")).expect(name);
        assert_eq!(
            statement.column_names().collect::<Vec<_>>(),
            columns.split_whitespace().collect::<Vec<_>>()
        );
        drop(statement);
        let count = format!("SELECT count(*) FROM {name}");
        let copied: i64 = copy.query_row(&count, [], |row| row.get(0)).expect(name);
        assert_eq!(query_rows(&connection, &count).rows[0][0], super::Cell::Integer(copied), "{name}");
    }
}

#[test]
fn xray_of_release_2_has_hidden_tables() {
    let (company, _) = company(Interface::Release2);
    let connection = company.projector.connection(Scope::Hidden).expect("a connection");
    query_rows(&connection, "SELECT count(*) FROM hidden.groups g JOIN customers USING (group_id)");
    assert_eq!(query_error(&connection, "SELECT rowid FROM customers").code, "sql_error");
}
