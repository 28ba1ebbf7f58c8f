//! Setting parameters of a debug run while it goes on (docs/debugging.md#parameters).

use std::sync::OnceLock;

use serde::Serialize;
use serde_json::Value;

use super::act::not_saved;
use super::overrides::{ParameterChange, Taken, Unfit, json_of_value, value_of_json};
use crate::figures::journal::JournalEntry;
use crate::state::Session;
use novamind_record::folder::configuration::Configuration;
use novamind_record::mode::Mode;
use novamind_record::trajectory::record::Override;
use novamind_record::trajectory::{Durability, Record};
use novamind_tools::{Kind, Refusal};
use novamind_world::params::{ParameterError, Params};

/// A parameter whose value is, or will be, another than that of the scenario.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ChangedParameter {
    /// Full key.
    pub key: String,
    /// Value before, or in the scenario.
    pub old: Value,
    /// Value from then on.
    pub new: Value,
    /// First day that is simulated with it; none: it is in force.
    pub from_day: Option<u32>,
}

/// What differs from the scenario of a run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ChangedParameters {
    /// What the values are held against: a shipped scenario, or none: the start of the run.
    pub scenario: Option<String>,
    /// Parameters in force with another value, by key.
    pub in_force: Vec<ChangedParameter>,
    /// Changes that wait for their day, the first one first.
    pub waiting: Vec<ChangedParameter>,
}

/// Whether a value is a table, or tables in a table, without any parameter.
fn names_nothing(value: &toml::Value) -> bool {
    value.as_table().is_some_and(|table| table.values().all(names_nothing))
}

impl Session {
    /// Sets a parameter, or a list or table of them, from now on, or from a later day on. The change is recorded before it
    /// acts.
    ///
    /// # Errors
    /// `not_in_this_mode` where the run is no debug run, whatever is to be set; `run_over`, `read_only`, `day_unknown`,
    /// `parameter_unknown`, `parameter_not_allowed`, `not_saved`. Nothing has changed then.
    pub fn set_parameter(
        &mut self,
        key: &str,
        value: &Value,
        from_day: Option<u32>,
    ) -> Result<ChangedParameter, Refusal> {
        self.refuse_parameters()?;
        self.set_parameter_anyway(key, value, from_day)
    }

    /// Sets a parameter as the lesson of the run does, from now on.
    ///
    /// # Errors
    /// As [`Session::set_parameter`].
    pub(crate) fn set_parameter_of_lesson(&mut self, key: &str, value: &Value) -> Result<(), Refusal> {
        self.set_parameter_anyway(key, value, None).map(|_| ())
    }

    fn set_parameter_anyway(
        &mut self,
        key: &str,
        value: &Value,
        from_day: Option<u32>,
    ) -> Result<ChangedParameter, Refusal> {
        self.refuse_if_over(Kind::Time)?;
        let (today, last) = (self.simulation.world.day, self.manifest.days);
        if let Some(day) = from_day.filter(|day| !(today + 1..=last).contains(day)) {
            let message =
                format!("a parameter is set from day {} to {last} on, not from day {day}", today + 1);
            return Err(Refusal::at("from", "day_unknown", message));
        }
        let old = json_of_value(&self.simulation.params.value(key).map_err(unknown)?);
        let value = value_of_json(value).ok_or_else(|| {
            Refusal::at(key, "parameter_not_allowed", format!("{key} cannot be null, nor hold it"))
        })?;
        if names_nothing(&value) {
            let message = format!("a table that names no parameter sets none; name one of {key}");
            return Err(Refusal::at(key, "parameter_not_allowed", message));
        }
        let change = ParameterChange { seq: self.position.seq + 1, key: key.to_owned(), value, from_day };
        let mut overrides = self.simulation.overrides.clone();
        let Taken { now, changed } = overrides.take(&self.simulation.params, change).map_err(not_allowed)?;
        let new = json_of_value(&changed.value(key).map_err(unknown)?);
        let line = Override { key: key.to_owned(), old: old.clone(), new: new.clone(), from_day };
        self.append(&Record::Override(line.clone()), Durability::Synced).map_err(not_saved)?;
        self.enter_parameter(self.position.seq, &line);
        self.simulation.overrides = overrides;
        self.simulation.use_params(now, self.projection.entries());
        self.renew_what_follows_from_parameters();
        Ok(ChangedParameter { key: key.to_owned(), old, new, from_day })
    }

