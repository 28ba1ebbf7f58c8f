//! Back-test of the outlook: companies are played, and the cash that the outlook expected before each week is compared
//! with the actual cash.

use std::collections::BTreeMap;
use std::path::Path;

use super::policy::Policy;
use super::runner::{RunError, RunSpec, advance_week, is_over, make_decisions, new_run};
use novamind_record::error::RunError as SessionError;
use novamind_record::folder::configuration::Configuration;
use novamind_record::trajectory::record::{Record, RunEndReason};
use novamind_session::{
    Category, ErrorIntervals, ForecastError, GrowthStage, Level, Playback, SeekTarget, Session,
    cash_at_week_end,
};
use novamind_world::params::Params;

/// Returns the forecast horizons in days.
pub fn forecast_horizons() -> Vec<u32> {
    Params::bundled().limits.prediction_horizons_days
}

/// The forecasts for a company, with their outcomes.
#[derive(Debug, Clone, PartialEq)]
pub struct CompanyForecasts {
    /// Name of the policy or of the recorded run.
    pub name: String,
    forecasts: Vec<PastForecast>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct PastForecast {
    stage: GrowthStage,
    horizon: u32,
    /// Expected cash, dollars.
    expected: f64,
    /// Amount to which errors are proportional, dollars.
    scale: f64,
    /// Ends of the cash range of each level, dollars.
    ranges: [(f64, f64); 2],
    /// Cash at the end of the week that ends on the due day, or 0 after a bankruptcy, dollars.
    outcome: f64,
    /// Income and costs from the forecast to its outcome, without one-time costs, dollars.
    turnover: f64,
}

/// The results of the forecasts for one growth stage and one horizon.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct StageResult {
    /// Number of companies with forecasts.
    pub companies: usize,
    /// Number of forecasts whose outcome is known.
    pub forecasts: usize,
    /// Mean absolute error, as a share of income and costs until the horizon.
    pub mean_error: f64,
    /// Median absolute error, as a share of income and costs until the horizon.
    pub median_error: f64,
    /// Share of the outcomes within the 80 % range.
    pub covered_80: f64,
    /// Share of the outcomes within the 95 % range.
    pub covered_95: f64,
}

/// Plays a policy and returns the forecasts before each week. If `scenario` is `None`, the policy's scenario
/// is used.
///
/// # Errors
/// Fails if the run cannot start or a tool rejects a call that must succeed.
pub fn backtest_policy(
    policy: &Policy,
    seed: u64,
    scenario: Option<&str>,
    configuration: &Configuration,
) -> Result<CompanyForecasts, RunError> {
    let spec = RunSpec { scenario: scenario.map(str::to_owned), ..RunSpec::for_seed(seed) };
    let mut session = Session::create(new_run(policy, &spec), configuration)?;
    let mut made = Vec::new();
    while !is_over(&session, &spec) {
        make_decisions(policy, seed, &mut session)?;
        made.extend(current_forecasts(&session));
        advance_week(policy, seed, u32::MAX, &mut session, &mut |_| {})?;
    }
    Ok(CompanyForecasts::with_outcomes(policy.name.clone(), made, &session))
}

/// Replays a recorded run and returns the forecasts before each recorded week.
///
/// # Errors
/// Fails if the run cannot be read, or if a line does not reproduce the recorded state.
pub fn backtest_recorded_run(folder: &Path) -> Result<CompanyForecasts, SessionError> {
    let mut playback = Playback::open(folder)?;
    let starts: Vec<usize> = playback
        .lines()
        .iter()
        .enumerate()
        .filter(|(_, line)| matches!(line.record, Record::Advance(_)))
        .map(|(at, _)| at)
        .collect();
    let (mut made, mut applied) = (Vec::new(), 1);
    let mut seek = |playback: &mut Playback, lines: usize| {
        let ahead = lines as i64 - applied as i64;
        applied = lines;
        playback.seek(SeekTarget::Lines(ahead as _), &mut |_| std::ops::ControlFlow::Continue(())).map(|_| ())
    };
    for start in starts {
        seek(&mut playback, start)?;
        made.extend(current_forecasts(playback.session()));
    }
    let last = playback.lines().len();
    seek(&mut playback, last)?;
    let name = folder.file_name().map_or(String::new(), |name| name.to_string_lossy().into_owned());
    Ok(CompanyForecasts::with_outcomes(name, made, playback.session()))
}

/// Returns the forecasts on a decision day with their due days. The outcomes are not known yet.
fn current_forecasts(session: &Session) -> Vec<(u32, PastForecast)> {
    let outlook = session.company().outlook();
    let forecast = |horizon: u32| PastForecast {
        stage: outlook.stage,
        horizon,
        expected: outlook.expected_cash(horizon),
        scale: outlook.error_scale(horizon),
        ranges: [Level::Central80, Level::Central95].map(|level| outlook.range(horizon, level)),
        outcome: 0.0,
        turnover: 0.0,
    };
    forecast_horizons().into_iter().map(|horizon| (session.day(), forecast(horizon))).collect()
}

impl CompanyForecasts {
    fn with_outcomes(name: String, made: Vec<(u32, PastForecast)>, session: &Session) -> CompanyForecasts {
        let went_bankrupt = session.ended() == Some(RunEndReason::Bankruptcy);
        let scored = made.into_iter().filter_map(|(day, forecast)| {
            let due = day + forecast.horizon;
            // After a bankruptcy, the outcome is 0. If these forecasts were omitted, only successful
            // companies would be measured.
            let outcome = match cash_at_week_end(session.weeks(), due) {
                Some(cash) => cash.max(0.0),
                None if went_bankrupt => 0.0,
                None => return None,
            };
            Some(PastForecast { outcome, turnover: turnover(session, day, due), ..forecast })
        });
        CompanyForecasts { name, forecasts: scored.collect() }
    }
}

