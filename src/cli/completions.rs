//! `novamind completions`: prints a completion script for a shell.

use clap::{Args, CommandFactory};

use super::{Arguments, Failure, print};

#[derive(Debug, Args)]
pub struct Options {
    /// Shell that runs the script
    shell: clap_complete::Shell,
}

pub fn run(options: &Options) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(options.shell, &mut Arguments::command(), "novamind", &mut script);
    print(&String::from_utf8_lossy(&script))
}
