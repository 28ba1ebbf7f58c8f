//! Text of the participation curve explorer: its basis, the curve at several prices, and the expected
//! outcome.

use novamind_base::notation::{cents, percent, price_to_cents};
use novamind_insight::{CurveBasis, CurveExplorer, CurveOutcome, CurvePoint, Expected, PlanPoint};
use novamind_session::identifiers::{ByPlan, Plan};

/// Interval between the points that become rows.
const ROW_EVERY: usize = 6;

const NOBODY: &str = "–";

/// Describes the source of the curve: `estimates of day 0, ±65%`.
pub fn basis_in_words(basis: &CurveBasis) -> String {
    match basis {
        CurveBasis::Truth { day } => format!("true values of day {day}"),
        CurveBasis::Estimates { noise, as_of, .. } => {
            format!("estimates of day {as_of}, ±{}", percent(*noise, 0))
        }
    }
}

/// Returns the column names of [`rows`].
pub fn columns(own: &CurveExplorer) -> Vec<String> {
    let names = ["price", "1 in 10", "half", "9 in 10", "half, at least", "half, at most"];
    let shown = if own.is_truth() { 4 } else { 6 };
    names[..shown].iter().map(|name| (*name).to_owned()).collect()
}

/// Returns the quality that 10%, 50% and 90% of the leads accept, at several prices.
pub fn rows(own: &CurveExplorer) -> Vec<Vec<String>> {
    let row = |point: &CurvePoint| {
        let (least, most) = point.median_between;
        let mut cells = vec![price_to_cents(point.price)];
        cells.extend([point.tenth, point.median, point.ninetieth].map(quality));
        if !own.is_truth() {
            cells.extend([least, most].map(quality));
        }
        cells
    };
    own.points.iter().step_by(ROW_EVERY).map(row).collect()
}

/// Explains the dash in the rows and the assumptions.
pub fn remarks(own: &CurveExplorer) -> Vec<String> {
    let mut lines = Vec::new();
    if rows(own).iter().flatten().any(|cell| cell == NOBODY) {
        lines.push(format!(
            "{NOBODY} the price is above the budget of too many leads: no quality is sufficient"
        ));
    }
    if !own.is_truth() {
        lines.push(
            "studies estimate means only; spread and slope of the curve are assumed to be the same for all groups"
                .to_owned(),
        );
    }
    lines
}

/// Describes the expected result: `conversion 31.2% (4.1% to 70.2%), revenue per lead $6.12 ($0.70 to
/// $20.31)`.
pub fn outcome_in_words(outcome: &CurveOutcome) -> String {
    let conversion = with_ends(&outcome.conversion, |value| percent(value, 1));
    match &outcome.revenue_per_lead {
        Some(revenue) => format!("conversion {conversion}, revenue per lead {}", with_ends(revenue, cents)),
        None => format!("{conversion} ask for an offer; enterprises negotiate the price"),
    }
}

/// Describes the expected result briefly: `31% (4% to 70%) · $6.12 ($0.70 to $20.31) a lead`.
pub fn outcome_in_few_words(outcome: &CurveOutcome) -> String {
    let conversion = with_ends(&outcome.conversion, |value| percent(value, 0));
    match &outcome.revenue_per_lead {
        Some(revenue) => format!("{conversion} · {} a lead", with_ends(revenue, cents)),
        None => format!("{conversion} ask for an offer"),
    }
}

/// Writes a figure, with its range if it has one.
pub fn with_ends(figure: &Expected, write: impl Fn(f64) -> String) -> String {
    let likely = write(figure.likely);
    match figure.least < figure.most {
        true => format!("{likely} ({} to {})", write(figure.least), write(figure.most)),
        false => likely,
    }
}

/// Describes a plan as leads see it: `A $12, quality 0.20, chosen by 12.3%`.
pub fn plan_in_words(plan: Plan, point: &PlanPoint, takers: Option<&ByPlan<f64>>) -> String {
    let taken = takers.map_or(String::new(), |all| format!(", chosen by {}", percent(all[plan], 1)));
    format!("{plan} {}, quality {}{taken}", price_to_cents(point.list), quality(point.quality))
}

/// Writes a quality; a dash if no quality is sufficient.
pub fn quality(value: f64) -> String {
    if value.is_finite() { format!("{value:.2}") } else { NOBODY.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_kit::played;
    use novamind_session::identifiers::Group;

    #[test]
    fn an_unfinished_run_is_told_with_ends_and_what_is_assumed() {
        let mut session = played(0);
        let own = CurveExplorer::of(&mut session, Group::parse("S1").expect("a group")).expect("an explorer");
        assert_eq!(basis_in_words(&own.basis), "estimates of day 0, ±65%");
        assert_eq!(columns(&own).len(), 6);
        assert_eq!(rows(&own).len(), 11);
        assert!(rows(&own)[0][0] == "$0" && rows(&own)[10][3] == "–");
        assert_eq!(remarks(&own).len(), 2);
        let told = outcome_in_words(&own.outcome_of(20.0, 0.4));
        assert!(told.contains(" to ") && told.contains("revenue per lead $"), "{told}");
        let companies =
            CurveExplorer::of(&mut session, Group::parse("E1").expect("a group")).expect("an explorer");
        let told = outcome_in_words(&companies.outcome(&companies.plans));
        assert!(told.contains("ask for an offer"), "{told}");
    }

    #[test]
    fn figures_without_ends_stand_alone() {
        let sure = Expected { likely: 0.5, least: 0.5, most: 0.5 };
        assert_eq!(with_ends(&sure, |value| percent(value, 1)), "50.0%");
        let open = Expected { likely: 0.5, least: 0.1, most: 0.75 };
        assert_eq!(with_ends(&open, |value| percent(value, 1)), "50.0% (10.0% to 75.0%)");
        assert_eq!(
            (price_to_cents(12.0), price_to_cents(12.5), quality(f64::INFINITY)),
            ("$12".into(), "$12.50".into(), "–".into())
        );
    }
}
