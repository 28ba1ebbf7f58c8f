//! Study files: parser, checks and expansion into arms.

use std::path::Path;

use serde::Deserialize;
use toml::{Table, Value};

use super::grid::{FactorLevel, cross_levels, flatten_table, override_text};
use crate::experiment::{Arm, Experiment, RecordedFigures};
use crate::policy::Policy;
use crate::runner::RunSpec;
use crate::seeds::parse_seeds;
use novamind_record::error::RunError;
use novamind_record::folder::configuration::{Configuration, DEFAULT_SCENARIO, check_cash, check_days};
use novamind_world::params::{Horizon, ParameterError, Params, Replayed, line_of_key};

const MAX_RUNS: u64 = 1_000_000;

/// A parsed study file, with its arms in the order of the rows.
#[derive(Debug, Clone)]
pub struct StudyPlan {
    /// Name of the study: letters, digits, hyphens and underscores.
    pub name: String,
    /// Names of the columns that identify a run: policy, scenario, and varied settings.
    pub factors: Vec<String>,
    /// Values of the factors for each arm.
    pub levels: Vec<Vec<String>>,
    /// Whether a scenario of the study replays recorded draws.
    pub replays_a_record: bool,
    /// Arms and seeds of the study.
    pub experiment: Experiment,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct StudyFile {
    name: String,
    #[serde(default, rename = "description")]
    _description: String,
    policies: Vec<String>,
    #[serde(default)]
    scenarios: Vec<String>,
    seeds: SeedList,
    days: Option<u32>,
    until: Option<u32>,
    cash: Option<f64>,
    surges: Option<bool>,
    #[serde(default)]
    daily: bool,
    #[serde(default)]
    overrides: Vec<OverrideSet>,
    #[serde(default)]
    grid: Table,
}

#[derive(Deserialize)]
#[serde(untagged, expecting = "seeds must be a number, a range like \"1..24\", or a list of numbers")]
enum SeedList {
    One(u64),
    Range(String),
    List(Vec<u64>),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct OverrideSet {
    name: String,
    #[serde(default)]
    set: Table,
}

/// A study file with its text, which is needed to locate errors.
struct StudySource<'a> {
    name: String,
    text: &'a str,
}

impl StudySource<'_> {
    fn error_at_key(&self, key: &str, problem: impl Into<String>) -> ParameterError {
        ParameterError::for_key(&self.name, self.text, key, problem)
    }

    /// Returns an error that is located at the first line of the table `within` that contains the overridden
    /// key.
    fn override_error(&self, within: &str, key: &str, problem: impl Into<String>) -> ParameterError {
        let from = line_of_key(self.text, within).unwrap_or(1);
        let names = |line: &&str| line.contains(key) || line.contains(key.rsplit('.').next().unwrap_or(key));
        let at = self.text.lines().skip(from - 1).position(|line| names(&line));
        ParameterError {
            source: self.name.clone(),
            line: Some(from + at.unwrap_or(0)),
            key: key.to_owned(),
            problem: problem.into(),
        }
    }

    fn parse(&self) -> Result<StudyFile, ParameterError> {
        let at = |line: Option<usize>, key: String, problem: &str| ParameterError {
            source: self.name.clone(),
            line,
            key,
            problem: problem.to_owned(),
        };
        let line = |error: &toml::de::Error| {
            let start = error.span()?.start.min(self.text.len());
            Some(self.text[..start].matches('\n').count() + 1)
        };
        let reader = toml::Deserializer::parse(self.text)
            .map_err(|error| at(line(&error), String::new(), error.message()))?;
        serde_path_to_error::deserialize(reader).map_err(|error| {
            let key = error.path().to_string();
            let key = if key == "." { String::new() } else { key };
            at(line(error.inner()), key, error.inner().message())
        })
    }
}

impl StudyPlan {
    /// Reads a study file. Paths of policy files are relative to the study file.
    ///
    /// # Errors
    /// Returns the first error with its line and key.
    pub fn read(
        path: &Path,
        daily: bool,
        configuration: &Configuration,
    ) -> Result<StudyPlan, ParameterError> {
        let name = path.display().to_string();
        let text = std::fs::read_to_string(path).map_err(|error| ParameterError {
            source: name.clone(),
            line: None,
            key: String::new(),
            problem: error.to_string(),
        })?;
        let folder = path.parent().unwrap_or(Path::new(""));
        StudyPlan::build(&StudySource { name, text: &text }, folder, daily, configuration)
    }

