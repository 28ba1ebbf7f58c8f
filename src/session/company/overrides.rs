//! Immediate and scheduled parameter changes during a debug run, and values derived from the parameters in force.

use std::collections::BTreeSet;
use std::sync::{Arc, OnceLock};

use serde_json::Value as Json;
use toml::{Table, Value};

use super::simulation::Simulation;
use novamind_base::formatting::json_number;
use novamind_record::folder::manifest::Manifest;
use novamind_record::mode::Mode;
use novamind_record::trajectory::record::Override;
use novamind_record::trajectory::{Line, Record};
use novamind_tools::{ParameterNumbers, Rejection};
use novamind_world::params::{ParameterError, Params};

/// An immediate or scheduled change of a parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct ParameterChange {
    /// Number of the line that records the change.
    pub seq: u64,
    /// Full key of the parameter.
    pub key: String,
    /// Value after the change.
    pub value: Value,
    /// First simulated day with the new value; `None` if the change takes effect immediately.
    pub from_day: Option<u32>,
}

impl ParameterChange {
    /// Reads the change from a recorded line. Returns `None` if no parameter can have a value of this type.
    pub fn from_record(seq: u64, line: &Override) -> Option<ParameterChange> {
        let value = json_to_value(&line.new)?;
        Some(ParameterChange { seq, key: line.key.clone(), value, from_day: line.from_day })
    }
}

#[derive(Debug, Clone)]
struct ScheduledChange {
    day: u32,
    change: ParameterChange,
    params: Arc<Params>,
}

/// The parameter changes of a run that are scheduled for later days.
#[derive(Debug, Clone, Default)]
pub struct Overrides {
    has_changes: bool,
    /// Scheduled changes in the order of their days. Changes of the same day are in the order of their lines.
    scheduled: Vec<ScheduledChange>,
}

/// The parameters of a run after a change was added.
pub struct UpdatedParams {
    /// Parameters in force on the current day.
    pub current: Arc<Params>,
    /// Parameters in force after the change takes effect.
    pub after_change: Arc<Params>,
}

/// The reason why a parameter change is not allowed.
#[derive(Debug)]
pub struct ParameterConflict {
    /// The later day on which values would contradict each other; `None` if the change itself is invalid.
    pub day: Option<u32>,
    /// Error of the invalid value.
    pub error: ParameterError,
}

impl Overrides {
    /// Returns whether any parameter was changed since the start of the run.
    pub(crate) fn has_changes(&self) -> bool {
        self.has_changes
    }

    /// Returns the scheduled changes in the order of their days.
    pub fn scheduled_changes(&self) -> impl Iterator<Item = &ParameterChange> {
        self.scheduled.iter().map(|scheduled_change| &scheduled_change.change)
    }

    /// Adds an immediate or scheduled change. Checks that all scheduled changes remain valid, so that no change can
    /// fail on its day.
    ///
    /// # Errors
    /// The value is not allowed, or contradicts another value now or on a later day. After an error, nothing has
    /// changed.
    pub fn add_change(
        &mut self,
        now: &Arc<Params>,
        change: ParameterChange,
    ) -> Result<UpdatedParams, ParameterConflict> {
        let (mut now, mut later): (_, Vec<ParameterChange>) =
            (now.clone(), self.scheduled_changes().cloned().collect());
        let number = change.seq;
        match change.from_day {
            None => {
                now = params_after_change(&now, &change)
                    .map_err(|error| ParameterConflict { day: None, error })?
            }
            Some(day) => later.insert(later.partition_point(|other| other.from_day <= Some(day)), change),
        }
        let mut waiting: Vec<ScheduledChange> = Vec::with_capacity(later.len());
        for change in later {
            let before = waiting.last().map_or(&now, |last| &last.params);
            let params = params_after_change(before, &change).map_err(|error| {
                let day = change.from_day.filter(|_| change.seq != number);
                ParameterConflict { day, error }
            })?;
            waiting.push(ScheduledChange { day: change.from_day.unwrap_or_default(), change, params });
        }
        let changed =
            waiting.iter().find(|waits| waits.change.seq == number).map_or(&now, |waits| &waits.params);
        let updated_params = UpdatedParams { after_change: changed.clone(), current: now };
        *self = Overrides { has_changes: true, scheduled: waiting };
        Ok(updated_params)
    }

