//! Text for breakpoints: conditions, why a run stopped, and since when a condition is true.

use super::settled;
use crate::words::count;
use novamind_base::notation::point_number;
use novamind_insight::{
    Breakpoint, Condition, Direction, Hit, Judged, LookBack, Relation, RunUntil, TrueBefore,
};

const DECIMALS: usize = 4;
const MOST_DECIMALS: usize = 12;

/// Lists the breakpoints, one per line.
pub fn breakpoints_in_words(set: &[Breakpoint]) -> Vec<String> {
    match set.is_empty() {
        true => vec!["no breakpoint is set; example: break churn(S1) > 0.05 over 7".to_owned()],
        false => set.iter().map(|own| format!("{}  {}", own.number, own.condition)).collect(),
    }
}

/// Explains why a run stopped: each breakpoint that became true, with both sides, or that none did.
pub fn stop_in_words(run: &RunUntil, day: u32, breakpoints: usize) -> Vec<String> {
    let hit = |hit: &Hit| {
        let Hit { breakpoint, judged } = hit;
        format!(
            "stopped on day {day}: {} · breakpoint {}",
            sides(&breakpoint.condition, judged),
            breakpoint.number
        )
    };
    let from = run.from + 1;
    let ran = format!("ran day {from} to {day}");
    let mut lines = match (run.hits.is_empty(), breakpoints) {
        (false, _) => return settled(run.hits.iter().map(hit).collect()),
        (true, 0) => vec![format!("{ran}; no breakpoint is set")],
        (true, 1) if run.true_before.is_empty() => {
            vec![format!("{ran}; the breakpoint was never true")]
        }
        (true, count) if run.true_before.is_empty() => {
            vec![format!("{ran}; none of the {count} breakpoints was ever true")]
        }
        (true, 1) if run.true_before.iter().all(|own| own.began.is_some()) => {
            vec![format!(
                "{ran}; the breakpoint did not become true: it was true at its figure's first value"
            )]
        }
        (true, 1) => vec![format!("{ran}; the breakpoint did not become true: it was true before")],
        (true, count) => vec![format!("{ran}; none of the {count} breakpoints became true")],
    };
    lines.extend(run.true_before.iter().map(|own| true_before(own, day)));
    settled(lines)
}

fn true_before(own: &TrueBefore, day: u32) -> String {
    let Hit { breakpoint, judged } = &own.hit;
    let until = match (own.until == day, own.began) {
        (true, None) => "true on all these days and on the day before".to_owned(),
        (false, None) => format!("true until day {}", own.until),
        (true, Some(began)) => format!("true from day {began}, its figure's first value"),
        (false, Some(began)) => {
            format!("true from day {began}, its figure's first value, until day {}", own.until)
        }
    };
    format!("breakpoint {} was {until}: {}", breakpoint.number, sides(&breakpoint.condition, judged))
}

/// Describes since when a condition has its current value, with both sides of the change.
pub fn look_back_in_words(own: &LookBack) -> Vec<String> {
    let LookBack { condition, today, last_true, last_false } = own;
    let is = if today.is_true { "true" } else { "false" };
    let mut lines = vec![format!("{condition} is {is} on day {}: {}", today.day, sides(condition, today))];
    lines.push(match if today.is_true { last_false } else { last_true } {
        None if today.is_true => "it was true on every day".to_owned(),
        None => "it was never true".to_owned(),
        Some(other) => format!(
            "last {} on day {}: {}; {is} since day {}",
            if today.is_true { "false" } else { "true" },
            other.day,
            sides(condition, other),
            own.since()
        ),
    });
    settled(lines)
}

/// Lists the days on which a condition became true, marking first values of its figure.
pub fn found_in_words(condition: &Condition, found: &[Judged], last_day: u32) -> Vec<String> {
    let days = count(last_day, "day");
    let head = match found.iter().filter(|own| own.becomes_true()).count() {
        0 => format!("{condition} became true on none of {days}"),
        often => format!("{condition} became true on {often} of {days}"),
    };
    let line = |own: &Judged| {
        let began = if own.begins { " · its first value" } else { "" };
        format!("  day {:<4} {}{began}", own.day, sides(condition, own))
    };
    settled(std::iter::once(head).chain(found.iter().map(line)).collect())
}