    fn build(
        source: &StudySource<'_>,
        folder: &Path,
        daily: bool,
        configuration: &Configuration,
    ) -> Result<StudyPlan, ParameterError> {
        let study_file = source.parse()?;
        let fits = |letter: char| letter.is_ascii_alphanumeric() || "-_".contains(letter);
        if study_file.name.is_empty() || study_file.name.len() > 60 || !study_file.name.chars().all(fits) {
            let problem = "use up to 60 letters, digits, hyphens and underscores";
            return Err(source.error_at_key("name", problem));
        }
        let policies = read_policies(source, &study_file, folder, configuration)?;
        check_scenarios(source, &study_file)?;
        check_days_and_cash(source, &study_file)?;
        let levels = varied_factors(source, &study_file)?;
        let seeds = read_seeds(
            source,
            &study_file,
            (policies.len() * study_file.scenarios.len().max(1)) as u64,
            &levels,
        )?;
        let mut factors = vec!["policy".to_owned(), "scenario".to_owned()];
        factors.extend(levels.names.iter().cloned());
        let (mut arms, mut labels, mut replays_a_record) = (Vec::new(), Vec::new(), false);
        for policy in &policies {
            for scenario in scenarios_for(&study_file, policy) {
                for level in &levels.all {
                    let arm = study_file.build_arm(policy, &scenario, level);
                    let params = validated_parameters(source, &study_file, &arm, configuration)?;
                    replays_a_record |= params.series.replayed != Replayed::None;
                    arms.push(arm);
                    let words = [policy.name.clone(), scenario.clone()];
                    labels.push(words.into_iter().chain(level.labels.iter().cloned()).collect());
                }
            }
        }
        let wanted = RecordedFigures { daily: study_file.daily || daily, figures_on: Vec::new() };
        Ok(StudyPlan {
            name: study_file.name,
            factors,
            levels: labels,
            replays_a_record,
            experiment: Experiment { arms, seeds, recorded: wanted },
        })
    }

    /// Returns the factor levels of a run's arm, and the run's seed.
    pub(super) fn arm_and_seed(&self, number: usize) -> (&[String], u64) {
        let seeds = &self.experiment.seeds;
        (&self.levels[number / seeds.len()], seeds[number % seeds.len()])
    }
}

impl StudyFile {
    fn build_arm(&self, policy: &Policy, scenario: &str, level: &FactorLevel) -> Arm {
        let name: Vec<&str> = [policy.name.as_str(), scenario]
            .into_iter()
            .chain(level.labels.iter().map(String::as_str))
            .collect();
        let spec = RunSpec {
            days: self.days,
            stop_after_day: self.until,
            surges: self.surges,
            cash: self.cash,
            scenario: Some(scenario.to_owned()),
            overrides: level.overrides.clone(),
            ..RunSpec::for_seed(0)
        };
        Arm { name: name.join(", "), policy: policy.clone(), spec }
    }
}

/// Returns the scenarios in which a policy plays: the scenarios of the study, or the policy's scenario if the study
/// lists none.
fn scenarios_for(study_file: &StudyFile, policy: &Policy) -> Vec<String> {
    match study_file.scenarios.is_empty() {
        true => vec![policy.start.scenario.clone().unwrap_or(DEFAULT_SCENARIO.to_owned())],
        false => study_file.scenarios.clone(),
    }
}

fn read_policies(
    source: &StudySource<'_>,
    study_file: &StudyFile,
    folder: &Path,
    configuration: &Configuration,
) -> Result<Vec<Policy>, ParameterError> {
    if study_file.policies.is_empty() {
        return Err(source.error_at_key("policies", "a study needs at least one policy"));
    }
    let mut found: Vec<Policy> = Vec::new();
    for (at, name) in study_file.policies.iter().enumerate() {
        let key = format!("policies.{at}");
        let is_file = name.ends_with(".toml") || name.contains(std::path::is_separator);
        let place = if is_file { folder.join(name).display().to_string() } else { name.clone() };
        let policy = Policy::find(&place, configuration)
            .map_err(|error| source.error_at_key(&key, error.to_string()))?;
        if found.iter().any(|other| other.name == policy.name) {
            return Err(source.error_at_key(&key, format!("two policies are named {}", policy.name)));
        }
        found.push(policy);
    }
    Ok(found)
}

