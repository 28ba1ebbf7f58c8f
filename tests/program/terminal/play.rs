//! Tasks of a user in a pseudoterminal: weeks, SQL, enterprises, mouse and clipboard.

use super::pty::{Terminal, play_policy};

#[test]
fn user_plays_two_weeks_leaves_and_resumes() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut terminal = Terminal::start(runs.path(), &[], (120, 40));
    terminal.wait_for("New run");
    terminal.type_keys("n");
    terminal.wait_for("Start the run (enter)");
    terminal.type_keys("\r");
    terminal.wait_for("day 0/500");
    terminal.type_keys("8\r\r12\t25\t55\r");
    terminal.wait_for("pricing.set_prices");
    terminal.type_keys("\x13");
    terminal.wait_for("set_prices: done");
    for (week, day) in [(1, 7), (2, 14)] {
        terminal.type_keys("n");
        terminal.wait_for("[1 review]");
        terminal.type_keys("\rbecause\r");
        terminal.wait_for("[3 forecasts]");
        terminal.type_keys("f\r");
        terminal.wait_for(&format!("Week {week} · day {day}"));
        terminal.type_keys("\r");
    }
    terminal.wait_for("day 14/500");
    terminal.type_keys("q");
    let (code, screen) = terminal.wait_for_end();
    assert_eq!(code, 0);
    assert!(screen.contains("is saved at day 14"), "{screen}");
    let mut terminal = Terminal::start(runs.path(), &["--run", "latest"], (80, 24));
    terminal.wait_for("day 14/500");
    terminal.type_keys("\x03");
    assert_eq!(terminal.wait_for_end().0, 0);
}

#[test]
fn first_run_starts_the_tour() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut terminal = Terminal::start(runs.path(), &[], (80, 24));
    terminal.wait_for("New here?");
    terminal.type_keys("\r");
    terminal.wait_for("Tour · 1 of 15");
    // F3 continues.
    terminal.type_keys("\x1bOR");
    terminal.wait_for("Tour · 2 of 15");
    terminal.type_keys(";v");
    terminal.wait_for("Participation curve");
    terminal.wait_for("f3 continue");
    terminal.type_keys("\x1bOR");
    terminal.wait_for("Tour · 3 of 15");
    terminal.type_keys("\x1b");
    terminal.wait_until_gone("Participation curve");
    terminal.type_keys("3");
    terminal.wait_for("open the group");
    terminal.type_keys("\r\t");
    terminal.wait_for("f3 continue");
    terminal.type_keys("\x1bOR");
    terminal.wait_for("Tour · 4 of 15");
    for (tool, value, next_step) in [
        ("set_prices", "9", 5),
        ("set_model_tiers", "3", 6),
        ("set_usage_quotas", "400", 7),
        ("set_targeted_ad_spend", "500", 8),
    ] {
        terminal.type_keys(&format!(":{tool}\r"));
        terminal.wait_for(&format!("{tool} · "));
        terminal.type_keys(&format!("\r{value}\r\x13"));
        terminal.wait_for(&format!("Tour · {next_step} of 15"));
    }
    terminal.type_keys("n\rcurious\r");
    terminal.wait_for("[3 forecasts]");
    terminal.type_keys("f\r");
    terminal.wait_for("Tour · 9 of 15");
    // Types F4, which closes the tour.
    terminal.type_keys("\x1bOS");
    terminal.wait_until_gone("Tour ·");
    terminal.type_keys("\x03");
    let (code, screen) = terminal.wait_for_end();
    assert_eq!(code, 0, "{screen}");
}

#[test]
fn sql_statement_is_completed_and_run_and_a_slow_statement_is_cancelled() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut terminal = Terminal::start(runs.path(), &["--new", "--seed", "5"], (120, 40));
    terminal.wait_for("day 0/500");
    terminal.type_keys("9");
    terminal.wait_for("Query");
    terminal.type_keys("iSELECT count(*) AS plans FROM rese");
    terminal.wait_for("FROM rese");
    terminal.type_keys("\t");
    terminal.wait_for("FROM research_projects");
    // Types F5, which runs the statement.
    terminal.type_keys("\x1b[15~");
    terminal.wait_for("Result · 1 row");
    terminal.wait_for("plans");
    // Pasted text is inserted completely, including line ends, and the statement is not run.
    let slow = "WITH RECURSIVE n(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM n)\nSELECT count(*) FROM n";
    terminal.type_keys("\x0e");
    terminal.wait_until_gone("FROM research_projects");
    terminal.type_keys(&format!("\x1b[200~{slow}\x1b[201~"));
    terminal.wait_for("SELECT count(*) FROM n");
    terminal.type_keys("\x1b[15~");
    terminal.wait_for("esc cancels");
    terminal.type_keys("\x1b");
    terminal.wait_for("the query was cancelled");
    terminal.wait_for("SELECT count(*) FROM n");
    terminal.type_keys("\x03");
    assert_eq!(terminal.wait_for_end().0, 0);
}

