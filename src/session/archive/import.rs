//! Taking an archive in.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use flate2::read::MultiGzDecoder;

use super::lab_key::{LabPublicKey, signer_of};
use super::seal::{CopyError, SEAL_FORMAT, Seal, SealedFile, copy_hashed};
use super::workshop::Workshop;
use crate::archive::{DATABASE, FILES, MANIFEST, MEMO, SEAL, SIGNATURE, TRAJECTORY, is_run_name, refused};
use novamind_record::error::RunError;
use novamind_record::files::sync_folder;
use novamind_record::folder::derived::check_start;
use novamind_record::folder::manifest::Manifest;
use novamind_record::folder::runs::{PARTICIPANTS, all_run_folders, label_of, participant_folder};
use novamind_record::trajectory::{Line, Record, Trajectory};

/// What became of an archive.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Imported {
    /// The run is there now, in this folder.
    New(PathBuf),
    /// The same run, line for line, was there already; nothing was changed.
    Same {
        /// The notes that came with the archive differ from those that are there.
        other_memo: bool,
    },
}

/// The seal of an archive, who signed it, and what became of its run.
pub type ImportedRun = (Seal, Option<LabPublicKey>, Imported);

/// Takes the run of an archive into a folder of runs; tells whose signature it has, if it has one. Everything is checked
/// before anything is there: the seal, the hash of every file, the chain of the trajectory, and that nothing else is in the
/// archive. Under a name of its own it stands beside another record of the same run; its lines keep saying which run it is.
///
/// # Errors
/// [`RunError::Archive`] for what is damaged, foreign or dangerous, naming the file; [`RunError::Exists`] when another
/// state of the run is there, or the name is taken; [`RunError::NotPossible`] for what is no name. Nothing has changed then.
pub fn import_run(runs: &Path, archive: &Path, name: Option<&str>) -> Result<ImportedRun, RunError> {
    if let Some(name) = name.filter(|name| !is_folder_name(name)) {
        let message =
            format!("{name} is no name for a run: up to 40 letters, digits, - and _. Nothing was imported");
        return Err(RunError::NotPossible(message));
    }
    let workshop = Workshop::within(runs)?;
    let unpacked = unpack(archive, workshop.path())?;
    let seal = check_seal(archive, &unpacked)?;
    let signer =
        unpacked.signature.as_ref().map(|signature| signer_of(&unpacked.seal, signature)).transpose();
    let signer = signer.map_err(|problem| refused(archive, problem))?;
    let draft = workshop.path().join(&seal.run);
    check_run(archive, &draft, &seal)?;
    let folder = folder_for(runs, &draft, &seal)?;
    // A name is on a machine once, whoever's folder it is in.
    let own_name = name.unwrap_or(&seal.run);
    let there = all_run_folders(runs).into_iter().chain([folder.clone()]).map(|own| own.join(own_name));
    if let Some(place) = there.into_iter().find(|place| place.exists()) {
        let same = match name {
            None => compare(&draft, &place, &seal)?,
            Some(name) => {
                let message =
                    format!("there is a run {name} in {} already. Nothing was imported", place.display());
                return Err(RunError::Exists(message));
            }
        };
        return Ok((seal, signer, same));
    }
    let place = folder.join(own_name);
    sync_folder(&draft)?;
    std::fs::rename(&draft, &place).map_err(RunError::io(&place))?;
    sync_folder(&folder).inspect_err(|_| drop(std::fs::remove_dir_all(&place)))?;
    Ok((seal, signer, Imported::New(place)))
}

/// The folder of runs that a run belongs in: that of its participant where they have one on this machine.
fn folder_for(runs: &Path, draft: &Path, seal: &Seal) -> Result<PathBuf, RunError> {
    let whose = Manifest::read(draft)?.participant;
    match (label_of(runs), whose) {
        (Some(label), Some(other)) if label != other => Err(RunError::NotPossible(format!(
            "run {} belongs to {other}, not to {label}: import it with `--as {other}`. Nothing was imported",
            seal.run
        ))),
        (None, Some(label)) => {
            let own = participant_folder(runs, &label).ok().filter(|folder| folder.is_dir());
            Ok(own.unwrap_or_else(|| runs.to_owned()))
        }
        _ => Ok(runs.to_owned()),
    }
}

/// What was found in an archive.
struct Unpacked {
    run: String,
    files: Vec<SealedFile>,
    seal: String,
    signature: Option<String>,
}

