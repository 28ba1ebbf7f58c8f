//! Tables of configurations: the paper's columns for one seed, spread and rank stability for several.

use super::grid::Grid;
use crate::exhibit::{
    AxisScale, Column, Datum, Exhibit, Graph, GraphAxis, GraphForm, Measure, Series, Tabulation, column_name,
};
use crate::experiment::{ExperimentResults, RunResult};
use crate::ranks::{concordance, places};
use novamind_base::notation::dollars;
use novamind_base::statistics::{Interval, Quartiles, mean, median};
use novamind_report::ranking::published;

/// Returns the results of a grid's configurations.
pub fn baseline_exhibit(grid: &Grid, is_published: bool, results: &ExperimentResults) -> Exhibit {
    let board = Board::of(results);
    let count = results.seeds.len();
    let seeds = match (results.seeds.first(), results.seeds.last()) {
        (Some(first), Some(last)) if first != last => format!("seeds {first} to {last}"),
        (Some(first), _) => format!("seed {first}"),
        _ => "no seeds".to_owned(),
    };
    let table = if count > 1 { over_seeds(grid, &board) } else { of_one_seed(grid, &board) };
    let mut exhibit =
        Exhibit::of(format!("{}: {} configurations, {seeds}", grid.name, grid.configurations.len()), table);
    if count > 1 {
        exhibit.tables.push(stability(grid, &board));
        exhibit.tables.push(best_by_seed(grid, &board));
    }
    exhibit.graphs.push(if count > 1 { spread(&board) } else { bars(&board) });
    exhibit.tables.push(every_run(grid, &board));
    exhibit.notes.extend(notes(grid, is_published, &board));
    exhibit
}

/// Results with ranks.
struct Board<'a> {
    results: &'a ExperimentResults,
    /// Configurations by median final cash, highest first.
    order: Vec<usize>,
    /// Ranks by seed and configuration.
    by_seed: Vec<Vec<f64>>,
}

