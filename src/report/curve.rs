//! Texts of the participation curve explorer: the source of the curve, its values at several prices, and the expected
//! outcome.

use novamind_base::formatting::{dollars_and_cents, percent, price_to_cents};
use novamind_insight::{CurveBasis, CurveExplorer, CurveOutcome, CurvePoint, ExpectedRange, PlanPoint};
use novamind_session::identifiers::{ByPlan, Plan};

use crate::measured_conversion::MeasuredConversion;

/// Number of curve points per table row.
const POINTS_PER_ROW: usize = 6;

const UNREACHABLE: &str = "–";

/// Describes the source of the curve: `estimates of day 0 · each within 65% of its true value`.
pub fn describe_basis(basis: &CurveBasis) -> String {
    match basis {
        CurveBasis::Truth { day } => format!("true values of day {day}"),
        CurveBasis::Estimates { noise, as_of, .. } => {
            format!("estimates of day {as_of} · each within {} of its true value", percent(*noise, 0))
        }
    }
}

/// Returns the column names of [`rows`].
pub fn column_names(curve_explorer: &CurveExplorer) -> Vec<String> {
    let names = ["price", "1 in 10", "half", "9 in 10", "half, lowest", "half, highest"];
    let shown = if curve_explorer.shows_true_values() { 4 } else { 6 };
    names[..shown].iter().map(|name| (*name).to_owned()).collect()
}

/// Returns a table row for each displayed price: the price, and the qualities at which 10 %, 50 % and 90 % of the leads
/// accept it.
pub fn rows(curve_explorer: &CurveExplorer) -> Vec<Vec<String>> {
    let row = |point: &CurvePoint| {
        let (least, most) = point.median_range;
        let mut cells = vec![price_to_cents(point.price)];
        cells.extend([point.p10, point.median, point.p90].map(format_quality));
        if !curve_explorer.shows_true_values() {
            cells.extend([least, most].map(format_quality));
        }
        cells
    };
    curve_explorer.points.iter().step_by(POINTS_PER_ROW).map(row).collect()
}

/// Returns footnotes that explain the dash in [`rows`] and name what the estimates leave out.
pub fn footnotes(curve_explorer: &CurveExplorer) -> Vec<String> {
    let mut lines = Vec::new();
    if rows(curve_explorer).iter().flatten().any(|cell| cell == UNREACHABLE) {
        lines.push(format!(
            "{UNREACHABLE} the price is above the budget of too many leads: no quality is sufficient"
        ));
    }
    lines.push(describe_omissions(curve_explorer));
    lines
}

/// Describes the estimated conversion and revenue: `estimated conversion 31.2% (4.1% to 70.2%), revenue per lead $6.12
/// ($0.70 to $20.31)`.
pub fn describe_outcome(outcome: &CurveOutcome) -> String {
    let conversion = format_range(&outcome.conversion, |value| percent(value, 1));
    match &outcome.revenue_per_lead {
        Some(revenue) => {
            let revenue = format_range(revenue, dollars_and_cents);
            format!("estimated conversion {conversion}, revenue per lead {revenue}")
        }
        None => format!("an estimated {conversion} ask for an offer; enterprises negotiate the price"),
    }
}

/// Describes the estimated and the measured conversion briefly: `estimated 31% (4% to 70%), measured 26% of 1,230
/// leads`.
pub fn describe_conversion_briefly(outcome: &CurveOutcome, measured: Option<&MeasuredConversion>) -> String {
    let conversion = format_range(&outcome.conversion, |value| percent(value, 0));
    let asked = if outcome.revenue_per_lead.is_none() { " ask for an offer" } else { "" };
    let measured = measured.map_or(String::new(), |measured| format!(", {}", measured.describe_briefly()));
    format!("estimated {conversion}{asked}{measured}")
}

/// Describes in a few words what the estimated conversion leaves out: `leaves out market changes since day 0; spread
/// assumed`.
pub fn describe_omissions_briefly(explorer: &CurveExplorer) -> String {
    let assumed = if explorer.shows_true_values() { "" } else { "; spread assumed" };
    format!("leaves out {}{assumed}", market_changes(explorer))
}

fn market_changes(explorer: &CurveExplorer) -> String {
    match explorer.basis {
        CurveBasis::Truth { day } => format!("market changes after day {day}"),
        CurveBasis::Estimates { as_of, .. } => format!("market changes since day {as_of}"),
    }
}

