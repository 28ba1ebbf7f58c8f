//! Texts that explain a change by its causes.

use super::decision_periods::describe_change;
use super::formatting::{
    describe_short_week, figure_name, format_number, format_percentage_points, format_whole, pluralize,
};
use novamind_base::formatting::{dollars, grouped_number, percent};
use novamind_insight::{CauseDetail, ChangeExplanation, InputDetail};
use novamind_record::figures::FigureUnit;

/// Name of the part of a change that no cause explains.
pub const RESIDUAL_NAME: &str = "residual";

/// A cause or the residual, with its contribution to the change.
#[derive(Debug, Clone, PartialEq)]
pub struct CauseLine {
    /// Name of the cause, or [`RESIDUAL_NAME`].
    pub name: &'static str,
    /// Contribution of the cause to the change, in the unit of the figure.
    pub amount: f64,
    /// Contribution as text, with its sign and unit.
    pub amount_text: String,
    /// Inputs of the cause that differ between the two weeks, with their old and new values.
    pub details: Vec<String>,
}

/// Returns all causes of a change, largest contribution first, then the residual.
pub fn cause_lines(why: &ChangeExplanation) -> Vec<CauseLine> {
    let line = |name, amount, details| {
        let written = format_signed_change(why.quantity.unit(), amount);
        CauseLine { name, amount, amount_text: written, details }
    };
    let part = |part: &novamind_insight::CauseContribution| {
        line(part.cause.name(), part.amount, part.details.iter().map(describe_detail).collect())
    };
    why.contributions.iter().map(part).chain([line(RESIDUAL_NAME, why.residual, Vec::new())]).collect()
}

/// Formats the change and its causes as an equation: `cancellations +942 compared with week 19 = price +938 ·
/// competitors +4 · residual 0`.
pub fn equation(why: &ChangeExplanation) -> String {
    let parts: Vec<String> =
        cause_lines(why).iter().map(|line| format!("{} {}", line.name, line.amount_text)).collect();
    format!(
        "{} {} compared with week {} = {}",
        figure_name(&why.quantity.name()),
        format_signed_change(why.quantity.unit(), why.total_change()),
        why.week - 1,
        parts.join(" · ")
    )
}

/// Formats the figure of both weeks: `week 20: 195 → 1,137`. Adds the lengths of the weeks if they differ.
pub fn heading(why: &ChangeExplanation) -> String {
    let value = |value| format_figure(why.quantity.unit(), value);
    let [before, number] = why.days;
    let short = describe_short_week(number, before).map_or(String::new(), |short| format!(" ({short})"));
    let name = why.quantity.name();
    format!("{}, week {}: {} → {}{short}", figure_name(&name), why.week, value(why.before), value(why.after))
}

/// Formats a value in the unit of a figure.
pub fn format_figure(unit: FigureUnit, value: f64) -> String {
    match unit {
        FigureUnit::Dollars => dollars(value + 0.0),
        FigureUnit::Count => format_whole(value),
        FigureUnit::Share => percent(value, 1),
        FigureUnit::PreciseShare => percent(value, 2),
        FigureUnit::Level => grouped_number(value, 3),
    }
}

/// Formats a change with its sign. Changes of shares are in percentage points.
pub fn format_signed_change(unit: FigureUnit, change: f64) -> String {
    let size = change.abs();
    let text = match unit {
        FigureUnit::Dollars => format!("${}", grouped_number(size, 0)),
        FigureUnit::Count if size < 100.0 && (size - size.round()).abs() > 0.05 => grouped_number(size, 1),
        FigureUnit::Count => grouped_number(size, 0),
        FigureUnit::Share => format_percentage_points(size, 1),
        FigureUnit::PreciseShare => format_percentage_points(size, 2),
        FigureUnit::Level => grouped_number(size, 3),
    };
    let is_nothing = !text.contains(|digit: char| ('1'..='9').contains(&digit));
    match change {
        _ if is_nothing => "0".to_owned(),
        change if change > 0.0 => format!("+{text}"),
        _ => format!("-{text}"),
    }
}

