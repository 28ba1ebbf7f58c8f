//! A host with sessions in pseudoterminals: play, take-over, kills of the session and of the host, and rejections.

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use super::pty::Terminal;

/// A running host.
struct Host {
    process: Child,
    study: PathBuf,
}

/// Creates a study with a session of four weeks and two participants.
fn create_study(folder: &Path) -> PathBuf {
    let study = folder.join("pilot");
    std::fs::create_dir(&study).expect("a folder");
    let write = |name: &str, text: &str| std::fs::write(study.join(name), text).expect("written");
    write(
        "study.toml",
        "name = \"pilot\"\ntitle = \"Running a company\"\n[world]\ndays = 28\n[seeds]\nplan = \"secret\"\ncount = 2\n\
         [practice]\noffer = \"none\"\n",
    );
    program(&["study", "assign", &text(&study), "--participants", "2"]);
    study
}

fn text(path: &Path) -> String {
    path.to_str().expect("text").to_owned()
}

/// Runs the program, which has to succeed. Returns its output.
fn program(arguments: &[&str]) -> String {
    let output =
        Command::new(env!("CARGO_BIN_EXE_novamind")).args(arguments).output().expect("the program runs");
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("text")
}

impl Host {
    fn start(study: &Path) -> Host {
        let mut command = Command::new(env!("CARGO_BIN_EXE_novamind"));
        command.args(["host", "--study", &text(study), "--listen", "127.0.0.1:0"]).stdout(Stdio::null());
        let process = command.spawn().expect("the host starts");
        let host = Host { process, study: study.to_owned() };
        wait_until("a socket", || std::os::unix::net::UnixStream::connect(host.socket()).is_ok());
        host
    }

    fn socket(&self) -> PathBuf {
        self.study.join("host/host.sock")
    }

    fn attach(&self, label: &str, size: (u16, u16)) -> Terminal {
        Terminal::start(&self.study, &["host", "attach", label, "--socket", &text(&self.socket())], size)
    }

    fn signal(&self, signal: &str) {
        let sent = Command::new("kill").args([signal, &self.process.id().to_string()]).status();
        assert!(sent.expect("kill runs").success());
    }

    /// Returns the process of a session.
    fn session_process(&self, label: &str) -> String {
        let parent = self.process.id().to_string();
        let listed =
            Command::new("ps").args(["-o", "pid=,args=", "--ppid", &parent]).output().expect("ps runs");
        let listed = String::from_utf8(listed.stdout).expect("text");
        let line = listed.lines().find(|line| line.contains(&format!(" {label} ")));
        let line = line.unwrap_or_else(|| panic!("no session of {label} in:\n{listed}"));
        line.split_whitespace().next().expect("a number").to_owned()
    }

    fn audit_lines(&self) -> String {
        std::fs::read_to_string(self.study.join("host/audit.jsonl")).expect("a log")
    }
}

impl Drop for Host {
    fn drop(&mut self) {
        let _ = self.process.kill().and_then(|()| self.process.wait());
    }
}

fn wait_until(what: &str, holds: impl Fn() -> bool) {
    let deadline = Instant::now() + Duration::from_secs(60);
    while !holds() {
        assert!(Instant::now() < deadline, "waiting for {what} in vain");
        std::thread::sleep(Duration::from_millis(10));
    }
}

/// Plays a week with a rationale and naive forecasts.
fn play_week(terminal: &mut Terminal, week: u32) {
    terminal.type_keys("n");
    terminal.wait_for("[1 review]");
    terminal.type_keys("\rbecause\r");
    terminal.wait_for("[3 forecasts]");
    terminal.type_keys("f\r");
    terminal.wait_for(&format!("Week {week} · day {}", 7 * week));
    terminal.type_keys("\r");
    terminal.wait_for(&format!("day {}/28", 7 * week));
}

