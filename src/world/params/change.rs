//! Changes to parameters during a run.

use std::collections::{BTreeMap, BTreeSet};

use toml::{Table, Value};

use super::Params;
use super::load::{ParameterError, apply_override, from_tables};
use super::names::{entries, nearest_keys, value_at};

/// Parameters, tables and lists that cannot change during a run. These keys take effect only at the start of a run, or
/// define texts that are already recorded.
const START_ONLY_KEYS: [&str; 7] =
    ["run.seed", "run.total_days", "run.horizon_rule", "run.days_per_week", "initial", "channel", "personas"];
/// Parameters in `initial` that can change during a run, because they apply to every new customer.
const PER_CUSTOMER_KEYS: [&str; 2] = ["initial.customer_satisfaction", "initial.customer_relationship"];

/// A parameter that has different values in two sets of parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct ParameterDifference {
    /// Full key of the parameter.
    pub key: String,
    /// Value in the first set, or `None` if the key is missing there.
    pub old: Option<Value>,
    /// Value in the second set, or `None` if the key is missing there.
    pub new: Option<Value>,
}

impl Params {
    /// Returns the value of a key, which names a parameter, a list or a table of parameters.
    ///
    /// # Errors
    /// Returns an error that lists similar names if no parameter has this name.
    pub fn value(&self, key: &str) -> Result<Value, ParameterError> {
        let tables = self.to_tables();
        value_at(&tables, key).cloned().ok_or_else(|| {
            let near = nearest_keys(&tables, key);
            let help = if near.is_empty() {
                String::new()
            } else {
                format!("; did you mean {}?", near.join(" or "))
            };
            parameter_error(key, format!("there is no such parameter{help}"))
        })
    }

    /// Returns a copy in which a parameter, a list or a table of parameters has a new value.
    ///
    /// # Errors
    /// Returns an error for the same reasons as [`Params::load`] with a single override, or if the parameter takes
    /// effect only at the start of a run.
    pub fn with(&self, key: &str, value: Value) -> Result<Params, ParameterError> {
        self.value(key)?;
        let nested = key
            .rsplit('.')
            .fold(value, |inner, part| Value::Table(Table::from_iter([(part.to_owned(), inner)])));
        let mut tables = self.to_tables();
        if let Value::Table(nested) = nested {
            apply_override(&mut tables, nested).map_err(|(key, problem)| parameter_error(&key, problem))?;
        }
        let checked = from_tables(tables).map_err(|(key, problem)| parameter_error(&key, problem))?;
        let other = Params { fault: self.fault, ..checked };
        match self
            .differences(&other)
            .into_iter()
            .find(|parameter_difference| is_start_only(&parameter_difference.key))
        {
            None => Ok(other),
            Some(difference) => {
                let problem =
                    "takes effect only at the start of a run; start a run with --set to change it".to_owned();
                Err(parameter_error(&difference.key, problem))
            }
        }
    }

    /// Returns the parameters whose values differ between `self` and `other`.
    pub fn differences(&self, other: &Params) -> Vec<ParameterDifference> {
        if self == other {
            return Vec::new();
        }
        let (tables, other) = (self.to_tables(), other.to_tables());
        let old: BTreeMap<String, &Value> = entries(&tables).into_iter().collect();
        let new: BTreeMap<String, &Value> = entries(&other).into_iter().collect();
        let all: BTreeSet<&String> = old.keys().chain(new.keys()).collect();
        let changed = all.into_iter().filter(|key| old.get(*key) != new.get(*key));
        let value_in = |all: &BTreeMap<String, &Value>, key| all.get(key).map(|value| Value::clone(value));
        changed
            .map(|key| ParameterDifference {
                old: value_in(&old, key),
                new: value_in(&new, key),
                key: key.clone(),
            })
            .collect()
    }

    fn to_tables(&self) -> Table {
        Table::try_from(self).unwrap_or_default()
    }
}

fn parameter_error(key: &str, problem: String) -> ParameterError {
    ParameterError { source: String::new(), line: None, key: key.to_owned(), problem }
}

