//! `novamind study check`: checks the protocol and this machine.

mod design;

use std::path::Path;

use crate::cli::machine_checks::{
    CheckItem, CheckOutcome, check_clock, check_free_space, check_locale, check_window, check_writable,
    report_failures,
};
use crate::cli::{Context, Failure, print};
use crate::session::Machine;
use novamind_study::{LAB_KEY_FILE, Occasion, PracticeOffer, SEAL_KEY_FILE, Study};

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
    points.extend(design::check_design(&study, &context.configuration));
    text.extend(points.iter().map(CheckItem::report_line));
    print(&text)?;
    report_failures(&points)
}

/// Describes the keys of the study. Damaged keys need no check, because a study with a damaged key cannot be read.
fn describe_keys(folder: &Path) -> &'static str {
    let is_here = |file: &str| folder.join(file).exists();
    match (is_here(SEAL_KEY_FILE), is_here(LAB_KEY_FILE)) {
        (true, false) => "seal.key seals snapshots",
        (true, true) => {
            "seal.key seals snapshots; lab.key is in this folder: keep lab.key off the machines of participants"
        }
        (false, true) => {
            "lab.key is in this folder, but seal.key is missing: create seal.key with `novamind study key`"
        }
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
