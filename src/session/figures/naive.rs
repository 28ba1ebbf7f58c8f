//! Naive forecasts: the pace goes on. Their intervals are those that held for companies in the same stage, measured over the
//! shipped policies (`novamind lab forecasts`), and wider where the company's own past was harder to forecast.

use std::sync::LazyLock;

use serde::{Deserialize, Serialize};

use super::pace::Pace;
use super::week::Forecasts;
use novamind_record::figures::WeekFigures;
use novamind_tools::Forecast;
use novamind_world::events::Category;

/// Weeks of a young company.
const YOUNG: usize = 4;
/// Income has grown where it is this many times what it was four weeks before, and has shrunk below its inverse.
const GROWTH: f64 = 1.3;
/// Forecasts of a horizon whose errors are remembered.
const REMEMBERED: usize = 8;
/// An interval is widened where the root mean square of past errors, in shares of the interval, is above the inverse of this.
const OWN_ERROR: f64 = 1.5;
/// An error counts at most this many intervals.
const WORST: f64 = 10.0;
/// Dollars a day that move at least.
const LEAST: f64 = 1.0;
/// Share of what moves that an interval reaches at least: no policy is as inventive as a person.
const NARROWEST: f64 = 0.05;
/// A share of what moves that is no error.
const ROUNDING: f64 = 1e-4;
/// Quantiles of the errors between which an interval lies: wider than 95 %, as the next company is none of those measured.
const QUANTILES: [f64; 2] = [0.02, 0.98];

/// How far a company has come, by its weekly income.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Stage {
    /// Before the first week.
    Start,
    /// In its first weeks.
    Young,
    /// Income grows.
    Growing,
    /// Income stays.
    Steady,
    /// Income shrinks.
    Shrinking,
    /// No income now, nor four weeks before.
    Idle,
}

impl Stage {
    /// All stages.
    pub const ALL: [Stage; 6] =
        [Stage::Start, Stage::Young, Stage::Growing, Stage::Steady, Stage::Shrinking, Stage::Idle];

    /// The stage after some weeks: income of the last two beside that of two weeks four weeks before.
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

/// How far below and above the point the interval reaches, in shares of what moves until then.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Band {
    /// Of companies in this stage.
    pub stage: Stage,
    /// Days ahead.
    pub horizon: u32,
    /// Negative.
    pub below: f64,
    /// Positive.
    pub above: f64,
    /// Forecasts that were measured.
    pub forecasts: usize,
}

/// How often intervals held.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Coverage {
    /// Days ahead.
    pub horizon: u32,
    /// Forecasts that came due.
    pub forecasts: usize,
    /// Share of them that came within the interval.
    pub held: f64,
}

/// What a back-test measured.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Bands {
    /// Policies that were played.
    pub policies: usize,
    /// Seeds of each.
    pub seeds: u64,
    /// How often the intervals held, by horizon.
    pub coverage: Vec<Coverage>,
    /// The intervals.
    pub bands: Vec<Band>,
}

static SHIPPED: LazyLock<Bands> = LazyLock::new(|| {
    toml::from_str(include_str!("../../../assets/naive-bands.toml")).expect("the shipped bands are tested")
});

impl Bands {
    /// Those that are shipped.
    pub fn shipped() -> &'static Bands {
        &SHIPPED
    }

    /// The intervals that held for measured errors: stage, days ahead, share of what moves.
    pub fn measured(errors: &[(Stage, u32, f64)], policies: usize, seeds: u64) -> Bands {
        let mut horizons: Vec<u32> = errors.iter().map(|(_, horizon, _)| *horizon).collect();
        horizons.sort_unstable();
        horizons.dedup();
        let band = |(horizon, stage): (u32, Stage)| {
            let own = errors.iter().filter(|error| (error.0, error.1) == (stage, horizon));
            let mut own: Vec<f64> = own.map(|(_, _, error)| *error).collect();
            own.sort_unstable_by(f64::total_cmp);
            let [below, above] = QUANTILES.map(|share| quantile(&own, share));
            // Four decimals are more than the measurement is worth; the point lies within.
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

    /// The interval of a stage for a horizon; for one that was not measured that of the next shorter one.
    fn of(&self, stage: Stage, horizon: u32) -> (f64, f64) {
        let own = self.bands.iter().filter(|band| band.stage == stage);
        let shorter = own.clone().filter(|band| band.horizon <= horizon).max_by_key(|band| band.horizon);
        let band = shorter.or_else(|| own.clone().min_by_key(|band| band.horizon));
        band.map_or((-1.0, 1.0), |band| (band.below, band.above))
    }

    /// Share of the measured intervals so far ahead that held, in words: `97 % of 17,000`.
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
            "{share} of {} such intervals held in back-tests of {} policies",
            novamind_base::notation::grouped(count as f64, 0),
            self.policies
        )
    }
}

