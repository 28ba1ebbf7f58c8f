//! The manifest of a run, `run.toml` (docs/formats/run-folder.md#runtoml).

use std::path::Path;

use serde::{Deserialize, Serialize};
use toml::{Table, Value};

use super::configuration::Configuration;
use crate::consent::Consent;
use crate::error::RunError;
use crate::files::write_atomically;
use crate::mode::Mode;
use crate::rules::{ResultsDisclosure, SessionRules};
use crate::stamp::HandoutStamp;
use crate::stamp::LessonStamp;
use crate::stamp::{EarlierRun, StudyStamp};
use crate::trajectory::record::{Parent, Start, first_mechanics};
use crate::trajectory::{Line, Record};
use novamind_voice::model::settings::RecordedModelSettings;
use novamind_world::MECHANICS;
use novamind_world::fault::Fault;
use novamind_world::params::{
    HorizonRule, Interface, ParameterError, ParameterSource, Params, bundled_sources,
};

/// Format number of the trajectories and manifests that this program writes.
pub const FORMAT: u32 = 2;

/// The manifest of a run. The manifest is written once and never changed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Manifest {
    /// Format number of the run's files.
    pub format: u32,
    /// Version of the program that created the run.
    pub version: String,
    /// Version number of the mechanics; absent in runs of the first builds.
    #[serde(default = "first_mechanics")]
    pub mechanics: u32,
    /// ID of the run: eight hexadecimal digits.
    pub id: String,
    /// Time of creation, RFC 3339.
    pub created: String,
    /// Seed of all random draws.
    pub seed: u64,
    /// Last day of the run.
    pub days: u32,
    /// Length that scales competitor events, if it differs from the last day.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub total_days: Option<u32>,
    /// Cash on day 0, dollars.
    pub cash: f64,
    /// Name of the scenario.
    pub scenario: String,
    /// Mode of the run, which never changes.
    pub mode: Mode,
    /// Label of the participant.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub participant: Option<String>,
    /// Number of earlier runs of the same participant with this seed and scenario.
    pub earlier_runs: u32,
    /// Digest of the effective parameters.
    pub parameters_digest: String,
    /// Seeded fault of the mechanics; debug runs only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fault: Option<Fault>,
    /// Consent of the participant; `None` if no consent was required.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub consent: Option<Consent>,
    /// Parent run and last copied line, if the run is a branch.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub parent: Option<Parent>,
    /// Study to which the run belongs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub study: Option<StudyStamp>,
    /// Lesson to which the run belongs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lesson: Option<LessonStamp>,
    /// Handout from which the run started.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub handout: Option<HandoutStamp>,
    /// Language model that words posts and messages, if one is used.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub voice: Option<RecordedModelSettings>,
    /// Session rules; `None` in runs of format 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rules: Option<SessionRules>,
    /// Earlier runs of the same participant.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub earlier: Vec<EarlierRun>,
    /// Parameters whose values differ from the bundled parameters.
    #[serde(default, skip_serializing_if = "Table::is_empty")]
    pub parameters: Table,
}

impl Manifest {
    /// Returns the run id as a number, or 0 if the id is not hexadecimal.
    pub fn id_number(&self) -> u32 {
        u32::from_str_radix(&self.id, 16).unwrap_or(0)
    }

    /// Returns the length that scales competitor events, in days ([`Horizon`](novamind_world::params::Horizon)).
    pub fn total_days(&self) -> u32 {
        self.total_days.unwrap_or(self.days)
    }

    /// Returns the rule that derived the last day.
    pub fn horizon_rule(&self) -> HorizonRule {
        self.parameter("run", "horizon_rule").unwrap_or(HorizonRule::Exact)
    }

    /// Returns the generation of the released simulator that defines the rules of the run at its start.
    pub fn generation(&self) -> Interface {
        self.parameter("fidelity", "interface").unwrap_or(Interface::Release1)
    }

    /// Returns the value of a parameter that differs from the bundled parameters.
    fn parameter<T: serde::de::DeserializeOwned>(&self, table: &str, key: &str) -> Option<T> {
        self.parameters.get(table)?.get(key)?.clone().try_into().ok()
    }

    /// Reads the manifest in a run folder.
    ///
    /// # Errors
    /// The file is missing, is damaged, or has another format.
    pub fn read(folder: &Path) -> Result<Manifest, RunError> {
        let path = folder.join("run.toml");
        let text = std::fs::read_to_string(&path).map_err(RunError::io(&path))?;
        // Read the format number first: a newer format may have fields that this program cannot parse.
        let format = text.parse::<Table>().ok().and_then(|table| table.get("format")?.as_integer());
        if let Some(format) = format.filter(|format| *format > i64::from(FORMAT)) {
            let id = folder.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
            return Err(RunError::OtherFormat { id, format: format as u32, known: FORMAT });
        }
        let manifest: Manifest = toml::from_str(&text).map_err(|error| RunError::Damaged {
            line: error.span().map_or(1, |span| text[..span.start].matches('\n').count() + 1),
            problem: error.message().to_owned(),
            remedy: "The trajectory was not changed; restore run.toml from a copy to open the run".to_owned(),
            path,
        })?;
        manifest.check_compatible()
    }

