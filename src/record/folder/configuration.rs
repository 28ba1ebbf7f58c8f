//! Where runs and configuration live, and the scenarios.

use crate::consent::ConsentText;
use std::path::{Path, PathBuf};

use serde::Deserialize;
use toml::Table;

use crate::error::RunError;
use novamind_voice::model::settings::ModelSettings;
use novamind_world::params::{ParameterError, ParameterSource, Params, line_of_key, shipped_sources};

/// Folders of this person on this machine.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Configuration {
    /// Files here go before the shipped ones; none: only the shipped ones count.
    pub folder: Option<PathBuf>,
    /// The language model that lends its voice to the runs that are played; none unless it was named.
    pub voice: Option<ModelSettings>,
}

/// A named set of overrides.
#[derive(Debug, Clone, PartialEq)]
pub struct Scenario {
    /// Name of its file.
    pub name: String,
    /// Short title.
    pub title: String,
    /// What is different.
    pub description: String,
    /// Last day, if it sets one.
    pub days: Option<u32>,
    /// Starting cash, if it sets some.
    pub cash: Option<f64>,
    /// Overrides of parameters.
    pub world: Table,
    /// File it was read from.
    source: ParameterSource,
    /// Whether it came with the program.
    pub shipped: bool,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ScenarioFile {
    title: String,
    description: String,
    days: Option<u32>,
    cash: Option<f64>,
    #[serde(default)]
    world: Table,
}

/// Name of the standard scenario.
pub const DEFAULT_SCENARIO: &str = "default";

impl Configuration {
    /// The configuration of this person: `NOVAMIND_CONFIG`, or the platform's folder.
    pub fn of_user() -> Configuration {
        let from_environment = std::env::var_os("NOVAMIND_CONFIG").map(PathBuf::from);
        let platform =
            || directories::ProjectDirs::from("", "", "novamind").map(|dirs| dirs.config_dir().to_owned());
        Configuration { folder: from_environment.or_else(platform), voice: None }
    }

    /// Only what came with the program.
    pub fn shipped() -> Configuration {
        Configuration { folder: None, voice: None }
    }

    /// Folder of runs: `NOVAMIND_RUNS`, or the platform's data folder.
    pub fn runs_folder() -> Option<PathBuf> {
        let from_environment = std::env::var_os("NOVAMIND_RUNS").map(PathBuf::from);
        let platform =
            || directories::ProjectDirs::from("", "", "novamind").map(|dirs| dirs.data_dir().join("runs"));
        from_environment.or_else(platform)
    }

    /// A file of this person's configuration, if it exists.
    ///
    /// # Errors
    /// It exists and cannot be read.
    pub fn file(&self, relative: impl AsRef<Path>) -> Result<Option<ParameterSource>, RunError> {
        let Some(folder) = &self.folder else { return Ok(None) };
        let path = folder.join(relative);
        match std::fs::read_to_string(&path) {
            Ok(text) => Ok(Some(ParameterSource { name: path.display().to_string(), text })),
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(None),
            Err(error) => Err(RunError::Io { path, error }),
        }
    }

    /// Names of the settings in a folder of this person's configuration, sorted.
    pub fn names(&self, folder: &str) -> Vec<String> {
        self.names_ending(folder, ".toml")
    }

    /// Names of the files of a kind in a folder of this person's configuration, without their ending, sorted.
    pub fn names_ending(&self, folder: &str, ending: &str) -> Vec<String> {
        let Some(own) = &self.folder else { return Vec::new() };
        let entries = std::fs::read_dir(own.join(folder)).into_iter().flatten().flatten();
        let mut names: Vec<String> = entries
            .filter_map(|entry| Some(entry.file_name().to_str()?.strip_suffix(ending)?.to_owned()))
            .collect();
        names.sort_unstable();
        names
    }

    /// Names of all scenarios: the shipped ones, then this person's.
    pub fn scenarios(&self) -> Vec<String> {
        let mut names: Vec<String> =
            novamind_assets::scenarios().into_iter().map(|(name, _)| name.to_owned()).collect();
        // The standard scenario stands first.
        names.sort_by_key(|name| name != DEFAULT_SCENARIO);
        let own = self.names("scenarios").into_iter().filter(|own| !names.contains(own));
        let own: Vec<String> = own.collect();
        names.extend(own);
        names
    }

