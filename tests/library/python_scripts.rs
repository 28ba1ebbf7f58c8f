//! Python scripts: results, restrictions, limits, and replays that use recorded results.

use std::ops::ControlFlow;
use std::process::Command;
use std::time::{Duration, Instant};

use novamind::insight::create_branch_with_decisions;
use novamind::record::folder::configuration::Configuration;
use novamind::record::mode::Mode;
use novamind::record::trajectory::record::{QuerySource, Via};
use novamind::record::trajectory::{Record, Trajectory};
use novamind::session::{Access, NewRun, Session, Storage, verify};
use novamind::tools::Rejection;
use serde_json::{Value, json};

use crate::support::company::{advance_week, call_tool};

/// Starts a run, or returns `None` if python3 is not available and the test is skipped.
fn create_run_if_python_is_available(storage: Storage) -> Option<Session> {
    let tried = Command::new("python3").args(["-c", ""]).output();
    if !tried.is_ok_and(|done| done.status.success()) {
        return None;
    }
    let new = NewRun { seed: Some(7), days: Some(28), storage, ..NewRun::default() };
    Some(Session::create(new, &Configuration::bundled()).expect("the run begins"))
}

fn run_script(session: &mut Session, code: &str) -> Value {
    call_tool(session, "python_exec", json!({ "code": format!("# python\n{code}") }))
}

#[track_caller]
fn script_rejection(session: &mut Session, code: &str, seconds: f64) -> Rejection {
    let given = json!({ "code": format!("# python\n{code}"), "timeout_seconds": seconds });
    let refusal = session.call("python_exec", &given, Via::Script).expect_err(code);
    assert_eq!(refusal.field.as_deref(), Some("code"), "{refusal}");
    refusal
}

#[track_caller]
fn assert_fails(session: &mut Session, code: &str, parts: &[&str]) {
    let refusal = script_rejection(session, code, 60.0);
    assert_eq!(refusal.code, "script_failed", "{code}: {refusal}");
    for part in parts {
        assert!(refusal.message.contains(part), "{code}: {part} is not in\n{}", refusal.message);
    }
}

#[test]
fn script_queries_and_prints() {
    let Some(mut session) = create_run_if_python_is_available(Storage::Memory) else { return };
    let hash = session.state_hash();
    let asked = session.company().query_history().to_vec();
    let output = run_script(
        &mut session,
        "rows = query('SELECT day, category, amount FROM ledger')\nprint(rows, get_vars())\n\
         print(sum(row['amount'] for row in rows))",
    );
    let first =
        "[{'day': 0, 'category': 'initial_funding', 'amount': 1000000.0}] {'current_day': 0}\n1000000.0\n";
    assert_eq!(output, json!({ "returncode": 0, "stdout": first, "stderr": "" }));
    let output = run_script(
        &mut session,
        "from novamind_script import query as ask\nimport statistics, sys\n\
         print(ask(\"SELECT * FROM subscriptions WHERE status = 'active'\"), statistics.mean([1, 3]))\nsys.exit(0)",
    );
    assert_eq!(output["stdout"], "[] 2\n");
    assert!(
        output["stderr"].as_str().is_some_and(|text| text.contains("status is never 'active'")),
        "{output}"
    );
    call_tool(
        &mut session,
        "register_script",
        json!({ "name": "day", "code": "#!/usr/bin/env python3\nprint(get_vars())" }),
    );
    advance_week(&mut session);
    assert_eq!(
        call_tool(&mut session, "run_script", json!({ "name": "day" }))["stdout"],
        "{'current_day': 7}\n"
    );
    assert_ne!(session.state_hash(), hash, "a week has passed");
    assert_eq!(session.company().query_history(), asked, "queries of a script are not in the query history");
}