/// The value below which a share of sorted values lies, between its neighbours; 0 of none.
fn quantile(sorted: &[f64], share: f64) -> f64 {
    let at = share * sorted.len().saturating_sub(1) as f64;
    let value = |at: f64| sorted.get(at as usize).copied().unwrap_or(0.0);
    value(at.floor()) + (value(at.ceil()) - value(at.floor())) * at.fract()
}

/// A naive forecast as it was, or would have been, made before a week, and what came.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hindcast {
    /// The stage then.
    pub stage: Stage,
    /// What would have come without later purchases, less the point, in shares of what was to move: a forecast does not
    /// foresee what a person decides to buy.
    pub error: f64,
    /// Whether the interval held what came, purchases included.
    pub held: bool,
    /// Week after which the outcome is known.
    due: usize,
    /// The error in intervals.
    intervals: f64,
}

/// Naive forecasts a horizon ahead before each of the weeks that ran, as far as what came is known.
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

/// Index of the week that ends a horizon after the beginning of another. A bankrupt company keeps its last cash: without that,
/// only those that fared well would be measured.
fn due(weeks: &[WeekFigures], before: usize, horizon: u32) -> Option<usize> {
    let day = weeks[before].day - weeks[before].days_run + horizon;
    let last = weeks.last().filter(|last| last.cash < 0.0 && last.day < day);
    weeks.binary_search_by_key(&day, |week| week.day).ok().or(last.map(|_| weeks.len() - 1))
}

/// Cash on the decision day of a week, when its purchases were made.
fn cash_before(week: &WeekFigures) -> f64 {
    week.cash - week.cash_change + purchases(week)
}

/// What a week booked for research and studies, negative.
fn purchases(week: &WeekFigures) -> f64 {
    let kinds = [Category::ResearchProject, Category::MarketResearch, Category::GroupResearch];
    kinds.iter().map(|category| week.booked.of(*category)).sum()
}

/// What the settings of a week committed to, dollars a day.
fn committed(week: &WeekFigures) -> f64 {
    let kinds = [Category::Capacity, Category::Operations, Category::Development, Category::Advertising];
    -kinds.iter().map(|category| week.booked.of(*category)).sum::<f64>() / f64::from(week.days_run.max(1))
}

/// Dollars that go in and out until a horizon at a pace.
fn moved(pace: &Pace, horizon: u32) -> f64 {
    (pace.income + pace.committed + pace.variable).max(LEAST) * f64::from(horizon)
}

/// How much wider an interval is than the measured one, by the forecasts that have come due before a week.
fn widening(made: &[Hindcast], before: usize) -> f64 {
    let known = made.iter().rev().filter(|hindcast| hindcast.due < before).take(REMEMBERED);
    let squares: Vec<f64> = known.map(|hindcast| hindcast.intervals * hindcast.intervals).collect();
    let mean = squares.iter().sum::<f64>() / squares.len().max(1) as f64;
    (OWN_ERROR * mean.sqrt()).max(1.0)
}

/// Naive forecasts of cash after the weeks that ran, at a pace.
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

    /// Weeks with these payments and a thousand dollars of advertising each.
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
        // The first is made before there is an income to see.
        assert_eq!(errors.len(), 17);
        assert!(errors[1..].iter().all(|own| own.error.abs() < 1e-9 && own.held));
        assert_eq!(widening(&errors[1..], 20), 1.0);
        let wild: Vec<f64> = (0..20).map(|at| if at % 8 < 4 { 100.0 } else { 90_000.0 }).collect();
        let errors = hindcasts(&weeks(&wild), 28, bands);
        assert!(errors.iter().any(|own| !own.held));
        assert!(widening(&errors, 20) > 1.5, "{}", widening(&errors, 20));
        let known = errors.iter().filter(|own| own.due < 10).count();
        assert_eq!(widening(&errors, 10), widening(&errors[..known], 20), "only what has come due is known");
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
        assert!(!later[4].held, "what is bought later is in what came");
    }

    #[test]
    fn bands_are_the_quantiles_of_measured_errors() {
        let errors: Vec<(Stage, u32, f64)> =
            (0..=1000).map(|at| (Stage::Steady, 7, f64::from(at) / 1000.0 - 0.4)).collect();
        let bands = Bands::measured(&errors, 1, 1);
        assert_eq!(bands.of(Stage::Steady, 7), (-0.38, 0.58));
        assert_eq!(bands.of(Stage::Steady, 30), (-0.38, 0.58), "the next shorter horizon");
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
