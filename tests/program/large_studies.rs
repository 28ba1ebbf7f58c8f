//! Large laboratory studies. Shards are run by a job scheduler, killed, repeated and merged. Failures are a full disk,
//! an interruption and invalid paths.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use crate::support::home::{Home, run_with_input};

/// A study with 100 short runs.
const STUDY: &str = r#"
name = "small"
policies = ["P0", "P1b"]
seeds = "1..25"
days = 28

[grid]
"demand_surge.probability" = [0.0, 0.01]
"#;

const SHARDS: usize = 4;
/// Number of the shard that the test kills.
const KILLED_SHARD: usize = 3;

fn write_study(home: &Home, text: &str) -> String {
    let path = home.0.path().join("study.toml");
    fs::write(&path, text).expect("a file");
    path.to_string_lossy().into_owned()
}

/// Returns the paths of the files with stored results.
fn result_files(home: &Home) -> Vec<PathBuf> {
    let entries = fs::read_dir(home.runs().join(".lab/studies")).into_iter().flatten().flatten();
    entries.map(|entry| entry.path()).collect()
}

/// Counts the stored runs of a shard or of the unsplit study.
fn count_stored_runs(home: &Home, ending: &str) -> usize {
    let result_file = result_files(home).into_iter().find(|path| path.to_string_lossy().ends_with(ending));
    let bytes = result_file.and_then(|path| fs::read(path).ok()).unwrap_or_default();
    bytes.iter().filter(|byte| **byte == b'\n').count()
}

fn send_signal(name: &str, process: &str) {
    let sent = Command::new("kill").args([name, process]).status().expect("kill");
    assert!(sent.success(), "{name} {process}");
}

/// Waits until a condition is true.
fn wait_for(what: &str, mut is_so: impl FnMut() -> bool) {
    let begun = Instant::now();
    while !is_so() {
        assert!(begun.elapsed() < Duration::from_secs(300), "timed out waiting for {what}");
        std::thread::sleep(Duration::from_millis(2));
    }
}

/// Starts shards with GNU parallel if it is installed, otherwise directly.
struct Scheduler<'a> {
    home: &'a Home,
    file: &'a str,
    out: &'a Path,
    has_parallel: bool,
}

impl Scheduler<'_> {
    fn new<'a>(home: &'a Home, file: &'a str, out: &'a Path) -> Scheduler<'a> {
        let found = Command::new("parallel").arg("--version").output();
        let has_parallel =
            found.is_ok_and(|output| String::from_utf8_lossy(&output.stdout).starts_with("GNU parallel"));
        if !has_parallel {
            eprintln!("SKIPPED: GNU parallel is not installed; this test starts the shards itself");
        }
        Scheduler { home, file, out, has_parallel }
    }

    /// Returns the shell command of a shard, which writes its process ID to a file.
    fn shard_command(&self, shard: &str) -> String {
        let folder = self.home.0.path().display();
        format!(
            "echo $$ > '{folder}/process-{shard}'; exec '{}' lab study '{}' --shard {shard}/{SHARDS} --out '{}' --jobs 1",
            env!("CARGO_BIN_EXE_novamind"),
            self.file,
            self.out.display()
        )
    }

    /// Starts all shards, or only the shards that failed.
    fn start(&self, only_failed: bool) -> Vec<Child> {
        let quiet = |command: &mut Command| {
            command
                .stdin(Stdio::null())
                .stdout(Stdio::null())
                .stderr(Stdio::null())
                .spawn()
                .expect("it starts")
        };
        if !self.has_parallel {
            let shards = (1..=SHARDS).filter(|shard| !only_failed || *shard == KILLED_SHARD);
            let start = |shard: usize| {
                quiet(self.home.command("sh").args(["-c", &self.shard_command(&shard.to_string())]))
            };
            return shards.map(start).collect();
        }
        let log = self.home.0.path().join("log").display().to_string();
        let mut command = self.home.command("parallel");
        command.env("HOME", self.home.0.path()).args(["--will-cite", "--jobs", "4", "--joblog", &log]);
        if only_failed {
            command.arg("--resume-failed");
        }
        command.arg(self.shard_command("{}")).arg(":::").args((1..=SHARDS).map(|shard| shard.to_string()));
        vec![quiet(&mut command)]
    }

    /// Waits for all shards and returns whether all succeeded.
    fn wait(children: Vec<Child>) -> bool {
        let ended = children.into_iter().map(|mut child| child.wait().expect("it ends").success());
        ended.collect::<Vec<bool>>().into_iter().all(|succeeded| succeeded)
    }
}

