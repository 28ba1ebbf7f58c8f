//! Snapshots of a run: file format, sealing, and checks of trajectory and database.

pub(crate) mod file;
pub(crate) mod integrity;
pub(crate) mod sealing;