/// Copies the files of an archive into `workshop/<run>/`, but for the database, which is only measured.
fn unpack(archive: &Path, workshop: &Path) -> Result<Unpacked, RunError> {
    let broken = |error: io::Error| {
        refused(archive, format!("this is not an archive of a run, or it is cut short ({error})"))
    };
    let mut tar = tar::Archive::new(open(archive)?);
    let mut found = Unpacked { run: String::new(), files: Vec::new(), seal: String::new(), signature: None };
    // Raw: extensions that rename or enlarge the next file are not followed but refused.
    for entry in tar.entries().map_err(broken)?.raw(true) {
        let mut entry = entry.map_err(broken)?;
        let name = String::from_utf8_lossy(&entry.path_bytes()).into_owned();
        let kind = entry.header().entry_type();
        if kind == tar::EntryType::Directory && is_run_name(name.trim_end_matches('/')) {
            continue;
        }
        if kind != tar::EntryType::Regular {
            return Err(refused(archive, format!("{name} is not an ordinary file")));
        }
        let (run, file) =
            parts(&name).ok_or_else(|| refused(archive, format!("{name} does not belong to a run")))?;
        let (file, most) = *FILES
            .iter()
            .find(|(known, _)| *known == file)
            .ok_or_else(|| refused(archive, format!("{name} does not belong to a run")))?;
        if !found.run.is_empty() && found.run != run {
            return Err(refused(archive, format!("{name} belongs to another run than {}", found.run)));
        }
        if found.files.iter().any(|known| known.name == file) {
            return Err(refused(archive, format!("{name} occurs twice")));
        }
        let size = entry.size();
        if size > most {
            return Err(refused(
                archive,
                format!("{name} is too large: {size} bytes, but at most {most} are expected"),
            ));
        }
        found.run = run.to_owned();
        let path = workshop.join(run).join(file);
        let measured = store(&mut entry, &path, file).map_err(|error| match error {
            CopyError::Read(error) => broken_file(archive, &name, &error),
            // The archive is as good as it was: there is no room for it here.
            CopyError::Write(error) => RunError::Io { path, error },
        })?;
        if file == SEAL || file == SIGNATURE {
            let path = workshop.join(run).join(file);
            let text = std::fs::read_to_string(&path).map_err(|error| broken_file(archive, &name, &error))?;
            std::fs::remove_file(&path).map_err(RunError::io(&path))?;
            if file == SEAL { found.seal = text } else { found.signature = Some(text) }
        }
        found.files.push(measured);
    }
    // The end of a compressed file vouches for all of it.
    io::copy(&mut tar.into_inner().take(1 << 20), &mut io::sink()).map_err(broken)?;
    Ok(found)
}

/// Opens an archive, compressed or not.
fn open(archive: &Path) -> Result<Box<dyn Read>, RunError> {
    let mut file = File::open(archive).map_err(RunError::io(archive))?;
    let mut start = [0u8; 2];
    let count = file.read(&mut start).map_err(RunError::io(archive))?;
    file.seek(SeekFrom::Start(0)).map_err(RunError::io(archive))?;
    let reader = BufReader::new(file);
    let compressed = count == 2 && start == [0x1f, 0x8b];
    Ok(if compressed { Box::new(MultiGzDecoder::new(reader)) } else { Box::new(reader) })
}

/// Run and file of a name, if it has exactly this form.
fn parts(name: &str) -> Option<(&str, &str)> {
    let (run, file) = name.strip_prefix("./").unwrap_or(name).split_once('/')?;
    is_run_name(run).then_some((run, file))
}

fn broken_file(archive: &Path, name: &str, error: &io::Error) -> RunError {
    refused(archive, format!("{name} cannot be read ({error})"))
}

fn store(entry: &mut dyn Read, path: &Path, file: &str) -> Result<SealedFile, CopyError> {
    let name = file.to_owned();
    if file == DATABASE {
        // A projection: it is made anew from the trajectory, but its hash counts.
        let (bytes, blake3) = copy_hashed(entry, &mut io::sink())?;
        return Ok(SealedFile { name, bytes, blake3 });
    }
    let made = path.parent().map_or(Ok(()), std::fs::create_dir_all).and_then(|()| File::create_new(path));
    let mut out = made.map_err(CopyError::Write)?;
    let (bytes, blake3) = copy_hashed(entry, &mut out)?;
    out.sync_all().map_err(CopyError::Write)?;
    Ok(SealedFile { name, bytes, blake3 })
}

/// Reads the seal and compares it with what was found.
fn check_seal(archive: &Path, found: &Unpacked) -> Result<Seal, RunError> {
    if found.seal.is_empty() {
        return Err(refused(archive, "seal.toml is missing: this is not an archive of a run"));
    }
    let seal: Seal = toml::from_str(&found.seal)
        .map_err(|error| refused(archive, format!("seal.toml cannot be read ({})", error.message())))?;
    if seal.format > SEAL_FORMAT {
        let problem = format!(
            "version {} made it in format {}, but this program reads format {SEAL_FORMAT}: use that version",
            seal.program, seal.format
        );
        return Err(refused(archive, problem));
    }
    if !seal.is_intact() || seal.run != found.run {
        return Err(refused(archive, "seal.toml was changed: its checksum does not match"));
    }
    let there: BTreeMap<&str, &SealedFile> =
        found.files.iter().map(|file| (file.name.as_str(), file)).collect();
    for sealed in &seal.file {
        match there.get(sealed.name.as_str()) {
            None => return Err(refused(archive, format!("{} is missing", sealed.name))),
            Some(own) if *own != sealed => {
                return Err(refused(archive, format!("{} is not the file that was sealed", sealed.name)));
            }
            Some(_) => {}
        }
    }
    let sealed = |name: &str| seal.file.iter().any(|file| file.name == name);
    match found
        .files
        .iter()
        .find(|file| ![SEAL, SIGNATURE].contains(&file.name.as_str()) && !sealed(&file.name))
    {
        Some(stranger) => Err(refused(archive, format!("{} was added after sealing", stranger.name))),
        None => Ok(seal),
    }
}