#[test]
fn failed_script_reports_its_error_and_changes_nothing() {
    let Some(mut session) = create_run_if_python_is_available(Storage::Memory) else { return };
    let hash = session.state_hash();
    let code = "print('so far')\ndef half(x):\n    return x / 0\nhalf(1)";
    assert_fails(
        &mut session,
        code,
        &[
            "ZeroDivisionError: division by zero; python3 ended with code 1\n",
            "line 4, in half",
            "output of the script:\nso far",
        ],
    );
    assert_fails(&mut session, "import sys\nsys.exit(3)", &["python3 ended with code 3"]);
    assert_fails(&mut session, "def f(:", &["SyntaxError", "line 2"]);
    assert_fails(&mut session, "set_prices(A=1)", &["NameError"]);
    assert_fails(&mut session, "import os\nos._exit(4)", &["python3 ended with code 4"]);
    let unmarked =
        session.call("python_exec", &json!({ "code": "print('hello')" }), Via::Script).expect_err("SQL");
    assert!(
        unmarked.message.ends_with("this looks like Python: let its first line be `# python`"),
        "{unmarked}"
    );
    assert_eq!(session.state_hash(), hash);
}

#[test]
fn python_queries_have_the_limits_of_queries() {
    let Some(mut session) = create_run_if_python_is_available(Storage::Memory) else { return };
    for (sql, part) in [
        ("SELECT c_max FROM customers", "there is no column c_max"),
        ("SELECT * FROM customer_state", "table customer_state is not accessible"),
        ("DELETE FROM ledger", "only reading is allowed"),
        ("SELECT 1; SELECT 2", "only one statement is allowed"),
        ("SELECT * FROM hidden.customers", "there is no table hidden.customers"),
        ("PRAGMA query_only = 0", "sql_schema"),
    ] {
        assert_fails(&mut session, &format!("query({sql:?})"), &["NovamindError", part]);
    }
    let caught = "try:\n    query('SELECT nothing')\nexcept NovamindError as error:\n    print(error.code)";
    assert_eq!(run_script(&mut session, caught)["stdout"], "sql_error\n");
    assert_fails(&mut session, "query(5)", &["TypeError"]);
    assert_fails(
        &mut session,
        "query('SELECT 1 -- ' + 'x' * (2 << 20))",
        &["a statement of a script may have 1 MiB"],
    );
    assert_fails(
        &mut session,
        "for _ in range(10001): query('SELECT 1')",
        &["a script can send 10,000 queries"],
    );
    let endless =
        "query('WITH RECURSIVE n(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM n) SELECT count(*) FROM n')";
    let begun = Instant::now();
    let stopped = script_rejection(&mut session, endless, 1.0);
    assert!(begun.elapsed() < Duration::from_secs(20), "{stopped}");
}

#[test]
fn scripts_cannot_block_the_run() {
    let Some(mut session) = create_run_if_python_is_available(Storage::Memory) else { return };
    for code in [
        "print('begun')\nwhile True: pass",
        "print('begun')\nimport time\ntime.sleep(600)",
        "print('begun')\nimport signal, os\nfor number in range(1, 32):\n    try: signal.signal(number, signal.SIG_IGN)\n    \
         except (OSError, ValueError): pass\nwhile True: pass",
        "print('begun')\nimport os\nfor place in range(3, 64):\n    try: os.close(place)\n    except OSError: pass\nwhile True: pass",
        "print('begun')\nwhile True: print('x' * 4000)",
    ] {
        let begun = Instant::now();
        let refusal = script_rejection(&mut session, code, 1.5);
        assert_eq!(refusal.code, "script_timeout", "{code}: {refusal}");
        assert!(refusal.message.starts_with("the script did not end in 1.5 s"), "{refusal}");
        assert!(begun.elapsed() < Duration::from_secs(20), "{code}");
        assert!(code.contains('x') || refusal.message.ends_with("output of the script:\nbegun"), "{refusal}");
    }
    let flood =
        "import sys\nfor _ in range(20000):\n    print('x' * 999)\n    print('é' * 999, file=sys.stderr)";
    let value = run_script(&mut session, flood);
    let length = |field: &str| value[field].as_str().map_or(0, |text| text.chars().count());
    assert_eq!((length("stdout"), length("stderr")), (5000, 2000));
    // The script sends invalid requests to the program.
    let noise = "import os\nfor place in range(3, 64):\n    try: os.write(place, b'{}\\n\\xff\\n' * 100)\n    except OSError: pass\nprint('over')";
    assert_eq!(run_script(&mut session, noise)["stdout"], "over\n");
    assert_eq!(run_script(&mut session, "print(get_vars())")["stdout"], "{'current_day': 0}\n");
}

