//! `novamind study collect`: collects the runs of all machines in one folder, with their tables.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::json;

use super::read_study;
use crate::cli::run::progress_bar;
use crate::cli::runs::{remove_partial_files_on_signals, write_tables};
use crate::cli::{Context, Failure, print};
use crate::formatting::escape_control_characters;
use crate::report::collection::{CollectOptions, CollectionResult, LabKeys, collect};
use crate::session::LabKey;
use novamind_study::{CollectNote, load_lab_key, load_lab_public_key, load_seal_key};

#[derive(Debug, Args)]
pub struct Options {
    /// Folders of runs of the machines, copies of these folders, and archives; subfolders are also searched
    #[arg(value_name = "FOLDER", required = true)]
    sources: Vec<PathBuf>,
    /// Folder for archives, tables and collect.log
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Study whose assignment lists the expected participants
    #[arg(long, value_name = "DIR")]
    protocol: Option<PathBuf>,
    /// CSV with the columns run and participant: labels that replace the labels of the runs
    #[arg(long, value_name = "FILE")]
    labels: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

/// Collects the runs of a study. Fails with exit code 1 if notes need attention.
pub fn run(options: &Options, context: &Context) -> Result<(), Failure> {
    remove_partial_files_on_signals();
    let study = options.protocol.as_deref().map(read_study).transpose()?;
    let labels = options.labels.as_deref().map(read_labels).transpose()?.unwrap_or_default();
    let lab = options.protocol.as_ref().or(context.study_folder.as_ref());
    let lab_key = lab.map(|folder| load_lab_key(folder)).transpose()?.flatten();
    let public = lab.map(|folder| load_lab_public_key(folder)).transpose()?.flatten();
    let seal = lab.map(|folder| load_seal_key(folder)).transpose()?;
    let keys = LabKeys {
        signing_key: lab_key.as_ref(),
        verification_key: public.as_ref(),
        sealing_key: seal.as_ref(),
    };
    let mut bar = None;
    let (sources, out) = (&options.sources, &options.out);
    let what = CollectOptions { sources, output_folder: out, study: study.as_ref(), labels: &labels, keys };
    let collected = collect(what, &mut |done, all| {
        bar.get_or_insert_with(|| progress_bar(all as u64, "runs")).set_position(done as u64);
    })?;
    if let Some(bar) = bar {
        bar.finish_and_clear();
    }
    let CollectionResult { tables, runs, notes, visits } = collected;
    write_tables(tables, &options.out)?;
    let log: String =
        notes.iter().map(|note| format!("{}\n", escape_control_characters(&note.to_string()))).collect();
    let path = options.out.join("collect.log");
    std::fs::write(&path, &log).map_err(|error| Failure::failed(format!("{}: {error}", path.display())))?;
    if options.json {
        let entries = runs.iter().map(|(label, seal, archive)| {
            json!({ "run": seal.run, "participant": label, "file": archive, "checksum": seal.checksum })
        });
        let object = json!({ "runs": entries.collect::<Vec<_>>(), "notes": notes, "visits": visits });
        print(&format!("{object}\n"))?;
    } else {
        let signed = lab_key
            .as_ref()
            .map(LabKey::public_key)
            .map_or(String::new(), |key| format!(" and signed by the lab key {}", key.fingerprint()));
        let one = if runs.len() == 1 { "run" } else { "runs" };
        print(&format!(
            "{log}{visits}\n{} {one} verified{signed}; archives, tables and collect.log are in {}\n",
            runs.len(),
            options.out.display()
        ))?;
    }
    match notes.iter().filter(|note| CollectNote::needs_attention(note)).count() {
        0 => Ok(()),
        1 => Err(Failure::failed("1 note needs attention")),
        count => Err(Failure::failed(format!("{count} notes need attention"))),
    }
}

/// Reads the CSV file of `--labels` and returns the new labels by run.
fn read_labels(path: &Path) -> Result<BTreeMap<String, String>, Failure> {
    let wrong = |problem: String| Failure::usage(format!("{}: {problem}", path.display()));
    let mut reader = csv::Reader::from_path(path).map_err(|error| wrong(error.to_string()))?;
    let head = reader.headers().map_err(|error| wrong(error.to_string()))?;
    if head.iter().collect::<Vec<_>>() != ["run", "participant"] {
        return Err(wrong("the first line must be: run,participant".to_owned()));
    }
    let mut labels = BTreeMap::new();
    for row in reader.records() {
        let row = row.map_err(|error| wrong(error.to_string()))?;
        let (run, label) = (row[0].trim().to_owned(), row[1].trim().to_owned());
        if labels.insert(run.clone(), label).is_some() {
            return Err(wrong(format!("run {run} is listed twice")));
        }
    }
    Ok(labels)
}
