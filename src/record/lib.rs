//! The record of a run: its lines and their chain of hashes, its manifest, its folder with lock and configuration, and
//! what the first line states about the study, the lesson and the handout that the run belongs to. It also has the data from which
//! lines are made: figures of a week, lessons and the standing of a student.
//!
//! Modules from bottom to top: `clock`, `mode`; `consent`, `rules`, `stamp`; `error`; `files`; `trajectory`; `answer_book`,
//! `folder`; `figures`; `lesson`.

pub mod answer_book;
pub mod clock;
pub mod consent;
pub mod error;
pub mod figures;
pub mod files;
pub mod folder;
pub mod lesson;
pub mod mode;
pub mod rules;
pub mod stamp;
pub mod trajectory;

pub use error::RunError;
