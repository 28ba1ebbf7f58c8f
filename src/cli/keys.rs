//! `novamind keys`: every action of the console and its keys.

use clap::Args;

use super::{Context, Failure, print};
use crate::console::keys::Keys;
use crate::console::manual;

/// Options of `keys`.
#[derive(Debug, Args)]
pub struct Options {
    /// Print as a table in Markdown.
    #[arg(long)]
    markdown: bool,
}

/// Runs the command.
pub fn run(options: &Options, context: &Context) -> Result<(), Failure> {
    let keys = Keys::of_user(&context.configuration).map_err(Failure::unreadable)?;
    print(&if options.markdown { manual::markdown(&keys) } else { manual::text(&keys) })
}
