//! `novamind host --study DIR`: serves the sessions of a study.

use std::ffi::OsString;
use std::net::{IpAddr, SocketAddr};
use std::path::{Path, PathBuf};

use clap::Args;

use super::open_folder;
use crate::cli::{Failure, print};
use crate::host::{
    HostOptions, PublicAddress, SessionProgram, WebOptions, check_sandbox_support, serve_host,
};

#[derive(Debug, Args)]
pub struct ServeOptions {
    /// Address on which the host accepts browsers; 0.0.0.0:7420 accepts them from other machines
    #[arg(long, default_value = "127.0.0.1:7420", value_name = "ADDRESS:PORT")]
    listen: SocketAddr,
    /// Address of a reverse proxy whose X-Forwarded-For and X-Forwarded-Proto headers are used; can be repeated
    #[arg(long = "trust-proxy", value_name = "ADDRESS")]
    trusted_proxies: Vec<IpAddr>,
    /// Socket for `novamind host attach` [default: host.sock in the host folder]
    #[arg(long, value_name = "FILE")]
    socket: Option<PathBuf>,
    /// Account that several participants share: they enter label and code
    #[arg(long, value_name = "NAME")]
    shared_account: Option<String>,
    /// Start although this system cannot restrict the processes of sessions
    #[arg(long)]
    without_sandbox: bool,
}

pub fn run(options: &ServeOptions, study: Option<&Path>) -> Result<(), Failure> {
    let study =
        study.ok_or_else(|| Failure::usage("give the folder of the study: novamind host --study DIR"))?;
    let mut folder = open_folder(study)?;
    folder.report_failures(|problem| eprintln!("novamind: {problem}"));
    // Processes of sessions have another working folder.
    let socket = options.socket.clone().unwrap_or_else(|| folder.default_socket());
    let is_sandboxed = check_sandbox(options)?;
    if let Some(warning) = folder.study().guessable_seeds_warning() {
        eprintln!("novamind: note: {warning}");
    }
    let program = session_program(is_sandboxed)?;
    let public = folder.url().map(PublicAddress::parse).transpose().map_err(Failure::failed)?;
    let (count, name) = (folder.labels().count(), folder.study().protocol.name.clone());
    let terminals = socket.clone();
    let ready = |listens_on: SocketAddr| {
        format!(
            "serving {count} sessions of {name}\n\
             browsers  http://{listens_on}; the page for the experimenter is http://{listens_on}/admin\n\
             terminal  novamind host attach LABEL --socket {}\n\
             links     novamind host links {} --csv links.csv\n\
             ctrl-c saves all sessions and stops the host\n",
            terminals.display(),
            study.display(),
        )
    };
    let host = HostOptions {
        listen: options.listen,
        web: WebOptions { public, trusted_proxies: options.trusted_proxies.clone() },
        socket,
        shared_account: options.shared_account.clone(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        is_sandboxed,
    };
    let mut printed = Ok(());
    serve_host(folder, &program, &host, |listens_on| printed = print(&ready(listens_on)))
        .map_err(|error| Failure::failed(error.to_string()))?;
    printed
}

/// Returns whether the processes of sessions are restricted.
fn check_sandbox(options: &ServeOptions) -> Result<bool, Failure> {
    const CONSEQUENCE: &str = "Without this restriction, a participant who finds an error in the program can read seeds, keys and \
                               the data of others, and can use the network";
    if options.without_sandbox {
        eprintln!("novamind: the processes of sessions are not restricted. {CONSEQUENCE}");
        return Ok(false);
    }
    let refused = |problem| {
        Failure::failed(format!("{problem}. {CONSEQUENCE}. To start anyway, add --without-sandbox"))
    };
    check_sandbox_support().map_err(refused)?;
    Ok(true)
}

fn session_program(is_sandboxed: bool) -> Result<SessionProgram, Failure> {
    let program = std::env::current_exe()
        .map_err(|error| Failure::failed(format!("the path of this program is unknown: {error}")))?;
    let mut arguments = vec![OsString::from("host"), OsString::from("session")];
    if !is_sandboxed {
        arguments.push(OsString::from("--without-sandbox"));
    }
    Ok(SessionProgram { program, arguments, absence_limit: SessionProgram::ABSENCE_LIMIT })
}
