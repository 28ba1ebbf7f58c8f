//! `novamind study protocol`: prints the protocol as text.

use std::path::Path;

use super::read_study;
use crate::cli::{Context, Failure, print};
use crate::report::protocol::protocol;

/// Prints the protocol as Markdown.
pub fn run(folder: &Path, context: &Context) -> Result<(), Failure> {
    print(&protocol(&read_study(folder)?, &context.configuration)?)
}
