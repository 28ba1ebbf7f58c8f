//! `novamind runs export` and `import`: sealed archives of runs, and tables of many runs.

use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::{Value, json};

use super::formats::{self, ExportFormat};
#[cfg(feature = "server")]
use super::transcript::import_transcript;
use super::{find_run_in, list_all};
#[cfg(feature = "server")]
use crate::cli::new_run::NewRunOptions;
use crate::cli::output_file::write_text;
use crate::cli::run::progress_bar;
#[cfg(feature = "server")]
use crate::cli::shell_quoted;
use crate::cli::{Context, Failure, print};
use crate::formatting::escape_csv_cell;
use crate::record::error::RunError;
use crate::record::files::parent_folder;
use crate::record::folder::runs::RunSummary;
use crate::report::Logbook;
use crate::report::tables::{StudyTables, column_descriptions, table_headings};
use crate::session::archive::remove_temporary_folders;
use crate::session::{Export as Sealing, ImportOutcome, LabKey, LabPublicKey, Seal, SealKey, import_run};
use novamind_study::{FoundVisit, VISITS_FILE, read_visits};

#[derive(Debug, Args)]
pub struct Export {
    /// ID of the run, or `latest` for the newest run
    #[arg(required_unless_present = "all", conflicts_with = "all")]
    run: Option<String>,
    /// Export all runs, with tables of runs, weeks, forecasts, queries, events, answers and notes
    #[arg(long)]
    all: bool,
    /// With --all: export only runs of this participant
    #[arg(long, value_name = "LABEL", requires = "all")]
    participant: Option<String>,
    /// Archive file, compressed if the name ends in .gz or .tgz. With --all or --format script: a folder. With
    /// --format inspect: a .json file, or a folder in which the file gets the name that Inspect expects. The folder `data`
    /// of the viewer with --format viewer; runs can be added to it
    #[arg(long, value_name = "PATH")]
    out: PathBuf,
    /// Format: a sealed archive, or a format of another program
    #[arg(long, value_enum, default_value = "archive", conflicts_with_all = ["all", "lab_key"])]
    format: ExportFormat,
    /// Sign the archives with this lab key [default: lab.key in the folder of the study, if it exists]
    #[arg(long, value_name = "FILE")]
    lab_key: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub struct Import {
    /// Archives that `runs export` wrote
    #[cfg_attr(feature = "server", arg(required_unless_present = "transcript"))]
    #[cfg_attr(not(feature = "server"), arg(required = true))]
    files: Vec<PathBuf>,
    /// Import one archive under this name, next to an existing record of the same run
    #[arg(long, value_name = "NAME")]
    under: Option<String>,
    /// Play an external transcript in a new run: a trajectory in the Agent Trajectory Interchange Format, an Inspect
    /// log (.eval or .json), JSON lines with the keys tool and args, or history.jsonl of release 2
    #[cfg(feature = "server")]
    #[arg(long, value_name = "FILE", conflicts_with_all = ["files", "under"])]
    transcript: Option<PathBuf>,
    #[cfg(feature = "server")]
    #[command(flatten)]
    made_of: NewRunOptions,
}

/// The keys that sign archives and seal snapshots.
type ExportKeys = (Option<LabKey>, SealKey);

impl Export {
    pub fn run(&self, folders: &[PathBuf], json: bool, context: &Context) -> Result<(), Failure> {
        if let (Some(run), true) = (&self.run, self.format != ExportFormat::Archive) {
            return formats::write_export(&find_run_in(folders, run)?, self.format, &self.out, context);
        }
        remove_partial_files_on_signals();
        // Report an unreadable key before the run is simulated again.
        let keys = (context.lab_key(self.lab_key.as_deref())?, context.seal_key()?);
        match &self.run {
            Some(run) => self.export_one(&find_run_in(folders, run)?, &keys, json),
            None => self.export_all(folders, &keys, json),
        }
    }

