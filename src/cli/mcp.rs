//! `novamind mcp`: a run for a client of the Model Context Protocol.

use clap::Args;

use super::which_run::WhichRun;
use super::{Context, Failure};
use crate::server::serve_mcp;

/// Options of `mcp`.
#[derive(Debug, Args)]
pub struct Options {
    #[command(flatten)]
    which: WhichRun,
}

/// Runs the command.
pub fn run(options: &Options, context: &Context) -> Result<(), Failure> {
    Ok(serve_mcp(options.which.open(context)?, |words| eprintln!("{words}"))?)
}
