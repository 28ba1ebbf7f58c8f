//! What a study found, arm by arm: what a paper would print of it. The rows hold the rest.

use super::StudyPlan;
use crate::lab::exhibit::{
    AxisScale, Column, Datum, Exhibit, Graph, GraphAxis, GraphForm, Measure, Series, Tabulation,
};
use crate::lab::experiment::{Experiment, RunResult};
use crate::report::count;
use crate::statistics::{Interval, LEVEL, Quartiles, RESAMPLES, median};

/// Most arms whose curves can be told apart.
const MOST_CURVES: usize = 8;

/// Ends of the runs of each arm; the results are those of all runs, in their order.
pub fn summary(plan: &StudyPlan, results: &[RunResult]) -> Exhibit {
    let seeds = plan.experiment.seeds.len();
    let by_arm: Vec<&[RunResult]> = results.chunks(seeds).collect();
    let mut columns: Vec<Column> = plan.factors.iter().map(|name| Column::words(name, name)).collect();
    columns.extend([
        Column::numbers("alive", "not bankrupt", Measure::Share),
        Column::numbers("cash_lower_quartile", "lower quartile", Measure::Dollars),
        Column::numbers("cash_median", "median final cash", Measure::Dollars),
        Column::numbers("cash_upper_quartile", "upper quartile", Measure::Dollars),
        Column::intervals("cash_median_interval", "median, 95 % interval", Measure::Dollars),
        Column::numbers("peak_subscribers_median", "median peak subscribers", Measure::Count),
    ]);
    let mut table = Tabulation::new("arms", "", columns);
    for (levels, runs) in plan.levels.iter().zip(&by_arm) {
        let cash: Vec<f64> = runs.iter().map(|run| run.cash).collect();
        let peaks: Vec<f64> = runs.iter().map(|run| f64::from(run.peak_subscribers)).collect();
        let alive = runs.iter().filter(|run| !run.is_bankrupt()).count() as f64;
        let middle = Quartiles::of(&cash);
        let mut row: Vec<Datum> = levels.iter().map(Datum::words).collect();
        row.extend([
            Datum::number(alive / runs.len().max(1) as f64),
            Datum::number(middle.map(|own| own.lower)),
            Datum::number(middle.map(|own| own.median)),
            Datum::number(middle.map(|own| own.upper)),
            Datum::interval(Interval::of_median(&cash)),
            Datum::number(median(&peaks)),
        ]);
        table.rows.push(row);
    }
    let mut exhibit = Exhibit::of(format!("{}: {}", plan.name, size(plan)), table);
    if (1..=MOST_CURVES).contains(&by_arm.len()) {
        exhibit.graphs.push(curves(plan, &by_arm));
    }
    let luck = "Seeds are in common: the runs of one seed have the same luck in every arm.";
    let interval = format!(
        "Intervals: percentile bootstrap over seeds, {RESAMPLES} resamples, {:.0} %. Final cash is what a run ends with, on its \
         last day or in bankruptcy.",
        LEVEL * 100.0
    );
    exhibit.with_note(luck).with_note(interval)
}

/// How large a study is: `2 arms by 24 seeds`.
pub fn size(plan: &StudyPlan) -> String {
    let Experiment { arms, seeds, .. } = &plan.experiment;
    format!("{} by {}", count(arms.len() as u32, "arm"), count(seeds.len() as u32, "seed"))
}

fn curves(plan: &StudyPlan, by_arm: &[&[RunResult]]) -> Graph {
    let series = by_arm.iter().zip(&plan.experiment.arms).map(|(runs, arm)| {
        let mut days: Vec<u32> = runs.iter().flat_map(|run| run.weeks.iter().map(|week| week.day)).collect();
        days.sort_unstable();
        days.dedup();
        let cash = |day: u32| -> Vec<f64> {
            // A run that has ended keeps what it ended with.
            let at = |run: &RunResult| run.weeks.iter().rfind(|week| week.day <= day).map(|week| week.cash);
            runs.iter().filter_map(at).collect()
        };
        let points = days.into_iter().filter_map(|day| Some((f64::from(day), median(&cash(day))?)));
        Series { name: arm.name.clone(), points: points.collect() }
    });
    Graph {
        title: "Median cash by week".to_owned(),
        summary: "The median over seeds of the cash at the end of each week, for every arm.".to_owned(),
        across: GraphAxis { label: "day", scale: AxisScale::Whole },
        up: GraphAxis { label: "dollars", scale: AxisScale::Linear },
        series: series.collect(),
        form: GraphForm::Lines,
    }
}
