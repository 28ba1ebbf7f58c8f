//! Checks of the machine, for `novamind doctor` and `novamind study check`.

use std::path::Path;

use super::Failure;

/// Free disk space in bytes that a session of a large company needs, including the database.
const MIN_FREE_BYTES: u64 = 2 << 30;
/// Columns and rows of the smallest supported window.
const MIN_WINDOW_SIZE: (u16, u16) = (60, 16);

/// The result of one check.
pub struct CheckItem {
    /// Name of the checked item, in one word.
    pub name: &'static str,
    /// Outcome of the check.
    pub outcome: CheckOutcome,
}

/// The outcome of a check, with its explanation.
pub enum CheckOutcome {
    /// The check passed. No action is needed.
    Passed(String),
    /// The check found a state that may be intended, but that the user should know about.
    Note(String),
    /// The check found a problem that the user must fix first.
    Failed(String),
}

impl From<Result<String, String>> for CheckOutcome {
    fn from(result: Result<String, String>) -> CheckOutcome {
        result.map_or_else(CheckOutcome::Failed, CheckOutcome::Passed)
    }
}

impl CheckItem {
    /// Creates the item for one check.
    pub fn new(name: &'static str, outcome: impl Into<CheckOutcome>) -> CheckItem {
        CheckItem { name, outcome: outcome.into() }
    }

    /// Returns the verdict of the check as a word that programs can parse.
    pub fn verdict(&self) -> &'static str {
        match self.outcome {
            CheckOutcome::Passed(_) => "ok",
            CheckOutcome::Note(_) => "note",
            CheckOutcome::Failed(_) => "wrong",
        }
    }

    /// Returns the explanation of the outcome.
    pub fn explanation(&self) -> &str {
        let (CheckOutcome::Passed(text) | CheckOutcome::Note(text) | CheckOutcome::Failed(text)) =
            &self.outcome;
        text
    }

    /// Formats the check as one line of a report: verdict, name and explanation.
    pub fn report_line(&self) -> String {
        let verdict = if self.verdict() == "wrong" { "WRONG" } else { self.verdict() };
        // Line breaks and escape sequences in paths and variables could forge a line of the report.
        let text: String = self
            .explanation()
            .replace(|letter: char| letter.is_control() && self.name != "colors", "\u{fffd}");
        format!("  {verdict:<5} {:<11} {text}\n", self.name)
    }
}

/// Returns an error if a check failed.
///
/// # Errors
/// At least one check failed. The message contains the number of failed checks.
pub fn report_failures(items: &[CheckItem]) -> Result<(), Failure> {
    match items.iter().filter(|item| matches!(item.outcome, CheckOutcome::Failed(_))).count() {
        0 => Ok(()),
        1 => Err(Failure::failed("1 check failed: this machine is not ready")),
        failed => Err(Failure::failed(format!("{failed} checks failed: this machine is not ready"))),
    }
}

/// Checks that the wall clock does not jump relative to the monotonic clock and is not years behind.
pub fn check_clock() -> Result<String, String> {
    let wall = || std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).unwrap_or_default();
    const BUILT_AFTER: u64 = 1_760_000_000;
    let (before, steady) = (wall(), std::time::Instant::now());
    if before.as_secs() < BUILT_AFTER {
        return Err("the clock of this machine is years behind: set the clock".to_owned());
    }
    std::thread::sleep(std::time::Duration::from_millis(200));
    let drift = wall().as_secs_f64() - before.as_secs_f64() - steady.elapsed().as_secs_f64();
    if drift.abs() > 0.1 {
        return Err(format!(
            "the clock jumped by {drift:.1} s during the check: another program adjusts the clock"
        ));
    }
    Ok("runs evenly".to_owned())
}

/// Checks that the folder of runs can be written. Creates a missing folder, as the first session does.
pub fn check_writable(folder: &Path) -> Result<(), String> {
    std::fs::create_dir_all(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let probe = folder.join(format!(".novamind-check-{}", std::process::id()));
    let tried = std::fs::write(&probe, b"check");
    let removed = std::fs::remove_file(&probe);
    tried.and(removed).map_err(|error| format!("{}: {error}", folder.display()))
}

/// Checks the free space that the system reports.
pub fn check_free_space(folder: &Path) -> Result<String, String> {
    let output = std::process::Command::new("df").args(["-Pk".as_ref(), folder.as_os_str()]).output().ok();
    let text = output.map(|output| String::from_utf8_lossy(&output.stdout).into_owned()).unwrap_or_default();
    let free = text.lines().nth(1).and_then(|line| line.split_whitespace().nth(3)?.parse::<u64>().ok());
    match free.map(|kilobytes| kilobytes * 1024) {
        None => Ok("this system does not report free space".to_owned()),
        Some(free) if free < MIN_FREE_BYTES => {
            Err(format!("{} MB are free; a long session may need {} MB", free >> 20, MIN_FREE_BYTES >> 20))
        }
        Some(free) => Ok(format!("{} GB free", free >> 30)),
    }
}

/// Checks that the window has the minimum size.
pub fn check_window() -> Result<String, String> {
    match crossterm::terminal::size() {
        Ok((columns, rows)) if columns < MIN_WINDOW_SIZE.0 || rows < MIN_WINDOW_SIZE.1 => Err(format!(
            "{columns}×{rows}: at least {}×{} characters are required",
            MIN_WINDOW_SIZE.0, MIN_WINDOW_SIZE.1
        )),
        Ok((columns, rows)) => Ok(format!("{columns}×{rows}")),
        Err(_) => Ok("output is not a terminal: the window was not checked".to_owned()),
    }
}

/// Checks that the locale uses UTF-8, and shows characters for inspection.
pub fn check_locale() -> Result<String, String> {
    let name = ["LC_ALL", "LC_CTYPE", "LANG"]
        .iter()
        .find_map(|name| std::env::var(name).ok().filter(|value| !value.is_empty()));
    match name {
        Some(locale) if !locale.to_lowercase().replace('-', "").contains("utf8") => {
            Err(format!("the locale is {locale}, which is not UTF-8: set LANG, or play with --ascii"))
        }
        _ => Ok("you should see a box, a bar and a braille pattern: ┼ ▆ ⣿".to_owned()),
    }
}
