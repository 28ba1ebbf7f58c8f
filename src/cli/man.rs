//! `novamind man`: prints or writes manual pages.

use std::path::PathBuf;

use clap::{Args, Command, CommandFactory};

use super::output_file::write_text;
use super::{Arguments, Failure, print};

#[derive(Debug, Args)]
pub struct Options {
    /// Command whose page is printed, for example `runs list` [default: novamind itself]
    #[arg(value_name = "COMMAND")]
    command: Vec<String>,
    /// Write the pages of all commands to this folder instead
    #[arg(long, value_name = "DIR", conflicts_with = "command")]
    dir: Option<PathBuf>,
}

pub fn run(options: &Options) -> Result<(), Failure> {
    let mut root = Arguments::command().disable_help_subcommand(true);
    root.build();
    if let Some(folder) = &options.dir {
        std::fs::create_dir_all(folder)
            .map_err(|error| Failure::failed(format!("{}: {error}", folder.display())))?;
        return write_pages(&root, folder);
    }
    let mut command = &root;
    for name in &options.command {
        command = command.find_subcommand(name).ok_or_else(|| {
            Failure::usage(format!("{} has no command {name}", command.get_bin_name().unwrap_or("novamind")))
        })?;
    }
    print(&page(command)?)
}

/// Writes the page of a command and of all its visible subcommands.
fn write_pages(command: &Command, folder: &std::path::Path) -> Result<(), Failure> {
    write_text(&folder.join(format!("{}.1", page_name(command))), &page(command)?)?;
    command
        .get_subcommands()
        .filter(|command| !command.is_hide_set())
        .try_for_each(|command| write_pages(command, folder))
}

/// Returns the name of a page: the words of the command joined by hyphens.
fn page_name(command: &Command) -> String {
    command.get_display_name().unwrap_or_else(|| command.get_name()).replace(' ', "-")
}

/// Returns a page in roff, to be read with `man -l`.
fn page(command: &Command) -> Result<String, Failure> {
    let mut page = Vec::new();
    let manual = clap_mangen::Man::new(command.clone())
        .title(page_name(command))
        .manual("NovaMind console")
        .source(concat!("novamind ", env!("CARGO_PKG_VERSION")));
    manual.render(&mut page).map_err(|error| Failure::failed(format!("manual page: {error}")))?;
    String::from_utf8(page).map_err(|error| Failure::failed(format!("manual page: {error}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_command_has_a_page() {
        let folder = tempfile::tempdir().expect("a folder");
        run(&Options { command: Vec::new(), dir: Some(folder.path().to_owned()) }).expect("pages");
        for name in ["novamind", "novamind-play", "novamind-runs-list", "novamind-lab-golden"] {
            let page = std::fs::read_to_string(folder.path().join(format!("{name}.1"))).expect(name);
            assert!(page.contains(&format!(".TH {name} 1")), "{page}");
        }
        assert!(!folder.path().join("novamind-help.1").exists());
    }
}