/// Checks the run itself: manifest, chain of the trajectory, and that they belong together.
fn check_run(archive: &Path, draft: &Path, seal: &Seal) -> Result<(), RunError> {
    for name in [MANIFEST, TRAJECTORY] {
        if !draft.join(name).exists() {
            return Err(refused(archive, format!("{name} is missing")));
        }
    }
    let inside = |error: RunError| refused(archive, problem_inside(error));
    let manifest = Manifest::read(draft).map_err(|error| match error {
        other @ RunError::OtherFormat { .. } => other,
        error => inside(error),
    })?;
    let path = draft.join(TRAJECTORY);
    let trajectory = Trajectory::read(&path).map_err(inside)?;
    check_start(&path, trajectory.lines.first(), &manifest).map_err(inside)?;
    let last = trajectory.lines.last().map(|line| (line.seq, line.hash.as_str()));
    if trajectory.unfinished > 0 || last != Some((seal.last_seq, &seal.last_hash)) || manifest.id != seal.run
    {
        return Err(refused(archive, "trajectory.jsonl does not end with the line that was sealed"));
    }
    Ok(())
}

/// An error of the copies in words that do not name their places.
fn problem_inside(error: RunError) -> String {
    match error {
        RunError::Damaged { path, line, problem, .. } => {
            let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
            format!("{name}, line {line}: {problem}")
        }
        other => other.to_string(),
    }
}

/// Whether the run that is there is the one of the archive.
fn compare(draft: &Path, place: &Path, seal: &Seal) -> Result<Imported, RunError> {
    let read = |folder: &Path, name: &str| std::fs::read(folder.join(name)).unwrap_or_default();
    let (own, there) = (read(draft, TRAJECTORY), read(place, TRAJECTORY));
    if read(draft, MANIFEST) == read(place, MANIFEST) && own == there {
        return Ok(Imported::Same { other_memo: read(draft, MEMO) != read(place, MEMO) });
    }
    let how = if there.starts_with(&own) {
        "it is the same run, played further since the archive was made".to_owned()
    } else if own.starts_with(&there) {
        "the archive holds a later state of it; delete or move the older one to import it".to_owned()
    } else {
        difference(draft, place)
    };
    Err(RunError::Exists(format!(
        "run {} already exists in {}: {how}. Nothing was changed; --under NAME imports the record beside it, under another name",
        seal.run,
        place.display()
    )))
}

/// In what two records of a run differ.
fn difference(draft: &Path, place: &Path) -> String {
    let lines = |folder: &Path| Trajectory::read(&folder.join(TRAJECTORY)).map(|read| read.lines);
    let own = lines(draft).unwrap_or_default();
    let there = match lines(place) {
        Ok(lines) if !lines.is_empty() => lines,
        Ok(_) => return "the record there has no line".to_owned(),
        Err(problem) => return format!("the record there cannot be compared ({problem})"),
    };
    let same = own.iter().zip(&there).take_while(|(own, there)| own.hash == there.hash).count();
    let reach = |lines: &[Line]| {
        let day = lines.last().map_or(0, |line| line.day);
        format!("{} lines up to day {day}", lines.len())
    };
    let line = |lines: &[Line]| lines.get(same).map_or("nothing".to_owned(), line_in_words);
    if own.len() == there.len() && same == own.len() {
        return "the lines are the same, and run.toml is another one".to_owned();
    }
    format!(
        "the records differ from line {} on: there it is {}, in the archive {}; there are {}, in the archive {}",
        same + 1,
        line(&there),
        line(&own),
        reach(&there),
        reach(&own)
    )
}

/// A line in few words: its kind, the tool of a call, the day and the moment.
fn line_in_words(line: &Line) -> String {
    let what = match &line.record {
        Record::Call(call) => format!("a call of {}", call.tool),
        record => format!("a line {}", record.kind()),
    };
    format!("{what} on day {}, written {}", line.day, line.at)
}

/// Whether a folder of runs can hold a run under a name.
fn is_folder_name(name: &str) -> bool {
    let fits = |letter: u8| letter.is_ascii_alphanumeric() || matches!(letter, b'-' | b'_');
    (1..=40).contains(&name.len()) && name.bytes().all(fits) && name != PARTICIPANTS
}
