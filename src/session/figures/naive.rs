//! Naive forecasts, which assume that the cash flow of recent weeks continues. Intervals are derived from the errors
//! that `novamind lab forecasts` measured for companies in the same stage, with the bundled policies. Large past
//! errors of a company widen its intervals.

use std::sync::LazyLock;

use serde::{Deserialize, Serialize};

use super::cash_rate::CashRate;
use super::week::Forecasts;
use novamind_record::figures::WeekFigures;
use novamind_tools::Forecast;
use novamind_world::events::Category;

/// Maximum age of a young company, in completed weeks.
const YOUNG_WEEKS: usize = 4;
/// Income counts as growing above the income four weeks earlier times this factor, and as shrinking below that income
/// divided by this factor.
const MIN_GROWTH_RATIO: f64 = 1.3;
/// Number of past errors per horizon that affect the width of an interval.
const MAX_REMEMBERED_ERRORS: usize = 8;
/// Weight of past errors in the width of an interval. The width is multiplied by this weight times the root mean
/// square of `error_intervals` of past forecasts, if the product is above 1.
const PAST_ERROR_WEIGHT: f64 = 1.5;
/// Upper limit of `error_intervals` of a past forecast.
const MAX_ERROR_INTERVALS: f64 = 10.0;
/// Minimum expected cash flow, dollars per day.
const MIN_FLOW_PER_DAY: f64 = 1.0;
/// Minimum half-width of an interval, as a share of the expected flow, because users vary more than policies.
const MIN_INTERVAL_SHARE: f64 = 0.05;
/// Largest error that counts as 0, as a share of the expected flow.
const ROUNDING_TOLERANCE: f64 = 1e-4;
/// Quantiles of the errors that bound an interval. The range is wider than 95 %, because a company differs from the
/// measured companies.
const INTERVAL_QUANTILES: [f64; 2] = [0.02, 0.98];

/// Stage of a company, determined by its age and its weekly income.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum GrowthStage {
    /// The company has not completed a week.
    Start,
    /// The company is in its first four weeks.
    Young,
    /// The income of the company is growing.
    Growing,
    /// The income of the company is steady.
    Steady,
    /// The income of the company is shrinking.
    Shrinking,
    /// The company has no income now and had no income four weeks before.
    Idle,
}

impl GrowthStage {
    /// All stages of a company.
    pub const ALL: [GrowthStage; 6] = [
        GrowthStage::Start,
        GrowthStage::Young,
        GrowthStage::Growing,
        GrowthStage::Steady,
        GrowthStage::Shrinking,
        GrowthStage::Idle,
    ];

    /// Returns the stage of a company after these weeks. Compares the income of the last two weeks with the income
    /// four weeks before.
    pub fn from_weeks(weeks: &[WeekFigures]) -> GrowthStage {
        let end = weeks.len();
        if end <= YOUNG_WEEKS {
            return if end == 0 { GrowthStage::Start } else { GrowthStage::Young };
        }
        let income = |from: usize, upto: usize| CashRate::from_weeks(0.0, &weeks[from..upto]).income;
        let (now, before) = (income(end - 2, end), income(end.saturating_sub(6), end - 4));
        match (now > 0.0, before > 0.0) {
            (false, false) => GrowthStage::Idle,
            (true, false) => GrowthStage::Growing,
            _ if now > before * MIN_GROWTH_RATIO => GrowthStage::Growing,
            _ if now * MIN_GROWTH_RATIO < before => GrowthStage::Shrinking,
            _ => GrowthStage::Steady,
        }
    }
}

/// An interval around the predicted value, as shares of the expected flow.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ErrorInterval {
    /// Stage of the companies to which the interval applies.
    pub stage: GrowthStage,
    /// Horizon of the forecasts, in days.
    pub horizon: u32,
    /// Lower end of the interval, a negative share.
    pub below: f64,
    /// Upper end of the interval, a positive share.
    pub above: f64,
    /// Number of forecasts from which the interval was computed.
    pub forecasts: usize,
}

