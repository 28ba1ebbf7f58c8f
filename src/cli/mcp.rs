//! `novamind mcp`: a run for a client of the Model Context Protocol.

use clap::Args;

use super::which_run::WhichRun;
use super::{Context, Failure};
use crate::server::{refuse_mcp, serve_mcp};

/// Options of `mcp`.
#[derive(Debug, Args)]
pub struct Options {
    #[command(flatten)]
    which: WhichRun,
}

/// Runs the command.
pub fn run(options: &Options, context: &Context) -> Result<(), Failure> {
    let session = options.which.open(context).map_err(|failure| {
        // A host shows either of them, and rarely both.
        eprintln!("novamind: {failure}");
        refuse_mcp(&failure.to_string());
        Failure::code_only(failure.code)
    })?;
    Ok(serve_mcp(session, |words| eprintln!("{words}"))?)
}
