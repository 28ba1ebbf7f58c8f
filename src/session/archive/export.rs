//! Export of runs to archives.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use flate2::Compression;
use flate2::write::GzEncoder;

use super::lab_key::LabKey;
use super::seal::{SEAL_FORMAT, Seal, SealedFile};
use super::temporary_folder::TemporaryFolder;
use crate::archive::{
    DATABASE_FILE, MANIFEST_FILE, NOTES_FILE, SEAL_FILE, SIGNATURE_FILE, TRAJECTORY_FILE, is_compressed,
};
use crate::play::Session;
use crate::play::notes::current_notes_file;
use crate::play::open::Access;
use crate::recording::recorder::{AFTERWARDS_FILE, read_afterwards};
use crate::snapshot::integrity::Integrity;
use crate::snapshot::sealing::SealKey;
use novamind_record::error::RunError;
use novamind_record::files::{parent_folder, sync_folder};
use novamind_record::folder::manifest::Manifest;
use novamind_record::folder::manifest_check::{ManifestCheck, check_start};
use novamind_record::lesson::{PLAN_FILE, TEXTS_FILE};
use novamind_record::trajectory::{Line, Trajectory};

/// A verified copy of a run, ready to be inspected and archived.
///
/// The copy contains the files of the run at the time of the export. Another program can play the run during the
/// export.
pub struct Export {
    session: Session,
    trajectory: Trajectory,
    afterwards_lines: Vec<Line>,
    /// Folder with copies of the run's files; must outlive the session.
    copied_folder: PathBuf,
    _temporary_folder: TemporaryFolder,
}

impl Export {
    /// Copies the run in a folder and verifies the copy by simulation. The copies are in a hidden folder in `parent`,
    /// which should be on the same disk as the archive. `key` is the seal key of the run's snapshots.
    ///
    /// # Errors
    /// [`RunError::Damaged`] if the run is damaged; the error names the file, the line and the data that is safe. Other
    /// errors if the run was recorded with another version, or if `parent` cannot be written.
    pub fn prepare(folder: &Path, parent: &Path, key: &SealKey) -> Result<Export, RunError> {
        let derived = ManifestCheck::read(folder)?;
        let manifest = derived.manifest.clone();
        let (bytes, mut trajectory) = read_stable_trajectory(folder, &manifest, key)?;
        let temporary_folder = TemporaryFolder::create_in(parent)?;
        let copied_folder = &temporary_folder.path().join(&manifest.id);
        std::fs::create_dir(copied_folder).map_err(RunError::io(copied_folder))?;
        let put = |name: &str, bytes: &[u8]| {
            let path = copied_folder.join(name);
            std::fs::write(&path, bytes).map_err(RunError::io(&path))
        };
        match derived.problem {
            None => {
                let manifest_path = folder.join(MANIFEST_FILE);
                put(MANIFEST_FILE, &std::fs::read(&manifest_path).map_err(RunError::io(&manifest_path))?)?;
            }
            Some(_) => manifest.write(copied_folder)?,
        }
        // Omit a last line without a line feed: another program may still be writing this line.
        put(TRAJECTORY_FILE, bytes.get(..trajectory.length as usize).unwrap_or(&bytes))?;
        trajectory.unfinished_bytes = 0;
        let after = read_afterwards(folder, &trajectory)?;
        if !after.lines.is_empty() {
            let path = folder.join(AFTERWARDS_FILE);
            let bytes = std::fs::read(&path).map_err(RunError::io(&path))?;
            put(AFTERWARDS_FILE, bytes.get(..after.length as usize).unwrap_or(&bytes))?;
        }
        for name in [PLAN_FILE, TEXTS_FILE].into_iter().filter(|_| manifest.lesson.is_some()) {
            let path = folder.join(name);
            put(name, &std::fs::read(&path).map_err(RunError::io(&path))?)?;
        }
        let memo = current_notes_file(folder, &trajectory);
        match std::fs::read(&memo) {
            Ok(bytes) => put(NOTES_FILE, &bytes)?,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => {}
            Err(error) => return Err(RunError::Io { path: memo, error }),
        }
        let session = Session::open(copied_folder, Access::Read, true)
            .map_err(|error| with_original_path(error, copied_folder, folder))?;
        Ok(Export {
            session,
            trajectory,
            afterwards_lines: after.lines,
            copied_folder: copied_folder.clone(),
            _temporary_folder: temporary_folder,
        })
    }

    /// Returns a read-only session of the copied run.
    pub fn session(&self) -> &Session {
        &self.session
    }

    /// Returns the lines of the trajectory.
    pub fn trajectory(&self) -> &Trajectory {
        &self.trajectory
    }

    /// Returns the lines recorded after the end of the run.
    pub fn afterwards_lines(&self) -> &[Line] {
        &self.afterwards_lines
    }

