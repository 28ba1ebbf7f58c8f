//! Tables of configurations. For one seed, the tables have the paper's columns. For several seeds, the tables
//! show the spread over the seeds and the stability of the ranks.

use super::grid::PolicyGrid;
use crate::experiment::{ExperimentResults, RunResult};
use crate::lab_report::{
    AxisScale, CellValue, Column, Graph, GraphAxis, GraphForm, LabReport, LabTable, Measure, Series,
    column_name,
};
use crate::ranks::{concordance, mean_ranks};
use novamind_base::formatting::dollars;
use novamind_base::statistics::{Interval, Quartiles, mean, median};
use novamind_report::ranking::published_results;

/// Returns the report on the configurations of a grid.
pub fn baseline_report(grid: &PolicyGrid, is_published: bool, results: &ExperimentResults) -> LabReport {
    let ranked = RankedResults::new(results);
    let count = results.seeds.len();
    let seeds = match (results.seeds.first(), results.seeds.last()) {
        (Some(first), Some(last)) if first != last => format!("seeds {first} to {last}"),
        (Some(first), _) => format!("seed {first}"),
        _ => "no seeds".to_owned(),
    };
    let table = if count > 1 { many_seeds_table(grid, &ranked) } else { single_seed_table(grid, &ranked) };
    let mut exhibit = LabReport::with_table(
        format!("{}: {} configurations, {seeds}", grid.name, grid.configurations.len()),
        table,
    );
    if count > 1 {
        exhibit.tables.push(stability_table(grid, &ranked));
        exhibit.tables.push(best_by_seed_table(grid, &ranked));
    }
    exhibit.graphs.push(if count > 1 { cash_quartile_graph(&ranked) } else { cash_bar_graph(&ranked) });
    exhibit.tables.push(run_table(grid, &ranked));
    exhibit.notes.extend(notes(grid, is_published, &ranked));
    exhibit
}

/// The results of an experiment, and the rank of each configuration.
struct RankedResults<'a> {
    results: &'a ExperimentResults,
    /// Indices of the configurations, sorted by median final cash, highest first.
    order: Vec<usize>,
    /// Ranks of the configurations, by seed and configuration.
    ranks_by_seed: Vec<Vec<f64>>,
}

