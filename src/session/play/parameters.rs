//! Parameter changes of a running debug run (docs/debugging.md#parameters).

use serde_json::Value;

use super::Session;
use super::act::not_saved;
use crate::company::overrides::{
    DerivedOfParameters, ParameterChange, Taken, json_of_value, not_allowed, refuse_outside_debug, unknown,
    value_of_json,
};
use crate::figures::journal::JournalEntry;
use crate::view::debug_parameters::ChangedParameter;
use novamind_record::mode::Mode;
use novamind_record::trajectory::record::Override;
use novamind_record::trajectory::{Durability, Record};
use novamind_tools::{Kind, Refusal};
use novamind_world::params::ParameterError;

fn names_nothing(value: &toml::Value) -> bool {
    value.as_table().is_some_and(|table| table.values().all(names_nothing))
}

impl Session {
    /// Sets a parameter, or a list or table of parameters, immediately or from a later day. The change is recorded
    /// before it takes effect.
    ///
    /// # Errors
    /// `not_in_this_mode` if the run is not a debug run; `run_over`, `read_only`, `day_unknown`, `parameter_unknown`,
    /// `parameter_not_allowed`, `not_saved`. Nothing has changed then.
    pub fn set_parameter(
        &mut self,
        key: &str,
        value: &Value,
        from_day: Option<u32>,
    ) -> Result<ChangedParameter, Refusal> {
        refuse_outside_debug(self.manifest.mode)?;
        self.set_parameter_anyway(key, value, from_day)
    }

    /// Sets a parameter immediately, on behalf of the lesson.
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
            let message = format!("the start day must be between {} and {last}, not {day}", today + 1);
            return Err(Refusal::at("from", "day_unknown", message));
        }
        let old = json_of_value(&self.simulation.params.value(key).map_err(unknown)?);
        let value = value_of_json(value).ok_or_else(|| {
            Refusal::at(key, "parameter_not_allowed", format!("{key} cannot be or contain null"))
        })?;
        if names_nothing(&value) {
            let message = format!("the table contains no parameter; name a parameter of {key}");
            return Err(Refusal::at(key, "parameter_not_allowed", message));
        }
        let change =
            ParameterChange { seq: self.log.position().seq + 1, key: key.to_owned(), value, from_day };
        let mut overrides = self.simulation.overrides.clone();
        let Taken { now, changed } = overrides.take(&self.simulation.params, change).map_err(not_allowed)?;
        let new = json_of_value(&changed.value(key).map_err(unknown)?);
        let line = Override { key: key.to_owned(), old: old.clone(), new: new.clone(), from_day };
        self.append(&Record::Override(line.clone()), Durability::Synced).map_err(not_saved)?;
        self.enter_parameter(self.log.position().seq, &line);
        self.simulation.overrides = overrides;
        self.simulation.use_params(now, self.database.entries());
        self.derived = DerivedOfParameters::default();
        Ok(ChangedParameter { key: key.to_owned(), old, new, from_day })
    }

    /// Applies a recorded parameter change again.
    ///
    /// # Errors
    /// The line contradicts the state before it.
    pub(crate) fn replay_override(&mut self, seq: u64, line: &Override) -> Result<(), String> {
        if self.manifest.mode != Mode::Debug && self.manifest.lesson.is_none() {
            return Err("it sets a parameter, which only debug runs and lessons can".to_owned());
        }
        let today = self.simulation.world.day;
        if line.from_day.is_some_and(|day| day <= today) {
            return Err(format!("it sets a parameter from a day that is not after day {today}"));
        }
        let held = self.simulation.params.value(&line.key).map_err(|error| in_words(&error))?;
        if json_of_value(&held) != line.old {
            return Err(format!("{} was not {} before it", line.key, line.old));
        }
        self.enter_parameter(seq, line);
        let change = ParameterChange::of(seq, line).ok_or("its value is not valid for a parameter")?;
        let taken = self.simulation.overrides.take(&self.simulation.params, change);
        let Taken { now, .. } = taken.map_err(|unfit| in_words(&unfit.error))?;
        self.simulation.use_params(now, self.database.entries());
        self.derived = DerivedOfParameters::default();
        Ok(())
    }

    /// Adds a parameter change to the journal of a debug run. Changes by a lesson are omitted, because the student
    /// did not decide them.
    fn enter_parameter(&mut self, seq: u64, line: &Override) {
        if self.manifest.mode == Mode::Debug {
            let Override { key, old, new, from_day } = line.clone();
            let day = self.simulation.world.day;
            self.history.journal.push(JournalEntry::Parameter { seq, day, key, old, new, from_day });
        }
    }
}

fn in_words(error: &ParameterError) -> String {
    format!("{}: {}", error.key, error.problem)
}