/// Measured coverage of the intervals for one horizon.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Coverage {
    /// Horizon of the forecasts, in days.
    pub horizon: u32,
    /// Number of forecasts that came due.
    pub forecasts: usize,
    /// Share of the outcomes that were within the interval.
    pub held: f64,
}

/// Intervals and coverage from a back-test of naive forecasts.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ErrorIntervals {
    /// Number of policies in the back-test.
    pub policies: usize,
    /// Number of seeds per policy.
    pub seeds: u64,
    /// Measured coverage by horizon.
    pub coverage: Vec<Coverage>,
    /// Intervals by horizon and stage.
    pub bands: Vec<ErrorInterval>,
}

static BUNDLED: LazyLock<ErrorIntervals> = LazyLock::new(|| {
    toml::from_str(include_str!("../../../assets/naive-bands.toml")).expect("the bundled bands are valid")
});

impl ErrorIntervals {
    /// Returns the bundled intervals.
    pub fn bundled() -> &'static ErrorIntervals {
        &BUNDLED
    }

    /// Computes the intervals from measured errors. Each error consists of stage, horizon in days, and share of the
    /// expected flow.
    pub fn from_errors(errors: &[(GrowthStage, u32, f64)], policies: usize, seeds: u64) -> ErrorIntervals {
        let mut horizons: Vec<u32> = errors.iter().map(|(_, horizon, _)| *horizon).collect();
        horizons.sort_unstable();
        horizons.dedup();
        let band = |(horizon, stage): (u32, GrowthStage)| {
            let matching = errors.iter().filter(|error| (error.0, error.1) == (stage, horizon));
            let mut values: Vec<f64> = matching.map(|(_, _, error)| *error).collect();
            values.sort_unstable_by(f64::total_cmp);
            let [below, above] = INTERVAL_QUANTILES.map(|share| quantile(&values, share));
            // Four decimals are sufficient: they exceed the precision of the measurement.
            let rounded = |value: f64| (value * 1e4).round() / 1e4;
            ErrorInterval {
                stage,
                horizon,
                below: rounded(below.min(-MIN_INTERVAL_SHARE)),
                above: rounded(above.max(MIN_INTERVAL_SHARE)),
                forecasts: values.len(),
            }
        };
        let cells = horizons.into_iter().flat_map(|horizon| GrowthStage::ALL.map(|stage| (horizon, stage)));
        ErrorIntervals { policies, seeds, coverage: Vec::new(), bands: cells.map(band).collect() }
    }

    /// Returns the interval of a stage for a horizon. If the horizon was not measured, returns the interval of the
    /// next shorter horizon.
    fn interval(&self, stage: GrowthStage, horizon: u32) -> (f64, f64) {
        let of_stage = self.bands.iter().filter(|band| band.stage == stage);
        let shorter = of_stage.clone().filter(|band| band.horizon <= horizon).max_by_key(|band| band.horizon);
        let band = shorter.or_else(|| of_stage.clone().min_by_key(|band| band.horizon));
        band.map_or((-1.0, 1.0), |band| (band.below, band.above))
    }

    /// Describes the measured coverage: `97 % of 17,000 such intervals …`.
    pub fn describe_coverage(&self) -> String {
        let held = self.coverage.iter().map(|coverage| coverage.held);
        let (least, most) = held.fold((1.0f64, 0.0f64), |all, value| (all.0.min(value), all.1.max(value)));
        let count: usize = self.coverage.iter().map(|coverage| coverage.forecasts).sum();
        let percent = |share: f64| (share * 100.0).round();
        let share = match percent(least) == percent(most) {
            true => format!("{} %", percent(least)),
            false => format!("{} to {} %", percent(least), percent(most)),
        };
        format!(
            "{share} of {} such intervals covered the outcome in back-tests of {} policies",
            novamind_base::formatting::grouped_number(count as f64, 0),
            self.policies
        )
    }
}

/// Returns a quantile of sorted values by linear interpolation, or 0 if there are no values.
fn quantile(sorted: &[f64], share: f64) -> f64 {
    let at = share * sorted.len().saturating_sub(1) as f64;
    let value = |at: f64| sorted.get(at as usize).copied().unwrap_or(0.0);
    value(at.floor()) + (value(at.ceil()) - value(at.floor())) * at.fract()
}