    /// Returns the manifest if this program supports its mechanics and format.
    fn check_compatible(self) -> Result<Manifest, RunError> {
        if self.format > FORMAT {
            return Err(RunError::OtherFormat { id: self.id, format: self.format, known: FORMAT });
        }
        if self.mechanics != MECHANICS {
            return Err(RunError::OtherMechanics {
                id: self.id,
                version: self.version,
                recorded: self.mechanics,
                expected: MECHANICS,
            });
        }
        if self.fault.is_some() && self.mode != Mode::Debug {
            let message = format!("run {} names a seeded fault, which only a debug run can have", self.id);
            return Err(RunError::InvalidRequest(message));
        }
        Ok(self)
    }

    /// Builds the manifest from the first line of a trajectory.
    ///
    /// # Errors
    /// The line does not start a run.
    pub fn from_start_line(path: &Path, line: Option<&Line>) -> Result<Manifest, RunError> {
        let damaged = |problem: &str| RunError::Damaged {
            path: path.to_owned(),
            line: 1,
            problem: problem.to_owned(),
            remedy: "Nothing was changed".to_owned(),
        };
        let Some((line, Record::Start(start))) = line.map(|line| (line, &line.record)) else {
            return Err(damaged("the trajectory does not begin with the start of a run"));
        };
        let start = start.as_ref().clone();
        let earlier_runs = count_runs_with_same_seed(&start.earlier_runs, start.seed, &start.scenario);
        Manifest {
            format: start.format,
            version: start.version,
            mechanics: start.mechanics,
            id: start.run,
            created: line.at.clone(),
            seed: start.seed,
            days: start.days,
            total_days: start.total_days,
            cash: start.cash,
            scenario: start.scenario,
            mode: start.mode,
            participant: start.participant,
            earlier_runs,
            consent: start.consent,
            parameters_digest: start.parameters_digest,
            parent: start.parent,
            study: start.study,
            lesson: start.lesson,
            handout: start.handout,
            voice: start.voice,
            rules: start.rules,
            earlier: start.earlier_runs,
            fault: start.fault,
            parameters: start.overrides,
        }
        .check_compatible()
    }

    /// Writes the manifest to a run folder atomically.
    ///
    /// # Errors
    /// The folder cannot be written.
    pub fn write(&self, folder: &Path) -> Result<(), RunError> {
        let path = folder.join("run.toml");
        write_atomically(&path, self.to_toml().as_bytes())
    }

    /// Returns the text of `run.toml`.
    pub fn to_toml(&self) -> String {
        toml::to_string(self).expect("a manifest holds plain values")
    }

    /// Returns the session rules that apply to the run. A practice run never shows results, because results would
    /// reveal what the study measures.
    pub fn session_rules(&self) -> SessionRules {
        let rules = self.recorded_rules();
        match self.is_practice() {
            true => SessionRules { results: ResultsDisclosure::None, ..rules },
            false => rules,
        }
    }

    /// Returns the recorded rules, or the rules of the mode if no rules are recorded.
    pub fn recorded_rules(&self) -> SessionRules {
        self.rules.clone().unwrap_or_else(|| SessionRules::for_mode(self.mode))
    }

    /// Returns whether the run is a practice run of a study.
    pub fn is_practice(&self) -> bool {
        self.study.as_ref().is_some_and(|study| study.practice)
    }

    /// Returns whether the run has a seeded fault or parameters that differ from the bundled scenario of the same name.
    /// The horizon rule does not count, because it only determines the length.
    pub fn has_changed_parameters(&self) -> bool {
        let bundled = Configuration::bundled();
        let load_bundled =
            || bundled.load_parameters(&bundled.load_scenario(&self.scenario).ok()?, &[], false).ok();
        match self.scenario.as_str() {
            // Fast path for run lists: most runs use the default scenario, which has no overrides.
            "default" => self.fault.is_some() || self.parameters.iter().any(|entry| !is_horizon_rule(entry)),
            // The digests are compared because a scenario can have keys that the recording version did not have.
            _ => load_bundled().is_none_or(|mut params| {
                params.run.horizon_rule = self.horizon_rule();
                ![params.digest(), params.earlier_digest()].contains(&self.parameters_digest)
            }),
        }
    }

    /// Returns the parameters with which the run was recorded.
    ///
    /// # Errors
    /// The bundled parameters of this program differ from the parameters of the recording version.
    pub fn load_params(&self) -> Result<Params, RunError> {
        let other = |digest: String| RunError::OtherParameters {
            id: self.id.clone(),
            version: self.version.clone(),
            recorded: self.parameters_digest.clone(),
            expected: digest,
        };
        let text = toml::to_string(&self.parameters).expect("a table reads back");
        let over = ParameterSource { name: "run.toml".to_owned(), text };
        let loaded = Params::load(&bundled_sources(), &[over])
            .map_err(|error: ParameterError| other(format!("no compatible parameters: {error}")))?;
        let params = Params { fault: self.fault, ..loaded };
        let digest = params.digest();
        if digest == self.parameters_digest { Ok(params) } else { Err(other(digest)) }
    }
}

