//! The record of a run: its lines and their chain of hashes, its manifest, its folder with lock and configuration, and
//! what the first line says of the study, the lesson and the hand-out that the run belongs to. With them the data from which
//! lines are made: figures of a week, lessons and the standing of a student.

pub mod answer_book;
pub mod error;
pub mod figures;
pub mod folder;
pub mod lesson;
pub mod rules;
pub mod stamp;
pub mod trajectory;

pub use error::RunError;
