//! Locations of the runs folder and the configuration folder, and the scenarios in the configuration.

use crate::consent::ConsentText;
use std::path::{Path, PathBuf};

use serde::Deserialize;
use toml::Table;

use crate::error::RunError;
use crate::files::open_regular_file;
use novamind_voice::model::settings::ModelSettings;
use novamind_world::params::{ParameterError, ParameterSource, Params, bundled_sources, line_of_key};

/// The user's configuration folder and language model.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Configuration {
    /// Folder whose files take precedence over bundled files; `None` to use only bundled files.
    pub folder: Option<PathBuf>,
    /// Language model that words the texts of new runs, if the user configured a model.
    pub voice: Option<ModelSettings>,
}

/// A named set of parameter overrides.
#[derive(Debug, Clone, PartialEq)]
pub struct Scenario {
    /// Name of the scenario file, without the extension.
    pub name: String,
    /// Short title of the scenario.
    pub title: String,
    /// Description of the differences from the default scenario.
    pub description: String,
    /// Length of the run in days, if the scenario sets a length.
    pub days: Option<u32>,
    /// Starting cash in dollars, if the scenario sets an amount.
    pub cash: Option<f64>,
    /// Parameter overrides by table and key.
    pub world: Table,
    /// Name and text of the scenario file.
    source: ParameterSource,
    /// Whether the scenario is bundled with the program.
    pub is_bundled: bool,
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

/// Maximum size of a configuration file, in bytes.
const MAX_FILE_BYTES: u64 = 16 << 20;

/// Reads a regular file of limited size. Rejects devices and pipes, because they can be endless.
fn read_small_file(path: &Path) -> std::io::Result<String> {
    let file = open_regular_file(path)?;
    if file.metadata()?.len() > MAX_FILE_BYTES {
        let problem = format!("not a regular file of at most {} MB", MAX_FILE_BYTES >> 20);
        return Err(std::io::Error::new(std::io::ErrorKind::InvalidInput, problem));
    }
    std::io::read_to_string(file)
}

/// Name of the default scenario.
pub const DEFAULT_SCENARIO: &str = "default";

impl Configuration {
    /// Returns the configuration in the folder `NOVAMIND_CONFIG`, or in the platform's configuration folder.
    pub fn from_environment() -> Configuration {
        let from_environment = std::env::var_os("NOVAMIND_CONFIG").map(PathBuf::from);
        let platform =
            || directories::ProjectDirs::from("", "", "novamind").map(|dirs| dirs.config_dir().to_owned());
        Configuration { folder: from_environment.or_else(platform), voice: None }
    }

    /// Returns a configuration with bundled files only.
    pub fn bundled() -> Configuration {
        Configuration { folder: None, voice: None }
    }

    /// Returns the runs folder: `NOVAMIND_RUNS`, or a subfolder of the platform's data folder.
    pub fn default_runs_folder() -> Option<PathBuf> {
        let from_environment = std::env::var_os("NOVAMIND_RUNS").map(PathBuf::from);
        let platform =
            || directories::ProjectDirs::from("", "", "novamind").map(|dirs| dirs.data_dir().join("runs"));
        from_environment.or_else(platform)
    }

    /// Reads a file of the configuration folder. Returns `None` if the file does not exist.
    ///
    /// # Errors
    /// The file exists but cannot be read.
    pub fn read_file(&self, relative: impl AsRef<Path>) -> Result<Option<ParameterSource>, RunError> {
        let Some(folder) = &self.folder else { return Ok(None) };
        let path = folder.join(relative);
        match read_small_file(&path) {
            Ok(text) => Ok(Some(ParameterSource { name: path.display().to_string(), text })),
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(None),
            Err(error) => Err(RunError::Io { path, error }),
        }
    }

    /// Returns the sorted names of the TOML files in a subfolder of the configuration folder, without the extension.
    pub fn toml_names(&self, folder: &str) -> Vec<String> {
        self.file_names(folder, ".toml")
    }

    /// Returns the sorted names of the files with an extension in a subfolder of the configuration folder, without the
    /// extension.
    pub fn file_names(&self, folder: &str, ending: &str) -> Vec<String> {
        let Some(path) = &self.folder else { return Vec::new() };
        let entries = std::fs::read_dir(path.join(folder)).into_iter().flatten().flatten();
        let mut names: Vec<String> = entries
            .filter_map(|entry| Some(entry.file_name().to_str()?.strip_suffix(ending)?.to_owned()))
            .collect();
        names.sort_unstable();
        names
    }

