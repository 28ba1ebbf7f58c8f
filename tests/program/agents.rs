//! Agents with a shell: `novamind agent` finds, starts and stops its server, and restarts a server that was killed.

use std::path::PathBuf;
use std::process::{Command, Stdio};

use serde_json::{Value, json};

use crate::interfaces::{CALLS, last_state_hash, plain_mode_state_hash, predictions};
use crate::support::home::{Home, ProgramOutput, run_with_input};

/// Folders of a user, whose servers are killed at the end of the test.
struct AgentShell {
    home: Home,
}

impl Drop for AgentShell {
    fn drop(&mut self) {
        for file in self.runs().iter().map(|run| run.join("server.json")) {
            let pid = std::fs::read(&file)
                .ok()
                .and_then(|text| announced_pid(&serde_json::from_slice(&text).ok()?));
            if let Some(pid) = pid {
                let _ = Command::new("kill").args(["-KILL", &pid]).stderr(Stdio::null()).status();
            }
        }
    }
}

fn announced_pid(announced: &Value) -> Option<String> {
    announced["pid"].as_u64().map(|pid| pid.to_string())
}

impl AgentShell {
    fn new() -> AgentShell {
        AgentShell { home: Home::new() }
    }

    fn runs(&self) -> Vec<PathBuf> {
        let entries =
            std::fs::read_dir(self.home.runs()).expect("a folder").flatten().map(|entry| entry.path());
        entries.filter(|path| path.join("run.toml").is_file()).collect()
    }

    fn run_agent(&self, words: &[&str]) -> ProgramOutput {
        run_with_input(self.home.program().arg("agent").args(words), "")
    }

    /// Runs a command that must succeed, and returns its JSON output.
    #[track_caller]
    fn run_json(&self, words: &[&str]) -> Value {
        let done = self.run_agent(words);
        assert_eq!((done.exit_code, done.stderr.as_str()), (0, ""), "{words:?}: {}", done.stdout);
        serde_json::from_str(&done.stdout)
            .unwrap_or_else(|error| panic!("{words:?}: {error}: {}", done.stdout))
    }

    fn create_run(&self) -> Value {
        self.run_json(&["new", "--seed", "7", "--days", "28", "--mode", "sandbox"])
    }

    #[track_caller]
    fn advance_week(&self, day: u32) {
        let filed = json!({ "rationale": "on", "predictions": predictions() }).to_string();
        assert_eq!(self.run_json(&["next-week", &filed])["day"], day);
    }

    fn announcement(&self) -> Option<Value> {
        let text = std::fs::read(self.home.only_run().join("server.json")).ok()?;
        Some(serde_json::from_slice(&text).expect("JSON"))
    }

    /// Kills the server of the current run.
    fn kill_server(&self) {
        let pid = self.announcement().as_ref().and_then(announced_pid).expect("a server");
        assert!(Command::new("kill").args(["-KILL", &pid]).status().expect("kill").success());
    }
}

