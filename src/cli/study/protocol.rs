//! `novamind study protocol`: prints the protocol as text.

use std::path::Path;

use super::read_study;
use crate::cli::{Context, Failure, print};
use crate::report::protocol::protocol_markdown;

/// Prints the protocol as Markdown.
pub fn run(folder: &Path, context: &Context) -> Result<(), Failure> {
    print(&protocol_markdown(&read_study(folder)?, &context.configuration)?)
}
