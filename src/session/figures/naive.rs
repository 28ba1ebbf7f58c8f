//! Naive forecasts: the cash flow of recent weeks continues. Intervals contain the errors measured for companies in
//! the same stage, with the bundled policies (`novamind lab forecasts`). They are wider for a company with large past
//! errors.

use std::sync::LazyLock;

use serde::{Deserialize, Serialize};

use super::pace::Pace;
use super::week::Forecasts;
use novamind_record::figures::WeekFigures;
use novamind_tools::Forecast;
use novamind_world::events::Category;

/// A company is young up to this many weeks.
const YOUNG: usize = 4;
/// Income grows if it exceeds that of four weeks before by this factor, and shrinks if it is below the inverse.
const GROWTH: f64 = 1.3;
/// Number of past errors per horizon that affect the width.
const REMEMBERED: usize = 8;
/// The interval is multiplied by this factor times the root mean square of past errors in intervals, if the product
/// is above 1.
const OWN_ERROR: f64 = 1.5;
/// Maximum error, in intervals.
const WORST: f64 = 10.0;
/// Minimum cash flow, dollars a day.
const LEAST: f64 = 1.0;
/// Minimum half-width of an interval, as a share of the expected flow: users vary more than policies.
const NARROWEST: f64 = 0.05;
/// Errors up to this share of the expected flow count as 0.
const ROUNDING: f64 = 1e-4;
/// Quantiles of the errors that bound an interval: wider than 95 %, because a company differs from those measured.
const QUANTILES: [f64; 2] = [0.02, 0.98];

/// Stage of a company, by its weekly income.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Stage {
    /// Before the first week.
    Start,
    /// In its first weeks.
    Young,
    /// Income is growing.
    Growing,
    /// Income is steady.
    Steady,
    /// Income is shrinking.
    Shrinking,
    /// No income, now or four weeks before.
    Idle,
}

impl Stage {
    /// All stages.
    pub const ALL: [Stage; 6] =
        [Stage::Start, Stage::Young, Stage::Growing, Stage::Steady, Stage::Shrinking, Stage::Idle];

    /// Returns the stage after these weeks: compares income of the last two weeks with that of two weeks four weeks
    /// before.
    pub fn of(weeks: &[WeekFigures]) -> Stage {
        let end = weeks.len();
        if end <= YOUNG {
            return if end == 0 { Stage::Start } else { Stage::Young };
        }
        let income = |from: usize, upto: usize| Pace::of(0.0, &weeks[from..upto]).income;
        let (now, before) = (income(end - 2, end), income(end.saturating_sub(6), end - 4));
        match (now > 0.0, before > 0.0) {
            (false, false) => Stage::Idle,
            (true, false) => Stage::Growing,
            _ if now > before * GROWTH => Stage::Growing,
            _ if now * GROWTH < before => Stage::Shrinking,
            _ => Stage::Steady,
        }
    }
}

/// An interval around the point, in shares of the expected flow.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Band {
    /// Stage of the companies.
    pub stage: Stage,
    /// Days ahead.
    pub horizon: u32,
    /// Lower end, negative.
    pub below: f64,
    /// Upper end, positive.
    pub above: f64,
    /// Number of measured forecasts.
    pub forecasts: usize,
}

/// Measured coverage of intervals.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Coverage {
    /// Days ahead.
    pub horizon: u32,
    /// Number of forecasts that came due.
    pub forecasts: usize,
    /// Share of the outcomes within the interval.
    pub held: f64,
}

/// Results of a back-test.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Bands {
    /// Number of policies.
    pub policies: usize,
    /// Seeds per policy.
    pub seeds: u64,
    /// Coverage by horizon.
    pub coverage: Vec<Coverage>,
    /// The intervals.
    pub bands: Vec<Band>,
}

static SHIPPED: LazyLock<Bands> = LazyLock::new(|| {
    toml::from_str(include_str!("../../../assets/naive-bands.toml")).expect("the bundled bands are valid")
});

