//! Back-test of naive forecasts. Policies are played, and the naive forecast before each week is compared with the outcome.

use super::policy::Policy;
use super::runner::{RunError, RunSpec, play_all_weeks};
use novamind_record::figures::WeekFigures;
use novamind_record::folder::configuration::Configuration;
use novamind_session::{Coverage, ErrorIntervals, GrowthStage, Hindcast, hindcasts};
use novamind_world::params::Params;

/// Returns the forecast horizons in days.
pub fn forecast_horizons() -> Vec<u32> {
    Params::bundled().limits.prediction_horizons_days
}

/// The weeks of a run that a policy played.
#[derive(Debug, Clone)]
pub struct PlayedWeeks {
    /// Name of the policy that played the run.
    pub policy: String,
    /// Figures of the weeks, in order.
    pub weeks: Vec<WeekFigures>,
}

/// Plays a policy on a seed and returns the weeks of the run. Without a scenario, the policy's scenario is used.
///
/// # Errors
/// Fails if the run cannot start or a tool rejects a call that must succeed.
pub fn play_weeks(
    policy: &Policy,
    seed: u64,
    scenario: Option<&str>,
    configuration: &Configuration,
) -> Result<PlayedWeeks, RunError> {
    let spec = RunSpec { scenario: scenario.map(str::to_owned), ..RunSpec::for_seed(seed) };
    let weeks = play_all_weeks(policy, &spec, configuration)?;
    Ok(PlayedWeeks { policy: policy.name.clone(), weeks })
}

/// Returns forecast intervals that are fitted to the given runs, with their coverage in these runs.
pub fn measure_naive_intervals(runs: &[PlayedWeeks], horizons: &[u32], seeds: u64) -> ErrorIntervals {
    // The forecast errors do not depend on the intervals.
    let all = horizons.iter().flat_map(|horizon| runs.iter().map(move |run| (*horizon, run)));
    let errors: Vec<(GrowthStage, u32, f64)> = all
        .flat_map(|(horizon, run)| {
            let made = hindcasts(&run.weeks, horizon, ErrorIntervals::bundled());
            made.into_iter().map(move |hindcast| (hindcast.stage, horizon, hindcast.error))
        })
        .collect();
    let policies = policy_names(runs).len();
    let bands = ErrorIntervals::from_errors(&errors, policies, seeds);
    let coverage = horizons.iter().map(|horizon| interval_coverage(runs, None, *horizon, &bands)).collect();
    ErrorIntervals { coverage, ..bands }
}

/// Returns the coverage of the intervals at a horizon, over all runs or the runs of one policy.
pub fn interval_coverage(
    runs: &[PlayedWeeks],
    policy: Option<&str>,
    horizon: u32,
    bands: &ErrorIntervals,
) -> Coverage {
    let policy_runs = runs.iter().filter(|run| policy.is_none_or(|policy| run.policy == policy));
    let made: Vec<Hindcast> = policy_runs.flat_map(|run| hindcasts(&run.weeks, horizon, bands)).collect();
    let held = made.iter().filter(|hindcast| hindcast.is_covered).count();
    // The share is rounded to the displayed digits to keep the file readable.
    let share = if made.is_empty() { 0.0 } else { held as f64 / made.len() as f64 };
    Coverage { horizon, forecasts: made.len(), held: (share * 1e4).round() / 1e4 }
}

/// Returns the distinct policy names, in order.
pub fn policy_names(runs: &[PlayedWeeks]) -> Vec<&str> {
    let mut names: Vec<&str> = runs.iter().map(|run| run.policy.as_str()).collect();
    names.dedup();
    names
}

#[cfg(test)]
mod tests {
    use super::*;
    use novamind_session::JournalEntry;

    /// The forecast that is offered during play equals the forecast of the back-test.
    #[test]
    fn backtest_forecasts_equal_the_offered_forecasts() {
        let configuration = Configuration::bundled();
        let policy = Policy::find("P1c", &configuration).expect("a shipped policy");
        let spec = RunSpec { stop_after_day: Some(84), ..RunSpec::for_seed(5) };
        let session = super::super::runner::play_session(
            &policy,
            &spec,
            &configuration,
            &mut super::super::MetricsCollector::disabled(),
        )
        .expect("it plays");
        let filed: Vec<_> = session
            .journal()
            .iter()
            .filter_map(|entry| match entry {
                JournalEntry::Advance { day, forecasts, .. } => Some((*day, forecasts.clone())),
                _ => None,
            })
            .collect();
        let mut compared = 0;
        for horizon in [7, 28] {
            let made = hindcasts(session.weeks(), horizon, ErrorIntervals::bundled());
            for (hindcast, (day, forecasts)) in made.iter().zip(&filed) {
                let forecast = forecasts.iter().find(|one| one.horizon_days == horizon).expect("filed");
                let outcome = session.cash_by_day()[(day + horizon) as usize];
                let inside = (forecast.lower..=forecast.upper).contains(&outcome);
                assert_eq!(
                    inside, hindcast.is_covered,
                    "day {day}, {horizon} ahead: {outcome}, {forecast:?}"
                );
                compared += 1;
            }
        }
        assert_eq!(compared, 12 + 9);
    }
}