/// Describes a detail. The premise of a figure precedes the figure, because narrow windows cut the end of the text.
fn describe_detail(detail: &CauseDetail) -> String {
    match detail {
        CauseDetail::Setting(change) => describe_change(change),
        CauseDetail::Removed { first, last } => {
            format!("compared with a simulation without it on days {first} to {last}")
        }
        CauseDetail::RenewalsDue { bills: [before, now] } => format!(
            "without the other causes, at the mean cancellation rate: {} → {} due",
            count(*before),
            count(*now)
        ),
        CauseDetail::RenewalsCancelled { bills, cancelled } => {
            format!("without the other causes: {} of {} due are cancelled", count(*cancelled), count(*bills))
        }
        CauseDetail::BillsDue { bills: [before, now], dollars: [dollars_before, dollars_now] } => format!(
            "without the other causes, at the mean share paid: {} → {} due ({} → {})",
            count(*before),
            count(*now),
            dollars(*dollars_before),
            dollars(*dollars_now)
        ),
        CauseDetail::IssuesAtRenewal { shares: [before, now] } => format!(
            "without the other causes: {} → {} of those due had an open issue, valued by its age",
            percent(*before, 0),
            percent(*now, 0)
        ),
        CauseDetail::HiddenInputs => {
            "competitors, economy, demand, calendar and other inputs that you do not control; shown \
             one by one when the run has ended"
                .to_owned()
        }
        CauseDetail::Occurrences(times, noun) => pluralize(*times as u32, noun),
        CauseDetail::Input(InputDetail { name, old, new, is_share }) => {
            let value = |value: f64| if *is_share { percent(value, 1) } else { format_number(value) };
            format!("{name}: {} → {}", value(*old), value(*new))
        }
    }
}

fn count(number: u32) -> String {
    format_whole(number.into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use novamind_insight::{Cause, CauseContribution, WeekQuantity};
    use novamind_record::figures::WeekFigure;
    use novamind_tools::ToolId;

    fn sample_explanation(
        figure: WeekFigure,
        before: f64,
        after: f64,
        amounts: &[(Cause, f64)],
    ) -> ChangeExplanation {
        let part = |(cause, amount): &(Cause, f64)| CauseContribution {
            cause: *cause,
            amount: *amount,
            details: Vec::new(),
        };
        let parts: Vec<CauseContribution> = amounts.iter().map(part).collect();
        let quantity = WeekQuantity::for_company(figure).expect("a figure of the company");
        let rest = after - before - parts.iter().map(|part| part.amount).sum::<f64>();
        ChangeExplanation {
            week: 20,
            quantity,
            days: [7, 7],
            before,
            after,
            contributions: parts,
            residual: rest,
            simulation_count: 4,
        }
    }

    #[test]
    fn equation_names_every_cause_and_the_residual() {
        let price = Cause::Calls(ToolId::SetPrices);
        let change_explanation = sample_explanation(
            WeekFigure::Cancellations,
            195.0,
            1137.0,
            &[(price, 938.0), (Cause::Competitors, 3.5)],
        );
        let equation_text = equation(&change_explanation);
        assert_eq!(
            equation_text,
            "cancellations +942 compared with week 19 = price +938 · competitors +3.5 · residual +0.5"
        );
        assert_eq!(heading(&change_explanation), "cancellations, week 20: 195 → 1,137");
        let short = ChangeExplanation { days: [7, 3], ..change_explanation };
        assert_eq!(
            heading(&short),
            "cancellations, week 20: 195 → 1,137 (of 3 days, the previous week of 7)"
        );
        let explanation =
            sample_explanation(WeekFigure::Conversion, 0.2, 0.19, &[(price, -0.01), (Cause::Service, 0.0)]);
        assert_eq!(
            equation(&explanation),
            "conversion -1.00 pt compared with week 19 = price -1.00 pt · load and outages 0 · residual 0"
        );
        let cash_explanation =
            sample_explanation(WeekFigure::CashChange, 100.0, -4_900.4, &[(Cause::Market, -5_000.0)]);
        assert_eq!(
            equation(&cash_explanation),
            "cash change -$5,000 compared with week 19 = market -$5,000 · residual 0"
        );
    }

    #[test]
    fn cause_details_show_old_and_new_values() {
        let input = |name, old, new, is_share| CauseDetail::Input(InputDetail { name, old, new, is_share });
        let cases = [
            (CauseDetail::Occurrences(2, "move"), "2 moves"),
            (CauseDetail::Occurrences(1, "call"), "1 call"),
            (input("peak overload", 0.0, 0.131, true), "peak overload: 0.0% → 13.1%"),
            (input("index", 49.0, 50.25, false), "index: 49 → 50.25"),
            (
                CauseDetail::Removed { first: 8, last: 21 },
                "compared with a simulation without it on days 8 to 21",
            ),
            (
                CauseDetail::RenewalsDue { bills: [671, 1750] },
                "without the other causes, at the mean cancellation rate: 671 → 1,750 due",
            ),
            (
                CauseDetail::RenewalsCancelled { bills: 1750, cancelled: 80 },
                "without the other causes: 80 of 1,750 due are cancelled",
            ),
            (
                CauseDetail::BillsDue { bills: [671, 1750], dollars: [8_120.0, 21_000.4] },
                "without the other causes, at the mean share paid: 671 → 1,750 due ($8,120 → $21,000)",
            ),
            (
                CauseDetail::IssuesAtRenewal { shares: [0.2, 0.75] },
                "without the other causes: 20% → 75% of those due had an open issue, valued by its age",
            ),
        ];
        for (detail, words) in cases {
            assert_eq!(describe_detail(&detail), words);
        }
    }
}
