//! Figures by which runs are compared.

use std::collections::BTreeSet;

use super::compared_runs::{ComparisonRow, PublishedRange, published_range};
use novamind_report::Logbook;
use novamind_report::ranking::published_results;
use novamind_session::ForecastScore;

/// A figure and the function that computes it for a run.
pub struct ComparedFigure {
    name: &'static str,
    qualifier: &'static str,
    unit: &'static str,
    value: fn(&Logbook) -> Option<f64>,
    published: fn() -> Option<PublishedRange>,
}

/// Returns a figure of the whole run by its name and its horizon. A test checks that all names used in the
/// code exist.
pub fn find_figure(name: &str, of: &str) -> Option<&'static ComparedFigure> {
    FIGURES.iter().find(|figure| figure.name == name && figure.qualifier == of)
}

impl ComparedFigure {
    /// Returns the name of the figure with its horizon.
    pub fn title(&self) -> String {
        if self.qualifier.is_empty() {
            self.name.to_owned()
        } else {
            format!("{}, {} days", self.name, self.qualifier)
        }
    }

    /// Returns the unit of the figure.
    pub fn unit(&self) -> &'static str {
        self.unit
    }

    /// Returns the value of the figure for a run, or `None` if the run has no value.
    pub fn value(&self, run: &Logbook) -> Option<f64> {
        (self.value)(run)
    }

    pub(super) fn row(&self, runs: &[Logbook]) -> ComparisonRow {
        ComparisonRow {
            figure: self.name.to_owned(),
            of: self.qualifier.to_owned(),
            unit: self.unit,
            values: runs.iter().map(self.value).collect(),
            published: (self.published)(),
        }
    }
}

const fn compared_figure(
    name: &'static str,
    of: &'static str,
    unit: &'static str,
    value: fn(&Logbook) -> Option<f64>,
    published: fn() -> Option<PublishedRange>,
) -> ComparedFigure {
    ComparedFigure { name, qualifier: of, unit, value, published }
}

fn no_range() -> Option<PublishedRange> {
    None
}

fn forecast_value(run: &Logbook, horizon: u32, of: fn(&ForecastScore) -> f64) -> Option<f64> {
    let mut scores = run.measures.forecasts.iter();
    scores.find(|score| score.horizon_days == horizon && score.scored > 0).map(of)
}

fn forecast_error(score: &ForecastScore) -> f64 {
    score.mean_error
}

fn forecast_coverage(score: &ForecastScore) -> f64 {
    f64::from(score.covered) / f64::from(score.scored)
}

fn count_per_week(run: &Logbook, count: u32) -> Option<f64> {
    let weeks = run.weeks.len();
    (weeks > 0).then(|| f64::from(count) / weeks as f64)
}

/// Nominal coverage of forecast intervals: 95 %.
const NOMINAL_COVERAGE: PublishedRange = PublishedRange { least: 0.95, most: 0.95, what: "nominal coverage" };

