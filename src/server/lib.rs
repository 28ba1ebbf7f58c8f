//! Programs play through it: the routes of the released simulator over HTTP, and the Model Context Protocol
//! (docs/interfaces/http.md, docs/interfaces/mcp.md).
//!
//! One thread owns the session and answers one request after the other; what waits for the network runs beside it and never
//! enters `session`. Whoever comes in through a door meets the session that people play: the same calls, refusals and lines.

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
