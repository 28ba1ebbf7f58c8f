//! Classes: handouts of an instructor, and the submissions of students (docs/lessons/classes.md).
//!
//! Every student has a separate handout: the lesson, or the past of a run, with a label and the name of the run that it
//! creates. Runs that started from a handout carry the stamp of the class, so submissions from any number of machines can be
//! assigned to students.

pub(crate) mod class_file;
pub(crate) mod collected_class;
pub(crate) mod collection;
pub(crate) mod evidence;
pub(crate) mod finding;
pub(crate) mod handout;
pub(crate) mod handout_run;
pub(crate) mod reference;
