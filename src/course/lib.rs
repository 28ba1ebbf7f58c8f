//! Lessons from the student's side, and classes of students with their handouts (docs/lessons/classes.md).
//!
//! `novamind-record` defines lessons and the standing of a student. `novamind-session` applies a lesson while weeks pass.

mod class;
mod lesson;

pub use class::class_file::{Class, ToHandOut};
pub use class::collected_class::CollectedClass;
pub use class::collecting::{ClassCollection, ClassSources};
pub use class::evidence::{ClassRun, Evidence, RunVerdict, StepEvidence};
pub use class::finding::ClassFinding;
pub use class::handout::Handout;
pub use class::reference::{ClassReference, ranked_goal, share_of_good};
pub use lesson::answers::{guess_in_lesson, measure_over_part, take_hint};
pub use lesson::debrief::{
    Debrief, DebriefStep, DecisionComparison, DecisionEffect, FirstDifference, JudgedFigure, PartingEffect,
    PlayedPart, ReferenceCurve,
};
pub use lesson::decisions::{DecisionContrast, PartedDecision, SettingContrast};
pub use lesson::page::{GoalPage, LessonPage, LessonQuestion};
pub use lesson::runs::{begin_part, try_step_again};
pub use novamind_record::lesson::{
    CapacityMover, ForecastsAsked, GoalBound, Guess, GuessForm, Lesson, LessonAccess, LessonCall, LessonGoal,
    LessonPart, LessonPlan, LessonStanding, LessonStep, MEASURED_SEEDS, MeasuredFigure, Measurement,
    NumberSource, Over, Pitfall, PitfallBound, RationaleAsked, ReferencePlay, ScheduledCalls,
};
