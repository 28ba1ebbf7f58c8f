//! The record of a run: its lines and their chain of hashes, its manifest, its folder with lock and configuration, and
//! what the first line says of the study, the lesson and the hand-out that the run belongs to.
//!
//! Modules from bottom to top: `clock`, `mode`; `consent`, `rules`, `stamp`; `error`; `files`; `trajectory`; `answer_book`,
//! `folder`.

pub mod answer_book;
pub mod clock;
pub mod consent;
pub mod error;
pub mod files;
pub mod folder;
pub mod mode;
pub mod rules;
pub mod stamp;
pub mod trajectory;

pub use error::RunError;