impl Bands {
    /// Returns the bundled bands.
    pub fn shipped() -> &'static Bands {
        &SHIPPED
    }

    /// Computes the intervals from measured errors: stage, days ahead, share of the expected flow.
    pub fn measured(errors: &[(Stage, u32, f64)], policies: usize, seeds: u64) -> Bands {
        let mut horizons: Vec<u32> = errors.iter().map(|(_, horizon, _)| *horizon).collect();
        horizons.sort_unstable();
        horizons.dedup();
        let band = |(horizon, stage): (u32, Stage)| {
            let own = errors.iter().filter(|error| (error.0, error.1) == (stage, horizon));
            let mut own: Vec<f64> = own.map(|(_, _, error)| *error).collect();
            own.sort_unstable_by(f64::total_cmp);
            let [below, above] = QUANTILES.map(|share| quantile(&own, share));
            // Four decimals exceed the precision of the measurement; the interval contains the point.
            let rounded = |value: f64| (value * 1e4).round() / 1e4;
            Band {
                stage,
                horizon,
                below: rounded(below.min(-NARROWEST)),
                above: rounded(above.max(NARROWEST)),
                forecasts: own.len(),
            }
        };
        let cells = horizons.into_iter().flat_map(|horizon| Stage::ALL.map(|stage| (horizon, stage)));
        Bands { policies, seeds, coverage: Vec::new(), bands: cells.map(band).collect() }
    }

    /// Returns the interval of a stage for a horizon, or that of the next shorter measured horizon.
    fn of(&self, stage: Stage, horizon: u32) -> (f64, f64) {
        let own = self.bands.iter().filter(|band| band.stage == stage);
        let shorter = own.clone().filter(|band| band.horizon <= horizon).max_by_key(|band| band.horizon);
        let band = shorter.or_else(|| own.clone().min_by_key(|band| band.horizon));
        band.map_or((-1.0, 1.0), |band| (band.below, band.above))
    }

    /// Describes the measured coverage: `97 % of 17,000 such intervals …`.
    pub fn coverage_in_words(&self) -> String {
        let held = self.coverage.iter().map(|own| own.held);
        let (least, most) = held.fold((1.0f64, 0.0f64), |all, own| (all.0.min(own), all.1.max(own)));
        let count: usize = self.coverage.iter().map(|own| own.forecasts).sum();
        let percent = |share: f64| (share * 100.0).round();
        let share = match percent(least) == percent(most) {
            true => format!("{} %", percent(least)),
            false => format!("{} to {} %", percent(least), percent(most)),
        };
        format!(
            "{share} of {} such intervals covered the outcome in back-tests of {} policies",
            novamind_base::notation::grouped(count as f64, 0),
            self.policies
        )
    }
}

/// Returns a quantile of sorted values by linear interpolation; 0 if there are none.
fn quantile(sorted: &[f64], share: f64) -> f64 {
    let at = share * sorted.len().saturating_sub(1) as f64;
    let value = |at: f64| sorted.get(at as usize).copied().unwrap_or(0.0);
    value(at.floor()) + (value(at.ceil()) - value(at.floor())) * at.fract()
}

/// A naive forecast as it was, or would have been, made before a week, and its outcome.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hindcast {
    /// Stage at that time.
    pub stage: Stage,
    /// Outcome without later purchases, less the point, as a share of the expected flow. A naive forecast does not
    /// predict purchases.
    pub error: f64,
    /// Whether the interval contains the outcome, purchases included.
    pub held: bool,
    due: usize,
    /// The error, in intervals.
    intervals: f64,
}

/// Returns the naive forecasts before each past week for a horizon, as far as outcomes are known.
pub fn hindcasts(weeks: &[WeekFigures], horizon: u32, bands: &Bands) -> Vec<Hindcast> {
    let mut made: Vec<Hindcast> = Vec::new();
    for before in 0..weeks.len() {
        let Some(due) = due(weeks, before, horizon) else { break };
        let pace = Pace::of(committed(&weeks[before]), &weeks[..before]);
        let stage = Stage::of(&weeks[..before]);
        let point = cash_before(&weeks[before]) + pace.net() * f64::from(horizon);
        let bought: f64 = weeks[before + 1..=due].iter().map(purchases).sum();
        let error = (weeks[due].cash - bought - point) / moved(&pace, horizon);
        let (below, above) = bands.of(stage, horizon);
        let wider = widening(&made, before);
        let came = (weeks[due].cash - point) / moved(&pace, horizon);
        let held = (below * wider - ROUNDING..=above * wider + ROUNDING).contains(&came);
        let side = if error < 0.0 { below } else { above };
        let intervals = if error.abs() <= ROUNDING { 0.0 } else { (error / side).min(WORST) };
        made.push(Hindcast { stage, error, held, due, intervals });
    }
    made
}

