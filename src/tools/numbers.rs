//! Numbers in documentation: texts name a parameter in braces, and what people read is the value in force.
//!
//! `{table.key}` is the value, `{table.key:%}` a percentage, `{table.key:$}` dollars, `{table.key:-}` the value without
//! its sign.

use std::collections::BTreeMap;

use serde_json::Value;

use crate::notation::grouped;
use crate::world::params::Params;

/// Every parameter that is a single number, by its key.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Numbers(BTreeMap<String, f64>);

impl Numbers {
    /// The numbers of the shipped parameters.
    pub fn shipped() -> Numbers {
        Numbers::of(&Params::shipped())
    }

    /// The numbers of these parameters.
    pub fn of(params: &Params) -> Numbers {
        let mut numbers = BTreeMap::new();
        let tables = serde_json::to_value(params).unwrap_or(Value::Null);
        for (table, keys) in tables.as_object().into_iter().flatten() {
            for (key, value) in keys.as_object().into_iter().flatten() {
                if let Some(number) = value.as_f64() {
                    numbers.insert(format!("{table}.{key}"), number);
                }
            }
        }
        Numbers(numbers)
    }

    /// A text with the values in place of their names. A name that no parameter has stays as it is.
    pub fn fill(&self, text: &str) -> String {
        let mut filled = String::new();
        let mut rest = text;
        while let Some((before, after)) = rest.split_once('{') {
            filled.push_str(before);
            let value = after.split_once('}').and_then(|(name, after)| Some((self.written(name)?, after)));
            match value {
                Some((value, after)) => {
                    filled.push_str(&value);
                    rest = after;
                }
                None => {
                    filled.push('{');
                    rest = after;
                }
            }
        }
        filled + rest
    }

    fn written(&self, name: &str) -> Option<String> {
        let (key, form) = name.split_once(':').unwrap_or((name, ""));
        let value = *self.0.get(key)?;
        Some(match form {
            "%" => format!("{} %", plain(value * 100.0)),
            "$" => format!("${}", grouped(value, if value.fract() == 0.0 { 0 } else { 2 })),
            "-" => plain(value.abs()),
            _ => plain(value),
        })
    }
}

/// A number with as many decimals as it has, at most six.
fn plain(value: f64) -> String {
    let text = format!("{value:.6}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// Names in braces that a text holds.
#[cfg(test)]
pub(crate) fn names_in(text: &str) -> Vec<String> {
    let pieces = text.split('{').skip(1).filter_map(|piece| piece.split_once('}'));
    pieces.map(|(name, _)| name.to_owned()).filter(|name| name.contains('.') && !name.contains(' ')).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tools::CATALOGUE;

    #[test]
    fn names_become_the_values_in_force() {
        let mut params = Params::shipped();
        params.operations.base_outage_prob = 0.045;
        let numbers = Numbers::of(&params);
        assert_eq!(
            numbers.fill(
                "{operations.base_outage_prob:%} of {\"A\": 1} {leads.lead_acquisition_cost:$} {x.y} {"
            ),
            "4.5 % of {\"A\": 1} $0.50 {x.y} {"
        );
        assert_eq!(numbers.fill("{enterprise.late_reply_relationship_delta_per_day:-}"), "0.02");
    }

    #[test]
    fn every_number_of_a_tool_is_a_parameter() {
        let numbers = Numbers::shipped();
        for spec in CATALOGUE.iter().map(|tool| tool.spec()) {
            for text in [spec.effect, spec.cost, spec.summary] {
                for name in names_in(text) {
                    assert!(numbers.written(&name).is_some(), "{}: {name}", spec.name());
                }
            }
        }
    }
}
