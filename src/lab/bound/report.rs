//! Tables of the upper bound: the account compared with the published account, its sensitivity to slack, the groups,
//! and the assumptions.

use super::account::{BoundAccount, SATISFIED_SHARE, SensitivityRow};
use super::account_line::AccountLine;
use super::assumptions::PUBLISHED_SLACK;
use crate::lab_report::{
    AxisScale, CellValue, Column, Graph, GraphAxis, GraphForm, LabReport, LabTable, Measure, Series,
};
use novamind_base::formatting::percent;
use novamind_report::ranking::published_results;

/// Returns the report on the account and its sensitivity to slack.
pub fn bound_report(account: &BoundAccount, slacks: &[SensitivityRow]) -> LabReport {
    let title = format!(
        "Upper bound, slack {}: the paper's account from the parameters in force",
        account.assumptions.slack
    );
    let mut exhibit = LabReport::with_table(title, account_table(account));
    exhibit.tables.push(sensitivity_table(slacks));
    exhibit.tables.push(group_table(account));
    exhibit.tables.push(assumption_table(account));
    exhibit.graphs.push(renewal_graph(account));
    for differing in account.lines.iter().filter(|account_entry| account_entry.line != AccountLine::Costs) {
        exhibit.notes.push(format!("{}: {}.", differing.line.name(), differing.explanation));
    }
    if account.assumptions.slack != PUBLISHED_SLACK {
        exhibit.notes.push(format!("The published account has slack {PUBLISHED_SLACK}."));
    }
    exhibit.notes.push(
        "The estimate is the published share of the amount before the discount. The estimate does not limit the cash that a run can reach. The line \"before discount\" is the result of the account."
            .to_owned(),
    );
    exhibit.notes.push(format!("Published: {}.", published_results().paper().source));
    exhibit
}

fn account_table(account: &BoundAccount) -> LabTable {
    let columns = vec![
        Column::text("line", "line"),
        Column::number("own", "here, M$", Measure::Millions),
        Column::number("published", "published, M$", Measure::Millions),
        Column::number("ratio", "here / published", Measure::Share),
    ];
    let mut table = LabTable::new("account", "Millions of dollars", columns);
    table.rows = (account.lines.iter())
        .map(|account_entry| {
            vec![
                CellValue::text(account_entry.line.name()),
                CellValue::number(account_entry.computed / 1e6),
                CellValue::number(account_entry.published / 1e6),
                CellValue::number(account_entry.computed / account_entry.published),
            ]
        })
        .collect();
    table
}

fn sensitivity_table(slacks: &[SensitivityRow]) -> LabTable {
    let columns = vec![
        Column::number("slack", "slack", Measure::Number(1)),
        Column::number("targeted", "targeted development, M$", Measure::Millions),
        Column::number("renewals", "group renewals", Measure::Count),
        Column::number("satisfied", "nearly full renewals", Measure::Count),
        Column::number("mean_share", "mean share that renews", Measure::Share),
        Column::number("estimate", "estimate, M$", Measure::Millions),
    ];
    let caption =
        format!("Sensitivity to slack; nearly full: more than {} renew", percent(SATISFIED_SHARE, 0));
    let mut table = LabTable::new("slack", caption, columns);
    table.rows = (slacks.iter())
        .map(|sensitivity_row| {
            vec![
                CellValue::number(sensitivity_row.slack),
                CellValue::number(sensitivity_row.targeted / 1e6),
                CellValue::number(sensitivity_row.renewals as f64),
                CellValue::number(sensitivity_row.satisfied as f64),
                CellValue::number(sensitivity_row.mean_share),
                CellValue::number(sensitivity_row.estimate / 1e6),
            ]
        })
        .collect();
    table
}

fn group_table(account: &BoundAccount) -> LabTable {
    let columns = vec![
        Column::text("group", "group"),
        Column::number("customers", "N", Measure::Count),
        Column::number("price", "p", Measure::Dollars),
        Column::number("gap", "gap", Measure::Number(2)),
        Column::number("least_spending", "T0 a day", Measure::Dollars),
        Column::number("spending", "T a day", Measure::Dollars),
        Column::number("least_share", "least r", Measure::Share),
        Column::number("revenue", "revenue, M$", Measure::Millions),
    ];
    let caption = "Groups. N: customers or seats, p: price, T: $ per day that close the quality gap, r: share that renews";
    let mut table = LabTable::new("groups", caption, columns);
    table.rows = (account.groups.iter())
        .map(|bound_group| {
            vec![
                CellValue::text(bound_group.group),
                CellValue::number(bound_group.customers),
                CellValue::number(bound_group.price),
                CellValue::number(bound_group.quality_gap),
                CellValue::number(bound_group.min_spending),
                CellValue::number(bound_group.spending),
                CellValue::number(bound_group.renewal_shares.iter().copied().fold(1.0, f64::min)),
                CellValue::number(bound_group.revenue / 1e6),
            ]
        })
        .collect();
    table
}

fn assumption_table(account: &BoundAccount) -> LabTable {
    let columns = vec![Column::text("assumption", "assumption"), Column::text("meaning", "meaning")];
    let mut table = LabTable::new("assumptions", "Assumptions", columns);
    let rows = account.assumptions.descriptions(account.has_competitors);
    table.rows =
        rows.into_iter().map(|(name, text)| vec![CellValue::text(name), CellValue::text(text)]).collect();
    table
}

/// Returns a graph of the renewal shares by day: the mean of all groups, the lowest group and the highest group.
fn renewal_graph(account: &BoundAccount) -> Graph {
    let days = || account.assumptions.renewals.iter().map(|day| f64::from(*day));
    let shares_on_day = |at: usize| {
        account.groups.iter().filter_map(move |bound_group| bound_group.renewal_shares.get(at).copied())
    };
    let series = |name: &str, of: &dyn Fn(usize) -> f64| Series {
        name: name.to_owned(),
        points: days().enumerate().map(|(at, day)| (day, of(at))).collect(),
    };
    let count = account.groups.len().max(1) as f64;
    Graph {
        title: "Share that renews on each billing day".to_owned(),
        summary: "Mean of the groups, and the lowest and highest share of a group".to_owned(),
        x_axis: GraphAxis { label: "day", scale: AxisScale::Whole },
        y_axis: GraphAxis { label: "share", scale: AxisScale::Linear },
        series: vec![
            series("lowest group", &|at| shares_on_day(at).fold(1.0, f64::min)),
            series("highest group", &|at| shares_on_day(at).fold(0.0, f64::max)),
            series("mean", &|at| shares_on_day(at).sum::<f64>() / count),
        ],
        form: GraphForm::Lines,
    }
}
