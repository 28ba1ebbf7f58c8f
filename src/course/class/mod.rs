//! Classes: what an instructor hands out, what students begin with it, and what comes back (docs/lessons/classes.md).
//!
//! Every student has a hand-out of their own: the lesson, or the past of a run, with a label and the name of the run that it
//! begins. Runs that began with it carry the stamp of the class, so that what comes back from any number of machines is
//! told apart.

pub(crate) mod class_file;
pub(crate) mod collected_class;
pub(crate) mod collecting;
pub(crate) mod evidence;
pub(crate) mod finding;
pub(crate) mod handed_run;
pub(crate) mod handout;
pub(crate) mod reference;
