//! Text for differences between two days or between two runs on a day.

use serde_json::{Value, json};

use super::table;
use novamind_base::notation::grouped;
use novamind_insight::{CustomerDifference, Difference, RunDifference};

const FIGURES_TOLD: usize = 40;
/// Minimum number of decimals of a figure, and of one of at least a thousand.
const DECIMALS: usize = 4;
const DECIMALS_OF_LARGE: usize = 2;
/// Maximum number of decimals, used to distinguish close numbers.
const MOST_DECIMALS: usize = 12;
const PARAMETERS_TOLD: usize = 20;

/// Describes the differences between two days of a run.
pub fn days_in_words(found: &Difference, (one, other): (u32, u32)) -> Vec<String> {
    difference_in_words(found, (&format!("day {one}"), &format!("day {other}")), "on")
}

/// Describes the differences between two named states. `before` is the preposition of the names: `on` or `in`.
fn difference_in_words(found: &Difference, names: (&str, &str), before: &str) -> Vec<String> {
    if found.is_none() {
        return vec!["no differences".to_owned()];
    }
    let mut lines = parameters(found, names);
    if found.parts.is_empty() {
        lines.push("all parts of the state are equal".to_owned());
        return lines;
    }
    lines.push(format!("differs: {}", found.parts.join(", ")));
    if !found.alike.is_empty() {
        lines.push(format!("equal: {}", found.alike.join(", ")));
    }
    lines.extend(figures(found, names));
    lines.extend(customers(found, names, before));
    lines
}

/// Describes the differences between two named runs.
pub fn runs_in_words(found: &RunDifference, names: (&str, &str)) -> Vec<String> {
    let mut lines = vec![match found.first_day {
        None => format!("the runs are identical up to day {}", found.last_day),
        Some(day) => format!("the runs differ from day {day}"),
    }];
    if let Some(difference) = &found.difference {
        lines.push(format!("day {}", difference.days.0));
        lines.extend(difference_in_words(difference, names, "in"));
    }
    lines
}

/// Returns the differences as JSON.
pub fn difference_as_data(found: &Difference) -> Value {
    let figure = |(name, own, other): &(String, f64, f64)| json!({ "figure": name, "values": [own, other] });
    let customer = |own: &CustomerDifference| {
        let columns = own.columns.iter();
        let columns = columns.map(|(name, one, other)| json!({ "column": name, "values": [one, other] }));
        json!({
            "customer_id": own.customer,
            "group": own.group.id(),
            "subscribes": [own.subscribes.0, own.subscribes.1],
            "columns": columns.collect::<Vec<Value>>(),
        })
    };
    let parameter =
        |(key, own, other): &(String, Value, Value)| json!({ "parameter": key, "values": [own, other] });
    json!({
        "parameters": found.parameters.iter().map(parameter).collect::<Vec<Value>>(),
        "differs": found.parts,
        "alike": found.alike,
        "figures": found.figures.iter().map(figure).collect::<Vec<Value>>(),
        "customers": found.customers,
        "only": [found.only.0, found.only.1],
        "first_customers": found.first_customers.iter().map(customer).collect::<Vec<Value>>(),
    })
}

fn parameters(found: &Difference, names: (&str, &str)) -> Vec<String> {
    let row =
        |(key, own, other): &(String, Value, Value)| vec![key.clone(), own.to_string(), other.to_string()];
    let rows: Vec<Vec<String>> = found.parameters.iter().take(PARAMETERS_TOLD).map(row).collect();
    if rows.is_empty() {
        return Vec::new();
    }
    let mut lines = table(&["parameter", names.0, names.1], &rows);
    let more = found.parameters.len().saturating_sub(PARAMETERS_TOLD);
    lines.extend((more > 0).then(|| format!("  and {more} more parameters")));
    lines
}

fn figures(found: &Difference, names: (&str, &str)) -> Vec<String> {
    let row = |(name, own, other): &(String, f64, f64)| {
        vec![name.clone(), told_apart(*own, *other), told_apart(*other, *own)]
    };
    let rows: Vec<Vec<String>> = found.figures.iter().take(FIGURES_TOLD).map(row).collect();
    if rows.is_empty() {
        return vec!["figures are equal".to_owned()];
    }
    let mut lines = table(&["figure", names.0, names.1], &rows);
    let more = found.figures.len().saturating_sub(FIGURES_TOLD);
    lines.extend((more > 0).then(|| format!("  and {more} more figures")));
    lines
}

