//! `novamind runs export --format`: writes a run as a script, an agent trajectory or an evaluation log.

use std::path::{Path, PathBuf};

use clap::ValueEnum;
use serde_json::Value;

use crate::cli::output_file::write_text;
use crate::cli::run::progress_bar;
use crate::cli::{Context, Failure, print};
use crate::record::folder::manifest_check::read_manifest;
use crate::report::transcript::{
    AgentContext, Transcript, inspect_file_name, to_atif, to_inspect, to_plain_script, to_python_script,
};

/// Format of an exported run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ExportFormat {
    /// A sealed archive of the complete run, which can be verified and imported
    Archive,
    /// The decisions as a plain-mode script and as a Python program for the client: play.txt and play.py in a folder
    Script,
    /// The Agent Trajectory Interchange Format, version 1.8
    Atif,
    /// An evaluation log for Inspect
    Inspect,
}

/// Exports the run in a folder. Never replaces an existing file.
pub fn write_export(
    folder: &Path,
    format: ExportFormat,
    out: &Path,
    context: &Context,
) -> Result<(), Failure> {
    let manifest = read_manifest(folder)?;
    let (made, files) = match format {
        ExportFormat::Script => (Some(out), vec![out.join("play.txt"), out.join("play.py")]),
        ExportFormat::Inspect if has_extension(out, "eval") => {
            return Err(Failure::usage(format!(
                "{}: a file that ends in .eval must be an archive, but the log is written as JSON. Give a file that ends in .json, or a folder. Nothing was written",
                out.display()
            )));
        }
        ExportFormat::Inspect if !has_extension(out, "json") => {
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
            "run {} belongs to lesson {}. A script cannot create the start of a lesson; use --format atif or inspect",
            manifest.id, lesson.name
        )));
    }
    context.authorize_view(folder, "runs export", &format!("{format:?}").to_lowercase())?;
    let progress = progress_bar(u64::from(manifest.days), "days");
    let run = Transcript::open(folder, &mut |day| progress.set_position(day.into()));
    progress.finish_and_clear();
    let run = run?;
    let json = |value: Value| serde_json::to_string_pretty(&value).unwrap_or_default() + "\n";
    if let Some(made) = made {
        std::fs::create_dir_all(made)
            .map_err(|error| Failure::failed(format!("{}: {error}", made.display())))?;
    }
    let texts = match format {
        ExportFormat::Archive => return Ok(()),
        ExportFormat::Script => vec![to_plain_script(&run), to_python_script(&run).unwrap_or_default()],
        ExportFormat::Atif => vec![json(to_atif(&run, &export_context(&run)))],
        ExportFormat::Inspect => vec![json(to_inspect(&run, &export_context(&run)))],
    };
    let mut written: Vec<&PathBuf> = Vec::new();
    for (file, text) in files.iter().zip(&texts).filter(|(_, text)| !text.is_empty()) {
        write_text(file, text)?;
        written.push(file);
    }
    let names: Vec<String> = written.iter().map(|file| file.display().to_string()).collect();
    print(&format!("run {} to day {}: {}\n", run.manifest.id, run.last_day_and_cash.0, names.join(", ")))?;
    match (format, to_python_script(&run)) {
        (ExportFormat::Script, Err(error)) => Err(Failure::failed(format!("{error}; play.txt is written"))),
        _ => Ok(()),
    }
}

fn has_extension(file: &Path, ending: &str) -> bool {
    file.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(ending))
}

/// Returns the instructions and tools that the agent of the run received.
#[cfg(feature = "server")]
fn export_context(run: &Transcript) -> AgentContext {
    let of = crate::server::PageContext {
        days: run.manifest.days,
        cash: run.manifest.cash,
        numbers: &run.numbers,
    };
    AgentContext {
        instructions: crate::server::agent_page(&of),
        tools: crate::server::function_schemas(&run.numbers),
    }
}

/// Returns only the list of tools, because only builds with the server contain the instructions.
#[cfg(not(feature = "server"))]
fn export_context(_: &Transcript) -> AgentContext {
    AgentContext { instructions: crate::tools::catalogue::list_by_module(), tools: Vec::new() }
}