    fn export_one(&self, folder: &Path, (key, seal_key): &ExportKeys, json: bool) -> Result<(), Failure> {
        let parent = parent_folder(&self.out);
        if self.out.exists() {
            // Report an existing file before the run is simulated again.
            let message = format!("{} already exists: choose another name, or remove it", self.out.display());
            return Err(Failure::failed(message));
        }
        if !parent.is_dir() {
            return Err(Failure::failed(format!(
                "{} is not a folder; nothing was written",
                parent.display()
            )));
        }
        let export = Sealing::prepare(folder, parent, seal_key)?;
        let seal = export.write(&self.out, false, key.as_ref())?;
        let remarks = export.session().remarks();
        if json {
            return print(&format!(
                "{}\n",
                export_to_json(&seal, &self.out, export.session().day(), key.as_ref())
            ));
        }
        let remarks: String = remarks.iter().map(|remark| format!("{remark}\n")).collect();
        print(&format!("{remarks}{}", export_line(&seal, &self.out, export.session().day(), key.as_ref())))
    }

    fn export_all(&self, folders: &[PathBuf], keys: &ExportKeys, json: bool) -> Result<(), Failure> {
        let mut list = list_all(folders)?;
        // The participant of a damaged run is unknown, so a damaged run is always reported.
        let label = self.participant.as_deref();
        list.retain(|(_, run)| {
            run.problem.is_some() || label.is_none_or(|label| run.participant.as_deref() == Some(label))
        });
        list.sort_by(|(_, left), (_, right)| (&left.created, &left.id).cmp(&(&right.created, &right.id)));
        std::fs::create_dir_all(&self.out)
            .map_err(|error| Failure::failed(format!("{}: {error}", self.out.display())))?;
        let progress = progress_bar(list.len() as u64, "runs");
        let (mut tables, mut answers, mut worst, mut good) = (StudyTables::default(), Vec::new(), None, 0);
        for (folder, run) in &list {
            let exported = self.export_into(folder, run, keys);
            progress.inc(1);
            match exported {
                Ok((export, seal, archive)) => {
                    let book =
                        Logbook::new(export.session(), &export.trajectory().lines, export.afterwards_lines());
                    tables.add(&book, &export.trajectory().lines, export.afterwards_lines());
                    answers.push(if json {
                        export_to_json(&seal, &archive, book.day, keys.0.as_ref()).to_string() + "\n"
                    } else {
                        export_line(&seal, &archive, book.day, keys.0.as_ref())
                    });
                    good += 1;
                }
                Err(error) => {
                    let problem = error.to_string();
                    let failure = Failure::from(error);
                    let answer = json!({ "run": run.id, "problem": problem });
                    answers.push(if json {
                        format!("{answer}\n")
                    } else {
                        format!("{}  not exported: {problem}\n", run.id)
                    });
                    tables.add_unreadable_run(&run.id, &problem);
                    worst = Some(worst.map_or(failure.code, |code: u8| code.max(failure.code)));
                }
            }
        }
        progress.finish_and_clear();
        tables.add_visits(&find_visits(folders, label));
        write_tables(tables, &self.out)?;
        print(&answers.concat())?;
        if !json {
            print(&format!(
                "{good} of {} runs and their tables are in {}\n",
                list.len(),
                self.out.display()
            ))?;
        }
        match worst {
            None => Ok(()),
            Some(code) => {
                let message = format!(
                    "{} of {} runs could not be exported; all other runs are complete",
                    list.len() - good,
                    list.len()
                );
                Err(if code == 3 { Failure::unreadable(message) } else { Failure::failed(message) })
            }
        }
    }