fn customers(found: &Difference, names: (&str, &str), before: &str) -> Vec<String> {
    let count = |count: usize| grouped(count as f64, 0);
    let mut lines = vec![format!(
        "customers: {} differ, {} subscribe only {before} {}, {} only {before} {}",
        count(found.customers),
        count(found.only.0),
        names.0,
        count(found.only.1),
        names.1
    )];
    lines.extend(found.first_customers.iter().map(|own| customer(own, names, before)));
    lines
}

fn customer(own: &CustomerDifference, names: (&str, &str), before: &str) -> String {
    let what = match own.subscribes {
        (true, false) => format!("subscribes only {before} {}", names.0),
        (false, _) => format!("subscribes only {before} {}", names.1),
        (true, true) => {
            let columns = own.columns.iter().map(|(name, one, other)| {
                let (one, other) = cells_apart(one, other);
                format!("{name} {one} → {other}")
            });
            columns.collect::<Vec<String>>().join(", ")
        }
    };
    format!("  {} {}: {what}", own.customer, own.group)
}

/// Formats a number with as few decimals as distinguish it from another.
fn told_apart(value: f64, other: f64) -> String {
    if value.fract() == 0.0 {
        return grouped(value, 0);
    }
    let least = if value.abs() >= 1000.0 { DECIMALS_OF_LARGE } else { DECIMALS };
    let differs = |decimals: &usize| grouped(value, *decimals) != grouped(other, *decimals);
    match (least..=MOST_DECIMALS).find(differs) {
        Some(decimals) => grouped(value, decimals),
        None => value.to_string(),
    }
}

/// Formats two cells likewise if they are numbers with a fraction.
fn cells_apart(one: &str, other: &str) -> (String, String) {
    let number = |cell: &str| cell.parse::<f64>().ok().filter(|value| value.is_finite());
    match (number(one), number(other)) {
        (Some(own), Some(twin)) if own.fract() != 0.0 || twin.fract() != 0.0 => {
            (told_apart(own, twin), told_apart(twin, own))
        }
        _ => (one.to_owned(), other.to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use novamind_session::identifiers::Group;

    #[test]
    fn a_difference_names_parts_then_figures_then_customers() {
        let group = Group::at(0).expect("a group");
        let customer =
            |customer, subscribes, columns| CustomerDifference { customer, group, subscribes, columns };
        let found = Difference {
            days: (3, 3),
            parameters: vec![("operations.base_outage_prob".to_owned(), json!(0.01), json!(0.5))],
            parts: vec!["money", "customers"],
            alike: vec!["market"],
            figures: vec![("cash".to_owned(), 1_000.0, 999.5)],
            customers: 1,
            only: (1, 0),
            first_customers: vec![
                customer(4, (true, true), vec![("plan", "A".to_owned(), "B".to_owned())]),
                customer(9, (true, false), Vec::new()),
            ],
        };
        assert_eq!(
            difference_in_words(&found, ("one", "other"), "in"),
            [
                "  parameter                    one   other",
                "  operations.base_outage_prob  0.01  0.5",
                "differs: money, customers",
                "equal: market",
                "  figure  one    other",
                "  cash    1,000  999.5000",
                "customers: 1 differ, 1 subscribe only in one, 0 only in other",
                "  4 S1: plan A → B",
                "  9 S1: subscribes only in one",
            ]
        );
        let of_days = days_in_words(&found, (3, 300));
        assert_eq!(of_days[6], "customers: 1 differ, 1 subscribe only on day 3, 0 only on day 300");
        assert_eq!(of_days[8], "  9 S1: subscribes only on day 3");
        let alike = RunDifference { last_day: 28, first_day: None, difference: None };
        assert_eq!(runs_in_words(&alike, ("a", "b")), ["the runs are identical up to day 28"]);
    }
}
