//! Graphs of player behavior: cash as small multiples, and customers by group.

use std::collections::BTreeMap;

use super::{BehaviorRun, participant_label};
use crate::lab_report::{AxisScale, Graph, GraphAxis, GraphForm, Series};

/// Maximum number of runs for which a customer graph is drawn.
pub(super) const MAX_CUSTOMER_GRAPHS: usize = 4;

/// Returns a graph of cash per participant, and a graph of customers by group for each of the first runs.
pub(super) fn behavior_graphs(runs: &[BehaviorRun]) -> Vec<Graph> {
    let mut players: BTreeMap<Option<String>, Vec<&BehaviorRun>> = BTreeMap::new();
    runs.iter().for_each(|run| players.entry(participant_label(run)).or_default().push(run));
    let mut graphs: Vec<Graph> =
        players.into_iter().map(|(who, behavior_runs)| cash_graph(who.as_deref(), &behavior_runs)).collect();
    let few = if runs.len() > MAX_CUSTOMER_GRAPHS { &[] } else { runs };
    graphs.extend(few.iter().filter(|run| !run.groups.is_empty()).map(customer_graph));
    graphs
}

fn line_graph(
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
    Graph { title, summary, x_axis: across, y_axis: up, series, form: GraphForm::Lines }
}

fn cash_graph(who: Option<&str>, runs: &[&BehaviorRun]) -> Graph {
    let series = runs.iter().map(|run| Series {
        name: run.logbook.run.clone(),
        points: (0u32..).map(f64::from).zip(run.cash_by_day.iter().copied()).collect(),
    });
    let title = who.map_or("Cash by day".to_owned(), |who| format!("Cash by day, {who}"));
    let summary = format!("Cash of {} runs, from the first day to the last.", runs.len());
    line_graph(title, summary, "day", "dollars", series.collect())
}

fn customer_graph(run: &BehaviorRun) -> Graph {
    let series = run.groups.iter().map(|group| Series {
        name: group.group.id().to_owned(),
        points: (0u32..).map(f64::from).zip(group.active.iter().copied()).collect(),
    });
    let title = format!("Active subscriptions by group, run {}", run.logbook.run);
    let summary = format!("Subscriptions of {} groups, week by week.", run.groups.len());
    line_graph(title, summary, "week", "subscriptions", series.collect())
}