/// Returns whether a table of changed parameters contains only the horizon rule.
fn is_horizon_rule((name, table): (&String, &Value)) -> bool {
    name == "run" && table.as_table().is_some_and(|table| table.keys().all(|key| key == "horizon_rule"))
}

/// Returns the number of earlier runs with this seed and scenario.
pub fn count_runs_with_same_seed(earlier: &[EarlierRun], seed: u64, scenario: &str) -> u32 {
    earlier.iter().filter(|run| run.seed == seed && run.scenario == scenario).count() as u32
}

/// Returns the parameters that differ from the bundled parameters, as a table of tables.
pub fn changed_parameters(params: &Params) -> Table {
    let as_table = |params: &Params| match Value::try_from(params) {
        Ok(Value::Table(table)) => table,
        _ => Table::new(),
    };
    changed_entries(&as_table(params), &as_table(&Params::bundled()))
}

fn changed_entries(table: &Table, bundled: &Table) -> Table {
    table
        .iter()
        .filter_map(|(key, value)| match (value, bundled.get(key)) {
            (value, Some(same)) if value == same => None,
            (Value::Table(table), Some(Value::Table(bundled))) => {
                Some((key.clone(), Value::Table(changed_entries(table, bundled))))
            }
            (value, _) => Some((key.clone(), value.clone())),
        })
        .collect()
}

/// Converts a manifest to the start event, which is the first line of a trajectory.
pub fn to_start_record(manifest: &Manifest) -> Record {
    let manifest = manifest.clone();
    Record::Start(Box::new(Start {
        format: manifest.format,
        version: manifest.version,
        mechanics: manifest.mechanics,
        run: manifest.id,
        seed: manifest.seed,
        days: manifest.days,
        total_days: manifest.total_days,
        cash: manifest.cash,
        scenario: manifest.scenario,
        overrides: manifest.parameters,
        fault: manifest.fault,
        parameters_digest: manifest.parameters_digest,
        mode: manifest.mode,
        participant: manifest.participant,
        consent: manifest.consent,
        study: manifest.study,
        lesson: manifest.lesson,
        handout: manifest.handout,
        voice: manifest.voice,
        rules: manifest.rules,
        earlier_runs: manifest.earlier,
        parent: manifest.parent,
        line_sums: true,
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::folder::configuration::Configuration;

    fn test_manifest(params: &Params) -> Manifest {
        Manifest {
            format: FORMAT,
            version: "0.1.0".to_owned(),
            mechanics: MECHANICS,
            id: "0123abcd".to_owned(),
            created: "2026-11-21T10:00:00Z".to_owned(),
            seed: 42,
            days: 500,
            total_days: None,
            cash: 1_000_000.0,
            scenario: "paper".to_owned(),
            mode: Mode::Sandbox,
            participant: None,
            earlier_runs: 0,
            consent: None,
            parameters_digest: params.digest(),
            parent: None,
            study: None,
            lesson: None,
            handout: None,
            voice: None,
            rules: None,
            earlier: Vec::new(),
            fault: None,
            parameters: changed_parameters(params),
        }
    }

    #[test]
    fn scenario_parameters_round_trip_through_the_manifest() {
        let folder = tempfile::tempdir().expect("a folder");
        let configuration = Configuration::bundled();
        for name in configuration.scenario_names() {
            let scenario = configuration.load_scenario(&name).expect("a scenario");
            let params = configuration.load_parameters(&scenario, &[], false).expect("its parameters");
            let manifest = test_manifest(&params);
            manifest.write(folder.path()).expect("it is written");
            let read = Manifest::read(folder.path()).expect("it is read");
            assert_eq!(read, manifest);
            assert_eq!(read.load_params().expect("its parameters"), params);
        }
        assert!(changed_parameters(&Params::bundled()).is_empty());
    }

    #[test]
    fn manifest_rejects_other_parameters_mechanics_and_formats() {
        let folder = tempfile::tempdir().expect("a folder");
        let mut manifest = test_manifest(&Params::bundled());
        manifest.parameters_digest = "0000000000000000".to_owned();
        assert!(
            manifest.load_params().expect_err("another digest").to_string().contains("Nothing was changed")
        );
        manifest.mechanics = MECHANICS + 1;
        manifest.write(folder.path()).expect("it is written");
        let error = Manifest::read(folder.path()).expect_err("other mechanics").to_string();
        assert!(error.contains("version 0.1.0") && error.contains("Nothing was changed"), "{error}");
        manifest.mechanics = MECHANICS;
        manifest.format = FORMAT + 1;
        manifest.write(folder.path()).expect("it is written");
        let error = Manifest::read(folder.path()).expect_err("another format").to_string();
        assert!(error.contains(&format!("format {}", FORMAT + 1)), "{error}");
        std::fs::write(folder.path().join("run.toml"), "format = 1\nversion = ").expect("a file");
        let error = Manifest::read(folder.path()).expect_err("damaged").to_string();
        assert!(error.contains("line 2") && error.contains("trajectory was not changed"), "{error}");
    }
}
