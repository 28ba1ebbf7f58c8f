//! Hidden tables: permissions, recorded lines, and connections without these tables.

use std::fs;

use novamind::database::hidden_tables;
use novamind::insight::Inspect;
use novamind::record::mode::Mode;
use novamind::record::trajectory::record::Activity;
use novamind::record::trajectory::{Record, Trajectory};
use novamind::session::{Access, Session, read_afterwards, verify};

use super::{integer, play_until_several_groups_subscribe, query_hidden, run_in};
use crate::support::company::{advance_week, advance_weeks};

fn inspections(lines: &Trajectory) -> Vec<(String, String, u32)> {
    let look = |record: &Record| match record {
        Record::Activity(Activity::Inspection(inspection)) => {
            Some((inspection.what.clone(), inspection.which.clone(), inspection.shown_day))
        }
        _ => None,
    };
    lines.lines.iter().filter_map(|line| look(&line.record)).collect()
}

#[test]
fn hidden_queries_are_recorded_without_changing_the_state() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut asked = run_in(folder.path(), Mode::Debug, 60);
    let mut alone = run_in(folder.path(), Mode::Debug, 60);
    for session in [&mut asked, &mut alone] {
        play_until_several_groups_subscribe(session);
        advance_weeks(session, 2);
    }
    let place = asked.folder().expect("a folder").to_owned();
    let world = || fs::read(place.join("world.db")).expect("a database");
    asked.wait_for_database().expect("written");
    let before = world();
    let statements: Vec<String> =
        hidden_tables().iter().map(|table| format!("SELECT count(*) FROM {}", table.name)).collect();
    for sql in &statements {
        query_hidden(&mut asked, sql);
    }
    let refused = asked
        .inspect()
        .query_hidden_tables("SELECT c_mx FROM hidden.customers", Some(3))
        .expect_err("no column");
    assert!(refused.message.contains("did you mean c_max"), "{refused}");
    let refused = asked.inspect().query_hidden_tables("SELECT 1", Some(15)).expect_err("no day");
    assert_eq!(refused.to_string(), "day_unknown (day): there is no day 15; choose a day from 1 to 14");
    assert!(world() == before, "no hidden table is in the file");
    for session in [&mut asked, &mut alone] {
        advance_week(session);
    }
    assert_eq!(asked.state_hash(), alone.state_hash());
    drop(asked);
    let trajectory = Trajectory::read(&place.join("trajectory.jsonl")).expect("lines");
    let mut expected: Vec<(String, String, u32)> =
        statements.into_iter().map(|sql| ("sql".to_owned(), sql, 14)).collect();
    expected.push(("sql".to_owned(), "SELECT c_mx FROM hidden.customers".to_owned(), 3));
    assert_eq!(inspections(&trajectory), expected);
    assert_eq!(verify(&place).expect("it verifies").day, 21);
    // After the run is reopened, the hidden tables exist again.
    let mut again = Session::open(&place, Access::Write, true).expect("it opens");
    assert_eq!(query_hidden(&mut again, "SELECT max(day) FROM hidden.groups"), [[integer(21)]]);
}