#[test]
fn one_rule_answers_many_enterprises() {
    let runs = tempfile::tempdir().expect("a folder");
    play_policy(runs.path(), &["--policy", "P10", "--seed", "3", "--until", "35"]);
    let mut terminal = Terminal::start(runs.path(), &["--run", "latest"], (120, 40));
    terminal.wait_for("day 35/500");
    terminal.type_keys("6");
    terminal.wait_for("waiting for you");
    terminal.type_keys("a");
    terminal.wait_for("marked");
    terminal.type_keys("\x13");
    terminal.wait_for("y yes");
    terminal.type_keys("y");
    terminal.wait_for("0 waiting for you");
    terminal.type_keys("q");
    let (code, screen) = terminal.wait_for_end();
    assert_eq!(code, 0, "{screen}");
}

#[test]
fn mouse_can_be_disabled() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut terminal = Terminal::start(runs.path(), &["--new"], (120, 40));
    terminal.wait_for("day 0/500");
    // A click on a name in the second line opens the screen of this name.
    let tabs = terminal.contents().lines().nth(1).expect("a second line").to_owned();
    let column = tabs.find("8 Tools").expect("a tab") + 1;
    terminal.type_keys(&format!("\x1b[<0;{};2M\x1b[<0;{};2m", column + 2, column + 2));
    terminal.wait_for("set_prices");
    terminal.type_keys(";");
    terminal.wait_for("esc cancel");
    terminal.type_keys("m");
    terminal.wait_for("mouse off");
    terminal.wait_for_bytes(b"\x1b[?1000l");
    terminal.type_keys(";m");
    terminal.wait_for("shift-drag");
    terminal.type_keys("q");
    assert_eq!(terminal.wait_for_end().0, 0);
}

#[test]
fn tool_call_is_copied_through_the_terminal() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut terminal = Terminal::start(runs.path(), &["--new"], (120, 40));
    terminal.wait_for("day 0/500");
    terminal.type_keys("8\r\r12\t25\t55\r");
    terminal.wait_for("pricing.set_prices");
    terminal.type_keys("y");
    terminal.wait_for("copied");
    terminal.wait_for_bytes(b"\x1b]52;c;");
    terminal.type_keys("\x03y");
    assert_eq!(terminal.wait_for_end().0, 0);
}

#[test]
fn replay_can_continue_as_a_branch() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut terminal = Terminal::start(runs.path(), &["--new", "--days", "28"], (120, 40));
    terminal.wait_for("day 0/28");
    for (week, day) in [(1, 7), (2, 14)] {
        terminal.type_keys("n");
        terminal.wait_for("[1 review]");
        terminal.type_keys("\rbecause\r");
        terminal.wait_for("[3 forecasts]");
        terminal.type_keys("f\r");
        terminal.wait_for(&format!("Week {week} · day {day}"));
        terminal.type_keys("\r");
    }
    terminal.type_keys("q");
    assert_eq!(terminal.wait_for_end().0, 0);
    let mut terminal = Terminal::start(runs.path(), &["replay", "latest"], (120, 40));
    terminal.wait_for("week 0/2");
    terminal.type_keys("FFFF ");
    terminal.wait_for("week 2/2");
    terminal.wait_for("end of the record");
    terminal.type_keys("#1\r");
    terminal.wait_for("week 1/2");
    terminal.type_keys("T");
    terminal.wait_for("on day 7 before week 2");
    terminal.type_keys("\r");
    terminal.wait_for("SANDBOX");
    terminal.type_keys("q");
    let (code, screen) = terminal.wait_for_end();
    assert_eq!(code, 0);
    assert!(screen.contains("is saved at day 7"), "{screen}");
}

#[test]
fn participant_sees_only_the_study() {
    let place = tempfile::tempdir().expect("a folder");
    let folder = place.path().join("pilot");
    let made = std::process::Command::new(env!("CARGO_BIN_EXE_novamind"))
        .args(["study", "new"])
        .arg(&folder)
        .output()
        .expect("it starts");
    assert!(made.status.success());
    let protocol = std::fs::read_to_string(folder.join("study.toml")).expect("a protocol");
    let code = novamind::study::CodeDigest::from_code("open", "salt");
    let protocol = protocol.replace("# code = \"…\"", &format!("code = \"{}\"", code.as_str()));
    std::fs::write(folder.join("study.toml"), protocol).expect("written");
    let study = folder.display().to_string();
    let mut terminal = Terminal::start(&place.path().join("runs"), &["--study", &study], (80, 24));
    terminal.wait_for("Type the label");
    terminal.type_keys("\x05guess\r");
    terminal.wait_for("this is not the experimenter's code");
    terminal.type_keys("\x15open\r");
    terminal.wait_for("New run");
    terminal.type_keys("\x03");
    assert_eq!(terminal.wait_for_end().0, 0);
}