/// Describes what the estimated conversion leaves out, as one sentence.
pub fn describe_omissions(explorer: &CurveExplorer) -> String {
    let mut omitted = vec![market_changes(explorer)];
    if !explorer.group.is_enterprise() {
        omitted.push("discounts for single channels".to_owned());
    }
    if explorer.omits_service() {
        omitted.push("overload and outages".to_owned());
    }
    let text = match omitted.split_last() {
        Some((last, others)) if !others.is_empty() => format!("{} and {last}", others.join(", ")),
        _ => omitted.concat(),
    };
    let assumed = match explorer.shows_true_values() {
        true => "",
        false => "; it assumes the spread and slope of the curve",
    };
    format!("The estimate leaves out {text}{assumed}.")
}

/// Formats an expected value and its range, if it has one. `write` formats each number.
pub fn format_range(figure: &ExpectedRange, write: impl Fn(f64) -> String) -> String {
    let likely = write(figure.likely);
    match figure.least < figure.most {
        true => format!("{likely} ({} to {})", write(figure.least), write(figure.most)),
        false => likely,
    }
}

/// Describes the price, quality and share of a plan at a point of the curve: `A $12, quality 0.20, chosen by 12.3%`.
pub fn describe_plan(plan: Plan, point: &PlanPoint, takers: Option<&ByPlan<f64>>) -> String {
    let taken = takers.map_or(String::new(), |all| format!(", chosen by {}", percent(all[plan], 1)));
    format!("{plan} {}, quality {}{taken}", price_to_cents(point.list_price), format_quality(point.quality))
}

/// Formats a quality, or a dash if no quality is sufficient.
pub fn format_quality(value: f64) -> String {
    if value.is_finite() { format!("{value:.2}") } else { UNREACHABLE.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_kit::play_weeks;
    use novamind_session::identifiers::Group;

    #[test]
    fn curve_text_of_unfinished_run_has_ranges_and_assumptions() {
        let mut session = play_weeks(0);
        let curve_explorer =
            CurveExplorer::open(&mut session, Group::parse("S1").expect("a group")).expect("an explorer");
        assert_eq!(
            describe_basis(&curve_explorer.basis),
            "estimates of day 0 · each within 65% of its true value"
        );
        assert_eq!(column_names(&curve_explorer).len(), 6);
        assert_eq!(rows(&curve_explorer).len(), 11);
        assert!(rows(&curve_explorer)[0][0] == "$0" && rows(&curve_explorer)[10][3] == "–");
        assert_eq!(footnotes(&curve_explorer).len(), 2);
        let text = describe_outcome(&curve_explorer.outcome_at(20.0, 0.4));
        assert!(text.contains(" to ") && text.contains("revenue per lead $"), "{text}");
        let companies =
            CurveExplorer::open(&mut session, Group::parse("E1").expect("a group")).expect("an explorer");
        let text = describe_outcome(&companies.outcome_for_plans(&companies.plans));
        assert!(text.contains("ask for an offer"), "{text}");
    }

    #[test]
    fn omissions_depend_on_the_basis_and_the_group() {
        let mut session = play_weeks(0);
        let explorer = |group: &str, session: &mut novamind_session::Session| {
            CurveExplorer::open(session, Group::parse(group).expect("a group")).expect("an explorer")
        };
        assert_eq!(
            describe_omissions(&explorer("S1", &mut session)),
            "The estimate leaves out market changes since day 0 and discounts for single channels; it assumes the spread \
             and slope of the curve."
        );
        let text = describe_omissions(&explorer("E1", &mut session));
        assert!(!text.contains("discounts"), "{text}");
    }

    #[test]
    fn brief_conversion_contains_estimate_and_measurement() {
        let mut session = play_weeks(3);
        let group = Group::parse("S1").expect("a group");
        let measured = MeasuredConversion::of_group(&session, group);
        let explorer = CurveExplorer::open(&mut session, group).expect("an explorer");
        let text = describe_conversion_briefly(&explorer.outcome_for_plans(&explorer.plans), Some(&measured));
        let parts = ["estimated ", " to ", "), measured ", " leads"];
        assert!(parts.iter().all(|part| text.contains(part)), "{text}");
    }

    #[test]
    fn format_range_omits_the_range_of_exact_values() {
        let sure = ExpectedRange { likely: 0.5, least: 0.5, most: 0.5 };
        assert_eq!(format_range(&sure, |value| percent(value, 1)), "50.0%");
        let open = ExpectedRange { likely: 0.5, least: 0.1, most: 0.75 };
        assert_eq!(format_range(&open, |value| percent(value, 1)), "50.0% (10.0% to 75.0%)");
        assert_eq!(
            (price_to_cents(12.0), price_to_cents(12.5), format_quality(f64::INFINITY)),
            ("$12".into(), "$12.50".into(), "–".into())
        );
    }
}
