//! `novamind keys`: every action of the console with its keys.

use clap::Args;

use super::{Context, Failure, print};
use crate::console::keys::KeyBindings;
use crate::console::manual;
use crate::console::own_commands::OwnCommands;
use crate::record::folder::query_library::QueryLibrary;

#[derive(Debug, Args)]
pub struct Options {
    /// Print as a Markdown table
    #[arg(long)]
    markdown: bool,
}

pub fn run(options: &Options, context: &Context) -> Result<(), Failure> {
    let keys = KeyBindings::with_user_file(&context.configuration).map_err(Failure::unreadable)?;
    if options.markdown {
        return print(&manual::to_markdown(&keys));
    }
    let library = QueryLibrary::load(&context.configuration);
    let own = OwnCommands::load(&context.configuration, &keys, &library);
    print(&format!("{}{}", manual::to_text(&keys), own.to_text()))?;
    // The list is printed even if some commands are invalid, because the console also starts with the valid
    // ones.
    if own.problems.is_empty() { Ok(()) } else { Err(Failure::unreadable(own.problems.join("\n"))) }
}
