//! `novamind keys`: every action of the console with its keys.

use clap::Args;

use super::{Context, Failure, print};
use crate::console::keys::Keys;
use crate::console::manual;

#[derive(Debug, Args)]
pub struct Options {
    /// Print as a Markdown table
    #[arg(long)]
    markdown: bool,
}

pub fn run(options: &Options, context: &Context) -> Result<(), Failure> {
    let keys = Keys::of_user(&context.configuration).map_err(Failure::unreadable)?;
    print(&if options.markdown { manual::markdown(&keys) } else { manual::text(&keys) })
}