#[test]
fn merged_shards_equal_the_unsplit_study() {
    let (home, alone) = (Home::new(), Home::new());
    let file = write_study(&home, STUDY);
    let program_output = alone.run(&["lab", "study", &file]);
    assert_eq!(program_output.exit_code, 0, "{}", program_output.stderr);
    assert_eq!(program_output.stdout.lines().count(), 101);

    let out = home.0.path().join("shards");
    let scheduler = Scheduler::new(&home, &file, &out);
    let first = scheduler.start(false);
    let text = format!(".{KILLED_SHARD}-of-{SHARDS}.jsonl");
    wait_for("a run of the shard", || count_stored_runs(&home, &text) > 2);
    let process =
        fs::read_to_string(home.0.path().join(format!("process-{KILLED_SHARD}"))).expect("a number");
    send_signal("-KILL", process.trim());
    assert!(!Scheduler::wait(first), "a killed shard is a failure");
    let before = count_stored_runs(&home, &text);
    assert!((3..25).contains(&before), "killed in the middle: {before}");
    let folder = out.to_string_lossy().into_owned();
    home.run(&["lab", "merge", &folder])
        .assert_fails(1, &["missing: small.3-of-4.csv", "nothing was written"]);

    assert!(Scheduler::wait(scheduler.start(true)), "the shard is played to its end");
    assert_eq!(
        count_stored_runs(&home, &text),
        25 + usize::from(has_incomplete_line(&home, &text)),
        "every run is played once"
    );
    assert_eq!(count_stored_runs(&home, ".1-of-4.jsonl"), 25, "complete shards are not repeated");
    let merged = home.run(&["lab", "merge", &folder]);
    assert_eq!((merged.exit_code, merged.stderr.as_str()), (0, ""));
    assert_eq!(merged.stdout.as_bytes(), program_output.stdout.as_bytes());
    let into = home.0.path().join("small.csv").to_string_lossy().into_owned();
    assert_eq!(home.run(&["lab", "merge", &folder, "--out", &into]).exit_code, 0);
    assert_eq!(fs::read(&into).expect("rows"), program_output.stdout.as_bytes());
}

/// Returns whether the kill truncated a line. A truncated line stays in the file, and its run is played again.
fn has_incomplete_line(home: &Home, ending: &str) -> bool {
    let result_file =
        result_files(home).into_iter().find(|path| path.to_string_lossy().ends_with(ending)).expect("a file");
    let text = fs::read_to_string(result_file).expect("lines");
    text.lines().any(|line| serde_json::from_str::<serde_json::Value>(line).is_err())
}

/// A study with twenty runs.
const SMALL_STUDY: &str = "name = \"few\"\npolicies = [\"P1b\"]\nseeds = \"1..20\"\ndays = 56\n";

#[test]
fn interrupted_study_resumes() {
    let (home, alone) = (Home::new(), Home::new());
    let file = write_study(&home, SMALL_STUDY);
    let program_output = alone.run(&["lab", "study", &file]);
    let mut command = home.program();
    command.args(["lab", "study", &file, "--jobs", "1"]);
    let child = command.spawn().expect("the program starts");
    wait_for("a run", || count_stored_runs(&home, ".jsonl") > 1);
    send_signal("-INT", &child.id().to_string());
    let output = child.wait_with_output().expect("it ends");
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!((output.status.code(), output.stdout.len()), (Some(130), 0), "{text}");
    let done = count_stored_runs(&home, ".jsonl");
    assert!(
        text.contains(&format!("stopped: {done} of 20 runs are stored; repeat the command to resume")),
        "{text}"
    );
    let rest = home.run(&["lab", "study", &file]);
    assert_eq!((rest.exit_code, rest.stdout), (0, program_output.stdout));
    assert_eq!(count_stored_runs(&home, ".jsonl"), 20, "every run is played once");
}

#[test]
fn full_disk_keeps_stored_runs() {
    let (home, alone) = (Home::new(), Home::new());
    let file = write_study(&home, SMALL_STUDY);
    let into = home.0.path().join("few.csv").to_string_lossy().into_owned();
    let whole = alone.run(&["lab", "study", &file]).stdout;
    let program = env!("CARGO_BIN_EXE_novamind");
    // File size limits in blocks of 512 bytes: first sufficient for some of the runs, then for all runs but not for the table.
    let limited = |blocks: usize, more: &str| {
        let script = format!(
            "trap '' XFSZ; ulimit -f {blocks}; exec '{program}' lab study '{file}' --out '{into}' {more}"
        );
        run_with_input(home.command("sh").args(["-c", &script]), "")
    };
    limited(8, "--jobs 1").assert_fails(1, &["few.", ".jsonl", "File too large", "are safe"]);
    let before = count_stored_runs(&home, ".jsonl");
    assert!((1..20).contains(&before), "{before}");
    let last = fs::read(&result_files(&home)[0]).expect("runs");
    assert!(last.ends_with(b"\n"), "a partial line is removed");
    assert_eq!(home.run(&["lab", "study", &file]).stdout, whole, "there is space again");
    assert_eq!(count_stored_runs(&home, ".jsonl"), 20);
    limited(1, "").assert_fails(1, &["few.csv", "File too large", "runs are saved"]);
    assert!(!Path::new(&into).exists(), "no partial table is written");
    let program_output = home.run(&["lab", "study", &file, "--out", &into]);
    assert_eq!(program_output.exit_code, 0, "{}", program_output.stderr);
    assert_eq!(fs::read_to_string(&into).expect("rows"), whole);
    assert!(
        program_output.stdout.contains("few: 1 arm by 20 seeds") && program_output.stdout.contains("P1b"),
        "{}",
        program_output.stdout
    );
    assert!(
        program_output.stdout.lines().all(|line| line.chars().count() <= 100),
        "{}",
        program_output.stdout
    );
}

