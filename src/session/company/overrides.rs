//! Parameters that a debug run changes while it goes on, those changes that wait for their day, and facts that follow from the
//! parameters in force.

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

/// A parameter that is set to another value.
#[derive(Debug, Clone, PartialEq)]
pub struct ParameterChange {
    /// Line that sets it.
    pub seq: u64,
    /// Full key.
    pub key: String,
    /// Value from then on.
    pub value: Value,
    /// First day that is simulated with it; none: it acts at once.
    pub from_day: Option<u32>,
}

impl ParameterChange {
    /// The change that a line tells; none if its value is nothing that a parameter can be.
    pub fn of(seq: u64, line: &Override) -> Option<ParameterChange> {
        let value = value_of_json(&line.new)?;
        Some(ParameterChange { seq, key: line.key.clone(), value, from_day: line.from_day })
    }
}

/// A change that waits, with the parameters that are in force once it acts.
#[derive(Debug, Clone)]
struct WaitingChange {
    day: u32,
    change: ParameterChange,
    params: Arc<Params>,
}

/// What has become of the parameters of a run since it began.
#[derive(Debug, Clone, Default)]
pub struct Overrides {
    /// Whether any was set.
    is_used: bool,
    /// Changes that wait, by their day, those of a day in the order of their lines.
    waiting: Vec<WaitingChange>,
}

/// Parameters after a change was taken in.
pub struct Taken {
    /// Those in force now.
    pub now: Arc<Params>,
    /// Those in force once the change acts.
    pub changed: Arc<Params>,
}

/// Why a change is not possible.
#[derive(Debug)]
pub struct Unfit {
    /// The later day on which values would contradict each other; none: it is the change itself.
    pub day: Option<u32>,
    /// What is wrong.
    pub error: ParameterError,
}

impl Overrides {
    /// Whether any parameter was set since the run began.
    pub(crate) fn is_used(&self) -> bool {
        self.is_used
    }

    /// Changes that wait for their day.
    pub fn waiting(&self) -> impl Iterator<Item = &ParameterChange> {
        self.waiting.iter().map(|own| &own.change)
    }

    /// Takes a change in. Every change that waits still has to fit afterwards: when its day has come nothing can fail.
    ///
    /// # Errors
    /// The value is not allowed, or contradicts another now or on a later day. Nothing has changed then.
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

    /// The parameters with which a day will be simulated, if they change with it.
    pub(crate) fn due_on(&self, day: u32) -> Option<&Arc<Params>> {
        let count = self.waiting.partition_point(|own| own.day <= day);
        self.waiting[..count].last().map(|own| &own.params)
    }

    /// The parameters with which a day is simulated, if they change with it: they wait no longer.
    pub(crate) fn due(&mut self, day: u32) -> Option<Arc<Params>> {
        let count = self.waiting.partition_point(|own| own.day <= day);
        self.waiting.drain(..count).next_back().map(|own| own.params)
    }

    /// The same changes over other parameters, but for some lines; what does not fit them is left out.
    pub fn over(&self, now: &Arc<Params>, dropped: &BTreeSet<u64>) -> Overrides {
        let mut own = Overrides { is_used: self.is_used, waiting: Vec::new() };
        for change in self.waiting().filter(|change| !dropped.contains(&change.seq)) {
            let _ = own.take(now, change.clone());
        }
        own
    }

    /// What some lines of a run have made of the parameters with which it began, at the end of a day. None if a line does
    /// not fit.
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

/// A value of JSON as parameters have it; none where they have nothing like it.
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

/// A value of a parameter as JSON, whole numbers without a decimal point.
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

/// What follows from the parameters in force; replaced when they change.
#[derive(Default)]
pub(crate) struct DerivedOfParameters {
    numbers: OnceLock<Arc<Numbers>>,
    are_own: OnceLock<bool>,
}

impl DerivedOfParameters {
    /// The numbers that documentation names.
    pub(crate) fn numbers(&self, simulation: &Simulation) -> Arc<Numbers> {
        self.numbers.get_or_init(|| Numbers::of(&simulation.params).into()).clone()
    }

    /// Whether the parameters are, or were, others than those of the shipped scenario.
    pub(crate) fn has_own_parameters(&self, simulation: &Simulation, manifest: &Manifest) -> bool {
        let is_other = || simulation.overrides.is_used() || manifest.has_own_parameters();
        *self.are_own.get_or_init(is_other)
    }
}

/// Refuses to read or set parameters outside debug runs.
///
/// # Errors
/// `not_in_this_mode`.
pub fn refuse_outside_debug(mode: Mode) -> Result<(), Refusal> {
    match mode {
        Mode::Debug => Ok(()),
        _ => Err(Refusal::new("not_in_this_mode", "parameters can be set in debug runs only")),
    }
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
        let unfit = own.take(&now, change(2, MOST, most - 0.02, None)).err().expect("on day 30 it does not");
        assert_eq!(unfit.day, Some(30));
        assert_eq!(own.waiting().count(), 1, "nothing has changed");
        own.take(&now, change(3, LEAST, most - 0.05, Some(30))).expect("the later line of a day counts");
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
