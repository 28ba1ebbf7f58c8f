//! Tables and graphs of the ablation: figures by arm, paired differences between adjacent arms, and curves.

use super::competitors::{CompetitorSetting, reference_arm};
use crate::experiment::{ExperimentResults, RunResult};
use crate::lab_report::{
    AxisScale, CellValue, Column, Graph, GraphAxis, GraphForm, LabReport, LabTable, Measure, Series,
};
use novamind_base::statistics::{Interval, MIN_SAMPLE_SIZE, PairedDifference, mean, median};
use novamind_report::pluralize;

/// The results of one axis of the ablation.
pub struct AblationAxis<'a> {
    /// Identifier of the axis in data formats.
    pub name: &'static str,
    /// Caption that names the varied setting and the policy.
    pub caption: String,
    /// Name of the policy that plays.
    pub policy: &'a str,
    /// Competitor settings, one per arm.
    pub settings: &'a [CompetitorSetting],
    /// Results of the experiment, one arm per setting.
    pub results: &'a ExperimentResults,
}

/// The results of a policy in short runs, with and without competitors.
pub struct ShortRun<'a> {
    /// Name of the policy that plays.
    pub name: &'a str,
    /// Competitor settings: off, default, hard.
    pub settings: &'a [CompetitorSetting],
    /// Results of the experiment, one arm per setting.
    pub results: &'a ExperimentResults,
}

/// Length of a short run in days. Competitors and drift start later.
pub const SHORT_DAYS: u32 = 50;

/// Starting cash of a short run, dollars. Final cash is compared with this amount.
const SHORT_RUN_START_CASH: f64 = 1e6;

/// Returns the tables and graphs of the ablation: subscribers on `day`, final figures, differences between adjacent
/// arms, and short runs.
pub fn ablation_report(axes: &[AblationAxis<'_>], short: &[ShortRun<'_>], day: u32) -> LabReport {
    let seeds = axes.first().map_or(0, |axis| axis.results.seeds.len());
    let mut exhibit = LabReport {
        title: format!(
            "Competitors that copy and drain, {}, same random draws in every arm",
            pluralize(seeds as u32, "seed")
        ),
        tables: Vec::new(),
        graphs: Vec::new(),
        notes: Vec::new(),
    };
    for axis in axes {
        exhibit.tables.push(arm_table(axis, day));
        exhibit.tables.push(adjacent_difference_table(axis, day));
        exhibit.graphs.push(subscriber_graph(axis));
        exhibit.notes.push(describe_equal_runs(axis));
    }
    exhibit.tables.push(short_run_table(short));
    exhibit.tables.push(run_table(axes, short, day));
    exhibit.notes.push(format!(
        "Within {SHORT_DAYS} days neither competitors nor drift are active, so the short runs do not measure them."
    ));
    exhibit.notes.push(
        "u: share of shared improvements that a competitor event can copy; targeted development is not affected. Drain: share of a group's targeted improvements that an event copies."
            .to_owned(),
    );
    exhibit.notes.push(format!(
        "An event uses the copied improvement only if the improvement is larger than the size of the event. Subscribers are those at the end of day {day}; a run that went bankrupt earlier counts as 0. Intervals and verdicts need at least {MIN_SAMPLE_SIZE} seeds."
    ));
    exhibit
}

/// Returns the number of subscribers at the end of a day, or 0 after a bankruptcy.
fn subscribers_on(run: &RunResult, day: u32) -> f64 {
    run.weeks.iter().find(|week| week.day == day).map_or(0.0, |week| f64::from(week.subscribers))
}

