//! The console in small windows, after signals and failures, and in terminals without colors.

use super::pty::Terminal;

#[test]
fn small_window_shows_a_message_until_enlarged() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut terminal = Terminal::start(runs.path(), &["--new", "--seed", "1"], (40, 5));
    terminal.wait_for("NovaMind needs 60×16");
    terminal.resize(100, 30);
    terminal.wait_for("Action needed");
    terminal.resize(20, 5);
    terminal.wait_for("NovaMind needs 60×");
    terminal.type_keys("q");
    assert_eq!(terminal.wait_for_end().0, 0);
}

#[test]
fn termination_restores_the_terminal_and_keeps_the_run() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut terminal = Terminal::start(runs.path(), &["--new"], (100, 30));
    terminal.wait_for("day 0/500");
    terminal.signal("-TERM");
    let (code, screen) = terminal.wait_for_end();
    assert_eq!(code, 128 + 15);
    assert!(screen.contains("is saved at day 0"), "{screen}");
}

#[test]
fn suspended_program_restores_the_terminal() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut terminal = Terminal::start(runs.path(), &["--new"], (100, 30));
    terminal.wait_for("Action needed");
    assert!(terminal.is_raw());
    for _ in 0..2 {
        terminal.signal("-TSTP");
        terminal.wait_until_stopped();
        assert!(!terminal.is_raw(), "the terminal accepts input again");
        terminal.wait_for_bytes(b"\x1b[?1049l");
        terminal.signal("-CONT");
        terminal.wait_for("Action needed");
        terminal.wait_until_raw();
    }
    // While the program is stopped, another program can leave the terminal in any state.
    terminal.signal("-STOP");
    terminal.wait_until_stopped();
    terminal.set_canonical_mode();
    terminal.signal("-CONT");
    terminal.wait_until_raw();
    terminal.type_keys("8");
    terminal.wait_for("set_prices");
    terminal.type_keys("q");
    assert_eq!(terminal.wait_for_end().0, 0);
}

#[cfg(target_os = "linux")]
#[test]
fn full_disk_message_disappears_once_saved() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut terminal = Terminal::start(runs.path(), &["--new"], (120, 40));
    terminal.wait_for("Action needed");
    let entries = std::fs::read_dir(runs.path()).expect("a folder").flatten().map(|entry| entry.path());
    let run = entries.into_iter().find(|path| path.is_dir()).expect("a run");
    let written = std::fs::metadata(run.join("world.db-wal")).expect("a database").len();
    terminal.limit_file_size(&written.to_string());
    terminal.type_keys("n");
    terminal.wait_for("[1 review]");
    terminal.type_keys("\rbecause\r");
    terminal.wait_for("[3 forecasts]");
    terminal.type_keys("f\r");
    terminal.wait_for("Week 1 · day 7");
    terminal.wait_for("The database is behind");
    terminal.type_keys("\r3");
    terminal.wait_for("stale");
    terminal.limit_file_size("unlimited");
    terminal.wait_for("up to date again");
    terminal.wait_until_gone("The database is behind");
    terminal.type_keys("q");
    assert_eq!(terminal.wait_for_end().0, 0);
}

#[test]
fn screen_is_redrawn_on_request() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut terminal = Terminal::start(runs.path(), &["--new"], (100, 30));
    terminal.wait_for("Action needed");
    terminal.clear_screen();
    terminal.type_keys("\x0c");
    terminal.wait_for("Action needed");
    terminal.type_keys("q");
    assert_eq!(terminal.wait_for_end().0, 0);
}

#[test]
fn exit_message_names_the_resume_command() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut terminal = Terminal::start(runs.path(), &["--as", "P01", "--new"], (120, 30));
    terminal.wait_for("Action needed");
    terminal.type_keys("q");
    let (code, screen) = terminal.wait_for_end();
    assert_eq!(code, 0);
    assert!(screen.contains("Resume the run with `novamind --as P01 --run latest`"), "{screen}");
    let mut terminal = Terminal::start(runs.path(), &["--as", "P01", "--run", "latest"], (120, 30));
    terminal.wait_for("day 0/500");
    terminal.type_keys("q");
    assert_eq!(terminal.wait_for_end().0, 0);
}

