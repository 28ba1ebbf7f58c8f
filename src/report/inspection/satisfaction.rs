//! Texts for the causes of a change in satisfaction.

use super::{clean_up_numbers, describe_recent_days, indented_table};
use novamind_insight::{SatisfactionEquation, SatisfactionTerm};

/// Describes the mean satisfaction of a group on a day: the value before, each term, the value after the update, and
/// the value at the end of the day.
pub fn describe_satisfaction(satisfaction_equation: &SatisfactionEquation) -> Vec<String> {
    let SatisfactionEquation { group, day, weight, departed: left, joined, subscribers, .. } =
        *satisfaction_equation;
    let mut lines = vec![format!("satisfaction of {group} on day {day}")];
    match (
        satisfaction_equation.before(),
        satisfaction_equation.after(),
        satisfaction_equation.instant_satisfaction(),
    ) {
        (Some(before), Some(after), Some(instant)) => {
            lines.push(format!(
                "  {:.2} × before {before:.4} + {weight:.2} × perceived today {instant:.4} = after {after:.4} \
                 ({:+.4}), mean of {}",
                1.0 - weight,
                after - before,
                subscriber_count(satisfaction_equation.included_subscribers())
            ));
            lines.extend(term_lines(satisfaction_equation));
        }
        _ => {
            lines.push("  no experience today: there were no subscribers at the start of the day".to_owned())
        }
    }
    let moved = match (satisfaction_equation.end_of_day, satisfaction_equation.after()) {
        (Some(mean), Some(after)) => format!("mean {mean:.4} ({:+.4})", mean - after),
        (Some(mean), None) => format!("mean {mean:.4}"),
        (None, _) => "no mean".to_owned(),
    };
    lines.push(format!(
        "  end of day: {left} left, {joined} joined, {} remain, {moved}",
        subscriber_count(subscribers)
    ));
    lines.extend(describe_recent_days(satisfaction_equation.recent_days.iter().flatten().copied()));
    clean_up_numbers(lines)
}

fn subscriber_count(count: u32) -> String {
    match count {
        1 => "1 subscriber".to_owned(),
        count => format!("{count} subscribers"),
    }
}

fn term_lines(satisfaction_equation: &SatisfactionEquation) -> Vec<String> {
    let head = ["term", "today", "day before", "change", "change of mean"];
    let number = |value: Option<f64>| value.map_or(String::new(), |value| format!("{value:+.4}"));
    let row = |name: &str, today: Option<f64>, yesterday: Option<f64>| {
        vec![
            name.to_owned(),
            number(today),
            number(yesterday),
            number(today.zip(yesterday).map(|(today, yesterday)| today - yesterday)),
            number(today.map(|today| today * satisfaction_equation.weight)),
        ]
    };
    let mut rows: Vec<Vec<String>> = SatisfactionTerm::ALL
        .map(|term| {
            row(term.id(), satisfaction_equation.term(term), satisfaction_equation.term_yesterday(term))
        })
        .to_vec();
    let forgotten = satisfaction_equation
        .before()
        .map(|before| format!("{:+.4}", 0.0 - satisfaction_equation.weight * before));
    let blank = String::new;
    rows.push(vec!["decay".to_owned(), blank(), blank(), blank(), forgotten.unwrap_or_default()]);
    indented_table(&head, &rows)
}