#[test]
fn shell_agent_reaches_the_same_state() {
    let shell = AgentShell::new();
    assert_eq!(shell.run_agent(&["status"]).exit_code, 2);
    let begun = shell.create_run();
    assert_eq!((&begun["day"], &begun["total_days"]), (&json!(0), &json!(28)));
    assert_eq!(shell.announcement().map(|served| served["port"].clone()), Some(begun["port"].clone()));
    let [prices, quotas, ads] = CALLS;
    assert_eq!(shell.run_json(&["call", prices.0, "--A", "10", "--B=20"])["success"], true);
    assert_eq!(shell.run_json(&["call", quotas.0, quotas.1])["success"], true);
    let from_input = run_with_input(shell.home.program().args(["agent", "call", ads.0, "-"]), ads.1);
    assert_eq!(from_input.exit_code, 0, "{}", from_input.stderr);
    shell.run_agent(&["call", "set_capacity_tier", "--tier", "9"]).assert_fails(5, &["tier", "("]);
    shell.run_agent(&["call", "set_capacity_tier", "9"]).assert_fails(2, &["JSON object"]);
    shell.run_agent(&["query", "SELECT * FROM events"]).assert_fails(5, &["sql_"]);
    shell.run_agent(&["next-week", r#"{"rationale": "x"}"#]).assert_fails(5, &["prediction"]);
    shell.run_agent(&["next-week", "x", "1"]).assert_fails(2, &["12 numbers"]);
    shell.advance_week(7);
    let forecast = ["1e6", "0", "2000000"];
    let words = [&["next-week", "on"][..], &forecast, &forecast, &forecast, &forecast].concat();
    assert_eq!(shell.run_json(&words)["day"], 14);
    let shown = shell.run_json(&["dashboard"]);
    assert_eq!((&shown["day"], shown["dashboard"].is_string()), (&json!(14), true), "{shown}");
    let status = shell.run_json(&["status"]);
    let rows = shell.run_json(&["query", "SELECT SUM(amount) AS cash FROM ledger"]);
    assert_eq!((&status["day"], &rows["rows"][0]["cash"]), (&json!(14), &status["cash"]));
    let is_marked = || shell.home.run(&["runs", "list"]).stdout.contains("played by a program");
    assert!(is_marked());
    assert_eq!(shell.run_json(&["stop"])["stopped"], true);
    assert!(!is_marked());
    assert_eq!(shell.run_json(&["stop"])["stopped"], false);
    assert_eq!(shell.announcement(), None);
    assert_eq!(last_state_hash(&shell.home), plain_mode_state_hash());
}

#[test]
fn command_with_a_repeated_request_id_runs_once() {
    let shell = AgentShell::new();
    shell.create_run();
    let filed = json!({ "rationale": "on", "predictions": predictions() }).to_string();
    let week = ["--request-id", "w", "next-week", "--expected-day", "0", &filed];
    let price = ["--request-id", "p", "call", "set_prices", "--A", "12"];
    let first = [shell.run_json(&price), shell.run_json(&week)];
    shell.kill_server();
    assert_eq!([shell.run_json(&price), shell.run_json(&week)], first);
    shell
        .run_agent(&["--request-id", "p", "call", "set_prices", "--A", "13"])
        .assert_fails(5, &["request_id_payload_mismatch"]);
    shell
        .run_agent(&["next-week", "--expected-day", "0", &filed])
        .assert_fails(5, &["unexpected_day", "day 7"]);
    assert_eq!(shell.run_json(&["status"])["day"], 7);
    shell.run_json(&["stop"]);
}

#[test]
fn release_2_command_generates_and_prints_its_request_id() {
    let shell = AgentShell::new();
    shell.run_json(&["new", "--seed", "7", "--days", "28", "--mode", "sandbox", "--scenario", "release-2"]);
    let first = shell.run_agent(&["call", "set_prices", "--A", "12"]);
    assert_eq!(first.exit_code, 0, "{}", first.stderr);
    let printed: Value = serde_json::from_str(&first.stderr).expect("one line of JSON");
    let id = printed["request_id"].as_str().expect("an id");
    let again = shell.run_json(&["--request-id", id, "call", "set_prices", "--A", "12"]);
    assert_eq!(again, serde_json::from_str::<Value>(&first.stdout).expect("JSON"));
    shell
        .run_agent(&["--request-id", id, "call", "set_prices", "--A", "13"])
        .assert_fails(5, &["request_id_payload_mismatch (request_id): this request_id belongs"]);
    // Reads need no id.
    shell.run_json(&["call", "get_vars"]);
    let filed = json!({ "rationale": "on", "predictions": predictions() }).to_string();
    let week = shell.run_agent(&["next-week", &filed]);
    assert!(week.exit_code == 0 && week.stderr.contains("request_id"), "{}", week.stderr);
    shell.run_json(&["stop"]);
}

#[test]
fn killed_server_is_restarted() {
    let shell = AgentShell::new();
    let first = shell.create_run();
    shell.advance_week(7);
    shell.kill_server();
    // Concurrent commands must use the same server.
    let children: Vec<_> = (0..4)
        .map(|_| {
            shell.home.program().args(["agent", "call", "get_vars"]).spawn().expect("the program starts")
        })
        .collect();
    for child in children {
        let done = child.wait_with_output().expect("it ends");
        assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
        assert!(String::from_utf8_lossy(&done.stdout).contains(r#""current_day":7"#));
    }
    let second = shell.announcement().expect("a server");
    assert_ne!(second["pid"], first["pid"]);
    shell.advance_week(14);
    assert_eq!(shell.announcement(), Some(second));
    assert_eq!(shell.run_json(&["stop"])["stopped"], true);
    let id = first["run"].as_str().expect("a run");
    assert_eq!(shell.home.run(&["replay", id, "--verify"]).exit_code, 0);
}

#[test]
fn stale_announcement_is_ignored() {
    let shell = AgentShell::new();
    shell.create_run();
    shell.advance_week(7);
    assert_eq!(shell.run_json(&["stop"])["stopped"], true);
    let run = shell.home.only_run();
    // Another program has bound the port of the dead server and does not answer requests.
    let stranger = std::net::TcpListener::bind(("127.0.0.1", 0)).expect("a port");
    stranger.set_nonblocking(true).expect("a socket");
    let port = stranger.local_addr().expect("an address").port();
    let name = run.file_name().expect("a name").to_string_lossy().into_owned();
    for left in [
        json!({ "run": name, "port": port, "pid": 1 }).to_string(),
        json!({ "run": "00000000", "port": port, "pid": 1 }).to_string(),
        "{".to_owned(),
    ] {
        std::fs::write(run.join("server.json"), left).expect("a file");
        assert_eq!(shell.run_json(&["status"])["day"], 7);
        assert_eq!(shell.run_json(&["stop"])["stopped"], true);
    }
    assert!(stranger.accept().is_err(), "the other program gets no request");
    // An agent cannot use a run that is in use by a user.
    let mut child = shell.home.program().args(["serve", "--run", &name]).spawn().expect("the program starts");
    let mut line = String::new();
    let mut out = std::io::BufReader::new(child.stdout.take().expect("a pipe"));
    std::io::BufRead::read_line(&mut out, &mut line).expect("a line");
    std::fs::remove_file(run.join("server.json")).expect("a file");
    shell.run_agent(&["status"]).assert_fails(1, &["is open in another program"]);
    child.kill().and_then(|()| child.wait()).expect("it ends");
}

#[test]
fn finished_run_has_a_separate_exit_code() {
    let shell = AgentShell::new();
    shell.run_json(&["new", "--seed", "7", "--days", "7", "--mode", "sandbox"]);
    shell.advance_week(7);
    assert_eq!(shell.run_json(&["status"])["ended"], "horizon");
    let filed = json!({ "rationale": "on", "predictions": predictions() }).to_string();
    shell.run_agent(&["next-week", &filed]).assert_fails(6, &["run_over"]);
    shell.run_agent(&["next-week", r#"{"rationale": "on", "extra": 1}"#]).assert_fails(6, &["run_over"]);
    shell.run_agent(&["call", "set_prices", "--A", "9"]).assert_fails(6, &["run_over"]);
    assert_eq!(shell.run_json(&["call", "get_vars"])["success"], true);
}

#[test]
fn docs_command_writes_the_agent_page_and_its_documents() {
    let shell = AgentShell::new();
    let folder = shell.home.0.path().join("handed");
    assert!(shell.run_agent(&["docs"]).stdout.starts_with("# You run NovaMind\n"));
    shell.run_json(&["new", "--seed", "7", "--days", "35", "--cash", "250000", "--mode", "sandbox"]);
    let id = shell.announcement().expect("a server")["run"].as_str().expect("a run").to_owned();
    assert_eq!(shell.run_agent(&["--run", &id, "docs", "--out", &folder.to_string_lossy()]).exit_code, 0);
    let page = std::fs::read_to_string(folder.join("AGENT.md")).expect("a page");
    assert!(page.contains("for 35 days") && page.contains("$250,000"), "{page}");
    for (file, count) in [("tools.json", 36), ("tables.json", 19)] {
        let bytes = std::fs::read(folder.join(file)).expect("a file");
        let read: Value = serde_json::from_slice(&bytes).expect("JSON");
        assert_eq!(read.as_array().map(Vec::len), Some(count), "{file}");
    }
}

#[test]
fn python_program_finds_the_run_and_the_package() {
    let shell = AgentShell::new();
    shell.create_run();
    let program = "import novamind, sys; from novamind import pricing; pricing.set_prices(A=10); \
                   print(novamind.current_day()); sys.exit(9)";
    let bare = shell.home.0.path().join("bare");
    std::fs::create_dir(&bare).expect("a folder");
    let mut without = shell.home.program();
    without.env("PATH", &bare).args(["agent", "python", "-c", program]);
    run_with_input(&mut without, "").assert_fails(1, &["python3", "agent call"]);
    if Command::new("python3").arg("--version").stdout(Stdio::null()).status().is_err() {
        println!("SKIPPED: python3 is not installed");
        return;
    }
    let done = shell.run_agent(&["python", "-c", program]);
    assert_eq!((done.exit_code, done.stdout.as_str()), (9, "0\n"), "{}", done.stderr);
}

#[test]
fn code_option_after_a_tool_belongs_to_the_tool() {
    let shell = AgentShell::new();
    assert_eq!(shell.run_agent(&["new", "--seed", "3"]).exit_code, 0);
    let program_output = shell.run_agent(&["call", "python_exec", "--code", "SELECT 5 AS x"]);
    assert!(
        program_output.exit_code == 0 && program_output.stdout.contains("5"),
        "{}{}",
        program_output.stdout,
        program_output.stderr
    );
    let kept = shell.run_agent(&["call", "register_script", "--code", "SELECT 6 AS x", "--name", "six"]);
    assert_eq!(kept.exit_code, 0, "{}", kept.stderr);
    let rows = shell.run_agent(&["call", "query", "--sql", "SELECT 7 AS x"]);
    assert!(rows.exit_code == 0 && rows.stdout.contains("7"), "{}{}", rows.stdout, rows.stderr);
    assert_eq!(shell.run_agent(&["stop"]).exit_code, 0);
}

#[test]
fn batch_restarts_a_command_that_stops_early_and_selects_a_run() {
    let shell = AgentShell::new();
    let out = shell.home.0.path().join("batch");
    // Each start of the command plays one week. The second try exits with an error.
    let filed = json!({ "rationale": "on", "predictions": predictions() }).to_string();
    let program = env!("CARGO_BIN_EXE_novamind");
    let command = format!(
        "test -f AGENT.md && test -f client/novamind/__init__.py && test -n \"$NOVAMIND_API_PORT\" || exit 3; \
         echo \"$NOVAMIND_TRY/$NOVAMIND_ATTEMPT\"; test $NOVAMIND_TRY = 2 && exit 4; \
         '{program}' agent next-week '{filed}'; test $NOVAMIND_ATTEMPT = 1 && kill -KILL $(sed 's/.*pid\":\\([0-9]*\\).*/\\1/' \"$NOVAMIND_RUNS/$NOVAMIND_RUN/server.json\"); exit 0"
    );
    let folder = out.to_string_lossy().into_owned();
    let words =
        ["batch", "--command", &command, "--runs", "2", "--continue", "2", "--seed", "7", "--days", "14"];
    let done = shell.run_agent(&[&words[..], &["--mode", "sandbox", "--out", &folder, "--json"]].concat());
    assert_eq!(done.exit_code, 0, "{}", done.stderr);
    let value: Value = serde_json::from_str(&done.stdout).expect("JSON");
    let kept: Value =
        serde_json::from_slice(&std::fs::read(out.join("results.json")).expect("a file")).expect("JSON");
    assert_eq!(value, kept);
    let rows = &value["tables"]["tries"]["rows"];
    let row = |at: usize| {
        ["try", "end", "day", "attempts", "exit_code", "selected"].map(|name| rows[at][name].clone())
    };
    assert_eq!(row(0), [json!(1), json!("last day"), json!(14), json!(2), json!(0), json!("yes")]);
    assert_eq!(row(1), [json!(2), json!("unfinished"), json!(0), json!(3), json!(4), json!("")]);
    assert!(rows[0]["cash"].as_f64().is_some_and(|cash| cash > 0.0), "{value}");
    let log = std::fs::read_to_string(out.join("try-1/output.txt")).expect("a file");
    assert!(log.starts_with("1/1\n") && log.contains("1/2\n"), "{log}");
    for run in shell.runs() {
        assert!(!run.join("server.json").exists());
    }
    shell.run_agent(&[&words[..], &["--out", &folder]].concat()).assert_fails(2, &["not empty"]);
    let none = shell.home.0.path().join("none");
    let program_output =
        shell.run_agent(&["batch", "--command", "true", "--days", "3", "--out", &none.to_string_lossy()]);
    assert!(
        program_output.exit_code != 0 && !none.exists(),
        "a batch that cannot begin leaves nothing: {}",
        program_output.stderr
    );
}