    /// Sets a parameter again as a line tells it.
    ///
    /// # Errors
    /// The line does not follow from what is before it.
    pub(crate) fn replay_override(&mut self, seq: u64, line: &Override) -> Result<(), String> {
        if self.manifest.mode != Mode::Debug && self.manifest.lesson.is_none() {
            return Err("it sets a parameter, which only a debug run can, or a lesson by itself".to_owned());
        }
        let today = self.simulation.world.day;
        if line.from_day.is_some_and(|day| day <= today) {
            return Err(format!("it sets a parameter from a day on that has passed on day {today}"));
        }
        let held = self.simulation.params.value(&line.key).map_err(|error| in_words(&error))?;
        if json_of_value(&held) != line.old {
            return Err(format!("{} was not {} before it", line.key, line.old));
        }
        self.enter_parameter(seq, line);
        let change = ParameterChange::of(seq, line).ok_or("its value is none that a parameter can have")?;
        let taken = self.simulation.overrides.take(&self.simulation.params, change);
        let Taken { now, .. } = taken.map_err(|unfit| in_words(&unfit.error))?;
        self.simulation.use_params(now, self.projection.entries());
        self.renew_what_follows_from_parameters();
        Ok(())
    }

    /// Enters a parameter of a debug run into the journal: what a lesson sets by itself was not decided by whom it shows.
    fn enter_parameter(&mut self, seq: u64, line: &Override) {
        if self.manifest.mode == Mode::Debug {
            let Override { key, old, new, from_day } = line.clone();
            let day = self.simulation.world.day;
            self.history.journal.push(JournalEntry::Parameter { seq, day, key, old, new, from_day });
        }
    }

    /// The value of a parameter, or of a list or table of them, as it is in force.
    ///
    /// # Errors
    /// `not_in_this_mode` where the run is no debug run, `parameter_unknown`.
    pub fn parameter(&self, key: &str) -> Result<Value, Refusal> {
        self.refuse_parameters()?;
        self.simulation.params.value(key).map(|value| json_of_value(&value)).map_err(unknown)
    }

    /// Everything that differs from the scenario, and what waits for its day.
    ///
    /// # Errors
    /// `not_in_this_mode` where the run is no debug run.
    pub fn changed_parameters(&self) -> Result<ChangedParameters, Refusal> {
        self.refuse_parameters()?;
        let shipped = Configuration::shipped();
        let scenario = shipped.scenario(&self.manifest.scenario).ok();
        let of_scenario = scenario.as_ref().and_then(|own| shipped.parameters(own, &[], false).ok());
        let scenario = of_scenario.as_ref().and(scenario.map(|own| own.name));
        let base = of_scenario.map_or_else(|| self.manifest.params(), Ok);
        let base = base.map_err(|error| Refusal::new("not_readable", error.to_string()))?;
        let as_json = |value: Option<toml::Value>| value.as_ref().map_or(Value::Null, json_of_value);
        let in_force = base.differences(&self.simulation.params).into_iter().map(|found| ChangedParameter {
            key: found.key,
            old: as_json(found.old),
            new: as_json(found.new),
            from_day: None,
        });
        let old = |key: &str, params: &Params| as_json(params.value(key).ok());
        let waiting = self.simulation.overrides.waiting().map(|change| ChangedParameter {
            key: change.key.clone(),
            old: old(&change.key, &base),
            new: json_of_value(&change.value),
            from_day: change.from_day,
        });
        Ok(ChangedParameters { scenario, in_force: in_force.collect(), waiting: waiting.collect() })
    }

    /// Refuses to show and set parameters; the answer depends on nothing but the mode of the run.
    ///
    /// # Errors
    /// `not_in_this_mode`.
    pub fn refuse_parameters(&self) -> Result<(), Refusal> {
        if self.manifest.mode == Mode::Debug {
            return Ok(());
        }
        Err(Refusal::new("not_in_this_mode", "parameters can be set in debug runs only"))
    }

    /// Numbers in texts, and whether results can be compared, follow from the parameters.
    pub(crate) fn renew_what_follows_from_parameters(&mut self) {
        (self.numbers, self.own_parameters) = (OnceLock::new(), OnceLock::new());
    }

    /// Whether the parameters are, or were, others than those of the shipped scenario.
    pub(crate) fn has_own_parameters(&self) -> bool {
        let is_other = || self.simulation.overrides.is_used() || self.manifest.has_own_parameters();
        *self.own_parameters.get_or_init(is_other)
    }
}

fn in_words(error: &ParameterError) -> String {
    format!("{}: {}", error.key, error.problem)
}

/// The refusal for a parameter that does not exist.
pub fn unknown(error: ParameterError) -> Refusal {
    Refusal::at(error.key, "parameter_unknown", error.problem)
}

/// The refusal for a value that a parameter cannot have.
pub fn not_allowed(Unfit { day, error }: Unfit) -> Refusal {
    let message = match day {
        None => error.problem,
        Some(day) => format!("{}, from day {day} on, for which it was set before", error.problem),
    };
    Refusal::at(error.key, "parameter_not_allowed", message)
}
