//! Texts for the differences between two days of a run, or between two runs on one day.

use serde_json::{Value, json};

use super::indented_table;
use novamind_base::formatting::grouped_number;
use novamind_insight::{CustomerDifference, DayDifference, RunDifference};

const MAX_LISTED_FIGURES: usize = 40;
/// Minimum number of decimals of a figure below one thousand.
const MIN_DECIMALS: usize = 4;
/// Minimum number of decimals of a figure of one thousand or more.
const MIN_DECIMALS_FROM_1000: usize = 2;
/// Maximum number of decimals. More than the minimum are used only if they are necessary to distinguish close numbers.
const MAX_DECIMALS: usize = 12;
const MAX_LISTED_PARAMETERS: usize = 20;

/// Describes the differences between two days of a run.
pub fn describe_day_difference(found: &DayDifference, (one, other): (u32, u32)) -> Vec<String> {
    describe_difference(found, (&format!("day {one}"), &format!("day {other}")), "on")
}

/// Describes the differences between two named states. `before` is the preposition that stands before a name: `on` for
/// a day, `in` for a run.
fn describe_difference(found: &DayDifference, names: (&str, &str), before: &str) -> Vec<String> {
    if found.is_empty() {
        return vec!["no differences".to_owned()];
    }
    let mut lines = parameter_lines(found, names);
    if found.differing_parts.is_empty() {
        lines.push("all parts of the state are equal".to_owned());
        return lines;
    }
    lines.push(format!("differs: {}", found.differing_parts.join(", ")));
    if !found.equal_parts.is_empty() {
        lines.push(format!("equal: {}", found.equal_parts.join(", ")));
    }
    lines.extend(figure_lines(found, names));
    lines.extend(customer_lines(found, names, before));
    lines
}

/// Describes the differences between two named runs.
pub fn describe_run_difference(found: &RunDifference, names: (&str, &str)) -> Vec<String> {
    let mut lines = vec![match found.first_day {
        None => format!("the runs are identical up to day {}", found.last_day),
        Some(day) => format!("the runs differ from day {day}"),
    }];
    if let Some(difference) = &found.difference {
        lines.push(format!("day {}", difference.days.0));
        lines.extend(describe_difference(difference, names, "in"));
    }
    lines
}

/// Returns the differences between two days as JSON.
pub fn difference_to_json(found: &DayDifference) -> Value {
    let figure =
        |(name, value, other): &(String, f64, f64)| json!({ "figure": name, "values": [value, other] });
    let customer = |customer_difference: &CustomerDifference| {
        let columns = customer_difference.columns.iter();
        let columns = columns.map(|(name, one, other)| json!({ "column": name, "values": [one, other] }));
        json!({
            "customer_id": customer_difference.customer,
            "group": customer_difference.group.id(),
            "subscribes": [customer_difference.subscribes.0, customer_difference.subscribes.1],
            "columns": columns.collect::<Vec<Value>>(),
        })
    };
    let parameter =
        |(key, one, other): &(String, Value, Value)| json!({ "parameter": key, "values": [one, other] });
    json!({
        "parameters": found.parameters.iter().map(parameter).collect::<Vec<Value>>(),
        "differs": found.differing_parts,
        "alike": found.equal_parts,
        "figures": found.figures.iter().map(figure).collect::<Vec<Value>>(),
        "customers": found.differing_customers,
        "only": [found.only_in_one.0, found.only_in_one.1],
        "first_customers": found.first_customers.iter().map(customer).collect::<Vec<Value>>(),
    })
}

fn parameter_lines(found: &DayDifference, names: (&str, &str)) -> Vec<String> {
    let row = |(key, value, other): &(String, Value, Value)| {
        vec![key.clone(), value.to_string(), other.to_string()]
    };
    let rows: Vec<Vec<String>> = found.parameters.iter().take(MAX_LISTED_PARAMETERS).map(row).collect();
    if rows.is_empty() {
        return Vec::new();
    }
    let mut lines = indented_table(&["parameter", names.0, names.1], &rows);
    let more = found.parameters.len().saturating_sub(MAX_LISTED_PARAMETERS);
    lines.extend((more > 0).then(|| format!("  and {more} more parameters")));
    lines
}