/// A naive forecast for a past week, computed from earlier weeks only, with its outcome.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hindcast {
    /// Stage of the company at the time of the forecast.
    pub stage: GrowthStage,
    /// Outcome without later purchases minus predicted value, as a share of the expected flow. Purchases are excluded
    /// because a naive forecast does not predict them.
    pub error: f64,
    /// Whether the interval contains the outcome including purchases.
    pub is_covered: bool,
    due_week: usize,
    /// Error of the forecast, as a multiple of the distance from the prediction to the end of the interval.
    error_intervals: f64,
}

/// Returns a naive forecast with the given horizon for each past week whose outcome is known.
pub fn hindcasts(weeks: &[WeekFigures], horizon: u32, bands: &ErrorIntervals) -> Vec<Hindcast> {
    let mut made: Vec<Hindcast> = Vec::new();
    for before in 0..weeks.len() {
        let Some(due) = due_week(weeks, before, horizon) else { break };
        let pace = CashRate::from_weeks(committed_costs_per_day(&weeks[before]), &weeks[..before]);
        let stage = GrowthStage::from_weeks(&weeks[..before]);
        let point = cash_after_purchases(&weeks[before]) + pace.net_per_day() * f64::from(horizon);
        let bought: f64 = weeks[before + 1..=due].iter().map(booked_purchases).sum();
        let error = (weeks[due].cash - bought - point) / expected_flow(&pace, horizon);
        let (below, above) = bands.interval(stage, horizon);
        let wider = widening_factor(&made, before);
        let deviation = (weeks[due].cash - point) / expected_flow(&pace, horizon);
        let held =
            (below * wider - ROUNDING_TOLERANCE..=above * wider + ROUNDING_TOLERANCE).contains(&deviation);
        let side = if error < 0.0 { below } else { above };
        let intervals =
            if error.abs() <= ROUNDING_TOLERANCE { 0.0 } else { (error / side).min(MAX_ERROR_INTERVALS) };
        made.push(Hindcast { stage, error, is_covered: held, due_week: due, error_intervals: intervals });
    }
    made
}

/// Returns the index of the week that ends `horizon` days after the start of the week `before`. After a bankruptcy,
/// the last week counts: otherwise, only successful companies would be measured.
fn due_week(weeks: &[WeekFigures], before: usize, horizon: u32) -> Option<usize> {
    let day = weeks[before].day - weeks[before].days_run + horizon;
    let last = weeks.last().filter(|last| last.cash < 0.0 && last.day < day);
    weeks.binary_search_by_key(&day, |week| week.day).ok().or(last.map(|_| weeks.len() - 1))
}

/// Returns the cash on the decision day of a week, after the purchases on that day.
fn cash_after_purchases(week: &WeekFigures) -> f64 {
    week.cash - week.cash_change + booked_purchases(week)
}

/// Returns the amount booked for R&D, market research and studies in a week, as a negative number.
fn booked_purchases(week: &WeekFigures) -> f64 {
    let kinds = [Category::ResearchProject, Category::MarketResearch, Category::GroupResearch];
    kinds.iter().map(|category| week.booked.category_total(*category)).sum()
}

/// Returns the costs to which the settings of a week committed the company, in dollars per day.
fn committed_costs_per_day(week: &WeekFigures) -> f64 {
    let kinds = [Category::Capacity, Category::Operations, Category::Development, Category::Advertising];
    -kinds.iter().map(|category| week.booked.category_total(*category)).sum::<f64>()
        / f64::from(week.days_run.max(1))
}

/// Returns the sum of income and costs up to a horizon at a cash rate, in dollars.
fn expected_flow(pace: &CashRate, horizon: u32) -> f64 {
    (pace.income + pace.committed + pace.variable).max(MIN_FLOW_PER_DAY) * f64::from(horizon)
}

