//! The world of a run that is over, for somebody else to play: the same luck, from day 0.

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
    /// The day on which scores in it are compared: its last one, or the last of a part of a lesson.
    pub last_day: u32,
}

impl SameWorld {
    /// The world of the run in a folder.
    ///
    /// # Errors
    /// `not_in_this_mode` while the run goes on and is no debug run, or where a study shows no results; `not_possible` where
    /// parameters were set on the way, or a lesson played weeks before the student began; `not_readable`.
    pub fn of(folder: &Path) -> Result<SameWorld, Refusal> {
        let past = Past::read(folder).map_err(|error| not_readable(&error))?;
        if sight(&past.manifest, past.ended)? != Sight::All {
            let message = "opponents play the world of a run that is over: end it first";
            return Err(Refusal::new("not_in_this_mode", message));
        }
        let not_possible = |message: &str| Err(Refusal::new("not_possible", message));
        if past.between(0, u32::MAX).iter().any(|step| matches!(step, Move::Parameter(_))) {
            return not_possible(
                "parameters were set in this run while it went on: nobody else meets that world",
            );
        }
        if begins_played(folder, &past.manifest).map_err(|error| not_readable(&error))? {
            return not_possible(
                "this part of the lesson begins with a company: policies begin with an empty one",
            );
        }
        let last_day = if past.manifest.lesson.is_some() { past.last_day() } else { past.manifest.days };
        Ok(SameWorld { manifest: past.manifest, last_day })
    }

    /// Seed of its luck.
    pub fn seed(&self) -> u64 {
        self.manifest.seed
    }

    /// Begins a debug run in it, in memory and without a database.
    ///
    /// # Errors
    /// The parameters of the run are none of this program.
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

/// Whether a lesson played, or decided, something before its student did.
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
        assert_eq!(SameWorld::of(&folder).expect_err("it goes on").code, "not_in_this_mode");
        sandbox.end().expect("it is given up");
        sandbox.save().expect("it is saved");
        SameWorld::of(&folder).expect("it is over");
        let mut debug = played(runs.path(), Mode::Debug, 3, None);
        debug.set_parameter("demand_surge.probability", &0.5.into(), None).expect("it is set");
        debug.save().expect("it is saved");
        let closed = SameWorld::of(debug.folder().expect("a folder")).expect_err("it was set");
        assert_eq!(closed.code, "not_possible");
    }
}
