//! What each step of the rivals costs: figures of the arms, differences seed by seed, curves.

use super::rivals::{RivalSetting, reference};
use crate::exhibit::{
    AxisScale, Column, Datum, Exhibit, Graph, GraphAxis, GraphForm, Measure, Series, Tabulation,
};
use crate::experiment::{ExperimentResults, RunResult};
use novamind_base::statistics::{Interval, LEAST, PairedDifference, mean, median};
use novamind_report::count;

/// One axis of the ablation, played.
pub struct Axis<'a> {
    /// Name for programs.
    pub name: &'static str,
    /// What varies, and with which policy.
    pub caption: String,
    /// Name of the policy.
    pub policy: &'a str,
    /// Arms.
    pub settings: &'a [RivalSetting],
    /// Results, one arm for each setting.
    pub results: &'a ExperimentResults,
}

/// A policy over the short horizon, played without rivals and with.
pub struct ShortRun<'a> {
    /// Policy.
    pub name: &'a str,
    /// Settings of the rivals: off, default, hard.
    pub settings: &'a [RivalSetting],
    /// Results, one arm for each setting.
    pub results: &'a ExperimentResults,
}

/// Days of the short horizon: rivals and taste wait longer.
pub const SHORT_DAYS: u32 = 50;

/// Cash that a run of the short horizon begins with, dollars: what it is compared with.
const START: f64 = 1e6;

/// The ablation: subscribers on a day, the end of the runs, steps, the short horizon.
pub fn ablation_exhibit(axes: &[Axis<'_>], short: &[ShortRun<'_>], day: u32) -> Exhibit {
    let seeds = axes.first().map_or(0, |axis| axis.results.seeds.len());
    let mut exhibit = Exhibit {
        title: format!(
            "Rivals that copy and drain, {}, the same luck in every arm",
            count(seeds as u32, "seed")
        ),
        tables: Vec::new(),
        graphs: Vec::new(),
        notes: Vec::new(),
    };
    for axis in axes {
        exhibit.tables.push(arms(axis, day));
        exhibit.tables.push(steps(axis, day));
        exhibit.graphs.push(curves(axis));
        exhibit.notes.push(alike(axis));
    }
    exhibit.tables.push(short_runs(short));
    exhibit.tables.push(every_run(axes, short, day));
    exhibit.notes.push(format!(
        "Over {SHORT_DAYS} days there are neither rivals nor drift, for both wait longer: what is measured there says nothing about them."
    ));
    exhibit.notes.push(
        "u: the share of the shared bank that an event can copy; it touches nothing that was developed for one group. Drain: the share of a group's targeted bank that an event copies."
            .to_owned(),
    );
    exhibit.notes.push(format!(
        "An event applies what it copies only if that is more than its own size. Subscribers are those at the end of day {day}; a run that went bankrupt before counts with 0. Intervals and verdicts need {LEAST} seeds or more."
    ));
    exhibit
}

/// Subscribers at the end of a day; none after a bankruptcy.
fn subscribers_on(run: &RunResult, day: u32) -> f64 {
    run.weeks.iter().find(|week| week.day == day).map_or(0.0, |week| f64::from(week.subscribers))
}

fn arms(axis: &Axis<'_>, day: u32) -> Tabulation {
    let columns = vec![
        Column::words("rivals", "rivals"),
        Column::numbers("subscribers", &format!("mean subscribers, day {day}"), Measure::Count),
        Column::intervals("subscribers_interval", "95 % interval", Measure::Count),
        Column::numbers("difference", "minus default", Measure::Count),
        Column::intervals("difference_interval", "95 % interval of the difference", Measure::Count),
        Column::numbers("cash", "median final cash", Measure::Dollars),
        Column::numbers("bankrupt", "bankrupt", Measure::Share),
    ];
    let mut table = Tabulation::new(axis.name, axis.caption.clone(), columns);
    let default = reference(axis.settings);
    for (arm, setting) in axis.settings.iter().enumerate() {
        let own = axis.results.of(arm, |run| subscribers_on(run, day));
        let pairs = axis.results.pairs(arm, default, |run| subscribers_on(run, day));
        let difference = PairedDifference::of(pairs).filter(|_| arm != default);
        table.rows.push(vec![
            Datum::words(setting.name),
            Datum::number(mean(&own)),
            Datum::interval(Interval::of_mean(&own)),
            Datum::number(difference.map(|own| own.mean)),
            Datum::interval(difference.and_then(|own| own.interval)),
            Datum::number(median(&axis.results.of(arm, |run| run.cash))),
            Datum::number(mean(&axis.results.of(arm, |run| f64::from(u8::from(run.is_bankrupt()))))),
        ]);
    }
    table
}

/// What each step from one setting to the next costs, seed by seed.
fn steps(axis: &Axis<'_>, day: u32) -> Tabulation {
    let columns = vec![
        Column::words("step", "from, to"),
        Column::numbers("lost", &format!("subscribers lost, day {day}"), Measure::Count),
        Column::intervals("lost_interval", "95 % interval", Measure::Count),
        Column::numbers("seeds", "seeds that lose", Measure::Count),
        Column::words("verdict", "order"),
    ];
    let mut table = Tabulation::new(&format!("{}_steps", axis.name), "Steps, by paired differences", columns);
    for (at, pair) in axis.settings.windows(2).enumerate() {
        let pairs = axis.results.pairs(at, at + 1, |run| subscribers_on(run, day));
        let Some(own) = PairedDifference::of(pairs) else { continue };
        table.rows.push(vec![
            Datum::words(format!("{} to {}", pair[0].name, pair[1].name)),
            Datum::number(own.mean),
            Datum::interval(own.interval),
            Datum::number(f64::from(own.more)),
            Datum::words(verdict(&own)),
        ]);
    }
    table
}

