//! Results, rejections and limits of the database connection of the x-ray.

use novamind::database::Cell;
use novamind::insight::Inspect;
use novamind::record::mode::Mode;

use super::{integer, play_until_several_groups_subscribe, query_hidden, run_in};
use crate::support::company::{advance_week, advance_weeks};

#[test]
fn xray_connection_is_read_only_and_discloses_nothing_else() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut session = run_in(folder.path(), Mode::Debug, 28);
    play_until_several_groups_subscribe(&mut session);
    advance_week(&mut session);
    let count = query_hidden(&mut session, "SELECT count(*) FROM hidden.groups");
    for (code, sql) in [
        ("sql_write", "ATTACH ':memory:' AS other"),
        ("sql_write", "ATTACH 'file:hidden?mode=memory' AS again"),
        ("sql_write", "DETACH hidden"),
        ("sql_write", "DELETE FROM hidden.groups"),
        ("sql_write", "UPDATE hidden.groups SET reputation = 1"),
        ("sql_write", "INSERT INTO hidden.pmi (day, pmi) VALUES (1000, 50)"),
        ("sql_write", "DROP TABLE hidden.groups"),
        ("sql_write", "CREATE TABLE hidden.more (a)"),
        ("sql_write", "CREATE TEMP TABLE groups (a)"),
        ("sql_write", "CREATE INDEX hidden.own ON groups (reputation)"),
        ("sql_schema", "SELECT * FROM hidden.sqlite_master"),
        ("sql_schema", "SELECT count(*) FROM hidden.sqlite_schema"),
        ("sql_schema", "PRAGMA hidden.table_info(groups)"),
        ("sql_schema", "PRAGMA query_only = 0"),
        ("sql_schema", "SELECT * FROM pragma_table_info('groups', 'hidden')"),
        ("sql_schema", "EXPLAIN SELECT * FROM hidden.groups"),
        ("sql_hidden_table", "SELECT * FROM customer_rows"),
        ("sql_hidden_table", "SELECT * FROM main.projection"),
        ("sql_hidden_table", "SELECT * FROM customer_state"),
        ("sql_hidden_table", "SELECT count(*) FROM hidden.customer_rows"),
        ("sql_error", "SELECT * FROM hidden.nothing"),
        ("sql_error", "SELECT * FROM main.groups"),
        ("sql_error", "SELECT * FROM temp.groups"),
        ("sql_error", "SELECT * FROM hidden.ledger"),
        ("sql_error", "SELECT 1; DELETE FROM hidden.groups"),
        ("sql_write", "SELECT load_extension('x') FROM hidden.groups"),
        ("sql_empty", "-- nothing"),
    ] {
        let refused = session.inspect().query_hidden_tables(sql, None).expect_err(sql);
        assert_eq!(refused.code, code, "{sql}: {refused}");
    }
    assert_eq!(query_hidden(&mut session, "SELECT count(*) FROM hidden.groups"), count);
    for (sql, answer) in [
        ("SELECT count(DISTINCT group_id) FROM groups", 26),
        ("SELECT count(*) FROM HIDDEN.\"Groups\" WHERE [hidden].[groups].rowid = 1", 1),
        ("WITH groups AS (SELECT 1) SELECT count(*) FROM groups", 1),
        (
            "SELECT count(*) > 0 FROM group_info_levels LEFT JOIN hidden.groups USING (group_id) WHERE day = 7",
            1,
        ),
        (
            "SELECT count(*) FROM hidden.groups RIGHT JOIN group_info_levels USING (group_id) WHERE day = 7",
            26,
        ),
        (
            "SELECT count(*) - count(DISTINCT customer_id) FROM hidden.customers JOIN customers USING (customer_id)",
            0,
        ),
    ] {
        assert_eq!(query_hidden(&mut session, sql), [[integer(answer)]], "{sql}");
    }
    let plan = query_hidden(&mut session, "EXPLAIN QUERY PLAN SELECT * FROM hidden.groups WHERE day = 3");
    assert!(
        matches!(&plan[0][3], Cell::Text(text) if text == "SEARCH hidden.groups USING INDEX (day=?)"),
        "{plan:?}"
    );
    let many = "WITH RECURSIVE n(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM n WHERE x < 9000) \
                SELECT x FROM n, hidden.pmi WHERE day = 1";
    let rows = session.inspect().query_hidden_tables(many, None).expect("rows");
    assert!(rows.truncated && rows.rows.len() == 5000, "the limits are those of any query");
}

#[test]
fn stopped_statement_keeps_hidden_tables() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut session = run_in(folder.path(), Mode::Debug, 60);
    play_until_several_groups_subscribe(&mut session);
    advance_weeks(&mut session, 2);
    let interrupt = session.inspect().hidden_query_interrupt().expect("a debug run");
    let ticket = interrupt.issue_ticket();
    interrupt.stop();
    let refused = session
        .inspect()
        .query_hidden_tables_with_ticket(ticket, "SELECT * FROM hidden.groups", None)
        .expect_err("stopped");
    assert_eq!((refused.code, refused.message.as_str()), ("sql_cancelled", "the query was cancelled"));
    assert_eq!(query_hidden(&mut session, "SELECT count(*) FROM hidden.groups"), [[integer(14 * 26)]]);
}

#[test]
fn hidden_tables_do_not_block_the_run() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut session = run_in(folder.path(), Mode::Debug, 60);
    play_until_several_groups_subscribe(&mut session);
    advance_week(&mut session);
    let mut connection = session.database().open_connection().expect("a connection");
    let limits = session.company().query_limits();
    for week_number in 2..=4 {
        session.wait_for_database().expect("written");
        let asking = std::thread::scope(|scope| {
            let other = scope.spawn(move || {
                let answer = connection.query("SELECT max(day) FROM ledger", limits);
                (connection, answer)
            });
            let result = session
                .inspect()
                .query_hidden_tables("SELECT count(*) FROM hidden.customers, hidden.pmi", None);
            assert!(result.is_ok(), "{result:?}");
            other.join().expect("a thread")
        });
        connection = asking.0;
        assert_eq!(asking.1.expect("rows").rows, [[integer((week_number - 1) * 7)]]);
        advance_week(&mut session);
        session.wait_for_database().expect("the week is written");
        let sql = "SELECT (SELECT max(day) FROM ledger), (SELECT max(day) FROM hidden.groups)";
        assert_eq!(query_hidden(&mut session, sql), [[integer(week_number * 7), integer(week_number * 7)]]);
    }
}
