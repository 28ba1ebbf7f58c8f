//! The world of a finished run. A policy can play this world from day 0 with the random draws of the run.

use std::path::Path;

use crate::causes::{InputVisibility, input_visibility};
use crate::counterfactual::recorded_run::RecordedRun;
use crate::counterfactual::recorded_steps::RecordedStep;
use novamind_record::error::RunError;
use novamind_record::folder::manifest::Manifest;
use novamind_record::lesson::Lesson;
use novamind_record::mode::Mode;
use novamind_record::rules::SessionRules;
use novamind_session::{Session, new_run_id, unreadable_record_rejection};
use novamind_tools::Rejection;

/// The world of a finished run.
#[derive(Debug)]
pub struct ReplayedWorld {
    manifest: Manifest,
    /// Day on which scores are compared: the last day of the run or of the run's lesson part.
    pub last_day: u32,
}

impl ReplayedWorld {
    /// Reads the world of a finished run.
    ///
    /// # Errors
    /// `not_in_this_mode` if the run is unfinished and not a debug run, or if its study shows no results;
    /// `not_possible` if parameters were changed during the run, or if its lesson starts with preset decisions;
    /// `not_readable`.
    pub fn from_run(folder: &Path) -> Result<ReplayedWorld, Rejection> {
        let past = RecordedRun::open(folder).map_err(|error| unreadable_record_rejection(&error))?;
        if input_visibility(&past.manifest, past.is_ended)? != InputVisibility::EveryInput {
            let message = "opponents can play only the world of a finished run. End this run first";
            return Err(Rejection::new("not_in_this_mode", message));
        }
        let not_possible = |message: &str| Err(Rejection::new("not_possible", message));
        if past.steps_between(0, u32::MAX).iter().any(|step| matches!(step, RecordedStep::Parameter(_))) {
            return not_possible(
                "parameters were changed during this run, so its world cannot be reproduced",
            );
        }
        if has_preset_decisions(folder, &past.manifest)
            .map_err(|error| unreadable_record_rejection(&error))?
        {
            return not_possible(
                "this part of the lesson starts with an existing company, but opponents start with a new company",
            );
        }
        let last_day = if past.manifest.lesson.is_some() { past.last_day() } else { past.manifest.days };
        Ok(ReplayedWorld { manifest: past.manifest, last_day })
    }

    /// Returns the seed of the world's random draws.
    pub fn seed(&self) -> u64 {
        self.manifest.seed
    }

    /// Starts a debug run in the world, in memory and without a database.
    ///
    /// # Errors
    /// Returns an error if the program does not support the parameters of the run.
    pub fn start_session(&self) -> Result<Session, RunError> {
        let manifest = Manifest {
            id: new_run_id(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            mode: Mode::Debug,
            participant: None,
            earlier_runs: 0,
            consent: None,
            parent: None,
            study: None,
            lesson: None,
            handout: None,
            voice: None,
            rules: Some(SessionRules::for_mode(Mode::Debug)),
            earlier: Vec::new(),
            ..self.manifest.clone()
        };
        Session::create_in_memory(manifest)
    }
}

/// Returns whether the lesson part of a run starts with simulated weeks or preset decisions.
fn has_preset_decisions(folder: &Path, manifest: &Manifest) -> Result<bool, RunError> {
    let Some(stamp) = &manifest.lesson else { return Ok(false) };
    let lesson = Lesson::from_run(folder, &stamp.name)?;
    let part = lesson.plan.parts.get(stamp.part.saturating_sub(1) as usize);
    Ok(part.is_some_and(|part| !part.starts_empty()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::counterfactual::test_kit::play_weeks;

    #[test]
    fn replayed_world_equals_state_before_first_decision() {
        let runs = tempfile::tempdir().expect("a folder");
        let session = play_weeks(runs.path(), Mode::Debug, 3, None);
        let world = ReplayedWorld::from_run(session.folder().expect("a folder")).expect("a world");
        assert_eq!((world.seed(), world.last_day), (3, 120));
        let other = world.start_session().expect("a run");
        assert_eq!(
            (other.day(), other.company().observe().cash, other.params()),
            (0, 50_000_000.0, session.params())
        );
    }

    #[test]
    fn replayed_world_rejects_unfinished_runs_and_changed_parameters() {
        let runs = tempfile::tempdir().expect("a folder");
        let mut sandbox = play_weeks(runs.path(), Mode::Sandbox, 3, None);
        let folder = sandbox.folder().expect("a folder").to_owned();
        assert_eq!(ReplayedWorld::from_run(&folder).expect_err("an unfinished run").code, "not_in_this_mode");
        sandbox.abandon().expect("the run ends");
        sandbox.save().expect("it is saved");
        ReplayedWorld::from_run(&folder).expect("a finished run");
        let mut debug = play_weeks(runs.path(), Mode::Debug, 3, None);
        debug.set_parameter("demand_surge.probability", &0.5.into(), None).expect("it is set");
        debug.save().expect("it is saved");
        let closed =
            ReplayedWorld::from_run(debug.folder().expect("a folder")).expect_err("a changed parameter");
        assert_eq!(closed.code, "not_possible");
    }
}
