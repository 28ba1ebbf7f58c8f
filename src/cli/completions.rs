//! `novamind completions`: completion scripts.

use clap::{Args, CommandFactory};

use super::{Arguments, Failure, print};

/// Options of `completions`.
#[derive(Debug, Args)]
pub struct Options {
    /// Shell.
    shell: clap_complete::Shell,
}

/// Runs the command.
pub fn run(options: &Options) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(options.shell, &mut Arguments::command(), "novamind", &mut script);
    print(&String::from_utf8_lossy(&script))
}
