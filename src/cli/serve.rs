//! `novamind serve`: a run for programs, over HTTP.

use std::path::PathBuf;

use clap::Args;
use serde_json::json;

use super::which_run::WhichRun;
use super::{Context, Failure, print};
use crate::server::{HeldPort, HttpOptions, serve_http, write_client};

/// Options of `serve`.
#[derive(Debug, Args)]
pub struct Options {
    #[command(flatten)]
    which: WhichRun,
    /// Port on 127.0.0.1 [default: any free one].
    #[arg(long, value_name = "N")]
    port: Option<u16>,
    /// Requests must carry the token in this file; it is made if there is none.
    #[arg(long, value_name = "FILE")]
    token: Option<PathBuf>,
    /// Write the Python client into this folder, and serve nothing unless a run is named too.
    #[arg(long, value_name = "DIR")]
    client: Option<PathBuf>,
}

/// Runs the command.
pub fn run(options: &Options, context: &Context) -> Result<(), Failure> {
    if let Some(folder) = &options.client {
        write_client(folder)?;
        eprintln!("the client is in {}: pip install it, or add the folder to PYTHONPATH", folder.display());
        if !options.which.names_one() {
            return Ok(());
        }
    }
    let held = HeldPort::take(options.port)?;
    let session = options.which.open(context)?;
    let http = HttpOptions { token: options.token.clone() };
    let mut told = Ok(());
    serve_http(
        session,
        held,
        &http,
        |ready| told = print(&format!("{}\n", json!(ready))),
        |words| eprintln!("{words}"),
    )?;
    told
}
