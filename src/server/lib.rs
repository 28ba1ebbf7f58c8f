//! Interfaces for programs: the HTTP routes of the released simulator, and the Model Context Protocol (docs/interfaces/http.md,
//! docs/interfaces/mcp.md).
//!
//! One thread owns the session and executes requests one after the other. Network code runs next to it and never accesses
//! `session`. Programs use the same session as people, with the same calls, rejections and record lines.

mod announcement;
mod answering;
mod client;
mod http;
mod inspect_log;
mod mcp;
mod not_numbers;
mod openapi;
mod owner;
mod page;
mod remote;
mod request;
mod running;
mod schema;
mod transcript;
mod zip;

pub use announcement::Announcement;
pub use client::write_client;
pub use http::{HeldPort, HttpOptions, serve_http};
pub use mcp::{refuse_mcp, serve_mcp};
pub use page::{PageOf, page, write_documents};
pub use remote::{Remote, Reply};
pub use schema::functions;
pub use transcript::{ForeignCall, ForeignTranscript, PlayedTranscript};