#[cfg(target_os = "linux")]
#[test]
fn scripts_are_sandboxed_on_linux() {
    let Some(mut session) = create_run_if_python_is_available(Storage::Memory) else { return };
    let begun = Instant::now();
    assert_fails(&mut session, "hog = []\nwhile True: hog.append(bytearray(50 << 20))", &["MemoryError"]);
    assert!(begun.elapsed() < Duration::from_secs(30));
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("file");
    std::fs::write(&file, "kept").expect("a file");
    let file = file.display().to_string();
    // Further restrictions are tested only if the kernel supports Landlock.
    let fence = "import ctypes\nprint(ctypes.CDLL(None).syscall(444, None, 0, 1))";
    let has_fence =
        run_script(&mut session, fence)["stdout"].as_str().is_some_and(|text| !text.starts_with('-'));
    let mut forbidden = vec![
        format!("open({file:?}, 'a').write('x' * 100000)"),
        "import os\nos.fork()".to_owned(),
        "import subprocess\nsubprocess.run(['true'])".to_owned(),
        "import socket\nsocket.create_connection(('127.0.0.1', 80))".to_owned(),
        "import os\nos.kill(os.getppid(), 0)".to_owned(),
        format!("import os\nos.chmod({file:?}, 0)"),
    ];
    if has_fence {
        forbidden.extend([
            format!("open({file:?})"),
            format!("import os\nos.remove({file:?})"),
            "open('file', 'w')".to_owned(),
            "open(f'/proc/{__import__(\"os\").getppid()}/mem', 'rb')".to_owned(),
        ]);
    }
    for code in forbidden {
        assert_fails(&mut session, &code, &["Error: "]);
    }
    assert_eq!(std::fs::read_to_string(&file).expect("the file"), "kept");
    let empty = "import os\nprint(os.listdir('.'), sorted(set(os.environ) - {'PATH', 'LC_CTYPE'}))";
    let listing = run_script(&mut session, empty)["stdout"].clone();
    let listing = listing.as_str().unwrap_or_default();
    assert!(listing.starts_with("[] [") && !listing.contains("NOVAMIND"), "{listing}");
}

#[test]
fn replay_uses_recorded_script_output() {
    let runs = tempfile::tempdir().expect("a folder");
    let Some(mut session) = create_run_if_python_is_available(Storage::Runs(runs.path().to_owned())) else {
        return;
    };
    let folder = session.folder().expect("a folder").to_owned();
    // The output of this script differs on every execution.
    let code = "# python\nimport time\nprint(query('SELECT count(*) AS n FROM ledger'), time.time_ns())";
    call_tool(&mut session, "register_daily_calculation", json!({ "name": "now", "code": code }));
    call_tool(
        &mut session,
        "register_daily_calculation",
        json!({ "name": "wrong", "code": "# python\n1 / 0" }),
    );
    call_tool(&mut session, "python_exec", json!({ "code": code }));
    let dashboard = advance_week(&mut session).dashboard;
    assert!(dashboard.contains("now:\n  [{'n': 1}] "), "{dashboard}");
    assert!(
        dashboard.contains("wrong:\n  failed: ZeroDivisionError: division by zero; python3 ended"),
        "{dashboard}"
    );
    drop(session);
    let lines = Trajectory::read(&folder.join("trajectory.jsonl")).expect("lines").lines;
    let asked = lines.iter().filter_map(|line| match &line.record {
        Record::Query(query) => Some((query.via, query.rows)),
        _ => None,
    });
    assert_eq!(
        asked.collect::<Vec<_>>(),
        [(Some(QuerySource::Script), Some(1))],
        "calculations are not lines"
    );
    assert_eq!(verify(&folder).expect("it verifies").states, 1);
    std::fs::remove_file(folder.join("snapshot.bin")).ok();
    let mut session = Session::open(&folder, Access::Write, true).expect("it opens");
    assert_eq!(session.company().dashboard(), dashboard);
    assert!(session.remarks().join(" ").contains("Calculations in Python run before each week: now, wrong."));
    advance_week(&mut session);

    // A re-simulation does not run registered calculations.
    let again =
        create_branch_with_decisions(&session, 2, &[], Mode::Sandbox, &mut |_| ControlFlow::Continue(()));
    let branch = again.unwrap_or_else(|refusal| panic!("{refusal}")).session;
    assert_eq!(branch.state_hash(), session.state_hash());
    let text = &branch.company().calculation_outputs()[0].output;
    assert!(text.starts_with("failed: Python is not run"), "{text}");
}
