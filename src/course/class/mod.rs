//! Classes: handouts of an instructor, and the submissions of students (docs/lessons/classes.md).
//!
//! Every student has a separate handout. A handout contains the lesson or the past of a run, the student's label, and
//! the name of the run to create. The record of a run that started from a handout contains the stamp of the class.
//! Submissions from any number of machines can therefore be assigned to students.

pub(crate) mod class_file;
pub(crate) mod collected_class;
pub(crate) mod collection;
pub(crate) mod evidence;
pub(crate) mod finding;
pub(crate) mod handout;
pub(crate) mod handout_run;
pub(crate) mod reference;