fn arm_table(axis: &AblationAxis<'_>, day: u32) -> LabTable {
    let columns = vec![
        Column::text("rivals", "competitors"),
        Column::number("subscribers", &format!("mean subscribers, day {day}"), Measure::Count),
        Column::interval("subscribers_interval", "95 % interval", Measure::Count),
        Column::number("difference", "difference from default", Measure::Count),
        Column::interval("difference_interval", "95 % interval of the difference", Measure::Count),
        Column::number("cash", "median final cash", Measure::Dollars),
        Column::number("bankrupt", "bankrupt", Measure::Share),
    ];
    let mut table = LabTable::new(axis.name, axis.caption.clone(), columns);
    let default = reference_arm(axis.settings);
    for (arm, setting) in axis.settings.iter().enumerate() {
        let values = axis.results.figures_of_arm(arm, |run| subscribers_on(run, day));
        let pairs = axis.results.paired_figures(arm, default, |run| subscribers_on(run, day));
        let difference = PairedDifference::from_pairs(pairs).filter(|_| arm != default);
        table.rows.push(vec![
            CellValue::text(setting.name),
            CellValue::number(mean(&values)),
            CellValue::interval(Interval::for_mean(&values)),
            CellValue::number(difference.map(|paired_difference| paired_difference.mean)),
            CellValue::interval(difference.and_then(|paired_difference| paired_difference.interval)),
            CellValue::number(median(&axis.results.figures_of_arm(arm, |run| run.cash))),
            CellValue::number(mean(
                &axis.results.figures_of_arm(arm, |run| f64::from(u8::from(run.is_bankrupt()))),
            )),
        ]);
    }
    table
}

fn adjacent_difference_table(axis: &AblationAxis<'_>, day: u32) -> LabTable {
    let columns = vec![
        Column::text("step", "step"),
        Column::number("lost", &format!("subscribers lost, day {day}"), Measure::Count),
        Column::interval("lost_interval", "95 % interval", Measure::Count),
        Column::number("seeds", "seeds with a loss", Measure::Count),
        Column::text("verdict", "order"),
    ];
    let mut table = LabTable::new(
        &format!("{}_steps", axis.name),
        "Steps between adjacent settings, paired differences",
        columns,
    );
    for (at, pair) in axis.settings.windows(2).enumerate() {
        let pairs = axis.results.paired_figures(at, at + 1, |run| subscribers_on(run, day));
        let Some(paired_difference) = PairedDifference::from_pairs(pairs) else { continue };
        table.rows.push(vec![
            CellValue::text(format!("{} to {}", pair[0].name, pair[1].name)),
            CellValue::number(paired_difference.mean),
            CellValue::interval(paired_difference.interval),
            CellValue::number(f64::from(paired_difference.first_greater)),
            CellValue::text(describe_difference(&paired_difference)),
        ]);
    }
    table
}

fn describe_difference(paired_difference: &PairedDifference) -> &'static str {
    match paired_difference.interval {
        None => "too few seeds",
        Some(Interval { low, .. }) if low > 0.0 => "loses",
        Some(Interval { high, .. }) if high < 0.0 => "gains",
        Some(Interval { low, high }) if low == 0.0 && high == 0.0 => "identical",
        Some(_) => "inconclusive",
    }
}

/// Returns a note with the number of seeds for which the runs with default and hard competitors are
/// identical.
fn describe_equal_runs(axis: &AblationAxis<'_>) -> String {
    let place =
        |name: &str| axis.settings.iter().position(|competitor_setting| competitor_setting.name == name);
    let (Some(default), Some(hard)) = (place("default"), place("hard")) else { return String::new() };
    let ends = |run: &RunResult| (run.day, run.cash.to_bits(), run.subscribers, run.peak_subscribers);
    let runs = |arm: usize| axis.results.by_arm.get(arm).map_or(&[][..], Vec::as_slice);
    let same = runs(default)
        .iter()
        .zip(runs(hard))
        .filter(|(run_result, other)| ends(run_result) == ends(other))
        .count();
    format!(
        "{}: runs with default and hard competitors are identical for {same} of {}.",
        axis.caption,
        pluralize(runs(default).len() as u32, "seed")
    )
}

fn subscriber_graph(axis: &AblationAxis<'_>) -> Graph {
    let series = axis.settings.iter().enumerate().map(|(arm, setting)| {
        let runs = axis.results.by_arm.get(arm).map_or(&[][..], Vec::as_slice);
        let mut days: Vec<u32> = runs.iter().flat_map(|run| run.weeks.iter().map(|week| week.day)).collect();
        days.sort_unstable();
        days.dedup();
        let at = |day: u32| mean(&runs.iter().map(|run| subscribers_on(run, day)).collect::<Vec<_>>());
        let whole_weeks = days.into_iter().filter(|day| day.is_multiple_of(7));
        Series {
            name: setting.name.to_owned(),
            points: whole_weeks.map(|day| (f64::from(day), at(day))).collect(),
        }
    });
    Graph {
        title: axis.caption.clone(),
        summary: "Mean subscribers by day on a logarithmic axis, one line per competitor setting".to_owned(),
        x_axis: GraphAxis { label: "day", scale: AxisScale::Whole },
        y_axis: GraphAxis { label: "subscribers", scale: AxisScale::Logarithmic },
        series: series.collect(),
        form: GraphForm::Lines,
    }
}

