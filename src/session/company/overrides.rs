//! Parameter changes during a debug run, including scheduled ones, and values derived from the parameters in force.

use std::collections::BTreeSet;
use std::sync::{Arc, OnceLock};

use serde_json::Value as Json;
use toml::{Table, Value};

use super::simulation::Simulation;
use novamind_base::notation::json_number;
use novamind_record::folder::manifest::Manifest;
use novamind_record::mode::Mode;
use novamind_record::trajectory::record::Override;
use novamind_record::trajectory::{Line, Record};
use novamind_tools::{Numbers, Refusal};
use novamind_world::params::{ParameterError, Params};

/// A parameter change.
#[derive(Debug, Clone, PartialEq)]
pub struct ParameterChange {
    /// Line that records the change.
    pub seq: u64,
    /// Full key of the parameter.
    pub key: String,
    /// New value.
    pub value: Value,
    /// First simulated day with the new value; `None` if the change takes effect immediately.
    pub from_day: Option<u32>,
}

impl ParameterChange {
    /// Reads the change from a recorded line. Returns `None` if the value is not a valid type for a parameter.
    pub fn of(seq: u64, line: &Override) -> Option<ParameterChange> {
        let value = value_of_json(&line.new)?;
        Some(ParameterChange { seq, key: line.key.clone(), value, from_day: line.from_day })
    }
}

#[derive(Debug, Clone)]
struct WaitingChange {
    day: u32,
    change: ParameterChange,
    params: Arc<Params>,
}

/// The parameter changes of a run.
#[derive(Debug, Clone, Default)]
pub struct Overrides {
    is_used: bool,
    /// Scheduled changes by day; changes of one day in the order of their lines.
    waiting: Vec<WaitingChange>,
}

/// Parameters after a change was added.
pub struct Taken {
    /// Parameters in force now.
    pub now: Arc<Params>,
    /// Parameters in force once the change takes effect.
    pub changed: Arc<Params>,
}

/// The reason why a change is not allowed.
#[derive(Debug)]
pub struct Unfit {
    /// The later day on which values would contradict each other; `None` if the change itself is invalid.
    pub day: Option<u32>,
    /// The error.
    pub error: ParameterError,
}

impl Overrides {
    /// Whether any parameter was changed since the start of the run.
    pub(crate) fn is_used(&self) -> bool {
        self.is_used
    }

    /// Returns the scheduled changes.
    pub fn waiting(&self) -> impl Iterator<Item = &ParameterChange> {
        self.waiting.iter().map(|own| &own.change)
    }

    /// Adds a change. Checks that all scheduled changes remain valid, so that none can fail on its day.
    ///
    /// # Errors
    /// The value is not allowed, or contradicts another value now or on a later day. Nothing has changed then.
    pub fn take(&mut self, now: &Arc<Params>, change: ParameterChange) -> Result<Taken, Unfit> {
        let (mut now, mut later): (_, Vec<ParameterChange>) =
            (now.clone(), self.waiting().cloned().collect());
        let own = change.seq;
        match change.from_day {
            None => now = with(&now, &change).map_err(|error| Unfit { day: None, error })?,
            Some(day) => later.insert(later.partition_point(|other| other.from_day <= Some(day)), change),
        }
        let mut waiting: Vec<WaitingChange> = Vec::with_capacity(later.len());
        for change in later {
            let before = waiting.last().map_or(&now, |last| &last.params);
            let params = with(before, &change).map_err(|error| {
                let day = change.from_day.filter(|_| change.seq != own);
                Unfit { day, error }
            })?;
            waiting.push(WaitingChange { day: change.from_day.unwrap_or_default(), change, params });
        }
        let changed =
            waiting.iter().find(|waits| waits.change.seq == own).map_or(&now, |waits| &waits.params);
        let taken = Taken { changed: changed.clone(), now };
        *self = Overrides { is_used: true, waiting };
        Ok(taken)
    }

