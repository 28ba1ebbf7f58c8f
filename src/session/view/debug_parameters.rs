//! Read access to the parameters of a debug run for its player (docs/debugging.md#parameters).

use serde::Serialize;
use serde_json::Value;

use super::CompanyView;
use crate::company::overrides::{require_debug_mode, unknown_parameter_rejection, value_to_json};
use novamind_record::folder::configuration::Configuration;
use novamind_tools::Rejection;
use novamind_world::params::Params;

/// A parameter whose current or scheduled value differs from the scenario.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ChangedParameter {
    /// Full key of the parameter.
    pub key: String,
    /// Value before the change, or in the scenario.
    pub old: Value,
    /// Current or scheduled value.
    pub new: Value,
    /// First simulated day with the new value; `None` if the value is in force.
    pub from_day: Option<u32>,
}

/// Differences between the parameters of a run and its scenario.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ChangedParameters {
    /// Bundled scenario with which the values are compared; `None` if they are compared with the start of the run.
    pub scenario: Option<String>,
    /// Parameters in force that differ, ordered by key.
    pub in_force: Vec<ChangedParameter>,
    /// Scheduled changes, ordered by day.
    pub waiting: Vec<ChangedParameter>,
}

/// Read access to the parameters of a debug run.
pub struct DebugParameters<'a>(CompanyView<'a>);

impl<'a> CompanyView<'a> {
    /// Returns read access to the parameters. Permission depends only on the mode of the run.
    ///
    /// # Errors
    /// The rejection `not_in_this_mode`.
    pub fn debug_parameters(&self) -> Result<DebugParameters<'a>, Rejection> {
        require_debug_mode(self.manifest.mode).map(|()| DebugParameters(*self))
    }
}

impl DebugParameters<'_> {
    /// Returns the current value of a parameter, or of a list or table of parameters.
    ///
    /// # Errors
    /// The rejection `parameter_unknown`.
    pub fn value(&self, key: &str) -> Result<Value, Rejection> {
        self.0
            .simulation
            .params
            .value(key)
            .map(|value| value_to_json(&value))
            .map_err(unknown_parameter_rejection)
    }

    /// Returns the parameters that differ from the scenario, and the scheduled changes.
    ///
    /// # Errors
    /// `not_readable`: the parameters at the start of the run cannot be read.
    pub fn changes(&self) -> Result<ChangedParameters, Rejection> {
        let CompanyView { manifest, simulation, .. } = self.0;
        let bundled = Configuration::bundled();
        let scenario = bundled.load_scenario(&manifest.scenario).ok();
        let of_scenario =
            scenario.as_ref().and_then(|scenario| bundled.load_parameters(scenario, &[], false).ok());
        let scenario = of_scenario.as_ref().and(scenario.map(|scenario| scenario.name));
        let base = of_scenario.map_or_else(|| manifest.load_params(), Ok);
        let base = base.map_err(|error| Rejection::new("not_readable", error.to_string()))?;
        let as_json = |value: Option<toml::Value>| value.as_ref().map_or(Value::Null, value_to_json);
        let in_force = base.differences(&simulation.params).into_iter().map(|found| ChangedParameter {
            key: found.key,
            old: as_json(found.old),
            new: as_json(found.new),
            from_day: None,
        });
        let old = |key: &str, params: &Params| as_json(params.value(key).ok());
        let waiting = simulation.overrides.scheduled_changes().map(|change| ChangedParameter {
            key: change.key.clone(),
            old: old(&change.key, &base),
            new: value_to_json(&change.value),
            from_day: change.from_day,
        });
        Ok(ChangedParameters { scenario, in_force: in_force.collect(), waiting: waiting.collect() })
    }
}