/// Checks that scenarios are unique and that the list is not empty.
fn check_scenarios(source: &StudySource<'_>, study_file: &StudyFile) -> Result<(), ParameterError> {
    if study_file.scenarios.is_empty() && line_of_key(source.text, "scenarios").is_some() {
        let problem = "the list is empty; leave the key out to play each policy's own scenario";
        return Err(source.error_at_key("scenarios", problem));
    }
    let twice = |at: &usize| study_file.scenarios[..*at].contains(&study_file.scenarios[*at]);
    match (0..study_file.scenarios.len()).find(twice) {
        Some(at) => {
            let problem = format!("scenario {} appears twice", study_file.scenarios[at]);
            Err(source.error_at_key(&format!("scenarios.{at}"), problem))
        }
        None => Ok(()),
    }
}

/// Parameters for which studies and policies have separate keys. Values of these parameters in a grid or in
/// overrides would have no effect.
const RESERVED_PARAMETERS: [&str; 3] = ["run.seed", "run.total_days", "initial.initial_cash"];

fn check_reserved_parameters<'a>(
    source: &StudySource<'_>,
    within: &str,
    mut keys: impl Iterator<Item = &'a String>,
) -> Result<(), ParameterError> {
    match keys.find(|key| RESERVED_PARAMETERS.contains(&key.as_str())) {
        Some(key) => {
            let problem =
                "seeds, days and cash are keys of the study: set them there, or use several studies";
            Err(source.override_error(within, key, problem))
        }
        None => Ok(()),
    }
}

/// Returns whether two TOML values are equal. The integer 0 equals the float 0.0.
fn are_equal_values(one: &Value, other: &Value) -> bool {
    let number = |value: &Value| value.as_float().or(value.as_integer().map(|whole| whole as f64));
    match (number(one), number(other)) {
        (Some(one), Some(other)) => one == other,
        _ => one == other,
    }
}

/// The factors that a study varies, with all combinations of their values.
struct VariedFactors {
    names: Vec<String>,
    all: Vec<FactorLevel>,
}

fn varied_factors(source: &StudySource<'_>, study_file: &StudyFile) -> Result<VariedFactors, ParameterError> {
    let (mut names, mut all) = (Vec::new(), vec![FactorLevel::default()]);
    if !study_file.overrides.is_empty() {
        names.push("overrides".to_owned());
        let mut sets: Vec<FactorLevel> = Vec::new();
        for (at, set) in study_file.overrides.iter().enumerate() {
            let is_taken = sets.iter().any(|other| other.labels[0] == set.name);
            if set.name.is_empty() || is_taken || set.name.chars().any(char::is_control) {
                let problem = "every set of overrides needs a unique name";
                return Err(source.error_at_key(&format!("overrides.{at}"), problem));
            }
            let given = flatten_table(&set.set);
            check_reserved_parameters(source, "overrides", given.iter().map(|(key, _)| key))?;
            let overrides: Vec<_> =
                given.into_iter().map(|(key, value)| (key, override_text(value))).collect();
            if let Some(twin) = sets.iter().find(|other| other.overrides == overrides) {
                let problem = format!(
                    "{} sets the same parameters as {}: their runs would be identical",
                    set.name, twin.labels[0]
                );
                return Err(source.error_at_key(&format!("overrides.{at}"), problem));
            }
            sets.push(FactorLevel { labels: vec![set.name.clone()], overrides });
        }
        all = cross_levels(&all, &sets);
    }
    let grid = flatten_table(&study_file.grid);
    check_reserved_parameters(source, "grid", grid.iter().map(|(key, _)| key))?;
    let is_set =
        |key: &String| all.iter().any(|level| level.overrides.iter().any(|(parameter, _)| parameter == key));
    if let Some((key, _)) = grid.iter().find(|(key, _)| is_set(key)) {
        let problem =
            "a set of overrides also sets this parameter: set the parameter either there or in the grid";
        return Err(source.override_error("grid", key, problem));
    }
    for (key, values) in grid {
        let Value::Array(values) = values else {
            return Err(source.override_error("grid", &key, "a grid parameter needs a list of values"));
        };
        if values.is_empty() {
            return Err(source.override_error(
                "grid",
                &key,
                "the list is empty; add a value or remove the key",
            ));
        }
        if let Some(at) = (0..values.len())
            .find(|at| values[..*at].iter().any(|earlier| are_equal_values(earlier, &values[*at])))
        {
            let problem = format!("the value {} appears twice", override_text(&values[at]));
            return Err(source.override_error("grid", &key, problem));
        }
        let level = |value: &Value| {
            let text = override_text(value);
            let label = value.as_str().map_or(text.clone(), str::to_owned);
            FactorLevel { labels: vec![label], overrides: vec![(key.clone(), text)] }
        };
        let factor_levels: Vec<FactorLevel> = values.iter().map(level).collect();
        names.push(key.clone());
        all = cross_levels(&all, &factor_levels);
    }
    Ok(VariedFactors { names, all })
}

