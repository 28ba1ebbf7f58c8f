//! Texts for breakpoints: conditions, the reason why a run stopped, and the days on which a condition became true.

use super::clean_up_numbers;
use crate::formatting::pluralize;
use novamind_base::formatting::decimal_literal;
use novamind_insight::{
    Breakpoint, BreakpointHit, BreakpointRun, ComparisonOperator, Condition, ConditionHistory,
    ConditionState, Direction, StillTrueBreakpoint,
};

const MIN_DECIMALS: usize = 4;
const MAX_DECIMALS: usize = 12;

/// Lists the breakpoints, one per line.
pub fn describe_breakpoints(set: &[Breakpoint]) -> Vec<String> {
    match set.is_empty() {
        true => vec!["no breakpoint is set; example: break churn(S1) > 0.05 over 7".to_owned()],
        false => {
            set.iter().map(|breakpoint| format!("{}  {}", breakpoint.number, breakpoint.condition)).collect()
        }
    }
}

/// Explains why a run stopped. For each breakpoint that became true, shows both sides of its condition. Otherwise,
/// states that none became true.
pub fn describe_stop(run: &BreakpointRun, day: u32, breakpoints: usize) -> Vec<String> {
    let hit = |hit: &BreakpointHit| {
        let BreakpointHit { breakpoint, state: judged } = hit;
        format!(
            "stopped on day {day}: {} · breakpoint {}",
            describe_comparison(&breakpoint.condition, judged),
            breakpoint.number
        )
    };
    let from = run.from + 1;
    let ran = format!("ran day {from} to {day}");
    let mut lines = match (run.hits.is_empty(), breakpoints) {
        (false, _) => return clean_up_numbers(run.hits.iter().map(hit).collect()),
        (true, 0) => vec![format!("{ran}; no breakpoint is set")],
        (true, 1) if run.still_true.is_empty() => {
            vec![format!("{ran}; the breakpoint was never true")]
        }
        (true, count) if run.still_true.is_empty() => {
            vec![format!("{ran}; none of the {count} breakpoints was ever true")]
        }
        (true, 1)
            if run.still_true.iter().all(|true_breakpoint| true_breakpoint.first_value_day.is_some()) =>
        {
            vec![format!(
                "{ran}; the breakpoint did not become true: it was already true when its figure had its first value"
            )]
        }
        (true, 1) => vec![format!("{ran}; the breakpoint did not become true: it was true before")],
        (true, count) => vec![format!("{ran}; none of the {count} breakpoints became true")],
    };
    lines.extend(
        run.still_true.iter().map(|still_true_breakpoint| describe_still_true(still_true_breakpoint, day)),
    );
    clean_up_numbers(lines)
}

fn describe_still_true(true_breakpoint: &StillTrueBreakpoint, day: u32) -> String {
    let BreakpointHit { breakpoint, state: judged } = &true_breakpoint.hit;
    let until = match (true_breakpoint.last_true_day == day, true_breakpoint.first_value_day) {
        (true, None) => "true on all these days and on the day before".to_owned(),
        (false, None) => format!("true until day {}", true_breakpoint.last_true_day),
        (true, Some(began)) => format!("true from day {began}, when its figure had its first value"),
        (false, Some(began)) => {
            format!(
                "true from day {began}, when its figure had its first value, until day {}",
                true_breakpoint.last_true_day
            )
        }
    };
    format!(
        "breakpoint {} was {until}: {}",
        breakpoint.number,
        describe_comparison(&breakpoint.condition, judged)
    )
}

/// Describes whether a condition is true and since which day. Shows both sides of the comparison on that day and on the
/// day before.
pub fn describe_condition_history(condition_history: &ConditionHistory) -> Vec<String> {
    let ConditionHistory { condition, today, last_true, last_false } = condition_history;
    let is = if today.is_true { "true" } else { "false" };
    let mut lines =
        vec![format!("{condition} is {is} on day {}: {}", today.day, describe_comparison(condition, today))];
    lines.push(match if today.is_true { last_false } else { last_true } {
        None if today.is_true => "the condition was true on every day".to_owned(),
        None => "the condition was never true".to_owned(),
        Some(other) => format!(
            "last {} on day {}: {}; {is} since day {}",
            if today.is_true { "false" } else { "true" },
            other.day,
            describe_comparison(condition, other),
            condition_history.unchanged_since()
        ),
    });
    clean_up_numbers(lines)
}