    /// Writes the archive atomically. Signs the archive if `key` is given.
    ///
    /// # Errors
    /// [`RunError::AlreadyExists`] if the file exists and `replace` is false. [`RunError::Io`] if the archive cannot
    /// be written.
    pub fn write(&self, archive: &Path, replace: bool, key: Option<&LabKey>) -> Result<Seal, RunError> {
        if !replace && archive.exists() {
            let message = format!("{} already exists: choose another name, or remove it", archive.display());
            return Err(RunError::AlreadyExists(message));
        }
        let database = self.copied_folder.join(DATABASE_FILE);
        // The archive can be written more than once, so remove the database of an earlier call.
        let _ = std::fs::remove_file(&database);
        self.session.database().copy_to(&database)?;
        let seal = self.build_seal()?;
        let folder = parent_folder(archive);
        let temporary_folder = TemporaryFolder::create_in(folder)?;
        let draft = temporary_folder.path().join("archive");
        let written = self.write_archive(&draft, is_compressed(archive), (&seal, key));
        let placed = written.and_then(|()| std::fs::rename(&draft, archive));
        placed.map_err(RunError::io(archive))?;
        sync_folder(folder)?;
        Ok(seal)
    }

    fn build_seal(&self) -> Result<Seal, RunError> {
        let folder = &self.copied_folder;
        let there = [
            MANIFEST_FILE,
            TRAJECTORY_FILE,
            AFTERWARDS_FILE,
            PLAN_FILE,
            TEXTS_FILE,
            NOTES_FILE,
            DATABASE_FILE,
        ]
        .into_iter()
        .filter(|name| folder.join(name).exists());
        let file = there.map(|name| SealedFile::from_file(folder, name)).collect::<Result<_, _>>()?;
        let last = self.trajectory.lines.last();
        let seal = Seal {
            format: SEAL_FORMAT,
            program: env!("CARGO_PKG_VERSION").to_owned(),
            // The time of the last line is used instead of the time of the export, so that an unchanged run always has
            // the same seal.
            created: last.map(|line| line.at.clone()).unwrap_or_default(),
            run: self.session.manifest().id.clone(),
            last_seq: last.map_or(0, |line| line.seq),
            last_hash: last.map(|line| line.hash.clone()).unwrap_or_default(),
            checksum: String::new(),
            file,
        };
        Ok(seal.with_checksum())
    }

    fn write_archive(
        &self,
        draft: &Path,
        compressed: bool,
        seal: (&Seal, Option<&LabKey>),
    ) -> std::io::Result<()> {
        let file = BufWriter::new(File::create_new(draft)?);
        let file = if compressed {
            let packer = GzEncoder::new(file, Compression::default());
            self.append_entries(packer, seal)?.finish()?
        } else {
            self.append_entries(file, seal)?
        };
        file.into_inner().map_err(std::io::IntoInnerError::into_error)?.sync_all()
    }

    fn append_entries<W: Write>(&self, out: W, (seal, key): (&Seal, Option<&LabKey>)) -> std::io::Result<W> {
        let mut archive = tar::Builder::new(out);
        let text = seal.to_toml();
        archive.append(&entry_header(&seal.run, SEAL_FILE, text.len() as u64)?, text.as_bytes())?;
        if let Some(signature) = key.map(|key| key.sign(&text)) {
            archive.append(
                &entry_header(&seal.run, SIGNATURE_FILE, signature.len() as u64)?,
                signature.as_bytes(),
            )?;
        }
        for sealed in &seal.file {
            let file = File::open(self.copied_folder.join(&sealed.name))?;
            archive.append(&entry_header(&seal.run, &sealed.name, sealed.bytes)?, file)?;
        }
        archive.into_inner()
    }
}

/// Reads a trajectory that another program may be writing, and checks the trajectory against the manifest and the
/// integrity file. Reads these two files first, so that the trajectory is at least as new.
fn read_stable_trajectory(
    folder: &Path,
    manifest: &Manifest,
    key: &SealKey,
) -> Result<(Vec<u8>, Trajectory), RunError> {
    let path = folder.join(TRAJECTORY_FILE);
    let integrity = Integrity::read(folder, manifest, key);
    let bytes = std::fs::read(&path).map_err(RunError::io(&path))?;
    let trajectory = Trajectory::from_bytes(&path, &bytes)?;
    check_start(&path, trajectory.lines.first(), manifest)?;
    integrity.check(&path, &trajectory)?;
    Ok((bytes, trajectory))
}

/// Returns a tar header without owner and time, so that archives do not depend on the machine.
fn entry_header(run: &str, name: &str, bytes: u64) -> std::io::Result<tar::Header> {
    let mut header = tar::Header::new_ustar();
    header.set_path(format!("{run}/{name}"))?;
    header.set_size(bytes);
    header.set_mode(0o644);
    header.set_entry_type(tar::EntryType::Regular);
    header.set_cksum();
    Ok(header)
}

/// Replaces the path of a copied file in an error with the path of the original file.
fn with_original_path(error: RunError, copies: &Path, folder: &Path) -> RunError {
    let original = |path: PathBuf| match path.strip_prefix(copies) {
        Ok(name) => folder.join(name),
        Err(_) => path,
    };
    match error {
        RunError::Damaged { path, line, problem, remedy: safe } => {
            RunError::Damaged { path: original(path), line, problem, remedy: safe }
        }
        other => other,
    }
}
