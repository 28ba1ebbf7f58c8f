//! `novamind keys`: every action of the console with its keys.

use clap::Args;

use super::{Context, Failure, print};
use crate::console::keys::KeyBindings;
use crate::console::manual;

#[derive(Debug, Args)]
pub struct Options {
    /// Print as a Markdown table
    #[arg(long)]
    markdown: bool,
}

pub fn run(options: &Options, context: &Context) -> Result<(), Failure> {
    let keys = KeyBindings::with_user_file(&context.configuration).map_err(Failure::unreadable)?;
    print(&if options.markdown { manual::to_markdown(&keys) } else { manual::to_text(&keys) })
}
