//! `novamind runs export --format`: writes a run as a script, an agent trajectory, an evaluation log or data of a viewer.

use std::path::{Path, PathBuf};

use clap::ValueEnum;
use serde_json::Value;

use crate::cli::output_file::write_text;
use crate::cli::run::progress_bar;
use crate::cli::{Context, Failure, print};
use crate::record::files::write_atomically;
use crate::record::folder::manifest_check::read_manifest;
use crate::report::pluralize;
use crate::report::transcript::{
    AgentContext, Transcript, ViewerExport, add_to_viewer_manifest, inspect_file_name, to_atif, to_inspect,
    to_plain_script, to_python_script, to_viewer,
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
    /// The data folder of the trajectory viewer of the paper's web page
    Viewer,
}

/// Exports the run in a folder. Never replaces an existing file.
pub fn write_export(
    folder: &Path,
    format: ExportFormat,
    out: &Path,
    context: &Context,
) -> Result<(), Failure> {
    if format == ExportFormat::Viewer {
        return write_viewer_export(folder, out, context);
    }
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
        ExportFormat::Archive | ExportFormat::Viewer => return Ok(()),
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

/// Adds the run in `folder` to the data folder of the trajectory viewer. The manifest is written last, so that it never
/// lists a run whose files are incomplete.
fn write_viewer_export(folder: &Path, data: &Path, context: &Context) -> Result<(), Failure> {
    let runs = data.join("runs");
    let id = folder.file_name().map(PathBuf::from).unwrap_or_default();
    let (run_file, weeks) = (runs.join(&id).with_extension("json"), runs.join(&id));
    if let Some(there) = [&run_file, &weeks].into_iter().find(|file| file.exists()) {
        let message = format!("{} already exists: choose another folder, or remove it", there.display());
        return Err(Failure::failed(message));
    }
    let days = read_manifest(folder)?.days;
    context.authorize_view(folder, "runs export", "viewer")?;
    let progress = progress_bar(u64::from(days), "days");
    let export = to_viewer(folder, &mut |day| progress.set_position(day.into()));
    progress.finish_and_clear();
    let export = export?;
    let manifest = runs.join("manifest.json");
    let list = extend_viewer_manifest(&manifest, &export)?;
    std::fs::create_dir_all(&weeks)
        .map_err(|error| Failure::failed(format!("{}: {error}", weeks.display())))?;
    for (number, week) in &export.weeks {
        write_text(&weeks.join(format!("week_{number}.json")), &format!("{week}\n"))?;
    }
    write_text(&run_file, &format!("{}\n", export.run))?;
    // The manifest is valid, so it can be replaced even if another program formatted it differently.
    write_atomically(&manifest, (serde_json::to_string_pretty(&list).unwrap_or_default() + "\n").as_bytes())?;
    print(&format!(
        "run {} to day {}: {}, {}, {} of weeks in {}\n",
        id.display(),
        export.run["current_day"],
        manifest.display(),
        run_file.display(),
        pluralize(export.weeks.len() as u32, "file"),
        weeks.display()
    ))
}

/// Returns the manifest in a file with the run added, or a new manifest if there is no file.
fn extend_viewer_manifest(file: &Path, export: &ViewerExport) -> Result<Value, Failure> {
    let wrong = |why: String| Failure::failed(format!("{}: {why}. Nothing was written", file.display()));
    let text = match std::fs::read_to_string(file) {
        Ok(text) => Some(text),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => None,
        Err(error) => return Err(wrong(error.to_string())),
    };
    add_to_viewer_manifest(text.as_deref(), export).map_err(wrong)
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

/// Returns a context that contains only a list of the tools, because only builds with the server contain the
/// instructions.
#[cfg(not(feature = "server"))]
fn export_context(_: &Transcript) -> AgentContext {
    AgentContext { instructions: crate::tools::catalogue::list_by_module(), tools: Vec::new() }
}