    /// A scenario; this person's file goes before the shipped one.
    ///
    /// # Errors
    /// There is none of this name, or its file is wrong.
    pub fn scenario(&self, name: &str) -> Result<Scenario, RunError> {
        if let Some(source) = self.file(format!("scenarios/{name}.toml"))? {
            return Ok(read_scenario(name, source, false)?);
        }
        match novamind_assets::scenarios().into_iter().find(|(shipped, _)| *shipped == name) {
            Some((_, text)) => {
                let file = format!("configs/scenarios/{name}.toml");
                Ok(read_scenario(name, ParameterSource { name: file, text: text.to_owned() }, true)?)
            }
            None => Err(RunError::NoScenario { name: name.to_owned(), known: self.scenarios().join(", ") }),
        }
    }

    /// Days and starting cash of a scenario; `own` as in [`Configuration::parameters`].
    ///
    /// # Errors
    /// The first wrong value, with its place.
    pub fn terms(&self, scenario: &Scenario, own: bool) -> Result<(u32, f64), RunError> {
        Ok(scenario.terms(&self.parameters(scenario, &[], own)?))
    }

    /// The parameters of a scenario with single overrides on top, each `(table.key, value as TOML)`.
    ///
    /// `own` allows this person's files in the folder `world`; baseline runs take the shipped parameters only.
    ///
    /// # Errors
    /// The first wrong value, with its place.
    pub fn parameters(
        &self,
        scenario: &Scenario,
        overrides: &[(String, String)],
        own: bool,
    ) -> Result<Params, RunError> {
        let mut sources = Vec::new();
        if own {
            for name in self.names("world") {
                sources.extend(self.file(format!("world/{name}.toml"))?);
            }
        }
        sources.push(scenario.as_overrides());
        for (key, value) in overrides {
            sources.push(single_override(key, value)?);
        }
        Ok(Params::load(&shipped_sources(), &sources).map_err(|error| scenario.located(error))?)
    }
}

impl Scenario {
    /// The overrides as a source of their own.
    fn as_overrides(&self) -> ParameterSource {
        let text = toml::to_string(&self.world).expect("a table that was read can be written");
        ParameterSource { name: self.source.name.clone(), text }
    }

    /// Days and starting cash, with the parameters it leads to.
    pub fn terms(&self, params: &Params) -> (u32, f64) {
        (self.days.unwrap_or(params.run.total_days), self.cash.unwrap_or(params.initial.initial_cash))
    }

    /// An error in the overrides, at its line in the scenario's file.
    fn located(&self, error: ParameterError) -> ParameterError {
        if error.source != self.source.name {
            return error;
        }
        ParameterError { line: line_of_key(&self.source.text, &format!("world.{}", error.key)), ..error }
    }
}

fn read_scenario(name: &str, source: ParameterSource, shipped: bool) -> Result<Scenario, ParameterError> {
    let file: ScenarioFile = toml::from_str(&source.text)
        .map_err(|error| ParameterError::of_toml(&source.name, &source.text, &error))?;
    let wrong = |key: &str, problem: String| ParameterError::of_key(&source.name, &source.text, key, problem);
    file.days.map_or(Ok(()), check_days).map_err(|problem| wrong("days", problem))?;
    file.cash.map_or(Ok(()), check_cash).map_err(|problem| wrong("cash", problem))?;
    Ok(Scenario {
        name: name.to_owned(),
        title: file.title,
        description: file.description,
        days: file.days,
        cash: file.cash,
        world: file.world,
        source,
        shipped,
    })
}

/// A source that sets one parameter, from `table.key` and a TOML value; a bare word counts as text.
fn single_override(key: &str, value: &str) -> Result<ParameterSource, ParameterError> {
    let name = format!("--set {key}={value}");
    let wrong = |problem: &str| ParameterError {
        source: name.clone(),
        line: None,
        key: key.to_owned(),
        problem: problem.to_owned(),
    };
    let (table, rest) = key.split_once('.').ok_or_else(|| wrong("write a parameter as table.key=value"))?;
    let is_name = |part: &str| part.chars().all(|letter| letter.is_ascii_alphanumeric() || letter == '_');
    if !rest.split('.').chain([table]).all(|part| !part.is_empty() && is_name(part)) {
        return Err(wrong("write a parameter as table.key=value"));
    }
    let as_given = format!("{key} = {value}");
    let as_text = format!("{key} = {}", toml::Value::String(value.to_owned()));
    let text = if as_given.parse::<Table>().is_ok() { as_given } else { as_text };
    Ok(ParameterSource { name, text })
}

/// Shortest run, in days.
const FEWEST_DAYS: u32 = 7;

/// Whether a run can have this many days.
///
/// # Errors
/// It cannot: the days it can have.
pub fn check_days(days: u32) -> Result<(), String> {
    if (FEWEST_DAYS..=100_000).contains(&days) {
        return Ok(());
    }
    Err(format!("a run has between {FEWEST_DAYS} and 100,000 days, not {days}"))
}

/// Whether a run can start with this much cash, in dollars.
///
/// # Errors
/// It cannot: the cash it can have.
pub fn check_cash(cash: f64) -> Result<(), String> {
    if cash.is_finite() && cash > 0.0 && cash <= 1e15 {
        return Ok(());
    }
    Err(format!("starting cash must be above 0 and at most 1e15 dollars, not {cash}"))
}

/// Name of the file with the text that participants agree to.
pub const CONSENT_FILE: &str = "consent.md";

impl Configuration {
    /// The text that participants of baseline sessions agree to, if the experimenter has one.
    ///
    /// # Errors
    /// The file exists and cannot be read.
    pub fn consent(&self) -> Result<Option<ConsentText>, RunError> {
        let source = self.file(CONSENT_FILE)?.filter(|source| !source.text.trim().is_empty());
        Ok(source.map(|source| ConsentText { file: source.name, text: source.text }))
    }