    pub(crate) fn params_due_on(&self, day: u32) -> Option<&Arc<Params>> {
        let count = self.scheduled.partition_point(|scheduled_change| scheduled_change.day <= day);
        self.scheduled[..count].last().map(|change| &change.params)
    }

    /// Returns the parameters for a day, if parameters change on that day, and removes the changes from the schedule.
    pub(crate) fn take_due_params(&mut self, day: u32) -> Option<Arc<Params>> {
        let count = self.scheduled.partition_point(|scheduled_change| scheduled_change.day <= day);
        self.scheduled.drain(..count).next_back().map(|change| change.params)
    }

    /// Applies the scheduled changes to other parameters and returns the result. Omits changes on the lines in
    /// `dropped`, and changes that are not valid for these parameters.
    pub fn rebased_on(&self, now: &Arc<Params>, dropped: &BTreeSet<u64>) -> Overrides {
        let mut overrides = Overrides { has_changes: self.has_changes, scheduled: Vec::new() };
        for change in self.scheduled_changes().filter(|change| !dropped.contains(&change.seq)) {
            let _ = overrides.add_change(now, change.clone());
        }
        overrides
    }

    /// Applies the parameter changes in `lines` up to the end of a day to the parameters `opening`. Returns `None` if
    /// a change is not valid.
    pub(crate) fn replay(
        opening: &Arc<Params>,
        lines: &[Line],
        day: u32,
    ) -> Option<(Arc<Params>, Overrides)> {
        let (mut now, mut overrides) = (opening.clone(), Overrides::default());
        for line in lines {
            let Record::Override(change) = &line.record else { continue };
            now = overrides.take_due_params(line.day).unwrap_or(now);
            now = overrides.add_change(&now, ParameterChange::from_record(line.seq, change)?).ok()?.current;
        }
        now = overrides.take_due_params(day).unwrap_or(now);
        Some((now, overrides))
    }
}

fn params_after_change(params: &Params, change: &ParameterChange) -> Result<Arc<Params>, ParameterError> {
    params.with(&change.key, change.value.clone()).map(Arc::new)
}

/// Converts a JSON value to a parameter value. Returns `None` if the value has no equivalent.
pub fn json_to_value(value: &Json) -> Option<Value> {
    Some(match value {
        Json::Null => return None,
        Json::Bool(flag) => Value::Boolean(*flag),
        Json::Number(number) => match number.as_i64() {
            Some(whole) => Value::Integer(whole),
            None => Value::Float(number.as_f64()?),
        },
        Json::String(text) => Value::String(text.clone()),
        Json::Array(list) => Value::Array(list.iter().map(json_to_value).collect::<Option<_>>()?),
        Json::Object(fields) => {
            let field = |(name, value): (&String, &Json)| Some((name.clone(), json_to_value(value)?));
            Value::Table(fields.iter().map(field).collect::<Option<Table>>()?)
        }
    })
}

/// Converts a parameter value to JSON. Whole numbers have no decimal point.
pub fn value_to_json(value: &Value) -> Json {
    match value {
        Value::String(text) => Json::from(text.as_str()),
        Value::Integer(number) => Json::from(*number),
        Value::Float(number) => json_number(*number),
        Value::Boolean(flag) => Json::from(*flag),
        Value::Datetime(moment) => Json::from(moment.to_string()),
        Value::Array(list) => list.iter().map(value_to_json).collect(),
        Value::Table(table) => {
            Json::Object(table.iter().map(|(name, value)| (name.clone(), value_to_json(value))).collect())
        }
    }
}

/// Values derived from the parameters in force; reset when a parameter changes.
#[derive(Default)]
pub(crate) struct DerivedValues {
    numbers: OnceLock<Arc<ParameterNumbers>>,
    has_custom_parameters: OnceLock<bool>,
}

impl DerivedValues {
    pub(crate) fn parameter_numbers(&self, simulation: &Simulation) -> Arc<ParameterNumbers> {
        self.numbers.get_or_init(|| ParameterNumbers::from_params(&simulation.params).into()).clone()
    }

