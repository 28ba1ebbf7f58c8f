//! `novamind study check`: checks the protocol and this machine.

mod design;

use std::path::Path;

use crate::cli::{Context, Failure, print};
use crate::session::Machine;
use novamind_study::{LAB_KEY_FILE, Occasion, PracticeOffer, SEAL_KEY_FILE, Study};

/// Free disk space in bytes that a session of a large company needs, including the database.
const MIN_FREE_BYTES: u64 = 2 << 30;
/// Columns and rows of the smallest supported window.
const MIN_WINDOW_SIZE: (u16, u16) = (60, 16);

struct CheckItem {
    name: &'static str,
    outcome: CheckOutcome,
}

enum CheckOutcome {
    /// The check passed.
    Passed(String),
    /// The check found a property of the study that may be intended, for the experimenter to confirm.
    Note(String),
    /// The check found a problem that must be fixed before a session starts.
    Failed(String),
}

impl From<Result<String, String>> for CheckOutcome {
    fn from(result: Result<String, String>) -> CheckOutcome {
        result.map_or_else(CheckOutcome::Failed, CheckOutcome::Passed)
    }
}

impl CheckItem {
    fn new(name: &'static str, outcome: impl Into<CheckOutcome>) -> CheckItem {
        CheckItem { name, outcome: outcome.into() }
    }

    fn line(&self) -> String {
        let (verdict, words) = match &self.outcome {
            CheckOutcome::Passed(words) => ("ok   ", words),
            CheckOutcome::Note(words) => ("note ", words),
            CheckOutcome::Failed(words) => ("WRONG", words),
        };
        format!("  {verdict} {:<11} {words}\n", self.name)
    }
}

/// Checks a study and this machine.
pub fn run(folder: &Path, context: &Context) -> Result<(), Failure> {
    let study = Study::load(folder)?;
    let runs = context.runs_folder()?;
    let mut text = describe_study(&study);
    let mut points = vec![
        CheckItem::new("version", Ok(format!("novamind {}", env!("CARGO_PKG_VERSION")))),
        CheckItem::new("world", check_scenarios(&study, context)),
        CheckItem::new("clock", check_clock()),
        CheckItem::new("runs", check_writable(&runs).map(|()| runs.display().to_string())),
        CheckItem::new("disk", check_free_space(&runs)),
        CheckItem::new("window", check_window()),
        CheckItem::new("characters", check_locale()),
        CheckItem::new("machine", Ok(Machine::current().id)),
        CheckItem::new("keys", Ok(describe_keys(folder).to_owned())),
    ];
    let removed = study.protocol.removed_settings().into_iter();
    points.extend(removed.map(|words| CheckItem::new("settings", CheckOutcome::Note(words))));
    points.extend(design::design_checks(&study, &context.configuration));
    let failed = points.iter().filter(|point| matches!(point.outcome, CheckOutcome::Failed(_))).count();
    text.extend(points.iter().map(CheckItem::line));
    print(&text)?;
    match failed {
        0 => Ok(()),
        1 => Err(Failure::failed("1 check failed: this machine is not ready")),
        failed => Err(Failure::failed(format!("{failed} checks failed: this machine is not ready"))),
    }
}

/// Describes the keys of the study. Damaged keys need no check, because a study with a damaged key cannot be read.
fn describe_keys(folder: &Path) -> &'static str {
    let is_here = |file: &str| folder.join(file).exists();
    match (is_here(SEAL_KEY_FILE), is_here(LAB_KEY_FILE)) {
        (true, false) => "seal.key seals snapshots",
        (true, true) => {
            "seal.key seals snapshots; lab.key is here: keep lab.key off the machines of participants"
        }
        (false, true) => "no seal.key; lab.key is here: create seal.key with `novamind study key`",
        (false, false) => "no keys: snapshots are sealed without a study key, archives are not signed",
    }
}

fn describe_study(study: &Study) -> String {
    let questions: usize =
        study.questionnaires.iter().map(|questionnaire| questionnaire.questions.len()).sum();
    let asked = |moment: Occasion| {
        study.questionnaires.iter().filter(|questionnaire| questionnaire.when == moment).count()
    };
    let places = study
        .assignment
        .as_ref()
        .map_or("any label".to_owned(), |assignment| format!("{} labels", assignment.rows.len()));
    let consent = if study.consent.is_some() { "required" } else { "not required: there is no consent.md" };
    format!(
        "{} · {}\n  digest {}\n  {places} · consent {consent}\n  {questions} questions: {} before, {} after weeks, {} at breaks, {} at \
         the end\n",
        study.protocol.name,
        study.protocol.title,
        study.digest,
        asked(Occasion::Before),
        asked(Occasion::Weeks),
        asked(Occasion::Break),
        asked(Occasion::End),
    )
}

/// Checks that session and practice use bundled scenarios.
fn check_scenarios(study: &Study, context: &Context) -> Result<String, String> {
    let mut names = vec![study.protocol.world.scenario.clone()];
    if study.protocol.practice.offer != PracticeOffer::None {
        names.push(study.protocol.practice.scenario.clone());
    }
    for name in &names {
        let scenario = context.configuration.load_scenario(name).map_err(|error| error.to_string())?;
        if !scenario.is_bundled {
            return Err(format!("{name} is your own file: sessions need a bundled scenario"));
        }
    }
    let [session, practice @ ..] = names.as_slice() else { return Ok(String::new()) };
    let practice: String = practice.iter().map(|name| format!(", practice scenario {name}")).collect();
    Ok(format!("scenario {session}{practice}"))
}

/// Checks that the wall clock runs evenly and is not earlier than the build date of this program.
fn check_clock() -> Result<String, String> {
    let wall = || std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).unwrap_or_default();
    const BUILT_AFTER: u64 = 1_760_000_000;
    let (before, steady) = (wall(), std::time::Instant::now());
    if before.as_secs() < BUILT_AFTER {
        return Err("the clock of this machine is years behind: set it".to_owned());
    }
    std::thread::sleep(std::time::Duration::from_millis(200));
    let drift = wall().as_secs_f64() - before.as_secs_f64() - steady.elapsed().as_secs_f64();
    if drift.abs() > 0.1 {
        return Err(format!("the clock jumped by {drift:.1} s during the check: another program adjusts it"));
    }
    Ok("runs evenly".to_owned())
}

/// Checks that the folder of runs can be written. Creates a missing folder, as the first session does.
fn check_writable(folder: &Path) -> Result<(), String> {
    std::fs::create_dir_all(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let probe = folder.join(format!(".novamind-check-{}", std::process::id()));
    let tried = std::fs::write(&probe, b"check").and_then(|()| std::fs::remove_file(&probe));
    tried.map_err(|error| format!("{}: {error}", folder.display()))
}

/// Checks the free space by writing, because quotas may allow less than the file system reports.
fn check_free_space(folder: &Path) -> Result<String, String> {
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

fn check_window() -> Result<String, String> {
    match crossterm::terminal::size() {
        Ok((columns, rows)) if columns < MIN_WINDOW_SIZE.0 || rows < MIN_WINDOW_SIZE.1 => Err(format!(
            "{columns}×{rows}: at least {}×{} characters are required",
            MIN_WINDOW_SIZE.0, MIN_WINDOW_SIZE.1
        )),
        Ok((columns, rows)) => Ok(format!("{columns}×{rows}")),
        Err(_) => Ok("no terminal here: run this check on the machines of participants".to_owned()),
    }
}

/// Checks that the locale uses UTF-8, and shows characters for inspection.
fn check_locale() -> Result<String, String> {
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