fn is_start_only(key: &str) -> bool {
    let is_in_table = |table: &str| {
        let rest = key.strip_prefix(table);
        rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
    };
    START_ONLY_KEYS.into_iter().any(is_in_table) && !PER_CUSTOMER_KEYS.contains(&key)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn set(key: &str, value: impl Into<Value>) -> Result<Params, ParameterError> {
        Params::bundled().with(key, value.into())
    }

    #[test]
    fn with_sets_parameters_lists_and_tables_by_name() {
        let dear = set("group.S1.c_max_mean", 300).expect("a whole number is a number");
        assert_eq!(dear.group[0].c_max_mean, 300.0);
        let found = Params::bundled().differences(&dear);
        assert_eq!(found.len(), 1);
        assert_eq!(
            (found[0].key.as_str(), &found[0].new),
            ("group.S1.c_max_mean", &Some(Value::Float(300.0)))
        );
        let large = set("capacity_tier.3.capacity_units", 5_000_000).expect("units");
        assert_eq!(large.capacity_tier(3).capacity_units, 5_000_000);
        let influence = set("reputation_influence.S1.S3", 0.5).expect("a weight");
        assert_eq!(influence.reputation_influence["S1"][2], 0.5);
        let weekly = Value::try_from([1.0; 7]).expect("a list");
        assert_eq!(set("calendar.weekly", weekly).expect("a list").calendar.weekly, [1.0; 7]);
        let table = Table::from_iter([("base_outage_prob".to_owned(), Value::Float(0.5))]);
        assert_eq!(set("operations", table).expect("a part of a table").operations.base_outage_prob, 0.5);
    }

    #[test]
    fn errors_name_the_key_and_the_allowed_range() {
        for (key, value, part) in [
            (
                "group.S1.c_max_std",
                Value::Float(-1.0),
                "group.S1.c_max_std: is -1, but must be between 0 and",
            ),
            ("capacity_tier.3.capacity_units", Value::Integer(0), "must be between 1 and"),
            ("macro.pmi_scale", Value::Integer(0), "must be above 0 and at most 1000000"),
            ("initial.default_tier_B", Value::Integer(6), "is 6, but must be between 1 and 5"),
            ("billing.billing_period_days", Value::Integer(29), "must be 30"),
            ("calendar.weekly.6", Value::Float(-1.0), "calendar.weekly.6: is -1, but must be between 0 and"),
            ("social.sentiment.neutral.negative", Value::Float(1.5), "must be between 0 and 1"),
            ("group.E1.seat_count_min", Value::Integer(0), "group.E1.seat_count_min: is 0, but"),
            ("channel.linkedin.leads_per_1000_dollars.S1", Value::Integer(-1), "dollars.S1: is -1, but"),
            ("reputation_influence.S1.S3", Value::Integer(-1), "S1.S3: is -1, but must be at least 0"),
            ("operations.base_outage_prob", Value::Float(f64::NAN), "must be a finite number"),
            ("operations.base_outage_prob", Value::String("often".to_owned()), "expected a number"),
            (
                "operations",
                Value::Integer(3),
                "is a table; name one of its parameters, for instance operations.",
            ),
            ("group", Value::Integer(3), "is a list; name one of its elements, for instance group.S1"),
            ("operations.base_outage_prob.x", Value::Integer(3), "no such parameter"),
            ("operations.base_outage_prob", Value::Table(Table::new()), "is a single value"),
            ("group.S9.c_max_mean", Value::Integer(3), "did you mean group.S"),
            ("c_max_mean", Value::Integer(3), "did you mean group."),
            ("", Value::Integer(3), "no such parameter"),
            ("..", Value::Integer(3), "no such parameter"),
            ("competitor.competitor_feedback_u_min", Value::Float(0.9), "above the upper bound"),
            ("group.S1.id", Value::String("S2".to_owned()), "must be S1 at this position"),
            ("initial.initial_cash", Value::Integer(5), "takes effect only at the start of a run"),
            (
                "personas.email.last_names",
                Value::Array(Vec::new()),
                "takes effect only at the start of a run",
            ),
            ("run.seed", Value::Integer(5), "takes effect only at the start of a run"),
        ] {
            let error = set(key, value).expect_err(key);
            let text = format!("{}: {}", error.key, error.problem);
            assert!(text.contains(part), "{key}: {text}");
        }
        assert!(set("initial.customer_satisfaction", 0.1).is_ok());
        assert!(set("run.bankruptcy_cash_threshold", -5).is_ok());
    }
}
