//! `novamind doctor`: checks this machine and prints the information that a bug report needs.

use std::io::IsTerminal;
use std::path::Path;

use clap::Args;
use serde_json::json;

use super::machine_checks::{
    CheckItem, CheckOutcome, check_clock, check_free_space, check_locale, check_window, check_writable,
    report_failures,
};
use super::{Context, Failure, print};
use crate::console::keys::KeyBindings;
use crate::console::own_commands::OwnCommands;
use crate::console::themes;
use crate::lab::{MetricsCollector, Policy, RunSpec, play_policy};
use crate::record::folder::configuration::{Configuration, DEFAULT_SCENARIO};
use crate::record::folder::manifest::FORMAT;
use crate::record::folder::query_library::QueryLibrary;
use crate::worker::preferences::Preferences;
use crate::world::MECHANICS;

/// Policy and seed of the known run, which every build must reproduce.
const KNOWN_RUN: (&str, u64) = ("P1a", 42);
/// A day of the known run, and the state hash at the end of that day.
type KnownHash = (u32, &'static str);
const SHORT_RUN: KnownHash = (28, "d9ab0c740485828a443135ab2e4cdf35bc41c92fe9f66fffb63d1dcff27434b5");
const FULL_RUN: KnownHash = (500, "a6e13d9f17f50a662c19e8484eb0107fddf1be57ac495357bff71297a7704a3c");

#[derive(Debug, Args)]
pub struct Options {
    /// Simulate 500 days instead of 28; takes several seconds
    #[arg(long)]
    full: bool,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

pub fn run(options: &Options, context: &Context) -> Result<(), Failure> {
    let items = run_checks(if options.full { FULL_RUN } else { SHORT_RUN }, context);
    if options.json {
        let object = |item: &CheckItem| json!({"name": item.name, "verdict": item.verdict(), "text": item.explanation()});
        print(&format!("{}\n", json!({"checks": items.iter().map(object).collect::<Vec<_>>()})))?;
    } else {
        let lines: String = items.iter().map(CheckItem::report_line).collect();
        print(&format!(
            "novamind doctor\n{lines}\nFor a bug report, attach this output, the steps that lead to the problem, and the text or a picture of \
             the screen.\nIf the problem concerns a run, also attach the file that `novamind runs export ID` writes. It contains \
             your notes.\n"
        ))?;
    }
    report_failures(&items)
}

fn run_checks(known: KnownHash, context: &Context) -> Vec<CheckItem> {
    let mut items = vec![
        CheckItem::new("version", Ok(describe_build())),
        CheckItem::new("records", describe_versions(&context.configuration)),
        CheckItem::new("simulation", check_simulation(known)),
        CheckItem::new("terminal", CheckOutcome::from(describe_terminal())),
        CheckItem::new("window", check_window()),
        CheckItem::new("colors", Ok(describe_colors())),
        CheckItem::new("characters", check_locale()),
        CheckItem::new("clock", check_clock()),
    ];
    match context.runs_folder() {
        Ok(runs) => {
            items.push(CheckItem::new("runs", check_runs_folder(&runs)));
            items.push(CheckItem::new("disk", check_free_space(existing_ancestor(&runs))));
        }
        Err(failure) => items.push(CheckItem::new("runs", Err(failure.to_string()))),
    }
    items.push(CheckItem::new("settings", check_settings(&context.configuration)));
    items
}

fn describe_build() -> String {
    let linking = if cfg!(target_feature = "crt-static") { "static" } else { "dynamic" };
    let server = if cfg!(feature = "server") { "" } else { ", without servers" };
    let profile = if cfg!(debug_assertions) { "debug" } else { "release" };
    format!(
        "novamind {} for {} {}, {linking}, {profile} build{server}",
        env!("CARGO_PKG_VERSION"),
        std::env::consts::OS,
        std::env::consts::ARCH
    )
}

/// Lists the versions that determine which recorded runs this program can open.
fn describe_versions(configuration: &Configuration) -> Result<String, String> {
    let scenario = configuration.load_scenario(DEFAULT_SCENARIO).map_err(|error| error.to_string())?;
    let params = configuration.load_parameters(&scenario, &[], true).map_err(|error| error.to_string())?;
    Ok(format!(
        "formats 1 to {FORMAT}, mechanics {MECHANICS}, SQLite {}, scenario {DEFAULT_SCENARIO} with digest {}",
        novamind_database::sqlite_version(),
        params.digest()
    ))
}

/// Simulates the known run and compares its state hash with the state hash that every machine must reach.
fn check_simulation((days, expected): KnownHash) -> Result<String, String> {
    let (policy, seed) = KNOWN_RUN;
    let configuration = Configuration::bundled();
    let policy = Policy::find(policy, &configuration).map_err(|error| error.to_string())?;
    let spec = RunSpec { stop_after_day: Some(days), ..RunSpec::for_seed(seed) };
    let outcome = play_policy(&policy, &spec, &configuration, &mut MetricsCollector::disabled())
        .map_err(|error| error.to_string())?;
    if outcome.state_hash == expected {
        return Ok(format!("{days} days of seed {seed} give the known state hash {}", &expected[..16]));
    }
    Err(format!(
        "{days} days of seed {seed} give the state hash {} instead of {expected}: results of this machine are not \
         comparable with results of other machines. Report this problem",
        outcome.state_hash
    ))
}

fn describe_terminal() -> Result<String, String> {
    let mut words = vec![
        environment_variable("TERM").map_or("TERM is not set".to_owned(), |name| format!("TERM={name}")),
    ];
    words.extend(environment_variable("TERM_PROGRAM").map(|name| format!("TERM_PROGRAM={name}")));
    let layers = [
        ("TMUX", "in tmux"),
        ("STY", "in screen"),
        ("SSH_CONNECTION", "over SSH"),
        ("WSL_DISTRO_NAME", "in WSL"),
    ];
    words.extend(
        layers
            .iter()
            .filter(|(name, _)| environment_variable(name).is_some())
            .map(|(_, text)| (*text).to_owned()),
    );
    if !std::io::stdin().is_terminal() || !std::io::stdout().is_terminal() {
        words.push("input or output is not a terminal: the game is played line by line here".to_owned());
    }
    if environment_variable("TERM").as_deref() == Some("dumb") {
        return Err(
            "TERM=dumb: the console needs a terminal that can move the cursor; play with --plain".to_owned()
        );
    }
    Ok(words.join(", "))
}

/// Lists the environment variables that select colors. On a terminal, also shows color samples, first in 16
/// colors and then in 16 million colors.
fn describe_colors() -> String {
    let depth = environment_variable("COLORTERM")
        .map_or("COLORTERM is not set".to_owned(), |name| format!("COLORTERM={name}"));
    if environment_variable("NO_COLOR").is_some() {
        return format!("{depth}, NO_COLOR is set: the console uses the theme mono");
    }
    if !std::io::stdout().is_terminal() {
        return depth;
    }
    format!(
        "{depth}; you should see red, green and blue twice: \x1b[41m  \x1b[42m  \x1b[44m  \x1b[0m \
         \x1b[48;2;190;40;40m  \x1b[48;2;40;150;60m  \x1b[48;2;50;80;200m  \x1b[0m"
    )
}

/// Checks that the folder of runs can be written, without creating the folder.
fn check_runs_folder(runs: &Path) -> Result<String, String> {
    let ancestor = existing_ancestor(runs);
    let name = abbreviate_home_folder(runs);
    check_writable(ancestor).map_err(|problem| {
        format!("{name} cannot be written ({problem}); give another folder with --runs-dir")
    })?;
    if ancestor != runs {
        return Ok(format!("{name} does not exist yet; the first run creates it"));
    }
    let entries = std::fs::read_dir(runs).map_err(|error| format!("{name}: {error}"))?;
    let count = entries.flatten().filter(|entry| entry.path().join("run.toml").is_file()).count();
    Ok(format!(
        "{name} can be written and has {}",
        crate::formatting::pluralize(u32::try_from(count).unwrap_or(u32::MAX), "run")
    ))
}

/// Returns the path if it exists, otherwise its nearest existing ancestor.
fn existing_ancestor(path: &Path) -> &Path {
    path.ancestors().find(|ancestor| ancestor.exists()).unwrap_or(Path::new("."))
}

/// Checks that the user's keys, own commands, theme and scenarios can be read.
fn check_settings(configuration: &Configuration) -> Result<String, String> {
    let folder = configuration.folder.as_deref();
    let name = folder.map_or("bundled files only".to_owned(), abbreviate_home_folder);
    if !folder.is_some_and(Path::is_dir) {
        return Ok(format!("{name}: no files, defaults are used"));
    }
    let keys = KeyBindings::with_user_file(configuration).map_err(|error| error.to_string())?;
    let own = OwnCommands::load(configuration, &keys, &QueryLibrary::load(configuration));
    if let Some(problem) = own.problems.first() {
        return Err(problem.clone());
    }
    let theme = Preferences::load(configuration).theme;
    themes::find_theme(theme.as_deref().unwrap_or("dark"), configuration)?;
    for name in configuration.toml_names("themes") {
        themes::find_theme(&name, configuration)?;
    }
    for scenario in configuration.scenario_names() {
        configuration.load_scenario(&scenario).map_err(|error| error.to_string())?;
    }
    Ok(format!("{name}: keys, own commands, themes and scenarios are valid"))
}

/// Returns a path with `~` for the user's home folder, so that a report does not contain the user's name.
fn abbreviate_home_folder(path: &Path) -> String {
    let home = std::env::var_os("HOME").filter(|home| !home.is_empty());
    match home.and_then(|home| path.strip_prefix(home).ok().map(Path::to_owned)) {
        Some(rest) => format!("~/{}", rest.display()),
        None => path.display().to_string(),
    }
}

/// Returns the value of an environment variable without control characters, or `None` if it is empty.
fn environment_variable(name: &str) -> Option<String> {
    let value = std::env::var(name).ok().filter(|value| !value.is_empty())?;
    Some(value.replace(char::is_control, "\u{fffd}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn simulation_reaches_the_known_state_hash() {
        assert_eq!(
            check_simulation(SHORT_RUN).as_ref().map(|text| text.starts_with("28 days of seed 42")),
            Ok(true)
        );
    }

    #[test]
    fn runs_folder_is_checked_without_creating_it() {
        let folder = tempfile::tempdir().expect("a folder");
        let runs = folder.path().join("a/b");
        assert!(check_runs_folder(&runs).is_ok_and(|text| text.contains("does not exist yet")));
        assert_eq!(std::fs::read_dir(folder.path()).expect("a folder").count(), 0);
    }
}