    /// Returns the names of all scenarios: bundled scenarios, then the user's scenarios.
    pub fn scenario_names(&self) -> Vec<String> {
        let mut names: Vec<String> =
            novamind_assets::scenarios().into_iter().map(|(name, _)| name.to_owned()).collect();
        // The default scenario comes first.
        names.sort_by_key(|name| name != DEFAULT_SCENARIO);
        let user_names = self.toml_names("scenarios").into_iter().filter(|text| !names.contains(text));
        let texts: Vec<String> = user_names.collect();
        names.extend(texts);
        names
    }

    /// Loads a scenario. A user's scenario file takes precedence over a bundled file.
    ///
    /// # Errors
    /// The scenario does not exist, or its file is invalid.
    pub fn load_scenario(&self, name: &str) -> Result<Scenario, RunError> {
        if let Some(source) = self.read_file(format!("scenarios/{name}.toml"))? {
            return Ok(parse_scenario(name, source, false)?);
        }
        match novamind_assets::scenarios().into_iter().find(|(bundled, _)| *bundled == name) {
            Some((_, text)) => {
                let file = format!("configs/scenarios/{name}.toml");
                Ok(parse_scenario(name, ParameterSource { name: file, text: text.to_owned() }, true)?)
            }
            None => Err(RunError::UnknownScenario {
                name: name.to_owned(),
                known: self.scenario_names().join(", "),
            }),
        }
    }

    /// Returns the last day and the starting cash of a scenario. For `with_world_files`, see
    /// [`Configuration::load_parameters`].
    ///
    /// # Errors
    /// A parameter value is invalid; the error names the position of the first invalid value.
    pub fn days_and_cash(&self, scenario: &Scenario, with_world_files: bool) -> Result<(u32, f64), RunError> {
        let params = self.load_parameters(scenario, &[], with_world_files)?;
        let (days, cash) = scenario.days_and_cash_with(&params);
        Ok((params.run.horizon(days).last_day, cash))
    }

    /// Loads the parameters of a scenario and applies the overrides. Each override is a pair `(table.key, value as
    /// TOML)`.
    ///
    /// `with_world_files` also applies the user's files in the folder `world`; baseline runs use bundled parameters
    /// only.
    ///
    /// # Errors
    /// A parameter value is invalid; the error names the position of the first invalid value.
    pub fn load_parameters(
        &self,
        scenario: &Scenario,
        overrides: &[(String, String)],
        with_world_files: bool,
    ) -> Result<Params, RunError> {
        let mut sources = Vec::new();
        if with_world_files {
            for name in self.toml_names("world") {
                sources.extend(self.read_file(format!("world/{name}.toml"))?);
            }
        }
        sources.push(scenario.to_parameter_source());
        for (key, value) in overrides {
            sources.push(parse_override(key, value)?);
        }
        Ok(Params::load(&bundled_sources(), &sources).map_err(|error| scenario.with_scenario_line(error))?)
    }
}

impl Scenario {
    fn to_parameter_source(&self) -> ParameterSource {
        let text = toml::to_string(&self.world).expect("a table that was read can be written");
        ParameterSource { name: self.source.name.clone(), text }
    }

    /// Returns the length in days and the starting cash, with defaults from the parameters. `run.horizon_rule` derives
    /// the last day from the length.
    pub fn days_and_cash_with(&self, params: &Params) -> (u32, f64) {
        (self.days.unwrap_or(params.run.total_days), self.cash.unwrap_or(params.initial.initial_cash))
    }

    /// Adds the line number in the scenario file to an error.
    fn with_scenario_line(&self, error: ParameterError) -> ParameterError {
        if error.source != self.source.name {
            return error;
        }
        ParameterError { line: line_of_key(&self.source.text, &format!("world.{}", error.key)), ..error }
    }
}

fn parse_scenario(name: &str, source: ParameterSource, bundled: bool) -> Result<Scenario, ParameterError> {
    let file: ScenarioFile = toml::from_str(&source.text)
        .map_err(|error| ParameterError::from_toml(&source.name, &source.text, &error))?;
    let wrong =
        |key: &str, problem: String| ParameterError::for_key(&source.name, &source.text, key, problem);
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
        is_bundled: bundled,
    })
}