impl<'a> RankedResults<'a> {
    fn new(results: &'a ExperimentResults) -> RankedResults<'a> {
        let middle =
            |arm: usize| median(&results.figures_of_arm(arm, |run| run.cash)).unwrap_or(f64::NEG_INFINITY);
        let mut order: Vec<usize> = (0..results.by_arm.len()).collect();
        order.sort_by(|one, other| middle(*other).total_cmp(&middle(*one)));
        let ranks_on_seed = |at: usize| {
            let cash: Vec<f64> =
                results.by_arm.iter().filter_map(|runs| runs.get(at)).map(|run| run.cash).collect();
            mean_ranks(&cash)
        };
        RankedResults { results, order, ranks_by_seed: (0..results.seeds.len()).map(ranks_on_seed).collect() }
    }

    fn runs_of_arm(&self, arm: usize) -> &[RunResult] {
        self.results.by_arm.get(arm).map_or(&[], Vec::as_slice)
    }

    /// Returns the share of seeds in which a configuration ranks first, including ties.
    fn share_of_first_places(&self, arm: usize) -> f64 {
        let min = |places: &[f64]| places.iter().copied().fold(f64::INFINITY, f64::min);
        let firsts = self
            .ranks_by_seed
            .iter()
            .filter(|places| places.get(arm).is_some_and(|value| *value == min(places)));
        firsts.count() as f64 / self.ranks_by_seed.len().max(1) as f64
    }

    fn mean_rank(&self, arm: usize) -> f64 {
        mean(&self.ranks_by_seed.iter().filter_map(|places| places.get(arm).copied()).collect::<Vec<_>>())
    }
}

fn axis_columns(grid: &PolicyGrid) -> Vec<Column> {
    grid.axes.iter().map(|axis| Column::text(&column_name(axis), axis)).collect()
}

fn level_cells(grid: &PolicyGrid, arm: usize) -> Vec<CellValue> {
    grid.configurations[arm].levels.iter().map(CellValue::text).collect()
}

fn single_seed_table(grid: &PolicyGrid, ranked: &RankedResults<'_>) -> LabTable {
    let mut columns = axis_columns(grid);
    columns.extend([
        Column::number("cash", "final cash", Measure::Dollars),
        Column::number("survival", "survival, days", Measure::Days),
        Column::number("peak", "peak subscribers", Measure::Count),
        Column::number("peak_day", "peak day", Measure::Days),
    ]);
    let mut table = LabTable::new("configurations", "Highest final cash first", columns);
    for arm in &ranked.order {
        let Some(run) = ranked.runs_of_arm(*arm).first() else { continue };
        let mut row = level_cells(grid, *arm);
        row.extend([
            CellValue::number(run.cash),
            CellValue::number(f64::from(run.day)),
            CellValue::number(f64::from(run.peak_subscribers)),
            CellValue::number(f64::from(run.peak_day)),
        ]);
        table.rows.push(row);
    }
    table
}

fn many_seeds_table(grid: &PolicyGrid, ranked: &RankedResults<'_>) -> LabTable {
    let mut columns = axis_columns(grid);
    columns.extend([
        Column::number("median_cash", "median cash", Measure::Dollars),
        Column::interval("median_cash_interval", "95 % interval of the median", Measure::Dollars),
        Column::number("lower_quartile", "lower quartile", Measure::Dollars),
        Column::number("upper_quartile", "upper quartile", Measure::Dollars),
        Column::number("bankrupt", "bankrupt", Measure::Share),
    ]);
    let mut table = LabTable::new("configurations", "Highest median final cash first", columns);
    for arm in &ranked.order {
        let of = |figure: fn(&RunResult) -> f64| ranked.results.figures_of_arm(*arm, figure);
        let cash = of(|run| run.cash);
        let quartiles = Quartiles::from_values(&cash);
        let mut row = level_cells(grid, *arm);
        row.extend([
            CellValue::number(quartiles.map(|quartiles| quartiles.median)),
            CellValue::interval(Interval::for_median(&cash)),
            CellValue::number(quartiles.map(|quartiles| quartiles.lower)),
            CellValue::number(quartiles.map(|quartiles| quartiles.upper)),
            CellValue::number(mean(&of(|run| f64::from(u8::from(run.is_bankrupt()))))),
        ]);
        table.rows.push(row);
    }
    table
}

fn stability_table(grid: &PolicyGrid, ranked: &RankedResults<'_>) -> LabTable {
    let mut columns = axis_columns(grid);
    columns.extend([
        Column::number("survival", "mean survival, days", Measure::Number(1)),
        Column::number("peak", "median peak subscribers", Measure::Count),
        Column::number("first", "seeds ranked first", Measure::Share),
        Column::number("place", "mean rank", Measure::Number(1)),
    ]);
    let mut table = LabTable::new("stability", "Survival, size, and rank by final cash", columns);
    for arm in &ranked.order {
        let of = |figure: fn(&RunResult) -> f64| ranked.results.figures_of_arm(*arm, figure);
        let mut row = level_cells(grid, *arm);
        row.extend([
            CellValue::number(mean(&of(|run| f64::from(run.day)))),
            CellValue::number(median(&of(|run| f64::from(run.peak_subscribers)))),
            CellValue::number(ranked.share_of_first_places(*arm)),
            CellValue::number(ranked.mean_rank(*arm)),
        ]);
        table.rows.push(row);
    }
    table
}

fn best_by_seed_table(grid: &PolicyGrid, ranked: &RankedResults<'_>) -> LabTable {
    let mut columns = vec![Column::text("seed", "seed")];
    columns.extend(axis_columns(grid));
    columns.extend([
        Column::number("equal", "ties", Measure::Count),
        Column::number("cash", "final cash", Measure::Dollars),
        Column::number("bankrupt", "bankrupt", Measure::Count),
    ]);
    let mut table = LabTable::new("seeds", "Best configuration of each seed", columns);
    for (at, seed) in ranked.results.seeds.iter().enumerate() {
        let run = |arm: usize| ranked.runs_of_arm(arm).get(at);
        let cash = |arm: &usize| run(*arm).map_or(f64::NEG_INFINITY, |run_result| run_result.cash);
        let best = ranked.order.iter().map(cash).fold(f64::NEG_INFINITY, f64::max);
        let first: Vec<usize> = ranked.order.iter().copied().filter(|arm| cash(arm) == best).collect();
        let bankrupt =
            ranked.order.iter().filter(|arm| run(**arm).is_some_and(RunResult::is_bankrupt)).count();
        let Some((one, equal)) = first.split_first() else { continue };
        let mut row = vec![CellValue::text(seed.to_string())];
        row.extend(level_cells(grid, *one));
        row.extend([equal.len() as f64, best, bankrupt as f64].map(CellValue::number));
        table.rows.push(row);
    }
    table
}

/// Describes the configurations that share the first rank: names one of them and states the number of the
/// others.
fn describe_ties(grid: &PolicyGrid, first: &[usize]) -> String {
    match first {
        [] => String::new(),
        [one] => grid.configurations[*one].label(),
        [one, rest @ ..] => {
            format!("{} and {} ties", grid.configurations[*one].label(), rest.len())
        }
    }
}

fn run_table(grid: &PolicyGrid, ranked: &RankedResults<'_>) -> LabTable {
    let mut columns = axis_columns(grid);
    columns.extend([
        Column::text("seed", "seed"),
        Column::number("cash", "final cash", Measure::Dollars),
        Column::number("survival", "survival, days", Measure::Days),
        Column::text("bankrupt", "bankrupt"),
        Column::number("peak", "peak subscribers", Measure::Count),
        Column::number("peak_day", "peak day", Measure::Days),
    ]);
    let mut table =
        LabTable { is_machine_readable_only: true, ..LabTable::new("runs", "Every run", columns) };
    for arm in 0..grid.configurations.len() {
        for run in ranked.runs_of_arm(arm) {
            let mut row = level_cells(grid, arm);
            row.extend([
                CellValue::text(run.seed.to_string()),
                CellValue::number(run.cash),
                CellValue::number(f64::from(run.day)),
                CellValue::text(if run.is_bankrupt() { "yes" } else { "no" }),
                CellValue::number(f64::from(run.peak_subscribers)),
                CellValue::number(f64::from(run.peak_day)),
            ]);
            table.rows.push(row);
        }
    }
    table
}

fn cash_bar_graph(ranked: &RankedResults<'_>) -> Graph {
    let cash = |(at, arm): (usize, &usize)| {
        ranked.runs_of_arm(*arm).first().map(|run| ((at + 1) as f64, run.cash.max(0.0)))
    };
    Graph {
        title: "Final cash of the configurations, highest first".to_owned(),
        summary: "Final cash by the configuration's rank in the table".to_owned(),
        x_axis: GraphAxis { label: "rank in the table", scale: AxisScale::Whole },
        y_axis: GraphAxis { label: "dollars", scale: AxisScale::Linear },
        series: vec![Series {
            name: "final cash".to_owned(),
            points: ranked.order.iter().enumerate().filter_map(cash).collect(),
        }],
        form: GraphForm::Bars,
    }
}

fn cash_quartile_graph(ranked: &RankedResults<'_>) -> Graph {
    let quartiles: Vec<Quartiles> = (ranked.order.iter())
        .filter_map(|arm| Quartiles::from_values(&ranked.results.figures_of_arm(*arm, |run| run.cash)))
        .collect();
    let series = |name: &str, of: fn(&Quartiles) -> f64| Series {
        name: name.to_owned(),
        points: quartiles
            .iter()
            .enumerate()
            .map(|(at, arm_quartiles)| (at as f64 + 1.0, of(arm_quartiles)))
            .collect(),
    };
    Graph {
        title: "Final cash of the configurations, highest first".to_owned(),
        summary: "Median and quartiles of final cash by the configuration's rank in the table".to_owned(),
        x_axis: GraphAxis { label: "rank in the table", scale: AxisScale::Whole },
        y_axis: GraphAxis { label: "dollars", scale: AxisScale::Linear },
        series: vec![
            series("upper quartile", |quartiles| quartiles.upper),
            series("lower quartile", |quartiles| quartiles.lower),
            series("median", |quartiles| quartiles.median),
        ],
        form: GraphForm::Lines,
    }
}

fn notes(grid: &PolicyGrid, is_published: bool, ranked: &RankedResults<'_>) -> Vec<String> {
    let mut notes = Vec::new();
    if let Some(best) = ranked.order.first() {
        let has_equal_runs = |arm: &&usize| ranked.runs_of_arm(**arm) == ranked.runs_of_arm(*best);
        let first: Vec<usize> = ranked.order.iter().filter(has_equal_runs).copied().collect();
        let label = describe_ties(grid, &first);
        notes.push(match ranked.results.seeds.len() {
            1 => format!("Best configuration: {label}."),
            _ => format!("Best configuration by median final cash: {label}."),
        });
    }
    if let Some(value) = concordance(&ranked.ranks_by_seed) {
        notes.push(format!(
            "Rank stability: Kendall's W of the rankings by final cash is {value:.2}: 1 if every seed gives the same ranking, about {:.2} if the rankings are unrelated.",
            1.0 / ranked.ranks_by_seed.len() as f64
        ));
    }
    if !grid.description.is_empty() {
        notes.push(grid.description.clone());
    }
    if is_published {
        notes.push(format!(
            "Published for mid / S1 / heavy / $100K at the paper's seed 42: {}. The same seed gives different random draws here ({}).",
            dollars(published_results().rule_based_baseline),
            published_results().paper().source
        ));
    }
    notes
}