/// Returns the factor that widens an interval, computed from the errors of forecasts that came due before a week.
fn widening_factor(made: &[Hindcast], before: usize) -> f64 {
    let known = made.iter().rev().filter(|hindcast| hindcast.due_week < before).take(MAX_REMEMBERED_ERRORS);
    let squares: Vec<f64> =
        known.map(|hindcast| hindcast.error_intervals * hindcast.error_intervals).collect();
    let mean = squares.iter().sum::<f64>() / squares.len().max(1) as f64;
    (PAST_ERROR_WEIGHT * mean.sqrt()).max(1.0)
}

pub(crate) fn naive_forecasts(
    cash: f64,
    pace: &CashRate,
    weeks: &[WeekFigures],
    horizons: &[u32],
) -> Forecasts {
    let bands = ErrorIntervals::bundled();
    let stage = GrowthStage::from_weeks(weeks);
    let one = |horizon: u32| {
        let wider = widening_factor(&hindcasts(weeks, horizon, bands), weeks.len());
        let (below, above) = bands.interval(stage, horizon);
        let (point, moved) =
            (cash + pace.net_per_day() * f64::from(horizon), expected_flow(pace, horizon) * wider);
        let end = |share: f64| round_to_cents(point + share * moved);
        Forecast {
            horizon_days: horizon,
            point: round_to_cents(point),
            lower: end(below).min(round_to_cents(point) - 0.01),
            upper: end(above).max(round_to_cents(point) + 0.01),
        }
    };
    Forecasts { all: std::array::from_fn(|at| one(horizons[at])), filled_naively: [true; 4] }
}