    /// Exports one of several runs. Replaces an older archive of the run, which contains nothing else because
    /// trajectories only grow.
    fn export_into(
        &self,
        folder: &Path,
        run: &RunSummary,
        (key, seal_key): &ExportKeys,
    ) -> Result<(Sealing, Seal, PathBuf), RunError> {
        let export = Sealing::prepare(folder, &self.out, seal_key)?;
        let archive = self.out.join(format!("{}.tar.gz", run.id));
        let seal = export.write(&archive, true, key.as_ref())?;
        Ok((export, seal, archive))
    }
}

/// Returns the visit records in the folders of runs. If a label is given, returns only the records of this label.
fn find_visits(folders: &[PathBuf], label: Option<&str>) -> Vec<FoundVisit> {
    let visits_in_folder = |folder: &PathBuf| {
        let lines = read_visits(&folder.join(VISITS_FILE)).into_iter();
        let folder = folder.clone();
        lines.map(move |line| FoundVisit { line, folder: folder.clone() })
    };
    let all = folders.iter().flat_map(visits_in_folder);
    all.filter(|visit| label.is_none_or(|label| visit.line.label == label)).collect()
}

/// Writes every table to a folder as comma-separated values.
pub fn write_tables(tables: StudyTables, folder: &Path) -> Result<(), Failure> {
    for (name, rows) in tables.into_files() {
        let path = folder.join(format!("{name}.csv"));
        write_text(&path, &to_csv(&rows)?)?;
    }
    Ok(())
}

/// Removes incomplete archives if a signal ends the program, because incomplete archives may contain hidden
/// data.
pub fn remove_partial_files_on_signals() {
    #[cfg(unix)]
    {
        use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
        // Without signal handlers, signals end the program at once.
        let Ok(mut signals) = signal_hook::iterator::Signals::new([SIGINT, SIGTERM, SIGHUP]) else { return };
        std::thread::spawn(move || {
            if let Some(signal) = signals.forever().next() {
                remove_temporary_folders();
                std::process::exit(128 + signal);
            }
        });
    }
}

/// Formats rows as comma-separated values. Text is escaped so that spreadsheets do not interpret it as formulas or commands.
pub fn to_csv(rows: &[Vec<String>]) -> Result<String, Failure> {
    let wrong = |error: String| Failure::failed(format!("cannot write the table as CSV: {error}"));
    let mut writer = csv::Writer::from_writer(Vec::new());
    for row in rows {
        writer
            .write_record(row.iter().map(|cell| escape_csv_cell(cell).into_owned()))
            .map_err(|error| wrong(error.to_string()))?;
    }
    let bytes = writer.into_inner().map_err(|error| wrong(error.to_string()))?;
    String::from_utf8(bytes).map_err(|error| wrong(error.to_string()))
}

/// Prints the description of every exported column.
pub fn explain_columns(json: bool) -> Result<(), Failure> {
    if json {
        let all: serde_json::Map<String, Value> =
            table_headings().into_iter().map(|(table, columns)| (table.to_owned(), json!(columns))).collect();
        return print(&(serde_json::to_string_pretty(&all).unwrap_or_default() + "\n"));
    }
    print(&markdown_table(&column_descriptions()))
}

/// Formats rows as an aligned Markdown table. The first row is the header.
fn markdown_table(rows: &[Vec<String>]) -> String {
    let columns = rows.first().map_or(0, Vec::len);
    let width = |at: usize| rows.iter().map(|row| row[at].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let line = |row: &Vec<String>| {
        let cells = row.iter().zip(&widths).map(|(cell, width)| format!("{cell:<width$}"));
        format!("| {} |\n", cells.collect::<Vec<_>>().join(" | "))
    };
    let rule: Vec<String> = widths.iter().map(|width| "-".repeat(*width)).collect();
    rows.iter().take(1).map(line).chain([line(&rule)]).chain(rows.iter().skip(1).map(line)).collect()
}

fn export_line(seal: &Seal, archive: &Path, day: u32, key: Option<&LabKey>) -> String {
    let signed = key
        .map_or(String::new(), |key| format!("  signed by the lab key {}\n", key.public_key().fingerprint()));
    format!(
        "{}  day {day}, {} lines  {}\n  checksum {}\n{signed}",
        seal.run,
        seal.last_seq + 1,
        archive.display(),
        seal.checksum
    )
}

fn export_to_json(seal: &Seal, archive: &Path, day: u32, key: Option<&LabKey>) -> Value {
    let signer = key.map(|key| key.public_key().fingerprint());
    json!({ "run": seal.run, "day": day, "lines": seal.last_seq + 1, "file": archive, "checksum": seal.checksum, "signed_by": signer })
}

impl Import {
    /// Imports the archives. If an archive fails, the remaining archives are still imported.
    pub fn run(&self, runs: &Path, json: bool, context: &Context) -> Result<(), Failure> {
        remove_partial_files_on_signals();
        #[cfg(feature = "server")]
        match &self.transcript {
            Some(file) => return import_transcript(file, &self.made_of, json, context),
            None if self.made_of.is_specified() => {
                return Err(Failure::usage(
                    "an archive contains the options of its run; options of a run need --transcript",
                ));
            }
            None => {}
        }
        #[cfg(not(feature = "server"))]
        let _ = context;
        if self.under.is_some() && self.files.len() > 1 {
            return Err(Failure::usage("--under needs exactly one archive"));
        }
        #[cfg(feature = "server")]
        self.reject_transcripts()?;
        let mut failures: Vec<Failure> = Vec::new();
        for file in &self.files {
            match import_run(runs, file, self.under.as_deref()) {
                Ok((seal, signer, imported)) => {
                    print(&describe_import(&seal, signer.as_ref(), &imported, json, self.under.as_deref()))?;
                }
                Err(error) => failures.push(error.into()),
            }
        }
        // The failure with the highest exit code determines the exit code of the command.
        failures.sort_by_key(|failure| std::cmp::Reverse(failure.code));
        let mut failures = failures.into_iter();
        match failures.next() {
            None => Ok(()),
            Some(worst) => {
                let texts: Vec<String> = std::iter::once(worst.to_string())
                    .chain(failures.map(|other| other.to_string()))
                    .collect();
                let message = texts.join("; ");
                Err(if worst.code == 3 { Failure::unreadable(message) } else { Failure::failed(message) })
            }
        }
    }
}

#[cfg(feature = "server")]
impl Import {
    /// Rejects files that need `--transcript`.
    fn reject_transcripts(&self) -> Result<(), Failure> {
        let is_log = |file: &&PathBuf| {
            file.extension().is_some_and(|extension| extension == "eval" || extension == "json")
        };
        let Some(log) = self.files.iter().find(is_log) else { return Ok(()) };
        Err(Failure::usage(format!(
            "{} is not an archive of a run. To play the tool calls of a log or trajectory in a new run, use `novamind runs import --transcript {}`. \
             Nothing was imported",
            log.display(),
            shell_quoted(log)
        )))
    }
}

fn describe_import(
    seal: &Seal,
    signer: Option<&LabPublicKey>,
    imported: &ImportOutcome,
    json: bool,
    under: Option<&str>,
) -> String {
    let (new, remark) = match imported {
        ImportOutcome::New(_) => (true, "imported; the database is built when you first open the run"),
        ImportOutcome::AlreadyPresent { notes_differ: false } => {
            (false, "already exists with the same lines; nothing was changed")
        }
        ImportOutcome::AlreadyPresent { notes_differ: true } => {
            (false, "already exists with the same lines, but with other notes; nothing was changed")
        }
    };
    if json {
        let answer = json!({ "run": under.unwrap_or(&seal.run), "new": new, "lines": seal.last_seq + 1, "checksum": seal.checksum, "signed_by": signer.map(LabPublicKey::fingerprint) });
        return format!("{answer}\n");
    }
    let signed = match signer {
        Some(key) => format!("signed by the lab key {}", key.fingerprint()),
        None => "not signed".to_owned(),
    };
    let name = under.map_or(String::new(), |name| format!(" as {name}"));
    format!("run {}{name}: {remark}\n  checksum {}\n  {signed}\n", seal.run, seal.checksum)
}
