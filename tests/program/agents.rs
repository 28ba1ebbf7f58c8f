//! Agents with a shell: `novamind agent` finds, starts, stops and loses its server.

use std::path::PathBuf;
use std::process::{Command, Stdio};

use serde_json::{Value, json};

use crate::doors::{CALLS, last_hash, of_plain_mode, predictions};
use crate::support::home::{Home, Said, said};

/// A home whose servers end with the test.
struct Shell {
    home: Home,
}

impl Drop for Shell {
    fn drop(&mut self) {
        for file in self.runs().iter().map(|run| run.join("server.json")) {
            let pid = std::fs::read(&file).ok().and_then(|text| pid_of(&serde_json::from_slice(&text).ok()?));
            if let Some(pid) = pid {
                let _ = Command::new("kill").args(["-KILL", &pid]).stderr(Stdio::null()).status();
            }
        }
    }
}

fn pid_of(announced: &Value) -> Option<String> {
    announced["pid"].as_u64().map(|pid| pid.to_string())
}

impl Shell {
    fn new() -> Shell {
        Shell { home: Home::new() }
    }

    fn runs(&self) -> Vec<PathBuf> {
        let entries =
            std::fs::read_dir(self.home.runs()).expect("a folder").flatten().map(|entry| entry.path());
        entries.filter(|path| path.join("run.toml").is_file()).collect()
    }

    fn agent(&self, words: &[&str]) -> Said {
        said(self.home.program().arg("agent").args(words), "")
    }

    /// Runs a command that succeeds; returns its object.
    #[track_caller]
    fn does(&self, words: &[&str]) -> Value {
        let done = self.agent(words);
        assert_eq!((done.code, done.err.as_str()), (0, ""), "{words:?}: {}", done.out);
        serde_json::from_str(&done.out).unwrap_or_else(|error| panic!("{words:?}: {error}: {}", done.out))
    }

    fn begin(&self) -> Value {
        self.does(&["new", "--seed", "7", "--days", "28", "--mode", "sandbox"])
    }

    #[track_caller]
    fn week(&self, day: u32) {
        let filed = json!({ "rationale": "on", "predictions": predictions() }).to_string();
        assert_eq!(self.does(&["next-week", &filed])["day"], day);
    }

    fn served(&self) -> Option<Value> {
        let text = std::fs::read(self.home.only_run().join("server.json")).ok()?;
        Some(serde_json::from_slice(&text).expect("JSON"))
    }

    /// Kills the server.
    fn kill(&self) {
        let pid = self.served().as_ref().and_then(pid_of).expect("a server");
        assert!(Command::new("kill").args(["-KILL", &pid]).status().expect("kill").success());
    }
}

