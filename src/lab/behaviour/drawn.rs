//! Graphs of player behavior: small multiples of cash, customers by group.

use std::collections::BTreeMap;

use super::{ObservedRun, who};
use crate::exhibit::{AxisScale, Graph, GraphAxis, GraphForm, Series};

/// Maximum number of runs with a customer graph; each run has its own graph.
pub(super) const MOST_WITH_CUSTOMERS: usize = 4;

/// Returns a cash graph per participant and, for the first few runs, a graph of customers by group.
pub(super) fn graphs(runs: &[ObservedRun]) -> Vec<Graph> {
    let mut players: BTreeMap<Option<String>, Vec<&ObservedRun>> = BTreeMap::new();
    runs.iter().for_each(|run| players.entry(who(run)).or_default().push(run));
    let mut graphs: Vec<Graph> = players.into_iter().map(|(who, own)| cash(who.as_deref(), &own)).collect();
    let few = if runs.len() > MOST_WITH_CUSTOMERS { &[] } else { runs };
    graphs.extend(few.iter().filter(|run| !run.groups.is_empty()).map(customers));
    graphs
}

fn lines(
    title: String,
    summary: String,
    across: &'static str,
    up: &'static str,
    series: Vec<Series>,
) -> Graph {
    let (across, up) = (
        GraphAxis { label: across, scale: AxisScale::Whole },
        GraphAxis { label: up, scale: AxisScale::Linear },
    );
    Graph { title, summary, across, up, series, form: GraphForm::Lines }
}

fn cash(who: Option<&str>, runs: &[&ObservedRun]) -> Graph {
    let series = runs.iter().map(|run| Series {
        name: run.book.run.clone(),
        points: (0u32..).map(f64::from).zip(run.cash_by_day.iter().copied()).collect(),
    });
    let title = who.map_or("Cash by day".to_owned(), |who| format!("Cash by day, {who}"));
    let summary = format!("Cash of {} runs, from the first day to the last.", runs.len());
    lines(title, summary, "day", "dollars", series.collect())
}

fn customers(run: &ObservedRun) -> Graph {
    let series = run.groups.iter().map(|group| Series {
        name: group.group.id().to_owned(),
        points: (0u32..).map(f64::from).zip(group.active.iter().copied()).collect(),
    });
    let title = format!("Active subscriptions by group, run {}", run.book.run);
    let summary = format!("Subscriptions of {} groups, week by week.", run.groups.len());
    lines(title, summary, "week", "subscriptions", series.collect())
}
