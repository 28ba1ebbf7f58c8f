//! Actions of a student in a lesson, and classes of students with their handouts (docs/lessons/classes.md).
//!
//! `novamind-record` defines lessons and the progress of a student. `novamind-session` applies a lesson while weeks
//! are simulated.

mod class;
mod lesson;

pub use class::class_file::{Class, HandoutSource};
pub use class::collected_class::CollectedClass;
pub use class::collection::{ClassCollection, CollectionInput};
pub use class::evidence::{ClassRun, Evidence, RunVerdict, StepEvidence};
pub use class::finding::ClassFinding;
pub use class::handout::Handout;
pub use class::reference::{ClassReference, ranked_goal, share_of_reference};
pub use lesson::answers::{measure_over_part, submit_guess, take_hint};
pub use lesson::debrief::{
    Debrief, DebriefStep, DecisionComparison, DecisionEffect, FinishedPart, FirstDifference, JudgedFigure,
    ReferenceCurve, ReferenceEffect,
};
pub use lesson::decisions::{DecisionDifference, DifferentDecision, SettingDifference};
pub use lesson::runs::{retry_step, start_part};
pub use lesson::status::{GoalStatus, LessonQuestion, LessonStatus};
pub use novamind_record::lesson::{
    CapacityControl, ForecastRequirement, GoalBound, Guess, GuessForm, Lesson, LessonAccess, LessonCall,
    LessonGoal, LessonPart, LessonPlan, LessonProgress, LessonStep, MEASURED_SEEDS, MeasuredFigure,
    MeasurementSpec, NumberSource, Pitfall, PitfallBound, RationaleRequirement, ReferencePlay,
    ScheduledCalls, WeekAggregation,
};
