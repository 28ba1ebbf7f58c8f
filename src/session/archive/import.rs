//! Import of runs from archives.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use flate2::read::MultiGzDecoder;

use super::lab_key::{LabPublicKey, verify_signature};
use super::seal::{CopyError, SEAL_FORMAT, Seal, SealedFile, copy_hashed};
use super::temporary_folder::TemporaryFolder;
use crate::archive::{
    DATABASE_FILE, ENTRY_LIMITS, MANIFEST_FILE, NOTES_FILE, SEAL_FILE, SIGNATURE_FILE, TRAJECTORY_FILE,
    archive_error, is_run_id,
};
use novamind_base::formatting::pluralize;
use novamind_record::error::RunError;
use novamind_record::files::sync_folder;
use novamind_record::folder::manifest::Manifest;
use novamind_record::folder::manifest_check::check_start;
use novamind_record::folder::runs::{
    PARTICIPANTS_FOLDER, all_run_folders, participant_folder, participant_of_folder,
};
use novamind_record::trajectory::{Line, Record, Trajectory};

/// The result of importing an archive.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ImportOutcome {
    /// The run was imported into this folder.
    New(PathBuf),
    /// An identical run already exists; nothing was changed.
    AlreadyPresent {
        /// Whether the notes in the archive differ from the notes of the existing run.
        notes_differ: bool,
    },
}

/// The seal of an archive, its signer and the result of the import.
pub type ImportResult = (Seal, Option<LabPublicKey>, ImportOutcome);

/// Imports the run in an archive into a runs folder. Returns the seal, the signer (if the archive is signed) and the
/// outcome. Before creating the run, checks the seal, the hash of every file, the hash chain of the trajectory, and
/// that the archive has no other files.
///
/// If `name` is given, imports the run under that name, even if the folder already contains a recording of the same
/// run. The lines keep the original run id.
///
/// # Errors
/// [`RunError::InvalidArchive`] if the archive is damaged or unsafe, or is not an archive of a run; the error names the
/// file. [`RunError::AlreadyExists`] if the folder contains the run with an earlier, later or different trajectory or
/// manifest, or if `name` is in use. [`RunError::InvalidRequest`] if `name` is invalid. After an error, nothing has
/// changed.
pub fn import_run(runs: &Path, archive: &Path, name: Option<&str>) -> Result<ImportResult, RunError> {
    if let Some(name) = name.filter(|name| !is_valid_run_name(name)) {
        let message = format!(
            "{name} is not a valid run name: use 1 to 40 letters, digits, - and _. Nothing was imported"
        );
        return Err(RunError::InvalidRequest(message));
    }
    let temporary_folder = TemporaryFolder::create_in(runs)?;
    let unpacked = unpack(archive, temporary_folder.path())?;
    let seal = check_seal(archive, &unpacked)?;
    let signer = unpacked
        .signature_text
        .as_ref()
        .map(|signature| verify_signature(&unpacked.seal_text, signature))
        .transpose();
    let signer = signer.map_err(|problem| archive_error(archive, problem))?;
    let draft = temporary_folder.path().join(&seal.run);
    check_run(archive, &draft, &seal)?;
    let folder = destination_folder(runs, &draft, &seal)?;
    // A run name must be unique on a machine, across all participants.
    let own_name = name.unwrap_or(&seal.run);
    let there = all_run_folders(runs).into_iter().chain([folder.clone()]).map(|path| path.join(own_name));
    if let Some(place) = there.into_iter().find(|place| place.exists()) {
        let same = match name {
            None => compare_with_existing(&draft, &place, &seal)?,
            Some(name) => {
                let message =
                    format!("run {name} already exists in {}. Nothing was imported", place.display());
                return Err(RunError::AlreadyExists(message));
            }
        };
        return Ok((seal, signer, same));
    }
    let place = folder.join(own_name);
    sync_folder(&draft)?;
    std::fs::rename(&draft, &place).map_err(RunError::io(&place))?;
    sync_folder(&folder).inspect_err(|_| drop(std::fs::remove_dir_all(&place)))?;
    Ok((seal, signer, ImportOutcome::New(place)))
}

