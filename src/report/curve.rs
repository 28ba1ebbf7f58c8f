//! The curve explorer in words: what it is drawn from, the curve at some prices, and what leads would do.

use novamind_base::notation::{cents, percent, price_to_cents};
use novamind_insight::{CurveBasis, CurveExplorer, CurveOutcome, CurvePoint, Expected, PlanPoint};
use novamind_session::identifiers::{ByPlan, Plan};

/// Every so many points of the curve is a row.
const ROW_EVERY: usize = 6;

/// What no quality wins.
const NOBODY: &str = "–";

/// What the curve is drawn from: `estimates of day 0, ±65%`.
pub fn basis_in_words(basis: &CurveBasis) -> String {
    match basis {
        CurveBasis::Truth { day } => format!("the truth of day {day}"),
        CurveBasis::Estimates { noise, as_of, .. } => {
            format!("estimates of day {as_of}, ±{}", percent(*noise, 0))
        }
    }
}

/// Names of the columns of [`rows`].
pub fn columns(own: &CurveExplorer) -> Vec<String> {
    let names = ["price", "1 in 10", "half", "9 in 10", "half, at least", "half, at most"];
    let shown = if own.is_truth() { 4 } else { 6 };
    names[..shown].iter().map(|name| (*name).to_owned()).collect()
}

/// The qualities that shares of the leads ask for at most, at some prices.
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

/// What a dash in the rows means, and what is assumed.
pub fn remarks(own: &CurveExplorer) -> Vec<String> {
    let mut lines = Vec::new();
    if rows(own).iter().flatten().any(|cell| cell == NOBODY) {
        lines.push(format!("{NOBODY} the price is above the budget of so many that no quality wins them"));
    }
    if !own.is_truth() {
        lines.push(
            "studies tell means only: how widely a group spreads and how far its curve rises is assumed alike for all groups"
                .to_owned(),
        );
    }
    lines
}

/// What leads would do: `conversion 31.2% (4.1% to 70.2%), revenue per lead $6.12 ($0.70 to $20.31)`.
pub fn outcome_in_words(outcome: &CurveOutcome) -> String {
    let conversion = with_ends(&outcome.conversion, |value| percent(value, 1));
    match &outcome.revenue_per_lead {
        Some(revenue) => format!("conversion {conversion}, revenue per lead {}", with_ends(revenue, cents)),
        None => format!("{conversion} ask for an offer; companies negotiate the price"),
    }
}

/// The same in few words: `31% (4% to 70%) · $6.12 ($0.70 to $20.31) a lead`.
pub fn outcome_in_few_words(outcome: &CurveOutcome) -> String {
    let conversion = with_ends(&outcome.conversion, |value| percent(value, 0));
    match &outcome.revenue_per_lead {
        Some(revenue) => format!("{conversion} · {} a lead", with_ends(revenue, cents)),
        None => format!("{conversion} ask for an offer"),
    }
}

/// A figure, with its ends where it has some.
pub fn with_ends(figure: &Expected, write: impl Fn(f64) -> String) -> String {
    let likely = write(figure.likely);
    match figure.least < figure.most {
        true => format!("{likely} ({} to {})", write(figure.least), write(figure.most)),
        false => likely,
    }
}

/// A plan as leads see it: `A $12, quality 0.20, taken by 12.3%`.
pub fn plan_in_words(plan: Plan, point: &PlanPoint, takers: Option<&ByPlan<f64>>) -> String {
    let taken = takers.map_or(String::new(), |all| format!(", taken by {}", percent(all[plan], 1)));
    format!("{plan} {}, quality {}{taken}", price_to_cents(point.list), quality(point.quality))
}

/// A quality; a dash where no quality is enough.
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