fn read_seeds(
    source: &StudySource<'_>,
    study_file: &StudyFile,
    arms: u64,
    levels: &VariedFactors,
) -> Result<Vec<u64>, ParameterError> {
    let arms = arms.saturating_mul(levels.all.len() as u64);
    let max = MAX_RUNS / arms.max(1);
    let too_many = |count: u64| {
        let problem = format!(
            "{count} seeds for each of {arms} arms exceed the maximum of {MAX_RUNS} runs: split the study"
        );
        source.error_at_key("seeds", problem)
    };
    let seeds: Vec<u64> = match &study_file.seeds {
        SeedList::One(seed) => vec![*seed],
        SeedList::List(seeds) => seeds.clone(),
        SeedList::Range(text) => {
            let range = parse_seeds(text).map_err(|problem| source.error_at_key("seeds", problem))?;
            let count = (range.last - range.first).saturating_add(1);
            if count > max {
                return Err(too_many(count));
            }
            (range.first..=range.last).collect()
        }
    };
    let mut sorted = seeds.clone();
    sorted.sort_unstable();
    if let Some(pair) = sorted.windows(2).find(|pair| pair[0] == pair[1]) {
        return Err(source.error_at_key("seeds", format!("seed {} appears twice", pair[0])));
    }
    match seeds.len() as u64 {
        0 => Err(source.error_at_key("seeds", "a study needs at least one seed")),
        count if count > max => Err(too_many(count)),
        _ => Ok(seeds),
    }
}

fn check_days_and_cash(source: &StudySource<'_>, study_file: &StudyFile) -> Result<(), ParameterError> {
    study_file.days.map_or(Ok(()), check_days).map_err(|problem| source.error_at_key("days", problem))?;
    study_file.cash.map_or(Ok(()), check_cash).map_err(|problem| source.error_at_key("cash", problem))?;
    match study_file.until {
        Some(0) => Err(source.error_at_key("until", "until must be at least 1")),
        _ => Ok(()),
    }
}

/// Returns the parameters of an arm. Returns an error if the runs of the arm cannot start.
fn validated_parameters(
    source: &StudySource<'_>,
    study_file: &StudyFile,
    arm: &Arm,
    configuration: &Configuration,
) -> Result<Params, ParameterError> {
    let error = match (arm.run_conditions(configuration), study_file.until) {
        (Ok((Horizon { last_day, .. }, ..)), Some(until)) if until > last_day => {
            return Err(source.error_at_key("until", format!("the runs of the study end on day {last_day}")));
        }
        (Ok((.., params)), _) => return Ok(params),
        (Err(error), _) => error,
    };
    if let RunError::Configuration(wrong) = &error {
        let concerns = |key: &&String| {
            wrong.key == **key || wrong.key.starts_with(&format!("{key}.")) || wrong.source.contains(*key)
        };
        let given = arm.spec.overrides.iter().map(|(key, _)| key).find(concerns);
        if let Some(key) = given {
            let is_grid_key = flatten_table(&study_file.grid).iter().any(|(other, _)| other == key);
            let within = if is_grid_key { "grid" } else { "overrides" };
            return Err(source.override_error(within, key, wrong.problem.clone()));
        }
    }
    let at = study_file.scenarios.iter().position(|name| Some(name) == arm.spec.scenario.as_ref());
    let key = at.map_or("policies".to_owned(), |at| format!("scenarios.{at}"));
    Err(source.error_at_key(&key, error.to_string()))
}
