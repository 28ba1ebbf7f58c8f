//! The world of a finished run for another player: the same random draws, from day 0.

use std::path::Path;

use crate::counterfactual::past::Past;
use crate::counterfactual::script::Move;
use crate::why::{Sight, sight};
use novamind_record::error::RunError;
use novamind_record::folder::manifest::Manifest;
use novamind_record::lesson::Lesson;
use novamind_record::mode::Mode;
use novamind_record::rules::SessionRules;
use novamind_session::{Session, new_id, not_readable};
use novamind_tools::Refusal;

/// The world of a run.
#[derive(Debug)]
pub struct SameWorld {
    manifest: Manifest,
    /// Day on which scores are compared: the last day of the run, or of its part of a lesson.
    pub last_day: u32,
}

impl SameWorld {
    /// Reads the world of the run in a folder.
    ///
    /// # Errors
    /// `not_in_this_mode` if the run is unfinished and not a debug run, or if its study shows no results; `not_possible` if
    /// parameters were changed during the run, or if its lesson starts with preset decisions; `not_readable`.
    pub fn of(folder: &Path) -> Result<SameWorld, Refusal> {
        let past = Past::read(folder).map_err(|error| not_readable(&error))?;
        if sight(&past.manifest, past.ended)? != Sight::All {
            let message = "opponents can play only the world of a finished run. End this run first";
            return Err(Refusal::new("not_in_this_mode", message));
        }
        let not_possible = |message: &str| Err(Refusal::new("not_possible", message));
        if past.between(0, u32::MAX).iter().any(|step| matches!(step, Move::Parameter(_))) {
            return not_possible(
                "parameters were changed during this run, so its world cannot be reproduced",
            );
        }
        if begins_played(folder, &past.manifest).map_err(|error| not_readable(&error))? {
            return not_possible(
                "this part of the lesson starts with an existing company, but opponents start with an empty one",
            );
        }
        let last_day = if past.manifest.lesson.is_some() { past.last_day() } else { past.manifest.days };
        Ok(SameWorld { manifest: past.manifest, last_day })
    }

    /// Returns the seed of the random draws.
    pub fn seed(&self) -> u64 {
        self.manifest.seed
    }

    /// Starts a debug run in this world, in memory and without a database.
    ///
    /// # Errors
    /// Returns an error if this program does not support the parameters of the run.
    pub fn begin(&self) -> Result<Session, RunError> {
        let manifest = Manifest {
            id: new_id(),
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
            rules: Some(SessionRules::of_mode(Mode::Debug)),
            earlier: Vec::new(),
            ..self.manifest.clone()
        };
        Session::begin_in_memory(manifest)
    }
}

/// Whether a lesson starts with simulated weeks or preset decisions.
fn begins_played(folder: &Path, manifest: &Manifest) -> Result<bool, RunError> {
    let Some(stamp) = &manifest.lesson else { return Ok(false) };
    let lesson = Lesson::of_run(folder, &stamp.name)?;
    let part = lesson.plan.parts.get(stamp.part.saturating_sub(1) as usize);
    Ok(part.is_some_and(|part| !part.begins_empty()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::counterfactual::test_kit::played;

    #[test]
    fn it_is_the_world_before_the_first_decision() {
        let runs = tempfile::tempdir().expect("a folder");
        let session = played(runs.path(), Mode::Debug, 3, None);
        let world = SameWorld::of(session.folder().expect("a folder")).expect("a world");
        assert_eq!((world.seed(), world.last_day), (3, 120));
        let other = world.begin().expect("a run");
        assert_eq!(
            (other.day(), other.company().observe().cash, other.params()),
            (0, 50_000_000.0, session.params())
        );
    }

    #[test]
    fn it_is_closed_while_a_run_goes_on_and_where_parameters_were_set() {
        let runs = tempfile::tempdir().expect("a folder");
        let mut sandbox = played(runs.path(), Mode::Sandbox, 3, None);
        let folder = sandbox.folder().expect("a folder").to_owned();
        assert_eq!(SameWorld::of(&folder).expect_err("an unfinished run").code, "not_in_this_mode");
        sandbox.end().expect("the run ends");
        sandbox.save().expect("it is saved");
        SameWorld::of(&folder).expect("a finished run");
        let mut debug = played(runs.path(), Mode::Debug, 3, None);
        debug.set_parameter("demand_surge.probability", &0.5.into(), None).expect("it is set");
        debug.save().expect("it is saved");
        let closed = SameWorld::of(debug.folder().expect("a folder")).expect_err("a changed parameter");
        assert_eq!(closed.code, "not_possible");
    }
}
