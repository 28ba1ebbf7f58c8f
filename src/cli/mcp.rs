//! `novamind mcp`: serves a run to a client of the Model Context Protocol.

use clap::Args;

use super::run_selection::RunSelection;
use super::{Context, Failure};
use crate::server::{reject_mcp_client, serve_mcp};

#[derive(Debug, Args)]
pub struct Options {
    #[command(flatten)]
    which: RunSelection,
}

pub fn run(options: &Options, context: &Context) -> Result<(), Failure> {
    let session = options.which.open(context).map_err(|failure| {
        // Report the failure twice, because most clients show only standard error or only the protocol error.
        eprintln!("novamind: {failure}");
        reject_mcp_client(&failure.to_string());
        Failure::code_only(failure.code)
    })?;
    Ok(serve_mcp(session, |words| eprintln!("{words}"))?)
}
