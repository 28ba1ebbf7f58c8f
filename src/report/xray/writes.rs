//! Text for the writes to a figure on a day.

use super::{settled, table};
use crate::words::{category_name, whole};
use novamind_base::notation::{cents, grouped};
use novamind_insight::{WhoWrites, Write, WriteTarget, WrittenBy};
use novamind_session::{EndCause, ReputationCause};

/// Describes the figure before and after the day, and each write with its amount and result.
pub fn writes_in_words(own: &WhoWrites) -> Vec<String> {
    let WhoWrites { target, day, first, last, writes } = own;
    let value = |value: f64| value_of(*target, value);
    let change = amount_of(*target, last - first);
    let mut lines =
        vec![format!("{target} on day {day}: {} → {}, change {change}", value(*first), value(*last))];
    if writes.is_empty() {
        lines.push("no writes".to_owned());
        return lines;
    }
    let row = |write: &Write| {
        let amount = amount_of(*target, write.amount());
        vec![written_by(write), amount, value(write.after), notes(*target, write)]
    };
    lines.extend(table(&["by", "amount", "after", ""], &writes.iter().map(row).collect::<Vec<_>>()));
    settled(lines)
}

/// Names the source of a write: `churn (17)`, `spillover from S1`, `payments`.
pub fn written_by(write: &Write) -> String {
    let count = whole(write.changes.len() as f64);
    match write.by {
        WrittenBy::Reputation(ReputationCause::Departures) => format!("churn ({count})"),
        WrittenBy::Reputation(ReputationCause::LostCompany) => format!("lost enterprises ({count})"),
        WrittenBy::Reputation(ReputationCause::Mood(mood)) => {
            format!("satisfaction of {} subscribers", whole(mood.count as f64))
        }
        WrittenBy::Reputation(ReputationCause::SpillOver(spill)) => {
            format!("spillover from {}", spill.source)
        }
        WrittenBy::Booked(category) => category_name(category).to_owned(),
        WrittenBy::Left(cause) => format!("cancelled: {}", why_left(cause)),
        WrittenBy::SignedUp(source) => format!("signed up: {}", source.id()),
        WrittenBy::FirstDeals => "first deals".to_owned(),
    }
}

fn why_left(cause: EndCause) -> &'static str {
    match cause {
        EndCause::Involuntary => "payment failed",
        EndCause::Quality => "no plan acceptable, low satisfaction",
        EndCause::Price => "no plan acceptable",
        EndCause::ExtendedIssue => "an issue stayed open",
        EndCause::QualityChange => "quality",
        EndCause::QuotaChange => "quota",
        EndCause::PriceSensitivity => "price",
        EndCause::LeadTimeout | EndCause::LeadSilent | EndCause::LeadRejected => {
            "a lead that did not convert"
        }
    }
}

/// Describes how the amount was computed, and whether a limit applied.
fn notes(target: WriteTarget, write: &Write) -> String {
    let how = match write.by {
        WrittenBy::Reputation(ReputationCause::SpillOver(spill)) => {
            format!("{:+.9} of {} × {} × {}", spill.change, spill.source, spill.weight, spill.factor)
        }
        WrittenBy::Reputation(ReputationCause::Mood(mood)) => {
            format!("contributions {:+.6}", mood.sum)
        }
        _ => String::new(),
    };
    match write.is_limited() {
        true => {
            let asked = amount_of(target, write.asked());
            format!("{how} limited: {asked} without limits").trim().to_owned()
        }
        false => how,
    }
}

fn value_of(target: WriteTarget, value: f64) -> String {
    match target {
        WriteTarget::Reputation(_) => format!("{value:.9}"),
        WriteTarget::Cash => cents(value),
        WriteTarget::Subscribers(_) => grouped(value, 0),
    }
}

fn amount_of(target: WriteTarget, amount: f64) -> String {
    let written = match target {
        WriteTarget::Reputation(_) => return format!("{amount:+.9}"),
        WriteTarget::Cash => cents(amount),
        WriteTarget::Subscribers(_) => grouped(amount, 0),
    };
    if amount > 0.0 { format!("+{written}") } else { written }
}
