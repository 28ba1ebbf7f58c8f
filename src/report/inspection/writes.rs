//! Texts for the writes to a figure on a day.

use super::{clean_up_numbers, indented_table};
use crate::formatting::{category_name, format_whole, pluralize};
use novamind_base::formatting::{dollars_and_cents, grouped_number};
use novamind_insight::{FigureWrite, FigureWrites, WriteSource, WriteTarget};
use novamind_session::{EndCause, ReputationCause};

/// Describes a figure before and after a day, and each write to the figure with its amount and result.
pub fn describe_writes(figure_writes: &FigureWrites) -> Vec<String> {
    let FigureWrites { target, day, opening_value: first, closing_value: last, writes } = figure_writes;
    let value = |value: f64| format_value(*target, value);
    let change = format_amount(*target, last - first);
    let mut lines =
        vec![format!("{target} on day {day}: {} → {}, change {change}", value(*first), value(*last))];
    if writes.is_empty() {
        lines.push("no writes".to_owned());
        return lines;
    }
    let row = |write: &FigureWrite| {
        let amount = format_amount(*target, write.amount());
        vec![describe_source(write), amount, value(write.after), explain_write(*target, write)]
    };
    lines.extend(indented_table(&["by", "amount", "after", ""], &writes.iter().map(row).collect::<Vec<_>>()));
    clean_up_numbers(lines)
}

/// Returns the name of the source of a write, such as `churn (17)`, `spillover from S1` or `payments`.
pub fn describe_source(write: &FigureWrite) -> String {
    let count = format_whole(write.changes.len() as f64);
    match write.source {
        WriteSource::Reputation(ReputationCause::Cancellations) => format!("churn ({count})"),
        WriteSource::Reputation(ReputationCause::LostEnterprise) => format!("lost enterprises ({count})"),
        WriteSource::Reputation(ReputationCause::Contributions(mood)) => {
            format!("satisfaction of {}", pluralize(mood.count, "subscriber"))
        }
        WriteSource::Reputation(ReputationCause::Spillover(spill)) => {
            format!("spillover from {}", spill.source)
        }
        WriteSource::LedgerEntries(category) => category_name(category).to_owned(),
        WriteSource::Cancellations(cause) => format!("cancelled: {}", subscription_end_cause_name(cause)),
        WriteSource::Signups(source) => format!("signed up: {}", source.id()),
        WriteSource::FirstDeals => "first deals".to_owned(),
    }
}

fn subscription_end_cause_name(cause: EndCause) -> &'static str {
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

/// Describes how the amount of a write was computed, and whether a limit applied.
fn explain_write(target: WriteTarget, write: &FigureWrite) -> String {
    let how = match write.source {
        WriteSource::Reputation(ReputationCause::Spillover(spill)) => {
            format!("{:+.9} of {} × {} × {}", spill.change, spill.source, spill.weight, spill.factor)
        }
        WriteSource::Reputation(ReputationCause::Contributions(mood)) => {
            format!("contributions {:+.6}", mood.sum)
        }
        _ => String::new(),
    };
    match write.is_limited() {
        true => {
            let asked = format_amount(target, write.requested_change());
            format!("{how} limited: {asked} without limits").trim().to_owned()
        }
        false => how,
    }
}

fn format_value(target: WriteTarget, value: f64) -> String {
    match target {
        WriteTarget::Reputation(_) => format!("{value:.9}"),
        WriteTarget::Cash => dollars_and_cents(value),
        WriteTarget::Subscribers(_) => grouped_number(value, 0),
    }
}

fn format_amount(target: WriteTarget, amount: f64) -> String {
    let written = match target {
        WriteTarget::Reputation(_) => return format!("{amount:+.9}"),
        WriteTarget::Cash => dollars_and_cents(amount),
        WriteTarget::Subscribers(_) => grouped_number(amount, 0),
    };
    if amount > 0.0 { format!("+{written}") } else { written }
}
