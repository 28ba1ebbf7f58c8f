//! `novamind study protocol`: the study in words.

use std::path::Path;

use crate::cli::{Context, Failure, print};
use crate::report::protocol::protocol;
use crate::session::Study;

/// Prints the protocol as Markdown.
pub fn run(folder: &Path, context: &Context) -> Result<(), Failure> {
    print(&protocol(&Study::read(folder)?, &context.configuration)?)
}
