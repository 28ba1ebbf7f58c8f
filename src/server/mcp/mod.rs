//! The Model Context Protocol interface on standard input and output.

mod resources;
mod startup_error;
mod stdio;
mod tools;

pub use startup_error::reject_mcp_client;

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

use super::agent_page::{PageContext, goal_and_rules};
use super::announcement::Announcement;
use super::request::ApiRequest;
use super::worker::{InterfaceInfo, OnDefect, SessionHandle, SessionWorker};
use novamind_record::error::RunError;
use novamind_record::trajectory::record::Via;
use novamind_session::Session;
use novamind_tools::ParameterNumbers;

/// Instructions that clients pass to their model.
const INSTRUCTIONS: &str = "You run a simulated AI subscription company. Every tool call acts on the same run; time passes only \
     with next_week. Read the resources novamind://goal and novamind://manual first.";

/// Serves a run on standard input and output until the input ends. Calls `on_defect` with reports of internal errors.
///
/// # Errors
/// The last line of the record cannot be written, or standard input and output cannot be used.
pub fn serve_mcp(session: Session, on_defect: OnDefect) -> Result<(), RunError> {
    let numbers = session.numbers();
    let folder = session.folder().map(PathBuf::from);
    let manifest = session.manifest();
    let goal = goal_and_rules(&PageContext { days: manifest.days, cash: manifest.cash, numbers: &numbers });
    let run = manifest.id.clone();
    if let Some(folder) = &folder {
        Announcement { run, port: None, pid: std::process::id(), token: None }.write(folder)?;
    }
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
    let runtime = runtime.map_err(RunError::io(Path::new("standard input")))?;
    let (owner, handle) =
        SessionWorker::start(session, InterfaceInfo { via: Via::Mcp, interface: "mcp", on_defect });
    let served = runtime.block_on(async {
        let (streams, writing) = stdio::open();
        let running = McpServer { handle, numbers, goal }.serve(streams).await.map_err(io::Error::other)?;
        let ended = running.waiting().await.map_err(io::Error::other);
        // Wait for the output, because the last response may not have been written yet.
        writing.await.map_err(io::Error::other)?;
        ended
    });
    // Reading standard input cannot be canceled, and its result is not needed.
    runtime.shutdown_background();
    // The run is still locked, so no other server can have written an announcement.
    if let Some(folder) = &folder {
        Announcement::remove(folder);
    }
    owner.finish()?;
    served.map(drop).map_err(RunError::io(Path::new("standard input")))
}

/// The protocol server for one run.
struct McpServer {
    handle: SessionHandle,
    numbers: Arc<ParameterNumbers>,
    /// Text that describes the goal, calendar and rules of the run.
    goal: String,
}

impl ServerHandler for McpServer {
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
        Ok(ListToolsResult::with_all_items(tools::list(&self.numbers)))
    }

    fn get_tool(&self, name: &str) -> Option<Tool> {
        tools::find(name, &self.numbers)
    }

    async fn call_tool(
        &self,
        request: CallToolRequestParams,
        _: RequestContext<RoleServer>,
    ) -> Result<CallToolResponse, ErrorData> {
        let arguments = request.arguments.unwrap_or_default();
        let request = ApiRequest::from_tool_call(&request.name, arguments.into(), serde_json::Value::Null);
        Ok(tools::to_call_result(self.handle.send(request).await).into())
    }

    async fn list_resources(
        &self,
        _: Option<PaginatedRequestParams>,
        _: RequestContext<RoleServer>,
    ) -> Result<ListResourcesResult, ErrorData> {
        Ok(ListResourcesResult::with_all_items(resources::list()))
    }

    async fn read_resource(
        &self,
        request: ReadResourceRequestParams,
        _: RequestContext<RoleServer>,
    ) -> Result<ReadResourceResponse, ErrorData> {
        resources::read(&request.uri, &self.handle, (&self.goal, &self.numbers)).await.map(Into::into)
    }
}
