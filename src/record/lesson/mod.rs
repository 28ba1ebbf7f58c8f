//! Lessons: their definition, and the recorded progress of a student (docs/lessons/authors-guide.md).
//!
//! A lesson has parts. Each part is a separate company that is recorded as a run. A part has steps of one or more
//! weeks. A step has goals, hints, and optionally a question before it is simulated. Lines of kind `lesson` record the
//! progress of a student.

mod completion;
mod definition;
mod lesson_call;
mod lesson_file;
mod measurement;
mod progress;
mod validation;

pub use completion::is_lesson_over;
pub use definition::{
    CapacityControl, ForecastRequirement, GoalBound, Guess, GuessForm, LessonAccess, LessonGoal, LessonPart,
    LessonPlan, LessonStep, MEASURED_SEEDS, MeasuredFigure, OutcomeTiming, Pitfall, PitfallBound,
    RationaleRequirement, ReferencePlay, ScheduledCalls,
};
pub use lesson_call::LessonCall;
pub use lesson_file::{Lesson, PLAN_FILE, TEXTS_FILE};
pub use measurement::{MeasurementSpec, NumberSource, WeekAggregation};
pub use progress::LessonProgress;
