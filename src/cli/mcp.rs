//! `novamind mcp`: serves a run to a client of the Model Context Protocol.

use clap::Args;

use super::which_run::WhichRun;
use super::{Context, Failure};
use crate::server::{refuse_mcp, serve_mcp};

#[derive(Debug, Args)]
pub struct Options {
    #[command(flatten)]
    which: WhichRun,
}

pub fn run(options: &Options, context: &Context) -> Result<(), Failure> {
    let session = options.which.open(context).map_err(|failure| {
        // Clients show either standard error or the protocol error, rarely both.
        eprintln!("novamind: {failure}");
        refuse_mcp(&failure.to_string());
        Failure::code_only(failure.code)
    })?;
    Ok(serve_mcp(session, |words| eprintln!("{words}"))?)
}
