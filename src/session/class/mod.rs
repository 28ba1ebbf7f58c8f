//! Classes: what an instructor hands out, what students begin with it, and what comes back (docs/lessons/classes.md).
//!
//! Every student has a hand-out of their own: the lesson, or the past of a run, with a label and the name of the run that it
//! begins. Runs that began with it carry the stamp of the class, so that what comes back from any number of machines is
//! told apart.

pub(in crate::session) mod class_file;
pub(in crate::session) mod collected_class;
pub(in crate::session) mod collecting;
pub(in crate::session) mod evidence;
pub(in crate::session) mod finding;
pub(in crate::session) mod handed_run;
pub(in crate::session) mod handout;
pub(in crate::session) mod reference;
pub(in crate::session) mod stamp;
