//! The door for clients of the Model Context Protocol, on standard input and output.

mod refusal;
mod resources;
mod stdio;
mod tools;

pub use refusal::refuse_mcp;

use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use rmcp::model::{
    CallToolRequestParams, CallToolResponse, Implementation, ListResourcesResult, ListToolsResult,
    PaginatedRequestParams, ReadResourceRequestParams, ReadResourceResponse, ServerCapabilities,
    ServerConfig, Tool,
};
use rmcp::service::RequestContext;
use rmcp::{ErrorData, RoleServer, ServerHandler, ServiceExt};

use super::announcement::Announcement;
use super::owner::{Door, Handle, OnDefect, Owner};
use super::page::{PageOf, goal_and_rules};
use super::request::Request;
use novamind_record::error::RunError;
use novamind_record::trajectory::record::Via;
use novamind_session::Session;
use novamind_tools::Numbers;

/// What a client is told first.
const INSTRUCTIONS: &str = "You run a simulated AI subscription company. Every tool call acts on the same run; time passes only \
     with next_week. Read the resources novamind://goal and novamind://manual first.";

/// Serves a run on standard input and output until the input ends; `on_defect` hears of defects of ours.
///
/// # Errors
/// The disk did not take the end of the record, or standard input and output cannot be used.
pub fn serve_mcp(session: Session, on_defect: OnDefect) -> Result<(), RunError> {
    let numbers = session.numbers();
    let folder = session.folder().map(PathBuf::from);
    let manifest = session.manifest();
    let goal = goal_and_rules(&PageOf { days: manifest.days, cash: manifest.cash, numbers: &numbers });
    let run = manifest.id.clone();
    if let Some(folder) = &folder {
        Announcement { run, port: None, pid: std::process::id(), token: None }.put_up(folder)?;
    }
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
    let runtime = runtime.map_err(RunError::io(Path::new("standard input")))?;
    let (owner, handle) = Owner::start(session, Door { via: Via::Mcp, interface: "mcp", on_defect });
    let served = runtime.block_on(async {
        let (streams, writing) = stdio::open();
        let running = McpDoor { handle, numbers, goal }.serve(streams).await.map_err(io::Error::other)?;
        let ended = running.waiting().await.map_err(io::Error::other);
        // What was answered last may not be written yet.
        writing.await.map_err(io::Error::other)?;
        ended
    });
    // Reading standard input cannot be cancelled, and nothing is waited for any more.
    runtime.shutdown_background();
    // While the run is still held: nobody else can have put up another one.
    if let Some(folder) = &folder {
        Announcement::take_down(folder);
    }
    owner.finish()?;
    served.map(drop).map_err(RunError::io(Path::new("standard input")))
}

/// One client and its run.
struct McpDoor {
    handle: Handle,
    numbers: Arc<Numbers>,
    /// Goal, calendar and rules of the run.
    goal: String,
}

impl ServerHandler for McpDoor {
    fn get_info(&self) -> ServerConfig {
        let capabilities = ServerCapabilities::builder().enable_tools().enable_resources().build();
        ServerConfig::new(capabilities)
            .with_server_info(Implementation::new("novamind", env!("CARGO_PKG_VERSION")))
            .with_instructions(INSTRUCTIONS)
    }

    async fn list_tools(
        &self,
        _: Option<PaginatedRequestParams>,
        _: RequestContext<RoleServer>,
    ) -> Result<ListToolsResult, ErrorData> {
        Ok(ListToolsResult::with_all_items(tools::all(&self.numbers)))
    }

    fn get_tool(&self, name: &str) -> Option<Tool> {
        tools::named(name, &self.numbers)
    }

    async fn call_tool(
        &self,
        request: CallToolRequestParams,
        _: RequestContext<RoleServer>,
    ) -> Result<CallToolResponse, ErrorData> {
        let arguments = request.arguments.unwrap_or_default();
        let request = Request::of_tool(&request.name, arguments.into(), serde_json::Value::Null);
        Ok(tools::result(self.handle.ask(request).await).into())
    }

    async fn list_resources(
        &self,
        _: Option<PaginatedRequestParams>,
        _: RequestContext<RoleServer>,
    ) -> Result<ListResourcesResult, ErrorData> {
        Ok(ListResourcesResult::with_all_items(resources::all()))
    }

    async fn read_resource(
        &self,
        request: ReadResourceRequestParams,
        _: RequestContext<RoleServer>,
    ) -> Result<ReadResourceResponse, ErrorData> {
        resources::read(&request.uri, &self.handle, (&self.goal, &self.numbers)).await.map(Into::into)
    }
}
