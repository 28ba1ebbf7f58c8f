//! The record of a run: lines with their hash chain, the manifest, the run folder with its lock, the configuration, and
//! the stamps of the study, lesson and handout of a run. The crate also defines the data that lines contain: figures of
//! a week, lessons and the progress of a student.
//!
//! Modules from bottom to top: `clock`, `mode`; `consent`, `rules`, `stamp`; `error`; `files`; `trajectory`;
//! `answered_questions`, `folder`; `figures`; `lesson`.

pub mod answered_questions;
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
