//! Creates archives.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use flate2::Compression;
use flate2::write::GzEncoder;

use super::lab_key::LabKey;
use super::seal::{SEAL_FORMAT, Seal, SealedFile};
use super::workshop::Workshop;
use crate::archive::{DATABASE, MANIFEST, MEMO, SEAL, SIGNATURE, TRAJECTORY, is_compressed};
use crate::play::Session;
use crate::play::memo::notes_file;
use crate::play::open::Access;
use crate::recording::recorder::{AFTERWARDS, lines_afterwards};
use crate::snapshot::integrity::Integrity;
use crate::snapshot::sealing::SealKey;
use novamind_record::error::RunError;
use novamind_record::files::{folder_of, sync_folder};
use novamind_record::folder::derived::{Derived, check_start};
use novamind_record::folder::manifest::Manifest;
use novamind_record::lesson::{PLAN_FILE, TEXTS_FILE};
use novamind_record::trajectory::{Line, Trajectory};

/// A verified copy of a run, ready to be inspected and archived.
///
/// The copy is the run on disk at the time of the call. A program that plays the run is not disturbed.
pub struct Export {
    session: Session,
    trajectory: Trajectory,
    afterwards: Vec<Line>,
    /// Folder with copies of the files; must outlive the session.
    copies: PathBuf,
    _workshop: Workshop,
}

impl Export {
    /// Copies the run in a folder and verifies it by simulation. The copies are in a hidden folder in `beside`, which
    /// should be on the disk of the archive. `key` is the key of the run's snapshots.
    ///
    /// # Errors
    /// [`RunError::Damaged`] if the run is damaged, with the file, the line and what is safe. Other errors if the run
    /// has another version, or if `beside` cannot be written.
    pub fn prepare(folder: &Path, beside: &Path, key: &SealKey) -> Result<Export, RunError> {
        let derived = Derived::of(folder)?;
        let manifest = derived.manifest.clone();
        let (bytes, mut trajectory) = read_settled(folder, &manifest, key)?;
        let workshop = Workshop::within(beside)?;
        let own = &workshop.path().join(&manifest.id);
        std::fs::create_dir(own).map_err(RunError::io(own))?;
        let put = |name: &str, bytes: &[u8]| {
            let path = own.join(name);
            std::fs::write(&path, bytes).map_err(RunError::io(&path))
        };
        match derived.problem {
            None => {
                let own = folder.join(MANIFEST);
                put(MANIFEST, &std::fs::read(&own).map_err(RunError::io(&own))?)?;
            }
            Some(_) => manifest.write(own)?,
        }
        // A line without a line end was never confirmed: another program may be writing it.
        put(TRAJECTORY, bytes.get(..trajectory.length as usize).unwrap_or(&bytes))?;
        trajectory.unfinished = 0;
        let after = lines_afterwards(folder, &trajectory)?;
        if !after.lines.is_empty() {
            let path = folder.join(AFTERWARDS);
            let bytes = std::fs::read(&path).map_err(RunError::io(&path))?;
            put(AFTERWARDS, bytes.get(..after.length as usize).unwrap_or(&bytes))?;
        }
        for name in [PLAN_FILE, TEXTS_FILE].into_iter().filter(|_| manifest.lesson.is_some()) {
            let path = folder.join(name);
            put(name, &std::fs::read(&path).map_err(RunError::io(&path))?)?;
        }
        let memo = notes_file(folder, &trajectory);
        match std::fs::read(&memo) {
            Ok(bytes) => put(MEMO, &bytes)?,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => {}
            Err(error) => return Err(RunError::Io { path: memo, error }),
        }
        let session = Session::open(own, Access::Read, true).map_err(|error| moved(error, own, folder))?;
        Ok(Export { session, trajectory, afterwards: after.lines, copies: own.clone(), _workshop: workshop })
    }

    /// Returns the run, open for reading.
    pub fn session(&self) -> &Session {
        &self.session
    }

    /// Returns the lines of the trajectory.
    pub fn trajectory(&self) -> &Trajectory {
        &self.trajectory
    }

    /// Returns the lines recorded after the end of the run.
    pub fn afterwards(&self) -> &[Line] {
        &self.afterwards
    }