/// Lists the days on which a condition became true. Marks a day if the figure of the condition had its first value on
/// this day.
pub fn describe_condition_days(
    condition: &Condition,
    found: &[ConditionState],
    last_day: u32,
) -> Vec<String> {
    let days = pluralize(last_day, "day");
    let head = match found.iter().filter(|condition_state| condition_state.becomes_true()).count() {
        0 => format!("{condition} became true on none of {days}"),
        often => format!("{condition} became true on {often} of {days}"),
    };
    let line = |state: &ConditionState| {
        let began = if state.is_first_value { " · first value of the figure" } else { "" };
        format!("  day {:<4} {}{began}", state.day, describe_comparison(condition, state))
    };
    clean_up_numbers(std::iter::once(head).chain(found.iter().map(line)).collect())
}

/// Formats both sides of a comparison: `churn(S1) over 7 = 0.0523 > 0.05 (day before 0.0481)`. If the comparison is
/// false, shows the opposite operator.
fn describe_comparison(condition: &Condition, judged: &ConditionState) -> String {
    let value = |value: Option<f64>, others: &[f64]| {
        value.map_or("no value".to_owned(), |number| format_distinct(number, others))
    };
    match condition {
        Condition::Compared(quantity, relation, threshold) => {
            let sign = match (judged.is_true, judged.value) {
                (true, _) => format!(" {} {threshold}", relation.symbol()),
                (false, Some(_)) => format!(" {} {threshold}", opposite_symbol(*relation)),
                (false, None) => String::new(),
            };
            let value_text = value(judged.value, &[*threshold]);
            let before_text = value(judged.before, &[*threshold]);
            format!("{quantity}{} = {value_text}{sign} (day before {before_text})", quantity.describe_days())
        }
        Condition::Changed(quantity, direction) => {
            let moves = match (judged.is_true, direction) {
                (true, direction) => direction.name(),
                (false, Direction::Rises) => "does not rise",
                (false, Direction::Falls) => "does not fall",
            };
            let value_text = value(judged.value, judged.before.as_slice());
            let before_text = value(judged.before, judged.value.as_slice());
            format!(
                "{quantity}{} = {value_text}, {moves} (day before {before_text})",
                quantity.describe_days()
            )
        }
        Condition::Event(event) => {
            let answer = |happens: bool| if happens { "yes" } else { "no" };
            let (today, before) = (answer(judged.is_true), answer(judged.was_true));
            format!("event {} {today} (day before {before})", event.id())
        }
    }
}

fn opposite_symbol(relation: ComparisonOperator) -> &'static str {
    match relation {
        ComparisonOperator::Above => ComparisonOperator::AtMost.symbol(),
        ComparisonOperator::AtLeast => ComparisonOperator::Below.symbol(),
        ComparisonOperator::Below => ComparisonOperator::AtLeast.symbol(),
        ComparisonOperator::AtMost => ComparisonOperator::Above.symbol(),
    }
}

/// Formats a number with the fewest decimals that distinguish it from the other numbers. Whole numbers have no
/// decimals.
fn format_distinct(value: f64, others: &[f64]) -> String {
    if value.fract() == 0.0 && value.abs() < 1e15 {
        return format!("{value:.0}");
    }
    let rounded = |value: f64, decimals: usize| format!("{value:.decimals$}").parse::<f64>().unwrap_or(value);
    let differs = |decimals: &usize| {
        let order = |other: f64| rounded(value, *decimals).partial_cmp(&rounded(other, *decimals));
        others.iter().all(|other| order(*other) == value.partial_cmp(other))
    };
    let decimals = (MIN_DECIMALS..=MAX_DECIMALS).find(differs);
    decimals.map_or_else(|| decimal_literal(value), |decimals| format!("{value:.decimals$}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_shown_with_minimal_distinct_decimals() {
        let condition: Condition = "reputation(S3) falls".parse().expect("a condition");
        let mut judged = ConditionState {
            day: 39,
            value: Some(0.507881),
            before: Some(0.507912),
            is_true: true,
            was_true: false,
            is_first_value: false,
        };
        let text = describe_comparison(&condition, &judged);
        assert_eq!(text, "reputation(S3) = 0.50788, falls (day before 0.50791)");
        (judged.before, judged.is_true) = (None, false);
        assert_eq!(
            describe_comparison(&condition, &judged),
            "reputation(S3) = 0.5079, does not fall (day before no value)"
        );
    }

    #[test]
    fn different_numbers_are_formatted_differently() {
        for (value, other, written) in [
            (0.05234, 0.05, "0.0523"),
            (0.050_000_4, 0.05, "0.0500004"),
            (0.05, 0.05, "0.0500"),
            (1200.0, 1000.0, "1200"),
            (0.049_999_999_999_999_996, 0.05, "0.049999999999999996"),
        ] {
            assert_eq!(format_distinct(value, &[other]), written);
        }
    }
}