/// Returns the runs folder for an imported run: the folder of its participant, if that folder exists on this machine.
fn destination_folder(runs: &Path, draft: &Path, seal: &Seal) -> Result<PathBuf, RunError> {
    let whose = Manifest::read(draft)?.participant;
    match (participant_of_folder(runs), whose) {
        (Some(label), Some(other)) if label != other => Err(RunError::InvalidRequest(format!(
            "run {} belongs to {other}, not to {label}: import it with `--as {other}`. Nothing was imported",
            seal.run
        ))),
        (None, Some(label)) => {
            let path = participant_folder(runs, &label).ok().filter(|folder| folder.is_dir());
            Ok(path.unwrap_or_else(|| runs.to_owned()))
        }
        _ => Ok(runs.to_owned()),
    }
}

struct UnpackedArchive {
    run: String,
    files: Vec<SealedFile>,
    seal_text: String,
    signature_text: Option<String>,
}

/// Unpacks the files of an archive to `workshop/<run>/`. The database is hashed but not copied.
fn unpack(archive: &Path, temporary_folder: &Path) -> Result<UnpackedArchive, RunError> {
    let broken = |error: io::Error| {
        archive_error(archive, format!("this is not an archive of a run, or it is truncated ({error})"))
    };
    let mut tar = tar::Archive::new(open_archive(archive)?);
    let mut found = UnpackedArchive {
        run: String::new(),
        files: Vec::new(),
        seal_text: String::new(),
        signature_text: None,
    };
    // Raw mode reads tar extensions as normal entries, so they cannot rename or enlarge the next file.
    for entry in tar.entries().map_err(broken)?.raw(true) {
        let mut entry = entry.map_err(broken)?;
        let name = String::from_utf8_lossy(&entry.path_bytes()).into_owned();
        let kind = entry.header().entry_type();
        if kind == tar::EntryType::Directory && is_run_id(name.trim_end_matches('/')) {
            continue;
        }
        if kind != tar::EntryType::Regular {
            return Err(archive_error(archive, format!("{name} is not a regular file")));
        }
        let (run, file) = split_entry_name(&name)
            .ok_or_else(|| archive_error(archive, format!("{name} is not a file of a run")))?;
        let (file, most) = *ENTRY_LIMITS
            .iter()
            .find(|(known, _)| *known == file)
            .ok_or_else(|| archive_error(archive, format!("{name} is not a file of a run")))?;
        if !found.run.is_empty() && found.run != run {
            return Err(archive_error(
                archive,
                format!("{name} belongs to a different run than {}", found.run),
            ));
        }
        if found.files.iter().any(|known| known.name == file) {
            return Err(archive_error(archive, format!("{name} occurs twice")));
        }
        let size = entry.size();
        if size > most {
            return Err(archive_error(
                archive,
                format!("{name} is too large: {size} bytes; the limit is {most} bytes"),
            ));
        }
        found.run = run.to_owned();
        let path = temporary_folder.join(run).join(file);
        let measured = store_entry(&mut entry, &path, file).map_err(|error| match error {
            CopyError::Read(error) => unreadable_entry(archive, &name, &error),
            // The archive is intact, but the copy cannot be written to the disk.
            CopyError::Write(error) => RunError::Io { path, error },
        })?;
        if file == SEAL_FILE || file == SIGNATURE_FILE {
            let path = temporary_folder.join(run).join(file);
            let text =
                std::fs::read_to_string(&path).map_err(|error| unreadable_entry(archive, &name, &error))?;
            std::fs::remove_file(&path).map_err(RunError::io(&path))?;
            if file == SEAL_FILE { found.seal_text = text } else { found.signature_text = Some(text) }
        }
        found.files.push(measured);
    }
    // Read the compressed file to its end, where its checksum is verified.
    io::copy(&mut tar.into_inner().take(1 << 20), &mut io::sink()).map_err(broken)?;
    Ok(found)
}