/// Returns the index of the week that ends `horizon` days after the start of another. A bankrupt company keeps its
/// last cash: without it, only successful companies would be measured.
fn due(weeks: &[WeekFigures], before: usize, horizon: u32) -> Option<usize> {
    let day = weeks[before].day - weeks[before].days_run + horizon;
    let last = weeks.last().filter(|last| last.cash < 0.0 && last.day < day);
    weeks.binary_search_by_key(&day, |week| week.day).ok().or(last.map(|_| weeks.len() - 1))
}

/// Returns the cash on the decision day of a week, before its purchases.
fn cash_before(week: &WeekFigures) -> f64 {
    week.cash - week.cash_change + purchases(week)
}

/// Returns the amount booked for R&D and studies in a week, negative.
fn purchases(week: &WeekFigures) -> f64 {
    let kinds = [Category::ResearchProject, Category::MarketResearch, Category::GroupResearch];
    kinds.iter().map(|category| week.booked.of(*category)).sum()
}

/// Returns the costs that the settings of a week committed to, dollars a day.
fn committed(week: &WeekFigures) -> f64 {
    let kinds = [Category::Capacity, Category::Operations, Category::Development, Category::Advertising];
    -kinds.iter().map(|category| week.booked.of(*category)).sum::<f64>() / f64::from(week.days_run.max(1))
}

/// Returns the total income and costs until a horizon at a rate, dollars.
fn moved(pace: &Pace, horizon: u32) -> f64 {
    (pace.income + pace.committed + pace.variable).max(LEAST) * f64::from(horizon)
}

/// Returns the factor that widens an interval, from the forecasts that came due before a week.
fn widening(made: &[Hindcast], before: usize) -> f64 {
    let known = made.iter().rev().filter(|hindcast| hindcast.due < before).take(REMEMBERED);
    let squares: Vec<f64> = known.map(|hindcast| hindcast.intervals * hindcast.intervals).collect();
    let mean = squares.iter().sum::<f64>() / squares.len().max(1) as f64;
    (OWN_ERROR * mean.sqrt()).max(1.0)
}

pub(crate) fn forecasts(cash: f64, pace: &Pace, weeks: &[WeekFigures], horizons: &[u32]) -> Forecasts {
    let bands = Bands::shipped();
    let stage = Stage::of(weeks);
    let one = |horizon: u32| {
        let wider = widening(&hindcasts(weeks, horizon, bands), weeks.len());
        let (below, above) = bands.of(stage, horizon);
        let (point, moved) = (cash + pace.net() * f64::from(horizon), moved(pace, horizon) * wider);
        let end = |share: f64| cents(point + share * moved);
        Forecast {
            horizon_days: horizon,
            point: cents(point),
            lower: end(below).min(cents(point) - 0.01),
            upper: end(above).max(cents(point) + 0.01),
        }
    };
    Forecasts { all: std::array::from_fn(|at| one(horizons[at])), filled_naively: [true; 4] }
}

