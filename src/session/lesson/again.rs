//! Trying a step of a lesson again, from its beginning, in a run of its own.

use super::conduct::LessonEntry;
use crate::create::{NewRun, Storage};
use crate::resume::branch::branch_of_lesson;
use crate::state::Session;
use novamind_record::folder::configuration::Configuration;
use novamind_record::mode::Mode;
use novamind_record::stamp::HandoutEntry;
use novamind_record::trajectory::Trajectory;
use novamind_record::trajectory::record::{LessonEvent, LessonNote};
use novamind_tools::Refusal;

impl Session {
    /// Tries a step again from its beginning, counted from 0: a run of its own, which counts the try.
    ///
    /// # Errors
    /// `not_in_a_lesson`, `step_unknown` for a step that has not begun, `not_saved`.
    pub fn try_step_again(&self, step: usize) -> Result<Session, Refusal> {
        let Some(standing) = self.lesson() else {
            return Err(Refusal::new("not_in_a_lesson", "this run belongs to no lesson"));
        };
        if !standing.has_begun(step) {
            let message = format!("choose a step from 1 to {}", standing.last_begun() + 1);
            return Err(Refusal::at("step", "step_unknown", message));
        }
        let Some(folder) = &self.folder else {
            return Err(Refusal::new("not_saved", "a run in memory cannot be tried again"));
        };
        let refused = |error: novamind_record::error::RunError| Refusal::new("not_saved", error.to_string());
        let trajectory = Trajectory::read(&folder.join("trajectory.jsonl")).map_err(refused)?;
        let begun = standing.own_part().weeks_of(step).0 * self.simulation.params.run.days_per_week;
        let mut again = branch_of_lesson(folder, &self.manifest, &trajectory, begun)?;
        again.company_answers = self.company_answers;
        // Whoever has seen what came of it is not asked again: the first guess stands.
        if let Some(value) = standing.guess(step) {
            let about = LessonNote::about(LessonEvent::Guess, step as u32 + 1);
            again.note_lesson(LessonNote { value: Some(value), ..about }).map_err(refused)?;
        }
        Ok(again)
    }

    /// Begins another part of the lesson of this run, counted from 0, in the same folder of runs.
    ///
    /// # Errors
    /// `not_in_a_lesson`, `part_unknown`, `not_saved`.
    pub fn begin_part(&self, part: usize) -> Result<Session, Refusal> {
        let Some(standing) = self.lesson() else {
            return Err(Refusal::new("not_in_a_lesson", "this run belongs to no lesson"));
        };
        let parts = standing.lesson.plan.parts.len();
        if part >= parts {
            return Err(Refusal::at("part", "part_unknown", format!("choose a part from 1 to {parts}")));
        }
        let runs = self.folder.as_deref().and_then(|folder| folder.parent());
        let Some(runs) = runs else {
            return Err(Refusal::new("not_saved", "a run in memory has no other parts"));
        };
        let new = NewRun {
            mode: Mode::Lesson,
            participant: self.manifest.participant.clone(),
            lesson: Some(LessonEntry { lesson: standing.lesson.clone(), part, is_judged: true }),
            handout: self.manifest.handout.clone().map(HandoutEntry::of_later_run),
            storage: Storage::Runs(runs.to_owned()),
            ..NewRun::default()
        };
        let mut begun = Session::create(new, &Configuration::shipped())
            .map_err(|error| Refusal::new("not_saved", error.to_string()))?;
        begun.company_answers = self.company_answers;
        Ok(begun)
    }
}
