//! Stored results of experiment runs.

use serde::{Deserialize, Serialize};

use super::RecordedFigures;
use crate::metrics::MetricsCollector;
use crate::runner::{PolicyRunOutcome, RunEnd};
use novamind_record::figures::WeekFigures;
use novamind_session::DayReport;

/// The stored result of an experiment run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RunResult {
    /// Seed of the run.
    pub seed: u64,
    /// Last possible day of the run.
    pub days: u32,
    /// Last simulated day of the run.
    pub day: u32,
    /// Cash on day 0, dollars.
    pub start_cash: f64,
    /// Reason for the end of the run.
    pub ended: RunEnd,
    /// Cash at the end of the run, dollars.
    pub cash: f64,
    /// Active subscriptions of individuals at the end.
    pub subscribers: u32,
    /// Seats of active enterprises at the end.
    pub seats: u32,
    /// Monthly recurring revenue after the last simulated day, dollars.
    pub mrr: f64,
    /// Highest number of active subscriptions of individuals at the end of a day.
    pub peak_subscribers: u32,
    /// First day on which [`RunResult::peak_subscribers`] was reached.
    pub peak_day: u32,
    /// Hash of the state after the last day.
    pub state_hash: String,
    /// Figures at the end of each simulated week.
    pub weeks: Vec<WeekPoint>,
    /// Figures at the end of each day; empty if not requested.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub daily: Vec<DayPoint>,
    /// All figures of the requested days; empty if no days are requested.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub figures: Vec<FigurePoint>,
}

/// The figures of a run at the end of a week.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct WeekPoint {
    /// Last day of the week.
    pub day: u32,
    /// Cash at the end of the week, dollars.
    pub cash: f64,
    /// Active subscriptions of individuals at the end of the week.
    pub subscribers: u32,
    /// Seats of active enterprises at the end of the week.
    pub seats: u32,
    /// Monthly recurring revenue at the end of the week, dollars.
    pub mrr: f64,
}

/// The figures of a run on a day.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct DayPoint {
    /// Day of the figures.
    pub day: u32,
    /// Cash at the end of the day, dollars.
    pub cash: f64,
    /// Monthly recurring revenue at the end of the day, dollars.
    pub mrr: f64,
    /// Active subscriptions of individuals at the end of the day.
    pub subscribers: u32,
    /// Seats of active enterprises at the end of the day.
    pub seats: u32,
    /// Leads of individuals on the day.
    pub individual_leads: u32,
    /// Leads of enterprises on the day.
    pub enterprise_leads: u32,
    /// New subscriptions of individuals on the day.
    pub new_subscribers: u32,
    /// Cancellations of individuals on the day.
    pub cancellations: u32,
    /// Payments of subscribers on the day, dollars.
    pub payments: f64,
    /// Running costs of the day, dollars: capacity, compute, operations, development and advertising.
    pub running_costs: f64,
    /// Other changes in cash since the previous day, dollars: purchases, lead costs and ad revenue.
    pub other: f64,
    /// Usage of the day, units.
    pub usage: u64,
}

/// The value of a figure on a day.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FigurePoint {
    /// Day of the value.
    pub day: u32,
    /// Name of the figure, as listed in docs/interfaces/golden.md#figures.
    pub figure: String,
    /// Breakdown of the figure, for example a group; empty for a total.
    pub group: String,
    /// Value of the figure on the day.
    pub value: f64,
}

impl RunResult {
    /// Returns whether the run ended in bankruptcy.
    pub fn is_bankrupt(&self) -> bool {
        self.ended == RunEnd::Bankruptcy
    }

    /// Returns the value of a figure on a requested day, or `None` if the value is not stored.
    pub fn figure(&self, day: u32, figure: &str, group: &str) -> Option<f64> {
        let is_requested =
            |point: &&FigurePoint| point.day == day && point.figure == figure && point.group == group;
        self.figures.iter().find(is_requested).map(|point| point.value)
    }
}

/// An observer of the days of a run, which collects the result of the run.
pub(super) struct RunRecorder {
    daily: Option<Vec<DayPoint>>,
    collector: MetricsCollector,
    peak: (u32, u32),
    start_cash: f64,
    /// Cash at the end of the previous day, dollars.
    cash: f64,
    mrr: f64,
}

impl RunRecorder {
    /// Creates a recorder for a run with the given starting cash.
    pub(super) fn new(wanted: &RecordedFigures, start_cash: f64) -> RunRecorder {
        let collector = match wanted.figures_on.is_empty() {
            true => MetricsCollector::disabled(),
            false => MetricsCollector::new(Some(wanted.figures_on.clone())),
        };
        let daily = wanted.daily.then(Vec::new);
        RunRecorder { daily, collector, peak: (0, 0), start_cash, cash: start_cash, mrr: 0.0 }
    }

    pub(super) fn add_day(&mut self, report: &DayReport<'_>) {
        self.collector.add_day(report);
        let day_figures = report.figures;
        if day_figures.individual_subscribers > self.peak.0 {
            self.peak = (day_figures.individual_subscribers, day_figures.day);
        }
        self.daily.iter_mut().for_each(|days| {
            days.push(DayPoint {
                day: day_figures.day,
                cash: day_figures.cash,
                mrr: day_figures.mrr,
                subscribers: day_figures.individual_subscribers,
                seats: day_figures.enterprise_seats,
                individual_leads: day_figures.new_individual_leads,
                enterprise_leads: day_figures.new_enterprise_leads,
                new_subscribers: day_figures.new_individual_subscribers,
                cancellations: day_figures.cancellations,
                payments: day_figures.payments_received,
                running_costs: day_figures.total_costs,
                other: day_figures.cash - self.cash - day_figures.payments_received + day_figures.total_costs,
                usage: day_figures.total_usage,
            });
        });
        (self.cash, self.mrr) = (day_figures.cash, day_figures.mrr);
    }

    /// Creates the stored result after the end of the run.
    pub(super) fn into_result(self, outcome: PolicyRunOutcome, weeks: &[WeekFigures]) -> RunResult {
        let week = |week_figures: &WeekFigures| WeekPoint {
            day: week_figures.day,
            cash: week_figures.cash,
            subscribers: week_figures.individual_subscribers,
            seats: week_figures.enterprise_seats,
            mrr: week_figures.recurring_revenue,
        };
        let figures = self.collector.finish(outcome.days).into_iter().map(|metric_value| FigurePoint {
            day: metric_value.day,
            figure: metric_value.figure.to_owned(),
            group: metric_value.group.to_owned(),
            value: metric_value.value,
        });
        RunResult {
            seed: outcome.seed,
            days: outcome.days,
            day: outcome.day,
            start_cash: self.start_cash,
            ended: outcome.ended,
            cash: outcome.cash,
            subscribers: outcome.subscribers,
            seats: outcome.seats,
            mrr: self.mrr,
            peak_subscribers: self.peak.0,
            peak_day: self.peak.1,
            state_hash: outcome.state_hash,
            weeks: weeks.iter().map(week).collect(),
            daily: self.daily.unwrap_or_default(),
            figures: figures.collect(),
        }
    }
}