fn cents(value: f64) -> f64 {
    (value * 100.0).round() / 100.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use novamind_record::figures::Booked;

    const HORIZONS: [u32; 4] = [7, 28, 84, 182];

    /// Returns weeks with these payments and 1,000 dollars of advertising each.
    fn weeks(payments: &[f64]) -> Vec<WeekFigures> {
        let mut cash = 1e6;
        let week = |(at, paid): (usize, &f64)| {
            let mut booked = Booked::default();
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
    fn the_stage_is_that_of_income() {
        for (payments, stage) in [
            (&[][..], Stage::Start),
            (&[1.0, 9.0, 50.0, 90.0], Stage::Young),
            (&[0.0, 0.0, 0.0, 0.0, 0.0], Stage::Idle),
            (&[0.0, 0.0, 0.0, 0.0, 0.0, 7.0], Stage::Growing),
            (&[7.0, 7.0, 7.0, 7.0, 9.0, 9.0], Stage::Steady),
            (&[7.0, 7.0, 7.0, 7.0, 9.0, 10.0], Stage::Growing),
            (&[7.0, 7.0, 7.0, 7.0, 5.0, 5.0], Stage::Shrinking),
            (&[7.0, 7.0, 0.0, 0.0, 0.0, 0.0], Stage::Shrinking),
        ] {
            assert_eq!(Stage::of(&weeks(payments)), stage, "{payments:?}");
        }
    }

    #[test]
    fn commitments_count_before_the_first_week() {
        let pace = Pace::of(5_585.0, &[]);
        let naive = forecasts(1_000_000.0, &pace, &[], &HORIZONS);
        assert_eq!(naive.all.map(|forecast| forecast.point), [960_905.0, 843_620.0, 530_860.0, -16_470.0]);
        assert!(naive.all.iter().all(|one| one.lower < one.point && one.point < one.upper));
        let idle = forecasts(0.0, &Pace::default(), &[], &HORIZONS);
        assert!(idle.all.iter().all(|one| one.lower < 0.0 && one.point == 0.0 && one.upper > 0.0));
    }

    #[test]
    fn a_company_that_goes_on_as_before_has_no_errors_and_one_that_does_not_gets_wider_intervals() {
        let calm = weeks(&[1_000.0; 20]);
        let bands = Bands::shipped();
        let errors = hindcasts(&calm, 28, bands);
        // The first forecast is made before there is any income.
        assert_eq!(errors.len(), 17);
        assert!(errors[1..].iter().all(|own| own.error.abs() < 1e-9 && own.held));
        assert_eq!(widening(&errors[1..], 20), 1.0);
        let wild: Vec<f64> = (0..20).map(|at| if at % 8 < 4 { 100.0 } else { 90_000.0 }).collect();
        let errors = hindcasts(&weeks(&wild), 28, bands);
        assert!(errors.iter().any(|own| !own.held));
        assert!(widening(&errors, 20) > 1.5, "{}", widening(&errors, 20));
        let known = errors.iter().filter(|own| own.due < 10).count();
        assert_eq!(
            widening(&errors, 10),
            widening(&errors[..known], 20),
            "only due forecasts affect the width"
        );
    }

    #[test]
    fn purchases_of_the_decision_day_are_no_error() {
        let mut all = weeks(&[1_000.0; 9]);
        all[6].booked.add(Category::ResearchProject, -50_000.0);
        all[6].cash_change -= 50_000.0;
        all[6..].iter_mut().for_each(|week| week.cash -= 50_000.0);
        let errors = hindcasts(&all, 7, Bands::shipped());
        assert!(errors[1..].iter().all(|own| own.error.abs() < 1e-9 && own.held), "{errors:?}");
        let later = hindcasts(&all, 28, Bands::shipped());
        assert!(later[1..].iter().all(|own| own.error.abs() < 1e-9), "{later:?}");
        assert!(!later[4].held, "later purchases are part of the outcome");
    }

    #[test]
    fn bands_are_the_quantiles_of_measured_errors() {
        let errors: Vec<(Stage, u32, f64)> =
            (0..=1000).map(|at| (Stage::Steady, 7, f64::from(at) / 1000.0 - 0.4)).collect();
        let bands = Bands::measured(&errors, 1, 1);
        assert_eq!(bands.of(Stage::Steady, 7), (-0.38, 0.58));
        assert_eq!(bands.of(Stage::Steady, 30), (-0.38, 0.58), "the next shorter horizon applies");
        assert_eq!(bands.of(Stage::Idle, 7), (-NARROWEST, NARROWEST), "nothing was measured");
        assert_eq!(quantile(&[], 0.5), 0.0);
    }

    #[test]
    fn shipped_bands_cover_every_stage_and_held_between_90_and_99_percent() {
        let bands = Bands::shipped();
        for (horizon, stage) in
            HORIZONS.into_iter().flat_map(|horizon| Stage::ALL.map(|stage| (horizon, stage)))
        {
            let own = bands.bands.iter().find(|band| (band.stage, band.horizon) == (stage, horizon));
            let own = own.unwrap_or_else(|| panic!("{stage:?} {horizon}"));
            assert!(own.below < 0.0 && own.above > 0.0 && own.forecasts >= 100, "{own:?}");
        }
        assert_eq!(bands.coverage.iter().map(|own| own.horizon).collect::<Vec<_>>(), HORIZONS);
        assert!(bands.coverage.iter().all(|own| (0.90..=0.99).contains(&own.held)), "{:?}", bands.coverage);
        assert!(bands.coverage_in_words().contains("of 12 policies") || bands.policies != 12);
    }
}