#[test]
fn unfinished_runs_reject_hidden_queries_uniformly() {
    let folder = tempfile::tempdir().expect("a folder");
    for mode in [Mode::Baseline, Mode::Sandbox, Mode::Lesson] {
        let mut session = run_in(folder.path(), mode, 28);
        play_until_several_groups_subscribe(&mut session);
        advance_week(&mut session);
        let place = session.folder().expect("a folder").to_owned();
        let lines = || Trajectory::read(&place.join("trajectory.jsonl")).expect("lines").lines.len();
        let before = lines();
        let asked =
            ["SELECT * FROM hidden.groups", "SELECT 1", "", "nonsense", "SELECT * FROM hidden.nothing"];
        for (sql, day) in asked.into_iter().zip([None, Some(3), Some(9000), None, Some(1)]) {
            let refused = session.inspect().query_hidden_tables(sql, day).expect_err("hidden").to_string();
            assert_eq!(
                refused,
                "not_in_this_mode: the x-ray is available in debug runs and in runs that have ended"
            );
        }
        assert!(session.inspect().hidden_query_interrupt().is_err());
        assert_eq!(lines(), before, "no inspection happened, so no line is recorded");
        session.abandon().expect("it ends");
        drop(session);
        let mut session = Session::open(&place, Access::Write, true).expect("it opens");
        let rows = query_hidden(&mut session, "SELECT count(*), max(day) FROM hidden.groups");
        assert_eq!(rows, [[integer(7 * 26), integer(7)]]);
        let active = "SELECT (SELECT count(*) FROM hidden.customers WHERE standing = 'subscriber') \
                      = (SELECT count(*) FROM subscriptions WHERE status = 'subscribed')";
        assert_eq!(query_hidden(&mut session, active), [[integer(1)]]);
        drop(session);
        let trajectory = Trajectory::read(&place.join("trajectory.jsonl")).expect("lines");
        assert_eq!(inspections(&trajectory), [], "the end is the last line");
        assert_eq!(inspections(&read_afterwards(&place, &trajectory).expect("lines")).len(), 2);
    }
}

const QUERY_FORMS: [&str; 12] = [
    "SELECT * FROM {t}",
    "SELECT count(*) FROM {t}",
    "SELECT day FROM {t} AS own",
    "SELECT 1 FROM ledger JOIN {t} USING (day)",
    "SELECT (SELECT 1 FROM {t})",
    "WITH x AS (SELECT * FROM {t}) SELECT * FROM x",
    "WITH hidden AS (SELECT 1) SELECT * FROM {t}",
    "EXPLAIN QUERY PLAN SELECT * FROM {t}",
    "SELECT * FROM ledger WHERE day IN (SELECT day FROM {t})",
    "SELECT * FROM ledger UNION SELECT * FROM {t}",
    "SELECT {t}.day FROM ledger",
    "SELECT day FROM ledger ORDER BY (SELECT day FROM {t})",
];

#[test]
fn other_connections_report_an_unknown_table() {
    let folder = tempfile::tempdir().expect("a folder");
    for mode in [Mode::Debug, Mode::Sandbox] {
        let mut session = run_in(folder.path(), mode, 28);
        play_until_several_groups_subscribe(&mut session);
        advance_week(&mut session);
        if mode == Mode::Debug {
            // The tables stay unknown to other connections after a query of the x-ray.
            hidden_tables().iter().for_each(|table| {
                query_hidden(&mut session, &format!("SELECT * FROM {}", table.name));
            });
        }
        let connection = session.database().open_connection().expect("a connection");
        let limits = session.company().query_limits();
        for table in hidden_tables() {
            let alone = table.name.strip_prefix("hidden.").expect("a schema");
            for form in QUERY_FORMS {
                let unknown_table_error = |schema: &str| {
                    let sql = form.replace("{t}", &format!("{schema}.{alone}"));
                    let error = connection.query(&sql, limits).expect_err("unknown");
                    (error.code, error.message.replace(schema, "other"), error.position)
                };
                assert_eq!(unknown_table_error("hidden"), unknown_table_error("secret"), "{form} of {alone}");
                let sql = form.replace("{t}", &table.name);
                let refused = session.query(&sql).expect_err("unknown");
                assert_eq!(refused.code, "sql_error", "{sql}");
            }
            if alone != "customers" {
                let refused = session.query(&format!("SELECT * FROM {alone}")).expect_err("unknown");
                assert!(refused.message.starts_with(&format!("there is no table {alone}")), "{refused}");
                assert!(!refused.message.contains("hidden"), "{refused}");
            }
        }
        let columns: Vec<String> = connection.query("SELECT * FROM customers", limits).expect("rows").columns;
        assert_eq!(columns.len(), 17, "the visible table");
    }
}