    pub(crate) fn due_on(&self, day: u32) -> Option<&Arc<Params>> {
        let count = self.waiting.partition_point(|own| own.day <= day);
        self.waiting[..count].last().map(|own| &own.params)
    }

    /// Returns the parameters for a day, if they change on it, and removes the changes from the schedule.
    pub(crate) fn due(&mut self, day: u32) -> Option<Arc<Params>> {
        let count = self.waiting.partition_point(|own| own.day <= day);
        self.waiting.drain(..count).next_back().map(|own| own.params)
    }

    /// Returns the scheduled changes applied to other parameters, without those of the lines in `dropped`. Omits
    /// changes that are not valid for these parameters.
    pub fn over(&self, now: &Arc<Params>, dropped: &BTreeSet<u64>) -> Overrides {
        let mut own = Overrides { is_used: self.is_used, waiting: Vec::new() };
        for change in self.waiting().filter(|change| !dropped.contains(&change.seq)) {
            let _ = own.take(now, change.clone());
        }
        own
    }

    /// Replays the parameter changes in `lines` up to the end of a day, starting with the parameters `opening`.
    /// Returns `None` if a change is not valid.
    pub(crate) fn after(opening: &Arc<Params>, lines: &[Line], day: u32) -> Option<(Arc<Params>, Overrides)> {
        let (mut now, mut own) = (opening.clone(), Overrides::default());
        for line in lines {
            let Record::Override(change) = &line.record else { continue };
            now = own.due(line.day).unwrap_or(now);
            now = own.take(&now, ParameterChange::of(line.seq, change)?).ok()?.now;
        }
        now = own.due(day).unwrap_or(now);
        Some((now, own))
    }
}

fn with(params: &Params, change: &ParameterChange) -> Result<Arc<Params>, ParameterError> {
    params.with(&change.key, change.value.clone()).map(Arc::new)
}

/// Converts a JSON value to a parameter value. Returns `None` if there is no equivalent.
pub fn value_of_json(value: &Json) -> Option<Value> {
    Some(match value {
        Json::Null => return None,
        Json::Bool(own) => Value::Boolean(*own),
        Json::Number(number) => match number.as_i64() {
            Some(whole) => Value::Integer(whole),
            None => Value::Float(number.as_f64()?),
        },
        Json::String(text) => Value::String(text.clone()),
        Json::Array(list) => Value::Array(list.iter().map(value_of_json).collect::<Option<_>>()?),
        Json::Object(fields) => {
            let field = |(name, value): (&String, &Json)| Some((name.clone(), value_of_json(value)?));
            Value::Table(fields.iter().map(field).collect::<Option<Table>>()?)
        }
    })
}

/// Converts a parameter value to JSON. Whole numbers have no decimal point.
pub fn json_of_value(value: &Value) -> Json {
    match value {
        Value::String(text) => Json::from(text.as_str()),
        Value::Integer(number) => Json::from(*number),
        Value::Float(number) => json_number(*number),
        Value::Boolean(own) => Json::from(*own),
        Value::Datetime(moment) => Json::from(moment.to_string()),
        Value::Array(list) => list.iter().map(json_of_value).collect(),
        Value::Table(table) => {
            Json::Object(table.iter().map(|(name, value)| (name.clone(), json_of_value(value))).collect())
        }
    }
}

/// Values derived from the parameters in force; reset when a parameter changes.
#[derive(Default)]
pub(crate) struct DerivedOfParameters {
    numbers: OnceLock<Arc<Numbers>>,
    are_own: OnceLock<bool>,
}

impl DerivedOfParameters {
    pub(crate) fn numbers(&self, simulation: &Simulation) -> Arc<Numbers> {
        self.numbers.get_or_init(|| Numbers::of(&simulation.params).into()).clone()
    }