/// Formats both sides: `churn(S1) over 7 = 0.0523 > 0.05 (day before 0.0481)`. If the comparison is false, shows the
/// opposite sign.
fn sides(condition: &Condition, judged: &Judged) -> String {
    let value =
        |value: Option<f64>, others: &[f64]| value.map_or("no value".to_owned(), |own| told(own, others));
    match condition {
        Condition::Compared(quantity, relation, threshold) => {
            let sign = match (judged.is_true, judged.value) {
                (true, _) => format!(" {} {threshold}", relation.sign()),
                (false, Some(_)) => format!(" {} {threshold}", opposite(*relation)),
                (false, None) => String::new(),
            };
            let of_value = value(judged.value, &[*threshold]);
            let of_before = value(judged.before, &[*threshold]);
            format!("{quantity}{} = {of_value}{sign} (day before {of_before})", quantity.span())
        }
        Condition::Moved(quantity, direction) => {
            let moves = match (judged.is_true, direction) {
                (true, direction) => direction.word(),
                (false, Direction::Rises) => "does not rise",
                (false, Direction::Falls) => "does not fall",
            };
            let of_value = value(judged.value, judged.before.as_slice());
            let of_before = value(judged.before, judged.value.as_slice());
            format!("{quantity}{} = {of_value}, {moves} (day before {of_before})", quantity.span())
        }
        Condition::Event(event) => {
            let said = |happens: bool| if happens { "yes" } else { "no" };
            let (today, before) = (said(judged.is_true), said(judged.was_true));
            format!("event {} {today} (day before {before})", event.id())
        }
    }
}

fn opposite(relation: Relation) -> &'static str {
    match relation {
        Relation::Above => Relation::AtMost.sign(),
        Relation::AtLeast => Relation::Below.sign(),
        Relation::Below => Relation::AtLeast.sign(),
        Relation::AtMost => Relation::Above.sign(),
    }
}

/// Formats a number with as few decimals as distinguish it from others; whole numbers without any.
fn told(value: f64, others: &[f64]) -> String {
    if value.fract() == 0.0 && value.abs() < 1e15 {
        return format!("{value:.0}");
    }
    let rounded = |value: f64, decimals: usize| format!("{value:.decimals$}").parse::<f64>().unwrap_or(value);
    let differs = |decimals: &usize| {
        let order = |other: f64| rounded(value, *decimals).partial_cmp(&rounded(other, *decimals));
        others.iter().all(|other| order(*other) == value.partial_cmp(other))
    };
    let decimals = (DECIMALS..=MOST_DECIMALS).find(differs);
    decimals.map_or_else(|| point_number(value), |decimals| format!("{value:.decimals$}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_sides_of_a_fall_are_told_apart_and_no_finer() {
        let condition: Condition = "reputation(S3) falls".parse().expect("a condition");
        let mut judged = Judged {
            day: 39,
            value: Some(0.507881),
            before: Some(0.507912),
            is_true: true,
            was_true: false,
            begins: false,
        };
        let said = sides(&condition, &judged);
        assert_eq!(said, "reputation(S3) = 0.50788, falls (day before 0.50791)");
        (judged.before, judged.is_true) = (None, false);
        assert_eq!(
            sides(&condition, &judged),
            "reputation(S3) = 0.5079, does not fall (day before no value)"
        );
    }

    #[test]
    fn numbers_are_written_so_that_they_stay_apart() {
        for (value, other, written) in [
            (0.05234, 0.05, "0.0523"),
            (0.050_000_4, 0.05, "0.0500004"),
            (0.05, 0.05, "0.0500"),
            (1200.0, 1000.0, "1200"),
            (0.049_999_999_999_999_996, 0.05, "0.049999999999999996"),
        ] {
            assert_eq!(told(value, &[other]), written);
        }
    }
}
