//! Courses: classes of students, their hand-outs, and what comes back from them (docs/lessons/classes.md).

mod class;

pub use class::class_file::{Class, ToHandOut};
pub use class::collected_class::CollectedClass;
pub use class::collecting::{ClassCollection, ClassSources};
pub use class::evidence::{ClassRun, Evidence, RunVerdict, StepEvidence};
pub use class::finding::ClassFinding;
pub use class::handout::Handout;
pub use class::reference::{ClassReference, ranked_goal, share_of_good};