    /// Whether the parameters differ, or differed at some time, from those of the bundled scenario.
    pub(crate) fn has_own_parameters(&self, simulation: &Simulation, manifest: &Manifest) -> bool {
        let is_other = || simulation.overrides.is_used() || manifest.has_own_parameters();
        *self.are_own.get_or_init(is_other)
    }
}

/// Rejects reading or setting parameters unless the run is a debug run.
///
/// # Errors
/// `not_in_this_mode`.
pub fn refuse_outside_debug(mode: Mode) -> Result<(), Refusal> {
    match mode {
        Mode::Debug => Ok(()),
        _ => Err(Refusal::new("not_in_this_mode", "parameters can be set in debug runs only")),
    }
}

/// Returns the rejection for an unknown parameter.
pub fn unknown(error: ParameterError) -> Refusal {
    Refusal::at(error.key, "parameter_unknown", error.problem)
}

/// Returns the rejection for a value that is not allowed.
pub fn not_allowed(Unfit { day, error }: Unfit) -> Refusal {
    let message = match day {
        None => error.problem,
        Some(day) => format!("{} from day {day}, because of a change scheduled for that day", error.problem),
    };
    Refusal::at(error.key, "parameter_not_allowed", message)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn change(seq: u64, key: &str, value: f64, from_day: Option<u32>) -> ParameterChange {
        ParameterChange { seq, key: key.to_owned(), value: Value::Float(value), from_day }
    }

    const LEAST: &str = "competitor.competitor_feedback_u_min";
    const MOST: &str = "competitor.competitor_feedback_u_max";

    #[test]
    fn a_change_waits_for_its_day_and_later_ones_build_on_it() {
        let (now, mut own) = (Arc::new(Params::shipped()), Overrides::default());
        assert!(!own.is_used());
        own.take(&now, change(5, "satisfaction.satisfaction_ema_alpha", 0.5, Some(30))).expect("it fits");
        own.take(&now, change(6, "satisfaction.satisfaction_ema_alpha", 0.6, Some(20))).expect("it fits");
        let taken = own.take(&now, change(7, "operations.base_outage_prob", 0.7, None)).expect("it fits");
        assert_eq!(taken.now.operations.base_outage_prob, 0.7);
        assert!(own.due(19).is_none());
        let on_20 = own.due(20).expect("one is due");
        assert_eq!(on_20.satisfaction.satisfaction_ema_alpha, 0.6);
        assert_eq!(on_20.operations.base_outage_prob, 0.7);
        let later = own.due(44).expect("one is due");
        assert_eq!(later.satisfaction.satisfaction_ema_alpha, 0.5);
        assert_eq!(own.waiting().count(), 0);
        assert!(own.is_used());
    }

    #[test]
    fn values_that_contradict_each_other_on_a_later_day_are_refused_today() {
        let (now, mut own) = (Arc::new(Params::shipped()), Overrides::default());
        let most = now.competitor.competitor_feedback_u_max;
        own.take(&now, change(1, LEAST, most - 0.01, Some(30))).expect("it fits");
        let unfit = own
            .take(&now, change(2, MOST, most - 0.02, None))
            .err()
            .expect("the values contradict each other on day 30");
        assert_eq!(unfit.day, Some(30));
        assert_eq!(own.waiting().count(), 1, "the schedule is unchanged");
        own.take(&now, change(3, LEAST, most - 0.05, Some(30)))
            .expect("the later of two changes on a day applies");
        assert_eq!(own.over(&now, &BTreeSet::from([3])).waiting().count(), 1);
    }

    #[test]
    fn values_come_back_from_json_as_they_were() {
        let json = serde_json::json!({ "a": [1, 2.5, "x", true], "b": -3 });
        assert_eq!(json_of_value(&value_of_json(&json).expect("a table")), json);
        assert!(value_of_json(&Json::Null).is_none());
        assert!(value_of_json(&serde_json::json!([null])).is_none());
        assert_eq!(json_of_value(&Value::Float(300.0)), serde_json::json!(300));
    }
}