    /// Writes the archive atomically. Signs it if `key` is given.
    ///
    /// # Errors
    /// [`RunError::Exists`] if the file exists and `replace` is false. [`RunError::Io`] if the disk fails.
    pub fn write(&self, archive: &Path, replace: bool, key: Option<&LabKey>) -> Result<Seal, RunError> {
        if !replace && archive.exists() {
            let message = format!("{} already exists: choose another name, or remove it", archive.display());
            return Err(RunError::Exists(message));
        }
        let database = self.copies.join(DATABASE);
        // The archive can be written twice. The database is copied for each.
        let _ = std::fs::remove_file(&database);
        self.session.database().copy_to(&database)?;
        let seal = self.seal()?;
        let folder = folder_of(archive);
        let workshop = Workshop::within(folder)?;
        let draft = workshop.path().join("archive");
        let written = self.pack(&draft, is_compressed(archive), (&seal, key));
        let placed = written.and_then(|()| std::fs::rename(&draft, archive));
        placed.map_err(RunError::io(archive))?;
        sync_folder(folder)?;
        Ok(seal)
    }

    fn seal(&self) -> Result<Seal, RunError> {
        let folder = &self.copies;
        let there = [MANIFEST, TRAJECTORY, AFTERWARDS, PLAN_FILE, TEXTS_FILE, MEMO, DATABASE]
            .into_iter()
            .filter(|name| folder.join(name).exists());
        let file = there.map(|name| SealedFile::of(folder, name)).collect::<Result<_, _>>()?;
        let last = self.trajectory.lines.last();
        let seal = Seal {
            format: SEAL_FORMAT,
            program: env!("CARGO_PKG_VERSION").to_owned(),
            // Not the time of the export: an unchanged run always has the same seal.
            created: last.map(|line| line.at.clone()).unwrap_or_default(),
            run: self.session.manifest().id.clone(),
            last_seq: last.map_or(0, |line| line.seq),
            last_hash: last.map(|line| line.hash.clone()).unwrap_or_default(),
            checksum: String::new(),
            file,
        };
        Ok(seal.signed())
    }

    fn pack(&self, draft: &Path, compressed: bool, seal: (&Seal, Option<&LabKey>)) -> std::io::Result<()> {
        let file = BufWriter::new(File::create_new(draft)?);
        let file = if compressed {
            let packer = GzEncoder::new(file, Compression::default());
            self.fill(packer, seal)?.finish()?
        } else {
            self.fill(file, seal)?
        };
        file.into_inner().map_err(std::io::IntoInnerError::into_error)?.sync_all()
    }

    fn fill<W: Write>(&self, out: W, (seal, key): (&Seal, Option<&LabKey>)) -> std::io::Result<W> {
        let mut archive = tar::Builder::new(out);
        let text = seal.text();
        archive.append(&header(&seal.run, SEAL, text.len() as u64)?, text.as_bytes())?;
        if let Some(signature) = key.map(|key| key.sign(&text)) {
            archive.append(&header(&seal.run, SIGNATURE, signature.len() as u64)?, signature.as_bytes())?;
        }
        for sealed in &seal.file {
            let file = File::open(self.copies.join(&sealed.name))?;
            archive.append(&header(&seal.run, &sealed.name, sealed.bytes)?, file)?;
        }
        archive.into_inner()
    }
}

/// Reads a trajectory that another program may be writing, and checks it against manifest and integrity. Reads these
/// two first, so that the trajectory is at least as new as they are.
fn read_settled(
    folder: &Path,
    manifest: &Manifest,
    key: &SealKey,
) -> Result<(Vec<u8>, Trajectory), RunError> {
    let path = folder.join(TRAJECTORY);
    let integrity = Integrity::of(folder, manifest, key);
    let bytes = std::fs::read(&path).map_err(RunError::io(&path))?;
    let trajectory = Trajectory::of_file(&path, &bytes)?;
    check_start(&path, trajectory.lines.first(), manifest)?;
    integrity.check(&path, &trajectory)?;
    Ok((bytes, trajectory))
}

/// Returns a tar header without owner and time, so that it does not depend on the machine.
fn header(run: &str, name: &str, bytes: u64) -> std::io::Result<tar::Header> {
    let mut header = tar::Header::new_ustar();
    header.set_path(format!("{run}/{name}"))?;
    header.set_size(bytes);
    header.set_mode(0o644);
    header.set_entry_type(tar::EntryType::Regular);
    header.set_cksum();
    Ok(header)
}

/// Replaces paths of the copies in an error by the original paths.
fn moved(error: RunError, copies: &Path, folder: &Path) -> RunError {
    let original = |path: PathBuf| match path.strip_prefix(copies) {
        Ok(name) => folder.join(name),
        Err(_) => path,
    };
    match error {
        RunError::Damaged { path, line, problem, safe } => {
            RunError::Damaged { path: original(path), line, problem, safe }
        }
        other => other,
    }
}
