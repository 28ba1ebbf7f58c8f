//! Python scripts in the built program. Without python3, scripts are rejected, but recorded results are still used.

use std::process::Command;

use crate::support::home::{Home, ProgramOutput, run_with_input};

/// Runs the program without python3 on the path.
fn run_without_python(home: &Home, arguments: &[&str], lines: &str) -> ProgramOutput {
    run_with_input(home.program().env("PATH", home.runs()).args(arguments), lines)
}

#[test]
fn only_python_scripts_require_python() {
    let home = Home::new();
    let lines = r##"python_exec {"code": "# python\nprint(1)"}
python_exec {"code": "SELECT 5 AS x"}
register_daily_calculation {"name": "day", "code": "# python\nprint(get_vars())"}
next naive
"##;
    let program_output = run_without_python(&home, &["play", "--plain", "--days", "28"], lines);
    assert_eq!(program_output.exit_code, 0, "{}", program_output.stderr);
    assert!(
        program_output
            .stdout
            .contains("refused script_failed (code): python3 is not on the PATH of this machine"),
        "{}",
        program_output.stdout
    );
    assert!(program_output.stdout.contains("ok python_exec\nx\n5\n"), "{}", program_output.stdout);
    assert!(
        program_output.stdout.contains("day:\n  failed: python3 is not on the PATH"),
        "{}",
        program_output.stdout
    );
}

#[cfg(unix)]
#[test]
fn path_selects_python_only_in_sandbox_runs() {
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
        run_with_input(&mut program, "python_exec {\"code\": \"# python\\nprint(6 * 7)\"}\nquit\n")
    };
    let sandbox = play(&["--days", "28"]);
    assert!(sandbox.stdout.contains("chosen by PATH"), "{}{}", sandbox.stdout, sandbox.stderr);
    let baseline = play(&["--mode", "baseline", "--participant", "P01"]);
    assert!(!baseline.stdout.contains("chosen by PATH"), "{}", baseline.stdout);
    let answered = baseline.stdout.contains("ok python_exec\n42\n");
    let refused = baseline.stdout.contains("a baseline run does not search PATH for python3");
    assert!(answered != refused, "{}{}", baseline.stdout, baseline.stderr);
}

#[test]
fn recorded_scripts_replay_without_python() {
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
    let program_output = home.play(&["--seed", "7", "--days", "28"], lines);
    assert!(
        program_output.stdout.contains("asked [{'x': 1}]") && program_output.stdout.contains("clock:\n  at "),
        "{}",
        program_output.stdout
    );
    let id = home.only_run().file_name().expect("a name").to_string_lossy().into_owned();
    let verified = home.run(&["replay", &id, "--verify"]);
    let without = run_without_python(&home, &["replay", &id, "--verify"], "");
    assert_eq!(
        (verified.exit_code, verified.stdout.as_str()),
        (0, without.stdout.as_str()),
        "{}",
        without.stderr
    );
    assert!(verified.stdout.contains("2 states verified"), "{}", verified.stdout);
    // A simulation from the first line reproduces the dashboard that was shown.
    std::fs::remove_file(home.only_run().join("snapshot.bin")).ok();
    let opened = run_without_python(&home, &["play", "--plain", "--run", &id], "dashboard\n");
    assert_eq!(opened.exit_code, 0, "{}", opened.stderr);
    let line = |text: &str| text.lines().rev().find(|line| line.starts_with("  at ")).map(str::to_owned);
    assert_eq!(line(&opened.stdout), line(&program_output.stdout), "{}", opened.stdout);
    assert!(
        opened.stdout.contains("Calculations in Python run before each week: clock."),
        "{}",
        opened.stdout
    );
}