/// Returns the sum of the income and costs of the weeks between two days, without one-time costs, in dollars.
fn turnover(session: &Session, after: u32, until: u32) -> f64 {
    let one_time = [
        Category::InitialFunding,
        Category::MarketResearch,
        Category::GroupResearch,
        Category::ResearchProject,
    ];
    let weeks = session.weeks().iter().filter(|week| week.day > after && week.day < until + 7);
    let amounts = weeks.flat_map(|week| {
        let kept = week.booked.nonzero_totals().filter(|(category, _)| !one_time.contains(category));
        kept.map(|(_, dollars)| dollars.abs()).collect::<Vec<f64>>()
    });
    amounts.sum::<f64>().max(1.0)
}

/// Returns intervals that are fitted to the forecasts of companies.
pub fn measure_intervals(companies: &[CompanyForecasts]) -> ErrorIntervals {
    let errors: Vec<ForecastError> = companies
        .iter()
        .enumerate()
        .flat_map(|(company, all)| {
            all.forecasts.iter().map(move |forecast| ForecastError {
                company,
                stage: forecast.stage,
                horizon: forecast.horizon,
                error: (forecast.outcome - forecast.expected) / forecast.scale,
                expected: forecast.expected / forecast.scale,
            })
        })
        .collect();
    ErrorIntervals::from_errors(&errors, companies.len())
}

/// Returns the results of the bundled intervals by stage and horizon.
pub fn stage_results(companies: &[CompanyForecasts]) -> BTreeMap<(GrowthStage, u32), StageResult> {
    let mut cells: BTreeMap<(GrowthStage, u32), Vec<(usize, PastForecast)>> = BTreeMap::new();
    for (company, all) in companies.iter().enumerate() {
        for forecast in &all.forecasts {
            cells.entry((forecast.stage, forecast.horizon)).or_default().push((company, *forecast));
        }
    }
    cells.into_iter().map(|(cell, forecasts)| (cell, StageResult::from_forecasts(&forecasts))).collect()
}

impl StageResult {
    fn from_forecasts(forecasts: &[(usize, PastForecast)]) -> StageResult {
        let mut companies: Vec<usize> = forecasts.iter().map(|(company, _)| *company).collect();
        companies.dedup();
        let errors: Vec<f64> = forecasts
            .iter()
            .map(|(_, forecast)| (forecast.outcome - forecast.expected).abs() / forecast.turnover)
            .collect();
        let covered = |level: Level| {
            let inside = forecasts.iter().filter(|(_, forecast)| {
                let (lower, upper) = forecast.ranges[level as usize];
                (lower - 0.01..=upper + 0.01).contains(&forecast.outcome)
            });
            inside.count() as f64 / forecasts.len().max(1) as f64
        };
        StageResult {
            companies: companies.len(),
            forecasts: forecasts.len(),
            mean_error: novamind_base::statistics::mean(&errors),
            median_error: novamind_base::statistics::median(&errors).unwrap_or(0.0),
            covered_80: covered(Level::Central80),
            covered_95: covered(Level::Central95),
        }
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::random_settings::random_policy;
    use novamind_record::trajectory::record::Via;

    #[test]
    fn forecasts_of_a_played_company_are_scored_once_due() {
        let configuration = Configuration::bundled();
        let company = backtest_policy(&random_policy(2), 5, Some("short"), &configuration).expect("it plays");
        let weekly = company.forecasts.iter().filter(|forecast| forecast.horizon == 7).count();
        let monthly = company.forecasts.iter().filter(|forecast| forecast.horizon == 28).count();
        assert!(weekly > 4 && monthly == weekly - 3, "{weekly} {monthly}");
        let first = company.forecasts[0].stage;
        assert!(matches!(first, GrowthStage::Start | GrowthStage::Launching), "{first:?}");
        let results = stage_results(&[company.clone(), company]);
        assert_eq!(results[&(first, 7)].companies, 2);
        assert!(results.values().all(|result| (0.0..=1.0).contains(&result.covered_95)));
    }

    #[test]
    fn outcome_precedes_the_purchases_of_the_due_day() {
        let configuration = Configuration::bundled();
        let spec = RunSpec::for_seed(5);
        let mut session = Session::create(new_run(&random_policy(2), &spec), &configuration).expect("a run");
        let made = current_forecasts(&session);
        let forecasts = session.company().naive_forecasts();
        session.advance("a week", &forecasts, Via::Script, &mut |_| {}).expect("a week");
        let before = session.company().observe().cash;
        session.call("start_research_project", &json!({"tier": 1}), Via::Script).expect("a project");
        assert!(session.company().observe().cash < before);
        let scored = CompanyForecasts::with_outcomes(String::new(), made, &session);
        assert_eq!(scored.forecasts.iter().map(|forecast| forecast.outcome).collect::<Vec<_>>(), [before]);
    }

    #[test]
    fn recorded_run_is_scored_like_a_played_run() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/recorded/format2-sandbox");
        let company = backtest_recorded_run(&folder).expect("a recorded run");
        assert_eq!(company.forecasts.iter().filter(|forecast| forecast.horizon == 7).count(), 6);
        assert!(company.forecasts.iter().all(|forecast| forecast.scale > 0.0 && forecast.turnover > 0.0));
    }
}
