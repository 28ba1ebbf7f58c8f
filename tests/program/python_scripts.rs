//! Python scripts through the built program: without python3 they are rejected, and recorded answers are still used.

use std::process::Command;

use crate::support::home::{Home, Said, said};

/// Runs the program without python3 on the path.
fn without_python(home: &Home, arguments: &[&str], lines: &str) -> Said {
    said(home.program().env("PATH", home.runs()).args(arguments), lines)
}

#[test]
fn without_python_scripts_are_refused_and_statements_answered() {
    let home = Home::new();
    let lines = r##"python_exec {"code": "# python\nprint(1)"}
python_exec {"code": "SELECT 5 AS x"}
register_daily_calculation {"name": "day", "code": "# python\nprint(get_vars())"}
next naive
"##;
    let told = without_python(&home, &["play", "--plain", "--days", "28"], lines);
    assert_eq!(told.code, 0, "{}", told.err);
    assert!(
        told.out.contains("refused script_failed (code): python3 is not on the path of this machine"),
        "{}",
        told.out
    );
    assert!(told.out.contains("ok python_exec\nx\n5\n"), "{}", told.out);
    assert!(told.out.contains("day:\n  failed: python3 is not on the path"), "{}", told.out);
}

#[cfg(unix)]
#[test]
fn path_chooses_the_python_of_sandbox_runs_only() {
    use std::os::unix::fs::PermissionsExt;
    let home = Home::new();
    let tools = home.0.path().join("tools");
    std::fs::create_dir(&tools).expect("a folder");
    let fake = tools.join("python3");
    std::fs::write(&fake, "#!/bin/sh\necho chosen by PATH\n").expect("written");
    std::fs::set_permissions(&fake, std::fs::Permissions::from_mode(0o755)).expect("permissions");
    let play = |options: &[&str]| {
        let mut program = home.program();
        program.env("PATH", &tools).args(["play", "--plain"]).args(options);
        said(&mut program, "python_exec {\"code\": \"# python\\nprint(6 * 7)\"}\nquit\n")
    };
    let sandbox = play(&["--days", "28"]);
    assert!(sandbox.out.contains("chosen by PATH"), "{}{}", sandbox.out, sandbox.err);
    let baseline = play(&["--mode", "baseline", "--participant", "P01"]);
    assert!(!baseline.out.contains("chosen by PATH"), "{}", baseline.out);
    let answered = baseline.out.contains("ok python_exec\n42\n");
    let refused = baseline.out.contains("a baseline run does not search PATH for python3");
    assert!(answered != refused, "{}{}", baseline.out, baseline.err);
}

#[test]
fn what_was_recorded_with_python_is_read_without_it() {
    let tried = Command::new("python3").args(["-c", ""]).output();
    if !tried.is_ok_and(|done| done.status.success()) {
        return;
    }
    let home = Home::new();
    let lines = r##"python_exec {"code": "# python\nimport time\nprint('asked', query('SELECT 1 AS x'), time.time_ns())"}
register_daily_calculation {"name": "clock", "code": "# python\nimport time\nprint('at', time.time_ns())"}
next naive
set_prices A=12
next naive
"##;
    let told = home.play(&["--seed", "7", "--days", "28"], lines);
    assert!(told.out.contains("asked [{'x': 1}]") && told.out.contains("clock:\n  at "), "{}", told.out);
    let id = home.only_run().file_name().expect("a name").to_string_lossy().into_owned();
    let verified = home.run(&["replay", &id, "--verify"]);
    let without = without_python(&home, &["replay", &id, "--verify"], "");
    assert_eq!((verified.code, verified.out.as_str()), (0, without.out.as_str()), "{}", without.err);
    assert!(verified.out.contains("2 states verified"), "{}", verified.out);
    // Simulated from the first line, the dashboard is the one that was shown.
    std::fs::remove_file(home.only_run().join("snapshot.bin")).ok();
    let opened = without_python(&home, &["play", "--plain", "--run", &id], "dashboard\n");
    assert_eq!(opened.code, 0, "{}", opened.err);
    let line = |text: &str| text.lines().rev().find(|line| line.starts_with("  at ")).map(str::to_owned);
    assert_eq!(line(&opened.out), line(&told.out), "{}", opened.out);
    assert!(opened.out.contains("Calculations in Python run before each week: clock."), "{}", opened.out);
}