    /// Returns whether the parameters differ from the bundled scenario, or differed earlier in the run.
    pub(crate) fn has_custom_parameters(&self, simulation: &Simulation, manifest: &Manifest) -> bool {
        let is_other = || simulation.overrides.has_changes() || manifest.has_changed_parameters();
        *self.has_custom_parameters.get_or_init(is_other)
    }
}

/// Checks that parameters may be read or set, which is allowed only in debug runs.
///
/// # Errors
/// The rejection `not_in_this_mode`.
pub fn require_debug_mode(mode: Mode) -> Result<(), Rejection> {
    match mode {
        Mode::Debug => Ok(()),
        _ => Err(Rejection::new("not_in_this_mode", "parameters can be set in debug runs only")),
    }
}

/// Returns the rejection for an unknown parameter.
pub fn unknown_parameter_rejection(error: ParameterError) -> Rejection {
    Rejection::for_field(error.key, "parameter_unknown", error.problem)
}

/// Returns the rejection for a value that is not allowed.
pub fn parameter_not_allowed_rejection(ParameterConflict { day, error }: ParameterConflict) -> Rejection {
    let message = match day {
        None => error.problem,
        Some(day) => format!("{} from day {day}, because of a change scheduled for that day", error.problem),
    };
    Rejection::for_field(error.key, "parameter_not_allowed", message)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn change(seq: u64, key: &str, value: f64, from_day: Option<u32>) -> ParameterChange {
        ParameterChange { seq, key: key.to_owned(), value: Value::Float(value), from_day }
    }

    const MIN_KEY: &str = "competitor.competitor_feedback_u_min";
    const MAX_KEY: &str = "competitor.competitor_feedback_u_max";

    #[test]
    fn scheduled_changes_apply_on_their_day_and_accumulate() {
        let (now, mut overrides) = (Arc::new(Params::bundled()), Overrides::default());
        assert!(!overrides.has_changes());
        overrides
            .add_change(&now, change(5, "satisfaction.satisfaction_ema_alpha", 0.5, Some(30)))
            .expect("it fits");
        overrides
            .add_change(&now, change(6, "satisfaction.satisfaction_ema_alpha", 0.6, Some(20)))
            .expect("it fits");
        let updated_params =
            overrides.add_change(&now, change(7, "operations.base_outage_prob", 0.7, None)).expect("it fits");
        assert_eq!(updated_params.current.operations.base_outage_prob, 0.7);
        assert!(overrides.take_due_params(19).is_none());
        let on_20 = overrides.take_due_params(20).expect("one is due");
        assert_eq!(on_20.satisfaction.satisfaction_ema_alpha, 0.6);
        assert_eq!(on_20.operations.base_outage_prob, 0.7);
        let later = overrides.take_due_params(44).expect("one is due");
        assert_eq!(later.satisfaction.satisfaction_ema_alpha, 0.5);
        assert_eq!(overrides.scheduled_changes().count(), 0);
        assert!(overrides.has_changes());
    }

    #[test]
    fn add_change_rejects_later_contradictions() {
        let (now, mut overrides) = (Arc::new(Params::bundled()), Overrides::default());
        let max = now.competitor.competitor_feedback_u_max;
        overrides.add_change(&now, change(1, MIN_KEY, max - 0.01, Some(30))).expect("it fits");
        let unfit = overrides
            .add_change(&now, change(2, MAX_KEY, max - 0.02, None))
            .err()
            .expect("the values contradict each other on day 30");
        assert_eq!(unfit.day, Some(30));
        assert_eq!(overrides.scheduled_changes().count(), 1, "the schedule is unchanged");
        overrides
            .add_change(&now, change(3, MIN_KEY, max - 0.05, Some(30)))
            .expect("the later of two changes on a day applies");
        assert_eq!(overrides.rebased_on(&now, &BTreeSet::from([3])).scheduled_changes().count(), 1);
    }

    #[test]
    fn values_round_trip_through_json() {
        let json = serde_json::json!({ "a": [1, 2.5, "x", true], "b": -3 });
        assert_eq!(value_to_json(&json_to_value(&json).expect("a table")), json);
        assert!(json_to_value(&Json::Null).is_none());
        assert!(json_to_value(&serde_json::json!([null])).is_none());
        assert_eq!(value_to_json(&Value::Float(300.0)), serde_json::json!(300));
    }
}
