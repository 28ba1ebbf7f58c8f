//! The snapshot of a run: its file, what seals it, and what it says about trajectory and database.

pub(crate) mod file;
pub(crate) mod integrity;
pub(crate) mod sealing;