fn short_run_table(short: &[ShortRun<'_>]) -> LabTable {
    let columns = vec![
        Column::text("policy", "policy"),
        Column::number("cash", "mean cash", Measure::Dollars),
        Column::interval("cash_interval", "95 % interval", Measure::Dollars),
        Column::number("gained", "seeds above $1,000,000", Measure::Count),
        Column::number("alike", "seeds with equal runs: competitors off, default, hard", Measure::Count),
        Column::number("seeds", "seeds", Measure::Count),
    ];
    let caption = format!("{SHORT_DAYS} days: neither competitors nor drift");
    let mut table = LabTable::new("short", caption, columns);
    for short_run in short {
        let cash = short_run.results.figures_of_arm(0, |run| run.cash);
        let by_seed = |at: usize| short_run.results.by_arm.iter().filter_map(move |runs| runs.get(at));
        let is_alike = |at: &usize| {
            let mut all = by_seed(*at).map(|run| run.cash.to_bits());
            let first = all.next();
            all.all(|other| Some(other) == first)
        };
        table.rows.push(vec![
            CellValue::text(short_run.name),
            CellValue::number(mean(&cash)),
            CellValue::interval(Interval::for_mean(&cash)),
            CellValue::number(cash.iter().filter(|cash| **cash > SHORT_RUN_START_CASH).count() as f64),
            CellValue::number((0..short_run.results.seeds.len()).filter(is_alike).count() as f64),
            CellValue::number(short_run.results.seeds.len() as f64),
        ]);
    }
    table
}

fn run_table(axes: &[AblationAxis<'_>], short: &[ShortRun<'_>], day: u32) -> LabTable {
    let columns = vec![
        Column::text("axis", "axis"),
        Column::text("policy", "policy"),
        Column::text("rivals", "competitors"),
        Column::text("seed", "seed"),
        Column::number("days", "days of the run", Measure::Days),
        Column::number("last_day", "last day", Measure::Days),
        Column::text("bankrupt", "bankrupt"),
        Column::number("cash", "final cash", Measure::Dollars),
        Column::number("subscribers_on_day", &format!("subscribers, day {day}"), Measure::Count),
        Column::number("subscribers", "subscribers at the end", Measure::Count),
        Column::number("peak", "peak subscribers", Measure::Count),
        Column::number("peak_day", "peak day", Measure::Days),
        Column::text("state_hash", "state hash"),
    ];
    let axis_experiments = axes.iter().map(|ablation_axis| {
        (ablation_axis.name, ablation_axis.policy, ablation_axis.settings, ablation_axis.results)
    });
    let short_experiments =
        short.iter().map(|short_run| ("short", short_run.name, short_run.settings, short_run.results));
    let mut table =
        LabTable { is_machine_readable_only: true, ..LabTable::new("runs", "Every run", columns) };
    for (axis, policy, settings, results) in axis_experiments.chain(short_experiments) {
        for (setting, runs) in settings.iter().zip(&results.by_arm) {
            let row = |run: &RunResult| {
                let then = (day <= run.days).then(|| subscribers_on(run, day));
                vec![
                    CellValue::text(axis),
                    CellValue::text(policy),
                    CellValue::text(setting.name),
                    CellValue::text(run.seed.to_string()),
                    CellValue::number(f64::from(run.days)),
                    CellValue::number(f64::from(run.day)),
                    CellValue::text(if run.is_bankrupt() { "yes" } else { "no" }),
                    CellValue::number(run.cash),
                    CellValue::number(then),
                    CellValue::number(f64::from(run.subscribers)),
                    CellValue::number(f64::from(run.peak_subscribers)),
                    CellValue::number(f64::from(run.peak_day)),
                    CellValue::text(&*run.state_hash),
                ]
            };
            table.rows.extend(runs.iter().map(row));
        }
    }
    table
}
