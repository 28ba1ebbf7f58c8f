//! Start of a lesson and of its steps, and completion of an interrupted start.

use super::progress::{lesson_step, weeks_passed};
use std::path::Path;
use std::sync::Arc;

use crate::company::reports::DayReport;
use crate::create::lesson_entry::LessonOptions;
use crate::play::Session;
use novamind_record::error::RunError;
use novamind_record::lesson::{Lesson, LessonCall, LessonProgress};
use novamind_record::trajectory::record::{Activity, LessonEvent, RecordedLessonEvent, Via};
use novamind_record::trajectory::{Line, Record, Trajectory};
use novamind_tools::Rejection;

impl Session {
    /// Executes the initial calls and weeks of a lesson, before the student can make decisions. Calls `progress` for
    /// each simulated day.
    ///
    /// # Errors
    /// One of the initial calls is rejected.
    pub(crate) fn start_lesson(
        &mut self,
        entry: &LessonOptions,
        progress: &mut dyn FnMut(&DayReport<'_>),
    ) -> Result<(), RunError> {
        let LessonOptions { lesson, part, is_judged } = entry;
        self.lesson = Some(Box::new(LessonProgress {
            lesson: lesson.clone(),
            part: *part,
            is_judged: *is_judged,
            events: Vec::new(),
        }));
        self.continue_start(0, progress)
    }

    /// Continues the start of a lesson in the current week, whose first `made` calls are recorded already. Then starts
    /// the first step.
    fn continue_start(
        &mut self,
        made: usize,
        progress: &mut dyn FnMut(&DayReport<'_>),
    ) -> Result<(), RunError> {
        let Some(lesson_progress) = self.lesson.as_deref() else { return Ok(()) };
        let (lesson, part) = (lesson_progress.lesson.clone(), lesson_progress.part);
        let start = &lesson.plan.parts[part];
        let first = weeks_passed(self);
        for week in first..=start.start_weeks {
            let due = start
                .start
                .iter()
                .filter(|scheduled_calls| scheduled_calls.week == week)
                .flat_map(|calls| &calls.calls);
            for call in due.skip(if week == first { made } else { 0 }) {
                self.execute_start_call(call).map_err(|rejection| {
                    RunError::InvalidRequest(format!("lesson {} cannot start: {rejection}", lesson.name))
                })?;
            }
            if week < start.start_weeks {
                let forecasts = self.company().naive_forecasts();
                let refused = |rejection: Rejection| RunError::InvalidRequest(rejection.to_string());
                self.advance("the start of the lesson", &forecasts, Via::Lesson, progress)
                    .map_err(refused)?;
            }
        }
        self.start_step(0, 1).map_err(|rejection| RunError::InvalidRequest(rejection.to_string()))
    }

    fn execute_start_call(&mut self, call: &LessonCall) -> Result<(), Rejection> {
        match call {
            LessonCall::Tool(tool, args) => self.call(tool, args, Via::Lesson).map(|_| ()),
            LessonCall::Rules(_) => Err(Rejection::new(
                "not_possible",
                "rules cannot answer enterprises at the start of a lesson",
            )),
        }
    }

    pub(super) fn start_step(&mut self, step: usize, number: u32) -> Result<(), Rejection> {
        let Some(lesson_step) =
            self.lesson.as_deref().and_then(|lesson_progress| lesson_progress.step(step)).cloned()
        else {
            return Ok(());
        };
        for (key, value) in &lesson_step.parameters {
            let value = serde_json::to_value(value).unwrap_or_default();
            self.set_lesson_parameter(key, &value)?;
        }
        let note = RecordedLessonEvent {
            number: Some(number),
            ..RecordedLessonEvent::new(LessonEvent::Begun, step as u32 + 1)
        };
        self.record_lesson_event(note)
    }

    /// Restores the lesson of a run that was reopened.
    ///
    /// # Errors
    /// The lesson in the run folder is missing or invalid, or differs from the lesson in the first line.
    pub(crate) fn resume_lesson(&mut self, folder: &Path, lines: &[Line]) -> Result<(), RunError> {
        let Some(stamp) = self.manifest().lesson.clone() else { return Ok(()) };
        let lesson = Lesson::from_run(folder, &stamp.name)?;
        let part = stamp.part as usize;
        if lesson.digest != stamp.digest || !(1..=lesson.plan.parts.len()).contains(&part) {
            return Err(RunError::Damaged {
                path: folder.join("lesson.toml"),
                line: 1,
                problem: format!("this file is not the recorded lesson, {}", stamp.name),
                remedy: "The trajectory was not changed; restore lesson.toml and lesson.md from a copy to open the run"
                    .to_owned(),
            });
        }
        self.lesson = Some(Box::new(LessonProgress::from_lines(Arc::new(lesson), part - 1, lines)));
        // The program may have stopped after simulating a week and before judging it.
        let is_open = |line: &Line| {
            matches!(
                line.record,
                Record::Week(_) | Record::Override(_) | Record::Activity(Activity::Lesson(_))
            )
        };
        if self.log().is_written() && lines.last().is_some_and(is_open) && !is_unstarted_attempt(lines) {
            self.finish_lesson_week();
        }
        Ok(())
    }

    /// Starts the first step of a lesson, or a step that the student repeats, if the program stopped before the step
    /// started. The caller must first simulate an interrupted week.
    ///
    /// # Errors
    /// The start of the lesson is rejected.
    pub(crate) fn finish_start(&mut self, lines: &[Line]) -> Result<(), RunError> {
        let is_open = self.log().is_written() && self.ended().is_none();
        let Some(lesson_progress) = self.lesson.as_deref().filter(|_| is_open) else { return Ok(()) };
        let Some(step) = lesson_step(self).filter(|step| !lesson_progress.has_started(*step)) else {
            return Ok(());
        };
        if is_unstarted_attempt(lines) {
            let number = self.parent_attempts(step) + 1;
            return self
                .start_step(step, number)
                .map_err(|rejection| RunError::InvalidRequest(rejection.to_string()));
        }
        if step == 0 { self.continue_start(self.count_start_calls(lines), &mut |_| {}) } else { Ok(()) }
    }

    fn count_start_calls(&self, lines: &[Line]) -> usize {
        let day = self.day();
        let after = lines.iter().rposition(Line::closes_days).map_or(0, |week| week + 1);
        let calls =
            lines[after..].iter().filter(|line| line.day == day && line.record.accepted_call().is_some());
        calls.count()
    }

    fn parent_attempts(&self, step: usize) -> u32 {
        let runs = self.folder().and_then(Path::parent);
        let parent = self.manifest().parent.as_ref().zip(runs);
        let read = parent.and_then(|(parent, runs)| {
            Trajectory::read(&runs.join(&parent.run).join("trajectory.jsonl")).ok()
        });
        let number = read.zip(self.lesson.as_deref()).map(|(parent, lesson_progress)| {
            LessonProgress::from_lines(lesson_progress.lesson.clone(), lesson_progress.part, &parent.lines)
                .attempt(step)
        });
        number.unwrap_or(1).max(1)
    }
}

fn is_unstarted_attempt(lines: &[Line]) -> bool {
    let begins = |line: &Line| match &line.record {
        Record::Activity(Activity::Lesson(note)) => note.event == LessonEvent::Begun,
        _ => false,
    };
    let branch = lines.iter().rposition(|line| matches!(line.record, Record::Branch(_)));
    branch.is_some_and(|branch| !lines[branch..].iter().any(begins))
}
