//! `novamind host attach`: opens a hosted session in this terminal.

use std::path::PathBuf;

use clap::Args;

use crate::cli::{Failure, print};
use crate::host::{AttachFailure, attach_terminal};

/// Socket of the host if no other socket is given.
pub(super) const SYSTEM_SOCKET: &str = "/run/novamind/host.sock";

#[derive(Debug, Args)]
pub struct Options {
    /// Label of the session [default: the name of this account]
    #[arg(value_name = "LABEL")]
    label: Option<String>,
    /// Socket of the host [default: /run/novamind/host.sock]
    #[arg(long, env = "NOVAMIND_HOST_SOCKET", value_name = "FILE")]
    socket: Option<PathBuf>,
}

pub fn run(options: &Options) -> Result<(), Failure> {
    let socket = options.socket.clone().unwrap_or_else(|| PathBuf::from(SYSTEM_SOCKET));
    match attach_terminal(&socket, options.label.clone()) {
        Ok(reason) => print(&format!("{reason}\n")),
        Err(AttachFailure::Signal(number)) => Err(Failure::signal(number)),
        Err(error) => Err(Failure::failed(error.to_string())),
    }
}
