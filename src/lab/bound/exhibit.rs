//! Tables of the account next to the published one, the sensitivity to slack, the groups, and the assumptions.

use super::account::{BoundAccount, NEARLY_ALL, SlackRow};
use super::premises::PUBLISHED_SLACK;
use super::published::AccountLine;
use crate::exhibit::{
    AxisScale, Column, Datum, Exhibit, Graph, GraphAxis, GraphForm, Measure, Series, Tabulation,
};
use novamind_base::notation::percent;
use novamind_report::ranking::published;

/// Returns the account and its sensitivity to slack.
pub fn bound_exhibit(account: &BoundAccount, slacks: &[SlackRow]) -> Exhibit {
    let title = format!(
        "Upper bound, slack {}: the paper's account from the parameters in force",
        account.premises.slack
    );
    let mut exhibit = Exhibit::of(title, lines(account));
    exhibit.tables.push(sensitivity_table(slacks));
    exhibit.tables.push(groups(account));
    exhibit.tables.push(assumptions(account));
    exhibit.graphs.push(renewals(account));
    for differing in account.lines.iter().filter(|own| own.line != AccountLine::Costs) {
        exhibit.notes.push(format!("{}: {}.", differing.line.name(), differing.why));
    }
    if account.premises.slack != PUBLISHED_SLACK {
        exhibit.notes.push(format!("The published account has slack {PUBLISHED_SLACK}."));
    }
    exhibit.notes.push(
        "The estimate is the published share of the amount before the discount. It does not limit what a run can reach; \
         before the discount is the account itself."
            .to_owned(),
    );
    exhibit.notes.push(format!("Published: {}.", published().source));
    exhibit
}

fn lines(account: &BoundAccount) -> Tabulation {
    let columns = vec![
        Column::words("line", "line"),
        Column::numbers("own", "here, M$", Measure::Millions),
        Column::numbers("published", "published, M$", Measure::Millions),
        Column::numbers("ratio", "here / published", Measure::Share),
    ];
    let mut table = Tabulation::new("account", "Millions of dollars", columns);
    table.rows = (account.lines.iter())
        .map(|own| {
            vec![
                Datum::words(own.line.name()),
                Datum::number(own.own / 1e6),
                Datum::number(own.published / 1e6),
                Datum::number(own.own / own.published),
            ]
        })
        .collect();
    table
}

fn sensitivity_table(slacks: &[SlackRow]) -> Tabulation {
    let columns = vec![
        Column::numbers("slack", "slack", Measure::Number(1)),
        Column::numbers("targeted", "targeted development, M$", Measure::Millions),
        Column::numbers("renewals", "renewals of groups", Measure::Count),
        Column::numbers("satisfied", "of which nearly all renew", Measure::Count),
        Column::numbers("mean_share", "mean share that renews", Measure::Share),
        Column::numbers("estimate", "estimate, M$", Measure::Millions),
    ];
    let caption = format!("Sensitivity to slack; nearly all: more than {}", percent(NEARLY_ALL, 0));
    let mut table = Tabulation::new("slack", caption, columns);
    table.rows = (slacks.iter())
        .map(|own| {
            vec![
                Datum::number(own.slack),
                Datum::number(own.targeted / 1e6),
                Datum::number(own.renewals as f64),
                Datum::number(own.satisfied as f64),
                Datum::number(own.mean_share),
                Datum::number(own.estimate / 1e6),
            ]
        })
        .collect();
    table
}

fn groups(account: &BoundAccount) -> Tabulation {
    let columns = vec![
        Column::words("group", "group"),
        Column::numbers("customers", "N", Measure::Count),
        Column::numbers("price", "p", Measure::Dollars),
        Column::numbers("gap", "gap", Measure::Number(2)),
        Column::numbers("least_spending", "T0 a day", Measure::Dollars),
        Column::numbers("spending", "T a day", Measure::Dollars),
        Column::numbers("least_share", "least r", Measure::Share),
        Column::numbers("revenue", "revenue, M$", Measure::Millions),
    ];
    let caption = "Groups: N customers or seats at price p; the gap of quality that T a day closes; r: share that renews";
    let mut table = Tabulation::new("groups", caption, columns);
    table.rows = (account.groups.iter())
        .map(|own| {
            vec![
                Datum::words(own.group),
                Datum::number(own.customers),
                Datum::number(own.price),
                Datum::number(own.gap),
                Datum::number(own.least_spending),
                Datum::number(own.spending),
                Datum::number(own.renewing.iter().copied().fold(1.0, f64::min)),
                Datum::number(own.revenue / 1e6),
            ]
        })
        .collect();
    table
}

fn assumptions(account: &BoundAccount) -> Tabulation {
    let columns = vec![Column::words("assumption", "assumption"), Column::words("meaning", "meaning")];
    let mut table = Tabulation::new("assumptions", "Assumptions", columns);
    let rows = account.premises.assumptions(account.has_rivals);
    table.rows = rows.into_iter().map(|(name, text)| vec![Datum::words(name), Datum::words(text)]).collect();
    table
}

/// Returns a graph of renewal shares by day: mean, lowest and highest group.
fn renewals(account: &BoundAccount) -> Graph {
    let days = || account.premises.renewals.iter().map(|day| f64::from(*day));
    let of_day = |at: usize| account.groups.iter().filter_map(move |own| own.renewing.get(at).copied());
    let series = |name: &str, of: &dyn Fn(usize) -> f64| Series {
        name: name.to_owned(),
        points: days().enumerate().map(|(at, day)| (day, of(at))).collect(),
    };
    let count = account.groups.len().max(1) as f64;
    Graph {
        title: "Share that renews on each billing day".to_owned(),
        summary: "Mean of the groups, and the lowest and highest share of a group".to_owned(),
        across: GraphAxis { label: "day", scale: AxisScale::Whole },
        up: GraphAxis { label: "share", scale: AxisScale::Linear },
        series: vec![
            series("lowest group", &|at| of_day(at).fold(1.0, f64::min)),
            series("most", &|at| of_day(at).fold(0.0, f64::max)),
            series("mean", &|at| of_day(at).sum::<f64>() / count),
        ],
        form: GraphForm::Lines,
    }
}