fn open_archive(archive: &Path) -> Result<Box<dyn Read>, RunError> {
    let mut file = File::open(archive).map_err(RunError::io(archive))?;
    let mut start = [0u8; 2];
    let count = file.read(&mut start).map_err(RunError::io(archive))?;
    file.seek(SeekFrom::Start(0)).map_err(RunError::io(archive))?;
    let reader = BufReader::new(file);
    let compressed = count == 2 && start == [0x1f, 0x8b];
    Ok(if compressed { Box::new(MultiGzDecoder::new(reader)) } else { Box::new(reader) })
}

/// Splits an entry name of the form `run/file` into run and file. Returns `None` for other names.
fn split_entry_name(name: &str) -> Option<(&str, &str)> {
    let (run, file) = name.strip_prefix("./").unwrap_or(name).split_once('/')?;
    is_run_id(run).then_some((run, file))
}

fn unreadable_entry(archive: &Path, name: &str, error: &io::Error) -> RunError {
    archive_error(archive, format!("{name} cannot be read ({error})"))
}

fn store_entry(entry: &mut dyn Read, path: &Path, file: &str) -> Result<SealedFile, CopyError> {
    let name = file.to_owned();
    if file == DATABASE_FILE {
        let (bytes, blake3) = copy_hashed(entry, &mut io::sink())?;
        return Ok(SealedFile { name, bytes, blake3 });
    }
    let made = path.parent().map_or(Ok(()), std::fs::create_dir_all).and_then(|()| File::create_new(path));
    let mut out = made.map_err(CopyError::Write)?;
    let (bytes, blake3) = copy_hashed(entry, &mut out)?;
    out.sync_all().map_err(CopyError::Write)?;
    Ok(SealedFile { name, bytes, blake3 })
}

/// Parses the seal and compares it with the contents of the archive.
fn check_seal(archive: &Path, found: &UnpackedArchive) -> Result<Seal, RunError> {
    if found.seal_text.is_empty() {
        return Err(archive_error(archive, "seal.toml is missing: this is not an archive of a run"));
    }
    let seal: Seal = toml::from_str(&found.seal_text)
        .map_err(|error| archive_error(archive, format!("seal.toml cannot be read ({})", error.message())))?;
    if seal.format > SEAL_FORMAT {
        let problem = format!(
            "version {} created this archive in format {}; this program reads format {SEAL_FORMAT}. Use that version",
            seal.program, seal.format
        );
        return Err(archive_error(archive, problem));
    }
    if !seal.is_intact() || seal.run != found.run {
        return Err(archive_error(archive, "seal.toml was changed: its checksum does not match"));
    }
    let there: BTreeMap<&str, &SealedFile> =
        found.files.iter().map(|file| (file.name.as_str(), file)).collect();
    for sealed in &seal.file {
        match there.get(sealed.name.as_str()) {
            None => return Err(archive_error(archive, format!("{} is missing", sealed.name))),
            Some(sealed_file) if *sealed_file != sealed => {
                return Err(archive_error(
                    archive,
                    format!("{} is not the file that was sealed", sealed.name),
                ));
            }
            Some(_) => {}
        }
    }
    let sealed = |name: &str| seal.file.iter().any(|file| file.name == name);
    match found
        .files
        .iter()
        .find(|file| ![SEAL_FILE, SIGNATURE_FILE].contains(&file.name.as_str()) && !sealed(&file.name))
    {
        Some(unlisted_file) => {
            Err(archive_error(archive, format!("{} was added after sealing", unlisted_file.name)))
        }
        None => Ok(seal),
    }
}