fn round_to_cents(value: f64) -> f64 {
    (value * 100.0).round() / 100.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use novamind_record::figures::CategoryTotals;

    const HORIZONS: [u32; 4] = [7, 28, 84, 182];

    /// Returns weeks with these payments and 1,000 dollars of advertising per week.
    fn weeks_with_payments(payments: &[f64]) -> Vec<WeekFigures> {
        let mut cash = 1e6;
        let week = |(at, paid): (usize, &f64)| {
            let mut booked = CategoryTotals::default();
            booked.add(Category::SubscriptionPayment, *paid);
            booked.add(Category::Advertising, -1_000.0);
            cash += paid - 1_000.0;
            let day = 7 * (at as u32 + 1);
            WeekFigures {
                day,
                days_run: 7,
                cash,
                cash_change: paid - 1_000.0,
                booked,
                ..WeekFigures::default()
            }
        };
        payments.iter().enumerate().map(week).collect()
    }

    #[test]
    fn stage_follows_income() {
        for (payments, stage) in [
            (&[][..], GrowthStage::Start),
            (&[1.0, 9.0, 50.0, 90.0], GrowthStage::Young),
            (&[0.0, 0.0, 0.0, 0.0, 0.0], GrowthStage::Idle),
            (&[0.0, 0.0, 0.0, 0.0, 0.0, 7.0], GrowthStage::Growing),
            (&[7.0, 7.0, 7.0, 7.0, 9.0, 9.0], GrowthStage::Steady),
            (&[7.0, 7.0, 7.0, 7.0, 9.0, 10.0], GrowthStage::Growing),
            (&[7.0, 7.0, 7.0, 7.0, 5.0, 5.0], GrowthStage::Shrinking),
            (&[7.0, 7.0, 0.0, 0.0, 0.0, 0.0], GrowthStage::Shrinking),
        ] {
            assert_eq!(GrowthStage::from_weeks(&weeks_with_payments(payments)), stage, "{payments:?}");
        }
    }

    #[test]
    fn forecasts_include_commitments_before_the_first_week() {
        let pace = CashRate::from_weeks(5_585.0, &[]);
        let naive = naive_forecasts(1_000_000.0, &pace, &[], &HORIZONS);
        assert_eq!(naive.all.map(|forecast| forecast.point), [960_905.0, 843_620.0, 530_860.0, -16_470.0]);
        assert!(naive.all.iter().all(|one| one.lower < one.point && one.point < one.upper));
        let idle = naive_forecasts(0.0, &CashRate::default(), &[], &HORIZONS);
        assert!(idle.all.iter().all(|one| one.lower < 0.0 && one.point == 0.0 && one.upper > 0.0));
    }

    #[test]
    fn intervals_widen_after_errors() {
        let calm = weeks_with_payments(&[1_000.0; 20]);
        let bands = ErrorIntervals::bundled();
        let errors = hindcasts(&calm, 28, bands);
        // The first forecast is made before the company has income.
        assert_eq!(errors.len(), 17);
        assert!(errors[1..].iter().all(|hindcast| hindcast.error.abs() < 1e-9 && hindcast.is_covered));
        assert_eq!(widening_factor(&errors[1..], 20), 1.0);
        let wild: Vec<f64> = (0..20).map(|at| if at % 8 < 4 { 100.0 } else { 90_000.0 }).collect();
        let errors = hindcasts(&weeks_with_payments(&wild), 28, bands);
        assert!(errors.iter().any(|hindcast| !hindcast.is_covered));
        assert!(widening_factor(&errors, 20) > 1.5, "{}", widening_factor(&errors, 20));
        let known = errors.iter().filter(|hindcast| hindcast.due_week < 10).count();
        assert_eq!(
            widening_factor(&errors, 10),
            widening_factor(&errors[..known], 20),
            "only due forecasts affect the width"
        );
    }

    #[test]
    fn decision_day_purchases_are_not_errors() {
        let mut all = weeks_with_payments(&[1_000.0; 9]);
        all[6].booked.add(Category::ResearchProject, -50_000.0);
        all[6].cash_change -= 50_000.0;
        all[6..].iter_mut().for_each(|week| week.cash -= 50_000.0);
        let errors = hindcasts(&all, 7, ErrorIntervals::bundled());
        assert!(
            errors[1..].iter().all(|hindcast| hindcast.error.abs() < 1e-9 && hindcast.is_covered),
            "{errors:?}"
        );
        let later = hindcasts(&all, 28, ErrorIntervals::bundled());
        assert!(later[1..].iter().all(|hindcast| hindcast.error.abs() < 1e-9), "{later:?}");
        assert!(!later[4].is_covered, "later purchases are part of the outcome");
    }

    #[test]
    fn from_errors_returns_quantiles() {
        let errors: Vec<(GrowthStage, u32, f64)> =
            (0..=1000).map(|at| (GrowthStage::Steady, 7, f64::from(at) / 1000.0 - 0.4)).collect();
        let bands = ErrorIntervals::from_errors(&errors, 1, 1);
        assert_eq!(bands.interval(GrowthStage::Steady, 7), (-0.38, 0.58));
        assert_eq!(
            bands.interval(GrowthStage::Steady, 30),
            (-0.38, 0.58),
            "the next shorter horizon applies"
        );
        assert_eq!(
            bands.interval(GrowthStage::Idle, 7),
            (-MIN_INTERVAL_SHARE, MIN_INTERVAL_SHARE),
            "nothing was measured"
        );
        assert_eq!(quantile(&[], 0.5), 0.0);
    }

    #[test]
    fn bundled_intervals_cover_90_to_99_percent_in_every_stage() {
        let bands = ErrorIntervals::bundled();
        for (horizon, stage) in
            HORIZONS.into_iter().flat_map(|horizon| GrowthStage::ALL.map(|stage| (horizon, stage)))
        {
            let band = bands.bands.iter().find(|band| (band.stage, band.horizon) == (stage, horizon));
            let band = band.unwrap_or_else(|| panic!("{stage:?} {horizon}"));
            assert!(band.below < 0.0 && band.above > 0.0 && band.forecasts >= 100, "{band:?}");
        }
        assert_eq!(bands.coverage.iter().map(|coverage| coverage.horizon).collect::<Vec<_>>(), HORIZONS);
        assert!(
            bands.coverage.iter().all(|coverage| (0.90..=0.99).contains(&coverage.held)),
            "{:?}",
            bands.coverage
        );
        assert!(bands.describe_coverage().contains("of 12 policies") || bands.policies != 12);
    }
}
