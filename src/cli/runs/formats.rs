//! `novamind runs export --format`: writes a run as a script, an agent trajectory or an evaluation log.

use std::path::{Path, PathBuf};

use clap::ValueEnum;
use serde_json::Value;

use crate::cli::output_file::write_text;
use crate::cli::run::progress_bar;
use crate::cli::{Context, Failure, print};
use crate::record::folder::derived::manifest_of;
use crate::report::transcript::{
    Surroundings, Transcript, atif, inspect, inspect_file_name, plain_script, python_script,
};

/// Format of an exported run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ExportFormat {
    /// A sealed archive with everything, to be verified and imported
    Archive,
    /// The decisions as a plain-mode script and as a Python program for the client: play.txt and play.py in a folder
    Script,
    /// The Agent Trajectory Interchange Format, version 1.8
    Atif,
    /// An evaluation log for Inspect
    Inspect,
}

/// Writes the run of a folder in a format. Never replaces an existing file.
pub fn write(folder: &Path, format: ExportFormat, out: &Path, context: &Context) -> Result<(), Failure> {
    let manifest = manifest_of(folder)?;
    let (made, files) = match format {
        ExportFormat::Script => (Some(out), vec![out.join("play.txt"), out.join("play.py")]),
        ExportFormat::Inspect if has_ending(out, "eval") => {
            return Err(Failure::usage(format!(
                "{}: the log is written as JSON, but Inspect expects an archive in a file that ends in .eval: give a file that \
                 ends in .json, or a folder. Nothing was written",
                out.display()
            )));
        }
        ExportFormat::Inspect if !has_ending(out, "json") => {
            (Some(out), vec![out.join(inspect_file_name(&manifest))])
        }
        _ => (None, vec![out.to_owned()]),
    };
    if let Some(there) = files.iter().find(|file| file.exists()) {
        let message = format!("{} already exists: choose another name, or remove it", there.display());
        return Err(Failure::failed(message));
    }
    if let (Some(lesson), ExportFormat::Script) = (&manifest.lesson, format) {
        return Err(Failure::usage(format!(
            "run {} belongs to lesson {}, whose start a script cannot create; use --format atif or inspect",
            manifest.id, lesson.name
        )));
    }
    context.look(folder, "runs export", &format!("{format:?}").to_lowercase())?;
    let progress = progress_bar(u64::from(manifest.days), "days");
    let run = Transcript::of(folder, &mut |day| progress.set_position(day.into()));
    progress.finish_and_clear();
    let run = run?;
    let json = |value: Value| serde_json::to_string_pretty(&value).unwrap_or_default() + "\n";
    if let Some(made) = made {
        std::fs::create_dir_all(made)
            .map_err(|error| Failure::failed(format!("{}: {error}", made.display())))?;
    }
    let texts = match format {
        ExportFormat::Archive => return Ok(()),
        ExportFormat::Script => vec![plain_script(&run), python_script(&run).unwrap_or_default()],
        ExportFormat::Atif => vec![json(atif(&run, &surroundings(&run)))],
        ExportFormat::Inspect => vec![json(inspect(&run, &surroundings(&run)))],
    };
    let mut written: Vec<&PathBuf> = Vec::new();
    for (file, text) in files.iter().zip(&texts).filter(|(_, text)| !text.is_empty()) {
        write_text(file, text)?;
        written.push(file);
    }
    let names: Vec<String> = written.iter().map(|file| file.display().to_string()).collect();
    print(&format!("run {} to day {}: {}\n", run.manifest.id, run.last.0, names.join(", ")))?;
    match (format, python_script(&run)) {
        (ExportFormat::Script, Err(error)) => Err(Failure::failed(format!("{error}; play.txt is written"))),
        _ => Ok(()),
    }
}

fn has_ending(file: &Path, ending: &str) -> bool {
    file.extension().is_some_and(|own| own.eq_ignore_ascii_case(ending))
}

/// Returns the page that the player of the run received.
#[cfg(feature = "server")]
fn surroundings(run: &Transcript) -> Surroundings {
    let of =
        crate::server::PageOf { days: run.manifest.days, cash: run.manifest.cash, numbers: &run.numbers };
    Surroundings { page: crate::server::page(&of), tools: crate::server::functions(&run.numbers) }
}

/// Returns only the list of tools, because the page is part of the server.
#[cfg(not(feature = "server"))]
fn surroundings(_: &Transcript) -> Surroundings {
    Surroundings { page: crate::tools::catalogue::overview(), tools: Vec::new() }
}
