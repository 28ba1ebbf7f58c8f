//! Parameter changes during a debug run (docs/debugging.md#parameters).

use serde_json::Value;

use super::Session;
use super::tool_call::not_saved_rejection;
use crate::company::overrides::{
    DerivedValues, ParameterChange, UpdatedParams, json_to_value, parameter_not_allowed_rejection,
    require_debug_mode, unknown_parameter_rejection, value_to_json,
};
use crate::figures::journal::JournalEntry;
use crate::view::debug_parameters::ChangedParameter;
use novamind_record::mode::Mode;
use novamind_record::trajectory::record::Override;
use novamind_record::trajectory::{Durability, Record};
use novamind_tools::{Rejection, ToolKind};
use novamind_world::params::ParameterError;

fn has_no_parameter(value: &toml::Value) -> bool {
    value.as_table().is_some_and(|table| table.values().all(has_no_parameter))
}

impl Session {
    /// Sets a parameter, or a list or table of parameters, immediately or on a later day. The change is recorded
    /// before it takes effect.
    ///
    /// # Errors
    /// `not_in_this_mode` if the run is not a debug run; `run_over`, `read_only`, `day_unknown`, `parameter_unknown`,
    /// `parameter_not_allowed`, `not_saved`. After an error, nothing has changed.
    pub fn set_parameter(
        &mut self,
        key: &str,
        value: &Value,
        from_day: Option<u32>,
    ) -> Result<ChangedParameter, Rejection> {
        require_debug_mode(self.manifest.mode)?;
        self.set_parameter_in_any_mode(key, value, from_day)
    }

    /// Sets a parameter that a lesson changes, with immediate effect.
    ///
    /// # Errors
    /// The same errors as [`Session::set_parameter`].
    pub(crate) fn set_lesson_parameter(&mut self, key: &str, value: &Value) -> Result<(), Rejection> {
        self.set_parameter_in_any_mode(key, value, None).map(|_| ())
    }

    fn set_parameter_in_any_mode(
        &mut self,
        key: &str,
        value: &Value,
        from_day: Option<u32>,
    ) -> Result<ChangedParameter, Rejection> {
        self.check_can_act(ToolKind::Time)?;
        let (today, last) = (self.simulation.world.day, self.manifest.days);
        if let Some(day) = from_day.filter(|day| !(today + 1..=last).contains(day)) {
            let message = format!("the start day must be between {} and {last}, not {day}", today + 1);
            return Err(Rejection::for_field("from", "day_unknown", message));
        }
        let old = value_to_json(&self.simulation.params.value(key).map_err(unknown_parameter_rejection)?);
        let value = json_to_value(value).ok_or_else(|| {
            Rejection::for_field(key, "parameter_not_allowed", format!("{key} cannot be or contain null"))
        })?;
        if has_no_parameter(&value) {
            let message = format!("the table contains no parameter; name a parameter of {key}");
            return Err(Rejection::for_field(key, "parameter_not_allowed", message));
        }
        let change =
            ParameterChange { seq: self.log.position().seq + 1, key: key.to_owned(), value, from_day };
        let mut overrides = self.simulation.overrides.clone();
        let UpdatedParams { current: now, after_change: changed } =
            overrides.add_change(&self.simulation.params, change).map_err(parameter_not_allowed_rejection)?;
        let new = value_to_json(&changed.value(key).map_err(unknown_parameter_rejection)?);
        let line = Override { key: key.to_owned(), old: old.clone(), new: new.clone(), from_day };
        self.append(&Record::Override(line.clone()), Durability::Synced).map_err(not_saved_rejection)?;
        self.add_to_journal(self.log.position().seq, &line);
        self.simulation.overrides = overrides;
        self.simulation.set_params(now, self.database.entry_writer());
        self.derived_values = DerivedValues::default();
        Ok(ChangedParameter { key: key.to_owned(), old, new, from_day })
    }

    /// Applies a recorded parameter change during a replay.
    ///
    /// # Errors
    /// The line contradicts the state before the change.
    pub(crate) fn replay_override(&mut self, seq: u64, line: &Override) -> Result<(), String> {
        if self.manifest.mode != Mode::Debug && self.manifest.lesson.is_none() {
            return Err(
                "the line sets a parameter, which is allowed only in debug runs and lessons".to_owned()
            );
        }
        let today = self.simulation.world.day;
        if line.from_day.is_some_and(|day| day <= today) {
            return Err(format!("the line sets a parameter from a day that is not after day {today}"));
        }
        let current_value =
            self.simulation.params.value(&line.key).map_err(|error| describe_error(&error))?;
        if value_to_json(&current_value) != line.old {
            return Err(format!("{} was not {} before this change", line.key, line.old));
        }
        self.add_to_journal(seq, line);
        let change = ParameterChange::from_record(seq, line)
            .ok_or("the value in the line is not valid for a parameter")?;
        let taken = self.simulation.overrides.add_change(&self.simulation.params, change);
        let UpdatedParams { current: now, .. } = taken.map_err(|unfit| describe_error(&unfit.error))?;
        self.simulation.set_params(now, self.database.entry_writer());
        self.derived_values = DerivedValues::default();
        Ok(())
    }

    /// Adds a parameter change to the journal of a debug run. Changes by a lesson are omitted, because the student
    /// did not decide them.
    fn add_to_journal(&mut self, seq: u64, line: &Override) {
        if self.manifest.mode == Mode::Debug {
            let Override { key, old, new, from_day } = line.clone();
            let day = self.simulation.world.day;
            self.history.journal.push(JournalEntry::Parameter { seq, day, key, old, new, from_day });
        }
    }
}

fn describe_error(error: &ParameterError) -> String {
    format!("{}: {}", error.key, error.problem)
}