fn figure_lines(found: &DayDifference, names: (&str, &str)) -> Vec<String> {
    let row = |(name, value, other): &(String, f64, f64)| {
        vec![name.clone(), format_distinct(*value, *other), format_distinct(*other, *value)]
    };
    let rows: Vec<Vec<String>> = found.figures.iter().take(MAX_LISTED_FIGURES).map(row).collect();
    if rows.is_empty() {
        return vec!["figures are equal".to_owned()];
    }
    let mut lines = indented_table(&["figure", names.0, names.1], &rows);
    let more = found.figures.len().saturating_sub(MAX_LISTED_FIGURES);
    lines.extend((more > 0).then(|| format!("  and {more} more figures")));
    lines
}

fn customer_lines(found: &DayDifference, names: (&str, &str), before: &str) -> Vec<String> {
    let count = |count: usize| grouped_number(count as f64, 0);
    let mut lines = vec![format!(
        "customers: {} differ, {} subscribe only {before} {}, {} only {before} {}",
        count(found.differing_customers),
        count(found.only_in_one.0),
        names.0,
        count(found.only_in_one.1),
        names.1
    )];
    lines.extend(
        found
            .first_customers
            .iter()
            .map(|customer_difference| customer_line(customer_difference, names, before)),
    );
    lines
}

fn customer_line(customer_difference: &CustomerDifference, names: (&str, &str), before: &str) -> String {
    let what = match customer_difference.subscribes {
        (true, false) => format!("subscribes only {before} {}", names.0),
        (false, _) => format!("subscribes only {before} {}", names.1),
        (true, true) => {
            let columns = customer_difference.columns.iter().map(|(name, one, other)| {
                let (one, other) = format_distinct_cells(one, other);
                format!("{name} {one} → {other}")
            });
            columns.collect::<Vec<String>>().join(", ")
        }
    };
    format!("  {} {}: {what}", customer_difference.customer, customer_difference.group)
}

/// Formats a number with the fewest decimals that distinguish it from the other number.
fn format_distinct(value: f64, other: f64) -> String {
    if value.fract() == 0.0 {
        return grouped_number(value, 0);
    }
    let min = if value.abs() >= 1000.0 { MIN_DECIMALS_FROM_1000 } else { MIN_DECIMALS };
    let differs = |decimals: &usize| grouped_number(value, *decimals) != grouped_number(other, *decimals);
    match (min..=MAX_DECIMALS).find(differs) {
        Some(decimals) => grouped_number(value, decimals),
        None => value.to_string(),
    }
}

/// Formats two cells with [`format_distinct`] if both cells are numbers with a fraction.
fn format_distinct_cells(one: &str, other: &str) -> (String, String) {
    let number = |cell: &str| cell.parse::<f64>().ok().filter(|value| value.is_finite());
    match (number(one), number(other)) {
        (Some(left), Some(right)) if left.fract() != 0.0 || right.fract() != 0.0 => {
            (format_distinct(left, right), format_distinct(right, left))
        }
        _ => (one.to_owned(), other.to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use novamind_session::identifiers::Group;

    #[test]
    fn difference_lists_parts_figures_and_customers() {
        let group = Group::at(0).expect("a group");
        let customer =
            |customer, subscribes, columns| CustomerDifference { customer, group, subscribes, columns };
        let found = DayDifference {
            days: (3, 3),
            parameters: vec![("operations.base_outage_prob".to_owned(), json!(0.01), json!(0.5))],
            differing_parts: vec!["money", "customers"],
            equal_parts: vec!["market"],
            figures: vec![("cash".to_owned(), 1_000.0, 999.5)],
            differing_customers: 1,
            only_in_one: (1, 0),
            first_customers: vec![
                customer(4, (true, true), vec![("plan", "A".to_owned(), "B".to_owned())]),
                customer(9, (true, false), Vec::new()),
            ],
        };
        assert_eq!(
            describe_difference(&found, ("one", "other"), "in"),
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
        let day_lines = describe_day_difference(&found, (3, 300));
        assert_eq!(day_lines[6], "customers: 1 differ, 1 subscribe only on day 3, 0 only on day 300");
        assert_eq!(day_lines[8], "  9 S1: subscribes only on day 3");
        let alike = RunDifference { last_day: 28, first_day: None, difference: None };
        assert_eq!(describe_run_difference(&alike, ("a", "b")), ["the runs are identical up to day 28"]);
    }
}