    /// The file of a lesson of this person's own; none where there is no folder of configuration.
    pub fn own_lesson(&self, name: &str) -> Option<PathBuf> {
        Some(self.folder.as_ref()?.join("lessons").join(format!("{name}.toml")))
    }

    /// Names of all lessons: the shipped ones in the order of the course, then this person's.
    pub fn lessons(&self) -> Vec<String> {
        let mut names: Vec<String> =
            novamind_assets::lessons().into_iter().map(|(name, _)| name.to_owned()).collect();
        let own: Vec<String> = self.names("lessons").into_iter().filter(|own| !names.contains(own)).collect();
        names.extend(own);
        names
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_shipped_scenarios_have_parameters() {
        let configuration = Configuration::shipped();
        let mut digests: Vec<String> = Vec::new();
        for name in configuration.scenarios() {
            let scenario = configuration.scenario(&name).expect("a shipped scenario");
            let params = configuration.parameters(&scenario, &[], false).expect("its parameters");
            assert!(!scenario.title.is_empty() && scenario.description.ends_with('.'));
            digests.push(params.digest());
        }
        digests.sort_unstable();
        digests.dedup();
        // `default` and `short` differ only in their days.
        assert_eq!(digests.len(), novamind_assets::scenarios().len() - 1);
    }

    #[test]
    fn single_overrides_take_numbers_words_and_tables() {
        let configuration = Configuration::shipped();
        let scenario = configuration.scenario("default").expect("default");
        let set = |key: &str, value: &str| {
            configuration.parameters(&scenario, &[(key.to_owned(), value.to_owned())], true)
        };
        assert_eq!(
            set("quality.base_product_quality", "0.3").expect("a number").quality.base_product_quality,
            0.3
        );
        assert!(set("fidelity.surge_start", "day").is_ok());
        assert!(set("personas.individual.usage_labels", "[\"a\", \"b\", \"c\", \"d\"]").is_ok());
        for (key, value, part) in [
            ("quality", "1", "table.key=value"),
            ("quality.nothing", "1", "no such parameter"),
            ("quality.base_product_quality", "good", "expected a number"),
            ("competitor.competitor_feedback_u_max", "2", "between 0 and 1"),
            ("quality.]x", "1", "table.key=value"),
        ] {
            let error = set(key, value).expect_err("wrong").to_string();
            assert!(error.contains(part) && error.contains("--set"), "{error}");
        }
    }

    #[test]
    fn a_wrong_scenario_of_a_person_names_its_line() {
        let folder = tempfile::tempdir().expect("a folder");
        std::fs::create_dir(folder.path().join("scenarios")).expect("a folder");
        let file = folder.path().join("scenarios/mine.toml");
        let text = "title = \"Mine\"\ndescription = \"x.\"\n\n[world.quality]\nbase_product_quality = -1.0\n";
        std::fs::write(&file, text).expect("a file");
        let configuration = Configuration { folder: Some(folder.path().to_owned()), voice: None };
        let scenario = configuration.scenario("mine").expect("it reads");
        let error =
            configuration.parameters(&scenario, &[], true).expect_err("a negative quality").to_string();
        assert!(error.contains("mine.toml, line 5, quality.base_product_quality"), "{error}");
        std::fs::write(&file, "title = \"Mine\"\nwrong = 1\n").expect("a file");
        let error = configuration.scenario("mine").expect_err("an unknown key").to_string();
        assert!(error.contains("line 2") && error.contains("wrong"), "{error}");
        assert!(
            configuration
                .scenario("none")
                .expect_err("no such")
                .to_string()
                .contains("reference-seed42, short, mine")
        );
    }
}