#[test]
fn participant_plays_through_kills_of_the_session_and_the_host() {
    let folder = tempfile::tempdir().expect("a folder");
    let study = create_study(folder.path());
    let host = Host::start(&study);
    let mut terminal = host.attach("P01", (120, 40));
    terminal.wait_for("enter starts");
    terminal.type_keys("\r");
    terminal.wait_for("day 0/28");
    play_week(&mut terminal, 1);
    // The host restarts a killed process.
    let killed = Command::new("kill").args(["-9", &host.session_process("P01")]).status().expect("kill runs");
    assert!(killed.success());
    terminal.wait_for("restarted");
    terminal.wait_for("day 7/28");
    play_week(&mut terminal, 2);
    let session = host.session_process("P01");
    host.signal("-KILL");
    let (code, screen) = terminal.wait_for_end();
    assert!(code == 1 && screen.contains("the connection to the host failed"), "{code}: {screen}");
    // The kernel closes the terminal of the session, which then saves.
    let command_line = format!("/proc/{session}/cmdline");
    wait_until("the end of the session", || !std::fs::read(&command_line).is_ok_and(|line| !line.is_empty()));
    drop(host);
    let host = Host::start(&study);
    let mut terminal = host.attach("P01", (80, 24));
    terminal.wait_for("day 14/28");
    host.signal("-TERM");
    let (code, screen) = terminal.wait_for_end();
    assert!(code == 0 && screen.contains("The host is shutting down"), "{code}: {screen}");
    wait_until("the end of the host", || host.audit_lines().ends_with("\"event\":\"host_stopped\"}\n"));
    let runs = text(&study.join("host/sessions/P01/runs"));
    let watched = program(&["study", "watch", &text(&study), &runs, "--json"]);
    assert!(watched.contains("\"state\":\"left\"") && watched.contains("\"day\":14"), "{watched}");
}

#[test]
fn second_terminal_takes_over_and_labels_are_checked() {
    let folder = tempfile::tempdir().expect("a folder");
    let study = create_study(folder.path());
    let host = Host::start(&study);
    let mut first = host.attach("P02", (80, 24));
    first.wait_for("Running a company");
    let mut second = host.attach("P02", (100, 30));
    second.wait_for("Running a company");
    let (code, screen) = first.wait_for_end();
    assert!(code == 0 && screen.contains("opened in another window"), "{code}: {screen}");
    for label in ["P03", "../P01"] {
        let (code, screen) = host.attach(label, (80, 24)).wait_for_end();
        assert!(code == 1 && screen.contains("this label is not in the study"), "{code}: {screen}");
    }
    let output = Command::new(env!("CARGO_BIN_EXE_novamind"))
        .args(["host", "attach", "P01", "--socket", &text(&host.socket())])
        .stdin(Stdio::null())
        .output()
        .expect("the program runs");
    assert!(String::from_utf8_lossy(&output.stderr).contains("needs a terminal"));
    // A window that is too small asks for a larger one.
    let mut small = host.attach("P01", (50, 12));
    small.wait_for("Enlarge the window to 60 x 16 (now 50 x 12)");
    small.resize(80, 24);
    small.wait_for("Running a company");
}

#[test]
fn host_folder_reveals_no_secret_in_links_and_settings() {
    let folder = tempfile::tempdir().expect("a folder");
    let study = create_study(folder.path());
    let file = folder.path().join("links.csv");
    program(&["host", "links", &text(&study), "--csv", &text(&file), "--url", "https://play.example.org/"]);
    let links = std::fs::read_to_string(&file).expect("a file");
    let assignment = std::fs::read_to_string(study.join("assignment.csv")).expect("a file");
    let seeds: Vec<&str> = assignment.lines().skip(1).filter_map(|line| line.split(',').nth(2)).collect();
    assert_eq!(seeds.len(), 2);
    assert!(seeds.iter().all(|seed| !links.contains(seed)), "{links}");
    assert!(links.lines().nth(1).expect("a row").starts_with("P01,https://play.example.org/s/"), "{links}");
    let again = Command::new(env!("CARGO_BIN_EXE_novamind"))
        .args(["host", "links", &text(&study), "--csv", &text(&folder.path().join("again.csv"))])
        .output()
        .expect("the program runs");
    assert!(String::from_utf8_lossy(&again.stderr).contains("all participants have links"));
    let protocol = program(&["study", "protocol", &text(&study)]);
    assert!(protocol.contains("2 secret seeds") && protocol.contains("pilot:"), "{protocol}");
    assert!(seeds.iter().all(|seed| !protocol.contains(seed)));
}