impl<'a> Board<'a> {
    fn of(results: &'a ExperimentResults) -> Board<'a> {
        let middle = |arm: usize| median(&results.of(arm, |run| run.cash)).unwrap_or(f64::NEG_INFINITY);
        let mut order: Vec<usize> = (0..results.by_arm.len()).collect();
        order.sort_by(|one, other| middle(*other).total_cmp(&middle(*one)));
        let of_seed = |at: usize| {
            let cash: Vec<f64> =
                results.by_arm.iter().filter_map(|runs| runs.get(at)).map(|run| run.cash).collect();
            places(&cash)
        };
        Board { results, order, by_seed: (0..results.seeds.len()).map(of_seed).collect() }
    }

    fn runs(&self, arm: usize) -> &[RunResult] {
        self.results.by_arm.get(arm).map_or(&[], Vec::as_slice)
    }

    /// Returns the share of seeds in which a configuration ranks first, including ties.
    fn first(&self, arm: usize) -> f64 {
        let least = |places: &[f64]| places.iter().copied().fold(f64::INFINITY, f64::min);
        let firsts =
            self.by_seed.iter().filter(|places| places.get(arm).is_some_and(|own| *own == least(places)));
        firsts.count() as f64 / self.by_seed.len().max(1) as f64
    }

    fn mean_place(&self, arm: usize) -> f64 {
        mean(&self.by_seed.iter().filter_map(|places| places.get(arm).copied()).collect::<Vec<_>>())
    }
}

fn head(grid: &Grid) -> Vec<Column> {
    grid.axes.iter().map(|axis| Column::words(&column_name(axis), axis)).collect()
}

fn levels(grid: &Grid, arm: usize) -> Vec<Datum> {
    grid.configurations[arm].levels.iter().map(Datum::words).collect()
}

fn of_one_seed(grid: &Grid, board: &Board<'_>) -> Tabulation {
    let mut columns = head(grid);
    columns.extend([
        Column::numbers("cash", "final cash", Measure::Dollars),
        Column::numbers("survival", "survival, days", Measure::Days),
        Column::numbers("peak", "peak subscribers", Measure::Count),
        Column::numbers("peak_day", "on day", Measure::Days),
    ]);
    let mut table = Tabulation::new("configurations", "Highest final cash first", columns);
    for arm in &board.order {
        let Some(run) = board.runs(*arm).first() else { continue };
        let mut row = levels(grid, *arm);
        row.extend([
            Datum::number(run.cash),
            Datum::number(f64::from(run.day)),
            Datum::number(f64::from(run.peak_subscribers)),
            Datum::number(f64::from(run.peak_day)),
        ]);
        table.rows.push(row);
    }
    table
}

fn over_seeds(grid: &Grid, board: &Board<'_>) -> Tabulation {
    let mut columns = head(grid);
    columns.extend([
        Column::numbers("median_cash", "median cash", Measure::Dollars),
        Column::intervals("median_cash_interval", "95 % interval of the median", Measure::Dollars),
        Column::numbers("lower_quartile", "lower quartile", Measure::Dollars),
        Column::numbers("upper_quartile", "upper quartile", Measure::Dollars),
        Column::numbers("bankrupt", "bankrupt", Measure::Share),
    ]);
    let mut table = Tabulation::new("configurations", "Highest median final cash first", columns);
    for arm in &board.order {
        let of = |figure: fn(&RunResult) -> f64| board.results.of(*arm, figure);
        let cash = of(|run| run.cash);
        let quartiles = Quartiles::of(&cash);
        let mut row = levels(grid, *arm);
        row.extend([
            Datum::number(quartiles.map(|own| own.median)),
            Datum::interval(Interval::of_median(&cash)),
            Datum::number(quartiles.map(|own| own.lower)),
            Datum::number(quartiles.map(|own| own.upper)),
            Datum::number(mean(&of(|run| f64::from(u8::from(run.is_bankrupt()))))),
        ]);
        table.rows.push(row);
    }
    table
}

fn stability(grid: &Grid, board: &Board<'_>) -> Tabulation {
    let mut columns = head(grid);
    columns.extend([
        Column::numbers("survival", "mean survival, days", Measure::Number(1)),
        Column::numbers("peak", "median peak subscribers", Measure::Count),
        Column::numbers("first", "best in", Measure::Share),
        Column::numbers("place", "mean rank", Measure::Number(1)),
    ]);
    let mut table = Tabulation::new("stability", "Survival, size, and rank by final cash", columns);
    for arm in &board.order {
        let of = |figure: fn(&RunResult) -> f64| board.results.of(*arm, figure);
        let mut row = levels(grid, *arm);
        row.extend([
            Datum::number(mean(&of(|run| f64::from(run.day)))),
            Datum::number(median(&of(|run| f64::from(run.peak_subscribers)))),
            Datum::number(board.first(*arm)),
            Datum::number(board.mean_place(*arm)),
        ]);
        table.rows.push(row);
    }
    table
}

fn best_by_seed(grid: &Grid, board: &Board<'_>) -> Tabulation {
    let mut columns = vec![Column::words("seed", "seed")];
    columns.extend(head(grid));
    columns.extend([
        Column::numbers("equal", "ties", Measure::Count),
        Column::numbers("cash", "its cash", Measure::Dollars),
        Column::numbers("bankrupt", "bankrupt", Measure::Count),
    ]);
    let mut table = Tabulation::new("seeds", "Best configuration of each seed", columns);
    for (at, seed) in board.results.seeds.iter().enumerate() {
        let run = |arm: usize| board.runs(arm).get(at);
        let cash = |arm: &usize| run(*arm).map_or(f64::NEG_INFINITY, |own| own.cash);
        let best = board.order.iter().map(cash).fold(f64::NEG_INFINITY, f64::max);
        let first: Vec<usize> = board.order.iter().copied().filter(|arm| cash(arm) == best).collect();
        let bankrupt =
            board.order.iter().filter(|arm| run(**arm).is_some_and(RunResult::is_bankrupt)).count();
        let Some((one, equal)) = first.split_first() else { continue };
        let mut row = vec![Datum::words(seed.to_string())];
        row.extend(levels(grid, *one));
        row.extend([equal.len() as f64, best, bankrupt as f64].map(Datum::number));
        table.rows.push(row);
    }
    table
}

/// Describes the configurations that share first place: one of them by name, and the number of others.
fn labels(grid: &Grid, first: &[usize]) -> String {
    match first {
        [] => String::new(),
        [one] => grid.configurations[*one].label(),
        [one, rest @ ..] => {
            format!("{} and {} ties", grid.configurations[*one].label(), rest.len())
        }
    }
}

fn every_run(grid: &Grid, board: &Board<'_>) -> Tabulation {
    let mut columns = head(grid);
    columns.extend([
        Column::words("seed", "seed"),
        Column::numbers("cash", "final cash", Measure::Dollars),
        Column::numbers("survival", "survival, days", Measure::Days),
        Column::words("bankrupt", "bankrupt"),
        Column::numbers("peak", "peak subscribers", Measure::Count),
        Column::numbers("peak_day", "on day", Measure::Days),
    ]);
    let mut table = Tabulation { is_for_programs: true, ..Tabulation::new("runs", "Every run", columns) };
    for arm in 0..grid.configurations.len() {
        for run in board.runs(arm) {
            let mut row = levels(grid, arm);
            row.extend([
                Datum::words(run.seed.to_string()),
                Datum::number(run.cash),
                Datum::number(f64::from(run.day)),
                Datum::words(if run.is_bankrupt() { "yes" } else { "no" }),
                Datum::number(f64::from(run.peak_subscribers)),
                Datum::number(f64::from(run.peak_day)),
            ]);
            table.rows.push(row);
        }
    }
    table
}

fn bars(board: &Board<'_>) -> Graph {
    let cash =
        |(at, arm): (usize, &usize)| board.runs(*arm).first().map(|run| ((at + 1) as f64, run.cash.max(0.0)));
    Graph {
        title: "Final cash of the configurations, highest first".to_owned(),
        summary: "Final cash by the configuration's rank in the table".to_owned(),
        across: GraphAxis { label: "rank in the table", scale: AxisScale::Whole },
        up: GraphAxis { label: "dollars", scale: AxisScale::Linear },
        series: vec![Series {
            name: "final cash".to_owned(),
            points: board.order.iter().enumerate().filter_map(cash).collect(),
        }],
        form: GraphForm::Bars,
    }
}

fn spread(board: &Board<'_>) -> Graph {
    let quartiles: Vec<Quartiles> = (board.order.iter())
        .filter_map(|arm| Quartiles::of(&board.results.of(*arm, |run| run.cash)))
        .collect();
    let series = |name: &str, of: fn(&Quartiles) -> f64| Series {
        name: name.to_owned(),
        points: quartiles.iter().enumerate().map(|(at, own)| (at as f64 + 1.0, of(own))).collect(),
    };
    Graph {
        title: "Final cash of the configurations, highest first".to_owned(),
        summary: "Median and quartiles of final cash by the configuration's rank in the table".to_owned(),
        across: GraphAxis { label: "rank in the table", scale: AxisScale::Whole },
        up: GraphAxis { label: "dollars", scale: AxisScale::Linear },
        series: vec![
            series("upper quartile", |own| own.upper),
            series("lower quartile", |own| own.lower),
            series("median", |own| own.median),
        ],
        form: GraphForm::Lines,
    }
}

fn notes(grid: &Grid, is_published: bool, board: &Board<'_>) -> Vec<String> {
    let mut notes = Vec::new();
    if let Some(best) = board.order.first() {
        let alike = |arm: &&usize| board.runs(**arm) == board.runs(*best);
        let first: Vec<usize> = board.order.iter().filter(alike).copied().collect();
        let label = labels(grid, &first);
        notes.push(match board.results.seeds.len() {
            1 => format!("Best configuration: {label}."),
            _ => format!("Best configuration by median final cash: {label}."),
        });
    }
    if let Some(own) = concordance(&board.by_seed) {
        notes.push(format!(
            "Rank stability: Kendall's W of the rankings by final cash is {own:.2}: 1 if every seed gives the same ranking, about {:.2} if the rankings are unrelated.",
            1.0 / board.by_seed.len() as f64
        ));
    }
    if !grid.description.is_empty() {
        notes.push(grid.description.clone());
    }
    if is_published {
        notes.push(format!(
            "Published for mid / S1 / heavy / $100K at the paper's seed 42: {}. The same seed gives different random draws here ({}).",
            dollars(published().rule_based_baseline),
            published().source
        ));
    }
    notes
}