fn check_run(archive: &Path, draft: &Path, seal: &Seal) -> Result<(), RunError> {
    for name in [MANIFEST_FILE, TRAJECTORY_FILE] {
        if !draft.join(name).exists() {
            return Err(archive_error(archive, format!("{name} is missing")));
        }
    }
    let inside = |error: RunError| archive_error(archive, problem_without_path(error));
    let manifest = Manifest::read(draft).map_err(|error| match error {
        other @ RunError::OtherFormat { .. } => other,
        error => inside(error),
    })?;
    let path = draft.join(TRAJECTORY_FILE);
    let trajectory = Trajectory::read(&path).map_err(inside)?;
    check_start(&path, trajectory.lines.first(), &manifest).map_err(inside)?;
    let last = trajectory.lines.last().map(|line| (line.seq, line.hash.as_str()));
    if trajectory.unfinished_bytes > 0
        || last != Some((seal.last_seq, &seal.last_hash))
        || manifest.id != seal.run
    {
        return Err(archive_error(archive, "trajectory.jsonl does not end with the line that was sealed"));
    }
    Ok(())
}

/// Describes an error in the unpacked copies without the temporary path.
fn problem_without_path(error: RunError) -> String {
    match error {
        RunError::Damaged { path, line, problem, .. } => {
            let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
            format!("{name}, line {line}: {problem}")
        }
        other => other.to_string(),
    }
}

/// Compares the existing run with the run in the archive.
fn compare_with_existing(draft: &Path, place: &Path, seal: &Seal) -> Result<ImportOutcome, RunError> {
    let read = |folder: &Path, name: &str| std::fs::read(folder.join(name)).unwrap_or_default();
    let (bytes, there) = (read(draft, TRAJECTORY_FILE), read(place, TRAJECTORY_FILE));
    if read(draft, MANIFEST_FILE) == read(place, MANIFEST_FILE) && bytes == there {
        return Ok(ImportOutcome::AlreadyPresent {
            notes_differ: read(draft, NOTES_FILE) != read(place, NOTES_FILE),
        });
    }
    let how = if there.starts_with(&bytes) {
        "the existing run was continued after the export".to_owned()
    } else if bytes.starts_with(&there) {
        "the archive has a later state of this run; delete or move the existing run to import the archive"
            .to_owned()
    } else {
        describe_difference(draft, place)
    };
    Err(RunError::AlreadyExists(format!(
        "run {} already exists in {}: {how}. Nothing was changed; to import under another name, use --under NAME",
        seal.run,
        place.display()
    )))
}

fn describe_difference(draft: &Path, place: &Path) -> String {
    let lines = |folder: &Path| Trajectory::read(&folder.join(TRAJECTORY_FILE)).map(|read| read.lines);
    let draft_lines = lines(draft).unwrap_or_default();
    let there = match lines(place) {
        Ok(lines) if !lines.is_empty() => lines,
        Ok(_) => return "the existing record has no lines".to_owned(),
        Err(problem) => return format!("the existing record cannot be compared ({problem})"),
    };
    let same = draft_lines
        .iter()
        .zip(&there)
        .take_while(|(draft_line, line_there)| draft_line.hash == line_there.hash)
        .count();
    let reach = |lines: &[Line]| {
        let day = lines.last().map_or(0, |line| line.day);
        format!("{} up to day {day}", pluralize(lines.len() as u32, "line"))
    };
    let line = |lines: &[Line]| lines.get(same).map_or("nothing".to_owned(), describe_line);
    if draft_lines.len() == there.len() && same == draft_lines.len() {
        return "the lines are the same, but run.toml differs".to_owned();
    }
    format!(
        "the records differ from line {}: the existing record has {}, the archive has {}; the existing record has {}, \
         the archive has {}",
        same + 1,
        line(&there),
        line(&draft_lines),
        reach(&there),
        reach(&draft_lines)
    )
}

/// Describes a line: its kind, the tool of a call, the day and the time.
fn describe_line(line: &Line) -> String {
    let what = match &line.record {
        Record::Call(call) => format!("a call of {}", call.tool),
        record => format!("a {} line", record.kind()),
    };
    format!("{what} on day {}, written {}", line.day, line.at)
}

/// Returns whether a run in a runs folder can have this name.
fn is_valid_run_name(name: &str) -> bool {
    let fits = |letter: u8| letter.is_ascii_alphanumeric() || matches!(letter, b'-' | b'_');
    (1..=40).contains(&name.len()) && name.bytes().all(fits) && name != PARTICIPANTS_FOLDER
}