/// Returns a parameter source that sets `table.key` to a TOML value. A bare word is read as a string.
fn parse_override(key: &str, value: &str) -> Result<ParameterSource, ParameterError> {
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

const MIN_RUN_DAYS: u32 = 7;

/// Checks that the number of days of a run is in the allowed range.
///
/// # Errors
/// The number is out of range; returns a message with the allowed range.
pub fn check_days(days: u32) -> Result<(), String> {
    if (MIN_RUN_DAYS..=100_000).contains(&days) {
        return Ok(());
    }
    Err(format!("a run has between {MIN_RUN_DAYS} and 100,000 days, not {days}"))
}

/// Checks that the starting cash of a run, in dollars, is in the allowed range.
///
/// # Errors
/// The amount is out of range; returns a message with the allowed range.
pub fn check_cash(cash: f64) -> Result<(), String> {
    if cash.is_finite() && cash > 0.0 && cash <= 1e15 {
        return Ok(());
    }
    Err(format!("starting cash must be above 0 and at most 1e15 dollars, not {cash}"))
}

/// Name of the file with the consent text.
pub const CONSENT_FILE: &str = "consent.md";

impl Configuration {
    /// Returns the consent text of baseline sessions, if the configuration has a consent file.
    ///
    /// # Errors
    /// The file exists but cannot be read.
    pub fn load_consent_text(&self) -> Result<Option<ConsentText>, RunError> {
        let source = self.read_file(CONSENT_FILE)?.filter(|source| !source.text.trim().is_empty());
        Ok(source.map(|source| ConsentText { file: source.name, text: source.text }))
    }

    /// Returns the path of a user lesson, or `None` if there is no configuration folder.
    pub fn user_lesson_file(&self, name: &str) -> Option<PathBuf> {
        Some(self.folder.as_ref()?.join("lessons").join(format!("{name}.toml")))
    }

    /// Returns the names of all lessons: bundled lessons in course order, then the user's lessons.
    pub fn lesson_names(&self) -> Vec<String> {
        let mut names: Vec<String> =
            novamind_assets::lessons().into_iter().map(|(name, _)| name.to_owned()).collect();
        let texts: Vec<String> =
            self.toml_names("lessons").into_iter().filter(|text| !names.contains(text)).collect();
        names.extend(texts);
        names
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn read_file_rejects_files_without_end() {
        let folder = tempfile::tempdir().expect("a folder");
        let configuration = Configuration { folder: Some(folder.path().to_owned()), voice: None };
        let huge = std::fs::File::create(folder.path().join("keys.toml")).expect("a file");
        huge.set_len(MAX_FILE_BYTES + 1).expect("a sparse file");
        std::fs::create_dir(folder.path().join("a.toml")).expect("a folder");
        for name in ["keys.toml", "a.toml"] {
            let error = configuration.read_file(name).expect_err(name).to_string();
            assert!(error.contains("not a regular file"), "{error}");
        }
        assert_eq!(configuration.read_file("b.toml").expect("no file"), None);
    }

    #[test]
    fn bundled_scenarios_have_valid_parameters() {
        let configuration = Configuration::bundled();
        let mut digests: Vec<String> = Vec::new();
        for name in configuration.scenario_names() {
            let scenario = configuration.load_scenario(&name).expect("a bundled scenario");
            let params = configuration.load_parameters(&scenario, &[], false).expect("its parameters");
            assert!(!scenario.title.is_empty() && scenario.description.ends_with('.'));
            digests.push(params.digest());
        }
        digests.sort_unstable();
        digests.dedup();
        // The scenarios `default` and `short` have the same parameters and differ only in their length.
        assert_eq!(digests.len(), novamind_assets::scenarios().len() - 1);
    }

    #[test]
    fn overrides_accept_numbers_words_and_lists() {
        let configuration = Configuration::bundled();
        let scenario = configuration.load_scenario("default").expect("default");
        let set = |key: &str, value: &str| {
            configuration.load_parameters(&scenario, &[(key.to_owned(), value.to_owned())], true)
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
    fn user_scenario_errors_name_the_line() {
        let folder = tempfile::tempdir().expect("a folder");
        std::fs::create_dir(folder.path().join("scenarios")).expect("a folder");
        let file = folder.path().join("scenarios/mine.toml");
        let text = "title = \"Mine\"\ndescription = \"x.\"\n\n[world.quality]\nbase_product_quality = -1.0\n";
        std::fs::write(&file, text).expect("a file");
        let configuration = Configuration { folder: Some(folder.path().to_owned()), voice: None };
        let scenario = configuration.load_scenario("mine").expect("it reads");
        let error =
            configuration.load_parameters(&scenario, &[], true).expect_err("a negative quality").to_string();
        assert!(error.contains("mine.toml, line 5, quality.base_product_quality"), "{error}");
        std::fs::write(&file, "title = \"Mine\"\nwrong = 1\n").expect("a file");
        let error = configuration.load_scenario("mine").expect_err("an unknown key").to_string();
        assert!(error.contains("line 2") && error.contains("wrong"), "{error}");
        assert!(
            configuration
                .load_scenario("none")
                .expect_err("no such")
                .to_string()
                .contains("reference-seed42, release-2, short, mine")
        );
    }
}
