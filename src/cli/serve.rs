//! `novamind serve`: serves a run to programs over HTTP.

use std::path::PathBuf;

use clap::Args;
use serde_json::json;

use super::run_selection::RunSelection;
use super::{Context, Failure, print};
use crate::server::{BoundPort, HttpOptions, serve_http, write_client};

#[derive(Debug, Args)]
pub struct Options {
    #[command(flatten)]
    which: RunSelection,
    /// Port on 127.0.0.1 [default: any free port]
    #[arg(long, value_name = "N")]
    port: Option<u16>,
    /// Require every request to include the token in this file; a missing file is created
    #[arg(long, value_name = "FILE")]
    token: Option<PathBuf>,
    /// Write the Python client to this folder; without options that select a run, no server is started
    #[arg(long, value_name = "DIR")]
    client: Option<PathBuf>,
}

pub fn run(options: &Options, context: &Context) -> Result<(), Failure> {
    if let Some(folder) = &options.client {
        write_client(folder)?;
        eprintln!(
            "the client is in {}: install it with pip, or add the folder to PYTHONPATH",
            folder.display()
        );
        if !options.which.is_specified() {
            return Ok(());
        }
    }
    let bound_port = BoundPort::bind(options.port)?;
    let session = options.which.open(context)?;
    let http = HttpOptions { token: options.token.clone() };
    let mut printed = Ok(());
    serve_http(
        session,
        bound_port,
        &http,
        |ready| printed = print(&format!("{}\n", json!(ready))),
        |words| eprintln!("{words}"),
    )?;
    printed
}