#[test]
fn unwritable_outputs_are_reported_before_playing() {
    let home = Home::new();
    let file = write_study(&home, SMALL_STUDY);
    let inside = format!("{file}/shards");
    home.run(&["lab", "study", &file, "--shard", "1/2", "--out", &inside])
        .assert_fails(1, &["study.toml/shards"]);
    assert_eq!(count_stored_runs(&home, ".jsonl"), 0);
    let wrong = home.run(&["lab", "study", &file, "--shard", "3/2", "--out", "x"]);
    assert!(wrong.exit_code == 2 && wrong.stderr.contains("3/2 is not a shard"), "{}", wrong.stderr);
    fs::write(home.runs().join(".lab"), "a file").expect("a file");
    home.run(&["lab", "study", &file]).assert_fails(1, &[".lab"]);
    let wrong = write_study(&home, "name = \"x\"\npolicies = [\"P0\"]\nseeds = 1\nday = 4\n");
    home.run(&["lab", "study", &wrong]).assert_fails(3, &["study.toml, line 4", "day"]);
}

#[test]
fn daily_study_has_a_row_per_run_and_day() {
    let home = Home::new();
    let file = write_study(&home, "name = \"d\"\npolicies = [\"P0\", \"P1b\"]\nseeds = [3, 9]\ndays = 14\n");
    let check = home.run(&["lab", "study", &file, "--check"]);
    assert_eq!((check.exit_code, check.stdout.as_str()), (0, "d: 2 arms by 2 seeds, 4 runs\n"));
    let daily = home.run(&["lab", "study", &file, "--daily"]);
    assert_eq!(daily.exit_code, 0, "{}", daily.stderr);
    let lines: Vec<&str> = daily.stdout.lines().collect();
    assert_eq!(lines.len(), 1 + 4 * 14);
    assert!(lines[0].starts_with("run,policy,scenario,seed,day,cash,mrr,subscribers"), "{}", lines[0]);
    let ends = home.run(&["lab", "study", &file]).stdout;
    let cell = |line: &str, name: &str, head: &str| {
        let at = head.split(',').position(|text| text == name).expect("a column");
        line.split(',').nth(at).expect("a cell").to_owned()
    };
    let head = ends.lines().next().expect("a head");
    for (at, end) in ends.lines().skip(1).enumerate() {
        let last = lines[14 * (at + 1)];
        for name in ["run", "policy", "seed", "day", "cash", "subscribers", "seats", "mrr"] {
            assert_eq!(cell(last, name, lines[0]), cell(end, name, head), "{name} of {end}");
        }
    }
}

#[test]
fn output_never_replaces_input() {
    let home = Home::new();
    let text = "name = \"s\"\npolicies = [\"P0\"]\nseeds = [1, 2]\ndays = 14\n";
    let file = write_study(&home, text);
    let place = |name: &str| home.0.path().join(name).to_string_lossy().into_owned();
    let twice = place("./rows");
    for (places, part) in [
        (&["--out", &file][..], "would be overwritten"),
        (&["--svg", &file], "would be overwritten"),
        (&["--out", &place("rows"), "--svg", &twice], "name the same file"),
    ] {
        home.run(&[&["lab", "study", &file], places].concat()).assert_fails(2, &[part]);
    }
    assert_eq!(fs::read_to_string(&file).expect("the study"), text);
    let folder = place("shards");
    for shard in ["1/2", "2/2"] {
        let program_output = home.run(&["lab", "study", &file, "--shard", shard, "--out", &folder]);
        assert_eq!(program_output.exit_code, 0, "{}", program_output.stderr);
    }
    let shard = place("shards/s.1-of-2.csv");
    home.run(&["lab", "merge", &folder, "--out", &shard]).assert_fails(2, &["is one of the shards"]);
    let output = home.run(&["lab", "merge", &folder]);
    assert_eq!((output.exit_code, output.stdout.lines().count()), (0, 3), "{}", output.stderr);
}