#[test]
fn preferences_persist() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut terminal = Terminal::start(runs.path(), &["--new"], (100, 30));
    terminal.wait_for("Action needed");
    assert!(!terminal.contents().is_ascii());
    terminal.type_keys(";c");
    terminal.wait_for("theme: high-contrast");
    terminal.type_keys(";d");
    terminal.wait_for("charts use blocks");
    terminal.type_keys(";d");
    terminal.wait_for("use ASCII characters");
    let chosen = runs.path().join("no-configuration/console.toml");
    let is_kept = || std::fs::read_to_string(&chosen).is_ok_and(|text| text.contains("ascii"));
    terminal.wait_until_true("the choice is kept", is_kept);
    terminal.type_keys("q");
    assert_eq!(terminal.wait_for_end().0, 0);
    assert!(std::fs::read_to_string(&chosen).expect("a file").contains("high-contrast"));
    let mut terminal = Terminal::start(runs.path(), &["--run", "latest"], (100, 30));
    terminal.wait_for("Action needed");
    assert!(terminal.contents().is_ascii(), "{}", terminal.contents());
    terminal.type_keys("q");
    assert_eq!(terminal.wait_for_end().0, 0);
}

#[test]
fn invalid_theme_or_key_file_is_reported_before_startup() {
    let runs = tempfile::tempdir().expect("a folder");
    let (code, screen) = Terminal::start(runs.path(), &["--theme", "pink"], (100, 30)).wait_for_end();
    assert_eq!(code, 2);
    assert!(screen.contains("there is no theme pink"), "{screen}");
    let configuration = runs.path().join("no-configuration");
    std::fs::create_dir(&configuration).expect("a folder");
    std::fs::write(configuration.join("keys.toml"), "[global]\nquit = [\"hyper\"]").expect("written");
    let (code, screen) = Terminal::start(runs.path(), &[], (100, 30)).wait_for_end();
    assert_eq!(code, 3);
    assert!(screen.contains("keys.toml") && screen.contains("is not a key"), "{screen}");
}

#[test]
fn ascii_and_no_color_options_are_applied() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut terminal = Terminal::start(runs.path(), &["--ascii", "--theme", "mono", "--new"], (100, 30));
    terminal.wait_for("day 0/500");
    terminal.wait_for("Action needed");
    let contents = terminal.contents();
    assert!(contents.is_ascii(), "{contents}");
    terminal.type_keys("q");
    assert_eq!(terminal.wait_for_end().0, 0);
}

#[test]
fn no_color_writes_no_color_sequences() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut terminal = Terminal::start_with(
        runs.path(),
        &["--new"],
        (100, 30),
        &[("NO_COLOR", "1"), ("COLORTERM", "truecolor")],
    );
    terminal.wait_for("day 0/500");
    terminal.wait_for("Action needed");
    let colours = sgr_sequences(terminal.written()).into_iter().filter(|parameters| sets_color(parameters));
    assert_eq!(colours.collect::<Vec<_>>(), Vec::<String>::new());
    terminal.type_keys("q");
    assert_eq!(terminal.wait_for_end().0, 0);
}

/// Returns the parameters of sequences that set the text style: `38;5;6` of `ESC [ 38;5;6 m`.
fn sgr_sequences(written: &[u8]) -> Vec<String> {
    let text = String::from_utf8_lossy(written);
    let parts = text.split("\x1b[").skip(1);
    let looks = |part: &str| {
        let end = part.find(|letter: char| !letter.is_ascii_digit() && letter != ';')?;
        part[end..].starts_with('m').then(|| part[..end].to_owned())
    };
    parts.filter_map(looks).collect()
}

/// 39 and 49 select the default colors of the terminal; all other numbers from 30 to 49 and from 90 on are colors.
fn sets_color(parameters: &str) -> bool {
    parameters
        .split(';')
        .filter_map(|number| number.parse::<u32>().ok())
        .any(|number| (30..=48).contains(&number) && number != 39 || (90..=107).contains(&number))
}

#[test]
fn panic_restores_the_terminal_and_names_the_run() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut terminal =
        Terminal::start_with(runs.path(), &["--new"], (120, 40), &[("NOVAMIND_FAULT", "panic")]);
    terminal.wait_for("day 0/500");
    // Types F12.
    terminal.type_keys("\x1b[24~");
    let (code, screen) = terminal.wait_for_end();
    assert_eq!(code, 101);
    assert!(screen.contains("all confirmed actions are saved in"), "{screen}");
    let mut terminal = Terminal::start(runs.path(), &["--run", "latest"], (120, 40));
    terminal.wait_for("day 0/500");
    terminal.type_keys("q");
    assert_eq!(terminal.wait_for_end().0, 0);
}
