//! Tables and graphs of the ablation: figures by arm, paired differences between neighboring arms, curves.

use super::rivals::{RivalSetting, reference};
use crate::exhibit::{
    AxisScale, Column, Datum, Exhibit, Graph, GraphAxis, GraphForm, Measure, Series, Tabulation,
};
use crate::experiment::{ExperimentResults, RunResult};
use novamind_base::statistics::{Interval, LEAST, PairedDifference, mean, median};
use novamind_report::count;

/// The results of one axis of the ablation.
pub struct Axis<'a> {
    /// Name for programs.
    pub name: &'static str,
    /// Caption: what varies and which policy plays.
    pub caption: String,
    /// Name of the policy.
    pub policy: &'a str,
    /// Arms.
    pub settings: &'a [RivalSetting],
    /// Results, one arm per setting.
    pub results: &'a ExperimentResults,
}

/// The results of a policy over the short horizon, with and without competitors.
pub struct ShortRun<'a> {
    /// Policy.
    pub name: &'a str,
    /// Competitor settings: off, default, hard.
    pub settings: &'a [RivalSetting],
    /// Results, one arm per setting.
    pub results: &'a ExperimentResults,
}

/// Days of the short horizon. Competitors and drift start later.
pub const SHORT_DAYS: u32 = 50;

/// Starting cash of a short run in dollars; final cash is compared with it.
const START: f64 = 1e6;

/// Returns the tables and graphs of the ablation: subscribers on `day`, final figures, steps, and short runs.
pub fn ablation_exhibit(axes: &[Axis<'_>], short: &[ShortRun<'_>], day: u32) -> Exhibit {
    let seeds = axes.first().map_or(0, |axis| axis.results.seeds.len());
    let mut exhibit = Exhibit {
        title: format!(
            "Competitors that copy and drain, {}, same random draws in every arm",
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
        "Within {SHORT_DAYS} days neither competitors nor drift are active, so the short runs do not measure them."
    ));
    exhibit.notes.push(
        "u: share of shared improvements that a competitor event can copy; targeted development is not affected. Drain: share of a group's targeted improvements that an event copies."
            .to_owned(),
    );
    exhibit.notes.push(format!(
        "An event uses the copied improvement only if it is larger than the event's own size. Subscribers are those at the end of day {day}; a run that went bankrupt earlier counts as 0. Intervals and verdicts need at least {LEAST} seeds."
    ));
    exhibit
}

/// Returns the subscribers at the end of a day; 0 after a bankruptcy.
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

fn steps(axis: &Axis<'_>, day: u32) -> Tabulation {
    let columns = vec![
        Column::words("step", "from, to"),
        Column::numbers("lost", &format!("subscribers lost, day {day}"), Measure::Count),
        Column::intervals("lost_interval", "95 % interval", Measure::Count),
        Column::numbers("seeds", "seeds that lose", Measure::Count),
        Column::words("verdict", "order"),
    ];
    let mut table = Tabulation::new(&format!("{}_steps", axis.name), "Steps, paired differences", columns);
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
        Some(_) => "inconclusive",
    }
}

/// Returns a note on how many runs are identical under default and hard competitors.
fn alike(axis: &Axis<'_>) -> String {
    let place = |name: &str| axis.settings.iter().position(|own| own.name == name);
    let (Some(default), Some(hard)) = (place("default"), place("hard")) else { return String::new() };
    let ends = |run: &RunResult| (run.day, run.cash.to_bits(), run.subscribers, run.peak_subscribers);
    let runs = |arm: usize| axis.results.by_arm.get(arm).map_or(&[][..], Vec::as_slice);
    let same = runs(default).iter().zip(runs(hard)).filter(|(own, other)| ends(own) == ends(other)).count();
    format!(
        "{}: default and hard competitors are identical in {same} of {}.",
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
        summary: "Mean subscribers by day on a logarithmic axis, one line per competitor setting".to_owned(),
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
        Column::numbers("alike", "seeds equal with rivals off, default, hard", Measure::Count),
        Column::numbers("seeds", "seeds", Measure::Count),
    ];
    let caption = format!("{SHORT_DAYS} days: neither competitors nor drift");
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