#[test]
fn the_same_decisions_from_a_shell_are_the_same_run() {
    let shell = Shell::new();
    assert_eq!(shell.agent(&["status"]).code, 2);
    let begun = shell.begin();
    assert_eq!((&begun["day"], &begun["total_days"]), (&json!(0), &json!(28)));
    assert_eq!(shell.served().map(|served| served["port"].clone()), Some(begun["port"].clone()));
    let [prices, quotas, ads] = CALLS;
    assert_eq!(shell.does(&["call", prices.0, "--A", "10", "--B=20"])["success"], true);
    assert_eq!(shell.does(&["call", quotas.0, quotas.1])["success"], true);
    let from_input = said(shell.home.program().args(["agent", "call", ads.0, "-"]), ads.1);
    assert_eq!(from_input.code, 0, "{}", from_input.err);
    shell.agent(&["call", "set_capacity_tier", "--tier", "9"]).fails(5, &["tier", "("]);
    shell.agent(&["call", "set_capacity_tier", "9"]).fails(2, &["JSON object"]);
    shell.agent(&["query", "SELECT * FROM events"]).fails(5, &["sql_"]);
    shell.agent(&["next-week", r#"{"rationale": "x"}"#]).fails(5, &["prediction"]);
    shell.agent(&["next-week", "x", "1"]).fails(2, &["12 numbers"]);
    shell.week(7);
    let forecast = ["1e6", "0", "2000000"];
    let words = [&["next-week", "on"][..], &forecast, &forecast, &forecast, &forecast].concat();
    assert_eq!(shell.does(&words)["day"], 14);
    let shown = shell.does(&["dashboard"]);
    assert_eq!((&shown["day"], shown["dashboard"].is_string()), (&json!(14), true), "{shown}");
    let status = shell.does(&["status"]);
    let rows = shell.does(&["query", "SELECT SUM(amount) AS cash FROM ledger"]);
    assert_eq!((&status["day"], &rows["rows"][0]["cash"]), (&json!(14), &status["cash"]));
    let is_marked = || shell.home.run(&["runs", "list"]).out.contains("played by a program");
    assert!(is_marked());
    assert_eq!(shell.does(&["stop"])["stopped"], true);
    assert!(!is_marked());
    assert_eq!(shell.does(&["stop"])["stopped"], false);
    assert_eq!(shell.served(), None);
    assert_eq!(last_hash(&shell.home), of_plain_mode());
}

#[test]
fn a_command_that_is_repeated_with_its_id_runs_once() {
    let shell = Shell::new();
    shell.begin();
    let filed = json!({ "rationale": "on", "predictions": predictions() }).to_string();
    let week = ["--request-id", "w", "next-week", "--expected-day", "0", &filed];
    let price = ["--request-id", "p", "call", "set_prices", "--A", "12"];
    let first = [shell.does(&price), shell.does(&week)];
    shell.kill();
    assert_eq!([shell.does(&price), shell.does(&week)], first);
    shell
        .agent(&["--request-id", "p", "call", "set_prices", "--A", "13"])
        .fails(5, &["request_id_payload_mismatch"]);
    shell.agent(&["next-week", "--expected-day", "0", &filed]).fails(5, &["unexpected_day", "day 7"]);
    assert_eq!(shell.does(&["status"])["day"], 7);
    shell.does(&["stop"]);
}

#[test]
fn a_server_that_was_killed_is_followed_by_another_one() {
    let shell = Shell::new();
    let first = shell.begin();
    shell.week(7);
    shell.kill();
    // Concurrent commands find the same server.
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
    let second = shell.served().expect("a server");
    assert_ne!(second["pid"], first["pid"]);
    shell.week(14);
    assert_eq!(shell.served(), Some(second));
    assert_eq!(shell.does(&["stop"])["stopped"], true);
    let id = first["run"].as_str().expect("a run");
    assert_eq!(shell.home.run(&["replay", id, "--verify"]).code, 0);
}

#[test]
fn what_a_dead_server_left_behind_leads_nobody_astray() {
    let shell = Shell::new();
    shell.begin();
    shell.week(7);
    assert_eq!(shell.does(&["stop"])["stopped"], true);
    let run = shell.home.only_run();
    // Another program took the port; requests to it would get no answer.
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
        assert_eq!(shell.does(&["status"])["day"], 7);
        assert_eq!(shell.does(&["stop"])["stopped"], true);
    }
    assert!(stranger.accept().is_err(), "the other program gets no request");
    // A run that a user plays is not taken over.
    let mut child = shell.home.program().args(["serve", "--run", &name]).spawn().expect("the program starts");
    let mut line = String::new();
    let mut out = std::io::BufReader::new(child.stdout.take().expect("a pipe"));
    std::io::BufRead::read_line(&mut out, &mut line).expect("a line");
    std::fs::remove_file(run.join("server.json")).expect("a file");
    shell.agent(&["status"]).fails(1, &["is open in another program"]);
    child.kill().and_then(|()| child.wait()).expect("it ends");
}

#[test]
fn a_run_that_is_over_says_so_with_a_code_of_its_own() {
    let shell = Shell::new();
    shell.does(&["new", "--seed", "7", "--days", "7", "--mode", "sandbox"]);
    shell.week(7);
    assert_eq!(shell.does(&["status"])["ended"], "horizon");
    let filed = json!({ "rationale": "on", "predictions": predictions() }).to_string();
    shell.agent(&["next-week", &filed]).fails(6, &["run_over"]);
    shell.agent(&["next-week", r#"{"rationale": "on", "extra": 1}"#]).fails(6, &["run_over"]);
    shell.agent(&["call", "set_prices", "--A", "9"]).fails(6, &["run_over"]);
    assert_eq!(shell.does(&["call", "get_vars"])["success"], true);
}

#[test]
fn the_page_and_its_documents_are_written() {
    let shell = Shell::new();
    let folder = shell.home.0.path().join("handed");
    assert!(shell.agent(&["docs"]).out.starts_with("# You run NovaMind\n"));
    shell.does(&["new", "--seed", "7", "--days", "35", "--cash", "250000", "--mode", "sandbox"]);
    let id = shell.served().expect("a server")["run"].as_str().expect("a run").to_owned();
    assert_eq!(shell.agent(&["--run", &id, "docs", "--out", &folder.to_string_lossy()]).code, 0);
    let page = std::fs::read_to_string(folder.join("AGENT.md")).expect("a page");
    assert!(page.contains("for 35 days") && page.contains("$250,000"), "{page}");
    for (file, count) in [("tools.json", 36), ("tables.json", 19)] {
        let bytes = std::fs::read(folder.join(file)).expect("a file");
        let read: Value = serde_json::from_slice(&bytes).expect("JSON");
        assert_eq!(read.as_array().map(Vec::len), Some(count), "{file}");
    }
}

#[test]
fn a_program_in_python_finds_the_run_and_the_package() {
    let shell = Shell::new();
    shell.begin();
    let program = "import novamind, sys; from novamind import pricing; pricing.set_prices(A=10); \
                   print(novamind.current_day()); sys.exit(9)";
    let bare = shell.home.0.path().join("bare");
    std::fs::create_dir(&bare).expect("a folder");
    let mut without = shell.home.program();
    without.env("PATH", &bare).args(["agent", "python", "-c", program]);
    said(&mut without, "").fails(1, &["python3", "agent call"]);
    if Command::new("python3").arg("--version").stdout(Stdio::null()).status().is_err() {
        println!("SKIPPED: python3 is not installed");
        return;
    }
    let done = shell.agent(&["python", "-c", program]);
    assert_eq!((done.code, done.out.as_str()), (9, "0\n"), "{}", done.err);
}

#[test]
fn code_behind_the_name_of_a_tool_is_the_tools() {
    let shell = Shell::new();
    assert_eq!(shell.agent(&["new", "--seed", "3"]).code, 0);
    let said = shell.agent(&["call", "python_exec", "--code", "SELECT 5 AS x"]);
    assert!(said.code == 0 && said.out.contains("5"), "{}{}", said.out, said.err);
    let kept = shell.agent(&["call", "register_script", "--code", "SELECT 6 AS x", "--name", "six"]);
    assert_eq!(kept.code, 0, "{}", kept.err);
    let rows = shell.agent(&["call", "query", "--sql", "SELECT 7 AS x"]);
    assert!(rows.code == 0 && rows.out.contains("7"), "{}{}", rows.out, rows.err);
    assert_eq!(shell.agent(&["stop"]).code, 0);
}

#[test]
fn a_batch_starts_a_command_that_stops_early_again_and_selects_a_run() {
    let shell = Shell::new();
    let out = shell.home.0.path().join("batch");
    // Each start plays one week; the second try gives up.
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
    let done = shell.agent(&[&words[..], &["--mode", "sandbox", "--out", &folder, "--json"]].concat());
    assert_eq!(done.code, 0, "{}", done.err);
    let told: Value = serde_json::from_str(&done.out).expect("JSON");
    let kept: Value =
        serde_json::from_slice(&std::fs::read(out.join("results.json")).expect("a file")).expect("JSON");
    assert_eq!(told, kept);
    let rows = &told["tables"]["tries"]["rows"];
    let row = |at: usize| {
        ["try", "end", "day", "attempts", "exit_code", "selected"].map(|name| rows[at][name].clone())
    };
    assert_eq!(row(0), [json!(1), json!("last day"), json!(14), json!(2), json!(0), json!("yes")]);
    assert_eq!(row(1), [json!(2), json!("not over"), json!(0), json!(3), json!(4), json!("")]);
    assert!(rows[0]["cash"].as_f64().is_some_and(|cash| cash > 0.0), "{told}");
    let log = std::fs::read_to_string(out.join("try-1/output.txt")).expect("a file");
    assert!(log.starts_with("1/1\n") && log.contains("1/2\n"), "{log}");
    for run in shell.runs() {
        assert!(!run.join("server.json").exists());
    }
    shell.agent(&[&words[..], &["--out", &folder]].concat()).fails(2, &["not empty"]);
    let none = shell.home.0.path().join("none");
    let said = shell.agent(&["batch", "--command", "true", "--days", "3", "--out", &none.to_string_lossy()]);
    assert!(said.code != 0 && !none.exists(), "a batch that cannot begin leaves nothing: {}", said.err);
}
