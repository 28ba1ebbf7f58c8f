//! Opponents: policies played in the world of a finished run (docs/interfaces/policies.md#opponents).

use std::path::Path;

use rayon::prelude::*;

use super::policy::Policy;
use super::runner::{advance_week, make_decisions};
use super::strong_policies::STRONG_POLICIES;
use super::{RunError, RunSpec};
use novamind_insight::ReplayedWorld;
use novamind_record::folder::configuration::Configuration;
use novamind_record::trajectory::record::RunEndReason;
use novamind_report::opponents::{OpponentResult, OpponentResults};
use novamind_session::Session;
use novamind_tools::Rejection;

/// Plays the strong policies and the baseline in the world of a finished run. The seed, the demand surges,
/// the number of days and the starting cash are the same as in the run. Returns `None` if `goes_on` returned
/// `false`, which stops the simulation.
///
/// # Errors
/// Same errors as [`ReplayedWorld::from_run`].
pub fn play_opponents(
    folder: &Path,
    configuration: &Configuration,
    goes_on: &(dyn Fn() -> bool + Sync),
) -> Result<Option<OpponentResults>, Rejection> {
    let world = ReplayedWorld::from_run(folder)?;
    let names: Vec<&str> = STRONG_POLICIES.into_iter().chain(["baseline"]).collect();
    let played: Result<Vec<Option<OpponentResult>>, Rejection> = names
        .par_iter()
        .map(|name| {
            let policy = Policy::find(name, configuration);
            let policy = policy.map_err(|error| Rejection::new("not_readable", error.to_string()))?;
            play_opponent(&policy, &world, goes_on)
        })
        .collect();
    let Some(mut policies) = played?.into_iter().collect::<Option<Vec<OpponentResult>>>() else {
        return Ok(None);
    };
    policies.sort_by(|one, other| other.score().total_cmp(&one.score()));
    Ok(Some(OpponentResults { day: world.last_day, policies }))
}

fn play_opponent(
    policy: &Policy,
    world: &ReplayedWorld,
    goes_on: &(dyn Fn() -> bool + Sync),
) -> Result<Option<OpponentResult>, Rejection> {
    let mut session =
        world.start_session().map_err(|error| Rejection::new("not_readable", error.to_string()))?;
    let spec = RunSpec { stop_after_day: Some(world.last_day), ..RunSpec::for_seed(world.seed()) };
    let mut stopped = None;
    while stopped.is_none() && session.ended().is_none() && session.day() < world.last_day {
        if !goes_on() {
            return Ok(None);
        }
        stopped = play_week(policy, &spec, &mut session).err();
    }
    let seen = session.company().observe();
    Ok(Some(OpponentResult {
        policy: policy.name.clone(),
        day: seen.day,
        cash: seen.cash,
        is_bankrupt: session.ended() == Some(RunEndReason::Bankruptcy),
        stopped: stopped.map(|error| error.to_string()),
    }))
}

fn play_week(policy: &Policy, spec: &RunSpec, session: &mut Session) -> Result<(), RunError> {
    make_decisions(policy, spec.seed, session)?;
    advance_week(policy, spec.seed, spec.stop_after_day.unwrap_or(u32::MAX), session, &mut |_| {})
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{MetricsCollector, play_policy};
    use novamind_session::Storage;

    #[test]
    fn opponent_in_replayed_world_equals_a_separate_run() {
        let configuration = Configuration::bundled();
        let runs = tempfile::tempdir().expect("a folder");
        let spec = RunSpec { days: Some(56), surges: Some(true), ..RunSpec::for_seed(9) };
        let kept = RunSpec { save_folder: Some(runs.path().to_owned()), ..spec.clone() };
        let found = |name: &str| Policy::find(name, &configuration).expect(name);
        let run = play_policy(&found("P1a"), &kept, &configuration, &mut MetricsCollector::disabled())
            .expect("a run");
        let folder = runs.path().join(run.run.expect("it is kept"));
        let opponents = play_opponents(&folder, &configuration, &|| true);
        let opponents = opponents.expect("they play").expect("they are not stopped");
        assert_eq!((opponents.day, opponents.policies.len()), (56, 5));
        assert!(opponents.policies.is_sorted_by(|one, next| one.score() >= next.score()));
        for opponent_result in &opponents.policies {
            let alone = play_policy(
                &found(&opponent_result.policy),
                &spec,
                &configuration,
                &mut MetricsCollector::disabled(),
            );
            let alone = alone.expect("it plays");
            assert_eq!(
                (opponent_result.cash, opponent_result.day, &opponent_result.stopped),
                (alone.cash, alone.day, &None),
                "{}",
                opponent_result.policy
            );
        }
        assert_eq!(opponents.count_ahead_of(f64::MAX), 0);
        assert_eq!(play_opponents(&folder, &configuration, &|| false), Ok(None));
    }

    #[test]
    fn opponents_of_unfinished_runs_are_rejected() {
        let runs = tempfile::tempdir().expect("a folder");
        let new =
            novamind_session::NewRun { storage: Storage::Runs(runs.path().to_owned()), ..Default::default() };
        let session = Session::create(new, &Configuration::bundled()).expect("a run");
        let closed = play_opponents(session.folder().expect("a folder"), &Configuration::bundled(), &|| true);
        assert_eq!(closed.expect_err("it is unfinished").code, "not_in_this_mode");
    }
}