/// Figures of a whole run, in output order.
pub const FIGURES: &[ComparedFigure] = &[
    compared_figure(
        "final cash",
        "",
        "dollars",
        |run| Some(run.cash),
        || published_range("best of three runs of each agent", |agent| Some(agent.best_cash)),
    ),
    compared_figure(
        "score",
        "",
        "dollars",
        |run| run.score,
        || {
            let cash = published_results().rule_based_baseline;
            Some(PublishedRange { least: cash, most: cash, what: "rule-based baseline" })
        },
    ),
    compared_figure(
        "survival",
        "",
        "days",
        // Survival is known only after the run has ended.
        |run| run.ended.map(|_| f64::from(run.measures.survival_days)),
        || published_range("mean of three runs of each agent", |agent| Some(agent.mean_survival_days)),
    ),
    compared_figure(
        "minutes played",
        "",
        "minutes",
        |run| Some(run.total.time.active_seconds() / 60.0),
        no_range,
    ),
    compared_figure("seconds for a week, median", "", "seconds", |run| run.median_week_seconds, no_range),
    compared_figure(
        "calls that act, a week",
        "",
        "per week",
        |run| count_per_week(run, run.measures.tools.calls),
        || published_range("turns a week of each agent", |agent| Some(agent.turns_per_week)),
    ),
    compared_figure(
        "all calls, a week",
        "",
        "per week",
        |run| count_per_week(run, run.total.calls),
        no_range,
    ),
    compared_figure(
        "queries, a week",
        "",
        "per week",
        |run| count_per_week(run, run.total.queries),
        no_range,
    ),
    compared_figure("refused calls", "", "count", |run| Some(f64::from(run.total.refused)), no_range),
    compared_figure(
        "decisions",
        "",
        "count",
        |run| Some(run.weeks.iter().map(|week| week.decisions.len()).sum::<usize>() as f64),
        no_range,
    ),
    compared_figure(
        "weeks with a decision",
        "",
        "count",
        |run| Some(run.weeks.iter().filter(|week| !week.decisions.is_empty()).count() as f64),
        no_range,
    ),
    compared_figure(
        "ad spend on the best channel, as measured",
        "",
        "share",
        |run| run.measures.channels.as_ref().and_then(|skill| skill.share),
        no_range,
    ),
    compared_figure(
        "ad spend on the truly best channel",
        "",
        "share",
        |run| run.measures.truly_best.as_ref().map(|best| best.share),
        random_channel_range,
    ),
    compared_figure(
        "targeted share of development",
        "",
        "share",
        |run| run.measures.targeted_development,
        || published_range("agents with a published figure", |agent| agent.targeted_development_share),
    ),
    compared_figure("forecast error", "7", "share", |run| forecast_value(run, 7, forecast_error), no_range),
    compared_figure("forecast error", "28", "share", |run| forecast_value(run, 28, forecast_error), no_range),
    compared_figure("forecast error", "84", "share", |run| forecast_value(run, 84, forecast_error), no_range),
    compared_figure(
        "forecast error",
        "182",
        "share",
        |run| forecast_value(run, 182, forecast_error),
        no_range,
    ),
    compared_figure(
        "forecast error of the first four weeks",
        "28",
        "share",
        |run| {
            let mut scores = run.measures.first_forecasts.iter();
            scores.find(|score| score.horizon_days == 28 && score.scored > 0).map(forecast_error)
        },
        no_range,
    ),
    compared_figure(
        "forecast coverage",
        "7",
        "share",
        |run| forecast_value(run, 7, forecast_coverage),
        || Some(NOMINAL_COVERAGE),
    ),
    compared_figure(
        "forecast coverage",
        "28",
        "share",
        |run| forecast_value(run, 28, forecast_coverage),
        || Some(NOMINAL_COVERAGE),
    ),
    compared_figure(
        "forecast coverage",
        "84",
        "share",
        |run| forecast_value(run, 84, forecast_coverage),
        || Some(NOMINAL_COVERAGE),
    ),
    compared_figure(
        "forecast coverage",
        "182",
        "share",
        |run| forecast_value(run, 182, forecast_coverage),
        || Some(NOMINAL_COVERAGE),
    ),
    compared_figure(
        "weeks with naive forecasts",
        "",
        "count",
        |run| Some(f64::from(run.measures.filled_naively.0)),
        no_range,
    ),
    compared_figure(
        "words of a rationale",
        "",
        "words",
        |run| Some(run.measures.planning.words_each),
        no_range,
    ),
    compared_figure(
        "words of planning in 100",
        "",
        "per 100 words",
        |run| run.wording.planning_per_hundred(),
        no_range,
    ),
    compared_figure("\"if\" in rationales", "", "count", |run| Some(run.wording.ifs as f64), no_range),
    compared_figure("\"if\" in notes", "", "count", |run| Some(run.notes.wording?.ifs as f64), no_range),
    compared_figure("evenness of tools", "", "share", |run| run.measures.tools.evenness, no_range),
];

fn random_channel_range() -> Option<PublishedRange> {
    let share = published_results().best_channel_random_share;
    Some(PublishedRange { least: share, most: share, what: "by chance" })
}

/// Returns a row for each group: the share of ad spending on the channel with the most leads per dollar.
pub(super) fn group_rows(runs: &[Logbook]) -> Vec<ComparisonRow> {
    let ads = |run: &Logbook| run.measures.channels.clone().map(|skill| skill.groups).unwrap_or_default();
    let by_run: Vec<_> = runs.iter().map(ads).collect();
    let groups: BTreeSet<&str> = by_run.iter().flatten().map(|group_ads| group_ads.group.as_str()).collect();
    let row = |group: &str| ComparisonRow {
        figure: "ad spend on the best channel, as measured".to_owned(),
        of: group.to_owned(),
        unit: "share",
        values: by_run
            .iter()
            .map(|run_ads| {
                run_ads.iter().find(|ads| ads.group == group).and_then(|ads| Some(ads.best.as_ref()?.share))
            })
            .collect(),
        published: None,
    };
    groups.into_iter().map(row).collect()
}

/// Returns a row of cash for each week that at least one run reached.
pub(super) fn cash_rows(runs: &[Logbook]) -> Vec<ComparisonRow> {
    let cash_of = |run: &Logbook, day: u32| {
        if day == 0 {
            return Some(run.start_cash);
        }
        let mut weeks = run.weeks.iter();
        weeks.find(|week| week.day == day)?.figures.get("cash")?.as_f64()
    };
    let mut days: Vec<u32> = runs.iter().flat_map(|run| run.weeks.iter().map(|week| week.day)).collect();
    days.push(0);
    days.sort_unstable();
    days.dedup();
    let row = |day: u32| ComparisonRow {
        figure: "cash".to_owned(),
        of: day.to_string(),
        unit: "dollars",
        values: runs.iter().map(|run| cash_of(run, day)).collect(),
        published: None,
    };
    days.into_iter().map(row).collect()
}
