//! Interfaces for programs: the HTTP routes of the released simulator, and the Model Context Protocol
//! (docs/interfaces/http.md, docs/interfaces/mcp.md).
//!
//! One thread owns the session and executes requests one after the other. Network code runs on other threads and never
//! accesses the crate `session`. Programs use the same session as people, so calls, rejections and record lines are the
//! same.

mod agent_page;
mod announcement;
mod client;
mod committed;
mod current_request;
mod http;
mod inspect_log;
mod mcp;
mod non_finite;
mod openapi;
mod release_history;
mod remote;
mod request;
mod request_handler;
mod request_id;
mod schema;
mod transcript;
mod worker;
mod zip;

pub use agent_page::{PageContext, agent_page, write_documents};
pub use announcement::Announcement;
pub use client::write_client;
pub use http::{BoundPort, HttpOptions, serve_http};
pub use mcp::{reject_mcp_client, serve_mcp};
pub use release_history::{HistoryEntry, LineRemark, PlayedHistory, ReleaseHistory};
pub use remote::{RemoteServer, ServerResponse};
pub use schema::function_schemas;
pub use transcript::{ForeignCall, ForeignTranscript, PlayedTranscript};