fn verdict(own: &PairedDifference) -> &'static str {
    match own.interval {
        None => "too few seeds",
        Some(Interval { low, .. }) if low > 0.0 => "loses",
        Some(Interval { high, .. }) if high < 0.0 => "gains",
        Some(Interval { low, high }) if low == 0.0 && high == 0.0 => "identical",
        Some(_) => "not told apart",
    }
}

/// Whether default and hard rivals come to the same, run by run.
fn alike(axis: &Axis<'_>) -> String {
    let place = |name: &str| axis.settings.iter().position(|own| own.name == name);
    let (Some(default), Some(hard)) = (place("default"), place("hard")) else { return String::new() };
    let ends = |run: &RunResult| (run.day, run.cash.to_bits(), run.subscribers, run.peak_subscribers);
    let runs = |arm: usize| axis.results.by_arm.get(arm).map_or(&[][..], Vec::as_slice);
    let same = runs(default).iter().zip(runs(hard)).filter(|(own, other)| ends(own) == ends(other)).count();
    format!(
        "{}: default and hard rivals are identical in {same} of {}.",
        axis.caption,
        count(runs(default).len() as u32, "seed")
    )
}

fn curves(axis: &Axis<'_>) -> Graph {
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
        summary: "Mean subscribers by day on a logarithmic axis, one line for each setting of the rivals"
            .to_owned(),
        across: GraphAxis { label: "day", scale: AxisScale::Whole },
        up: GraphAxis { label: "subscribers", scale: AxisScale::Logarithmic },
        series: series.collect(),
        form: GraphForm::Lines,
    }
}

fn short_runs(short: &[ShortRun<'_>]) -> Tabulation {
    let columns = vec![
        Column::words("policy", "policy"),
        Column::numbers("cash", "mean cash", Measure::Dollars),
        Column::intervals("cash_interval", "95 % interval", Measure::Dollars),
        Column::numbers("gained", "seeds above $1,000,000", Measure::Count),
        Column::numbers("alike", "seeds alike with rivals off, default, hard", Measure::Count),
        Column::numbers("seeds", "seeds", Measure::Count),
    ];
    let caption = format!("{SHORT_DAYS} days: neither rivals nor drift");
    let mut table = Tabulation::new("short", caption, columns);
    for own in short {
        let cash = own.results.of(0, |run| run.cash);
        let by_seed = |at: usize| own.results.by_arm.iter().filter_map(move |runs| runs.get(at));
        let is_alike = |at: &usize| {
            let mut all = by_seed(*at).map(|run| run.cash.to_bits());
            let first = all.next();
            all.all(|other| Some(other) == first)
        };
        table.rows.push(vec![
            Datum::words(own.name),
            Datum::number(mean(&cash)),
            Datum::interval(Interval::of_mean(&cash)),
            Datum::number(cash.iter().filter(|cash| **cash > START).count() as f64),
            Datum::number((0..own.results.seeds.len()).filter(is_alike).count() as f64),
            Datum::number(own.results.seeds.len() as f64),
        ]);
    }
    table
}

/// Every run, for programs.
fn every_run(axes: &[Axis<'_>], short: &[ShortRun<'_>], day: u32) -> Tabulation {
    let columns = vec![
        Column::words("axis", "axis"),
        Column::words("policy", "policy"),
        Column::words("rivals", "rivals"),
        Column::words("seed", "seed"),
        Column::numbers("days", "days of the run", Measure::Days),
        Column::numbers("last_day", "last day", Measure::Days),
        Column::words("bankrupt", "bankrupt"),
        Column::numbers("cash", "final cash", Measure::Dollars),
        Column::numbers("subscribers_on_day", &format!("subscribers, day {day}"), Measure::Count),
        Column::numbers("subscribers", "subscribers at the end", Measure::Count),
        Column::numbers("peak", "peak subscribers", Measure::Count),
        Column::numbers("peak_day", "on day", Measure::Days),
        Column::words("state_hash", "state hash"),
    ];
    let of_axes = axes.iter().map(|own| (own.name, own.policy, own.settings, own.results));
    let of_short = short.iter().map(|own| ("short", own.name, own.settings, own.results));
    let mut table = Tabulation { is_for_programs: true, ..Tabulation::new("runs", "Every run", columns) };
    for (axis, policy, settings, results) in of_axes.chain(of_short) {
        for (setting, runs) in settings.iter().zip(&results.by_arm) {
            let row = |run: &RunResult| {
                let then = (day <= run.days).then(|| subscribers_on(run, day));
                vec![
                    Datum::words(axis),
                    Datum::words(policy),
                    Datum::words(setting.name),
                    Datum::words(run.seed.to_string()),
                    Datum::number(f64::from(run.days)),
                    Datum::number(f64::from(run.day)),
                    Datum::words(if run.is_bankrupt() { "yes" } else { "no" }),
                    Datum::number(run.cash),
                    Datum::number(then),
                    Datum::number(f64::from(run.subscribers)),
                    Datum::number(f64::from(run.peak_subscribers)),
                    Datum::number(f64::from(run.peak_day)),
                    Datum::words(&*run.state_hash),
                ]
            };
            table.rows.extend(runs.iter().map(row));
        }
    }
    table
}
