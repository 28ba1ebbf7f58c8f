//! Checks for truncated or changed trajectories, and checks of the database.
//!
//! The database and the snapshot store the position of the last line. Therefore a trajectory that was truncated at a
//! line end is detected.

use std::path::Path;

use super::file::{SNAPSHOT_FILE, Snapshot};
use super::sealing::SealKey;
use novamind_database::{
    DatabaseLocation, ProjectionPosition, file_digest, has_current_layout, is_consistent, read_owner,
    read_position,
};
use novamind_record::error::RunError;
use novamind_record::folder::manifest::Manifest;
use novamind_record::folder::manifest_check::ManifestCheck;
use novamind_record::trajectory::record::VoiceAnswer;
use novamind_record::trajectory::{RECOVERY_HINT, Record, Trajectory};

/// The snapshot and the position of the database, read before the trajectory.
pub struct Integrity {
    pub(crate) snapshot: Option<Snapshot>,
    /// Position of the last line in the database, if the database can be read.
    database: Option<ProjectionPosition>,
    is_foreign_database: bool,
    /// Messages for the user about problems with snapshot and database.
    pub remarks: Vec<String>,
}

impl Integrity {
    /// Reads the snapshot and the position of the database. Must be called before the trajectory is read, because
    /// another program may append lines between the two reads.
    pub fn read(folder: &Path, manifest: &Manifest, key: &SealKey) -> Integrity {
        let mut remarks = Vec::new();
        let snapshot = Snapshot::read(folder, key).unwrap_or_else(|problem| {
            remarks.push(format!(
                "{SNAPSHOT_FILE} {problem} and is not used: the run was simulated from its start."
            ));
            None
        });
        // A snapshot of another run is irrelevant.
        let snapshot = snapshot.filter(|snapshot| snapshot.belongs_to(&manifest.id));
        let foreign =
            read_owner(&database_location(folder)).is_some_and(|owner| owner != manifest.id_number());
        // A database of another run is irrelevant, too.
        let database = if foreign { None } else { read_position(&database_location(folder)) };
        Integrity { snapshot, database, is_foreign_database: foreign, remarks }
    }

    /// Checks that the trajectory contains the last line of the database and the line of the snapshot.
    ///
    /// # Errors
    /// [`RunError::Damaged`] with the first missing or changed line.
    pub fn check(&self, path: &Path, trajectory: &Trajectory) -> Result<(), RunError> {
        let database = self.database.clone().map(|position| ("world.db", position));
        let snapshot = self.snapshot.as_ref().map(|snapshot| (SNAPSHOT_FILE, snapshot.position()));
        [database, snapshot].into_iter().flatten().try_for_each(|(file, position)| {
            let Some((line, problem)) = find_contradiction(trajectory, &position) else { return Ok(()) };
            let good = line - 1;
            Err(RunError::Damaged {
                path: path.to_owned(),
                line: line as usize,
                problem: format!("{problem} ({file} contains its result)"),
                remedy: format!(
                    "Lines 1 to {good} are valid; nothing was changed{RECOVERY_HINT}. To continue this run, restore the \
                     complete trajectory from a copy"
                ),
            })
        })
    }

    /// Returns whether the database includes lines that are missing in the trajectory.
    pub(crate) fn is_database_ahead_of(&self, trajectory: &Trajectory) -> bool {
        let last = trajectory.lines.last().map(|line| line.seq);
        self.database.as_ref().is_some_and(|position| Some(position.seq) > last)
    }

    /// Returns whether the database file is unchanged since the run was closed, or `None` if this is unknown.
    fn matches_closing_digest(&self, folder: &Path) -> Option<bool> {
        let position = self.database.as_ref()?;
        let closed = self.snapshot.as_ref().filter(|snapshot| snapshot.position() == *position)?;
        let digest = closed.database()?;
        Some(file_digest(&folder.join("world.db")).as_deref() == Some(digest))
    }

    /// Returns the database of an ended run, if the database file is unchanged and complete.
    pub(crate) fn finished_database(
        &self,
        folder: &Path,
        trajectory: &Trajectory,
    ) -> Option<DatabaseLocation> {
        let last = trajectory.lines.last().filter(|line| matches!(line.record, Record::End(_)))?;
        let position = self.database.as_ref()?;
        let complete = position.seq == last.seq && position.line_hash == last.hash;
        let location = database_location(folder);
        (complete && has_current_layout(&location) && self.matches_closing_digest(folder) == Some(true))
            .then_some(location)
    }

    /// Returns the snapshot, if its line is in the trajectory and the database has all rows up to this line.
    pub(crate) fn usable_snapshot(
        &self,
        manifest: &Manifest,
        trajectory: &Trajectory,
        rows_from: Option<u64>,
    ) -> Option<&Snapshot> {
        let snapshot = self.snapshot.as_ref().filter(|snapshot| snapshot.is_compatible(manifest))?;
        let position = snapshot.position();
        let line = trajectory.lines.get(position.seq as usize)?;
        let complete = rows_from.is_none_or(|seq| seq >= position.seq);
        (line.hash == position.line_hash && complete).then_some(snapshot)
    }

    /// Returns whether new rows can be added to the database. If the run was closed properly, compares the digest of
    /// the database file. Otherwise, checks the structure of the file.
    pub(crate) fn check_database(&mut self, folder: &Path) -> bool {
        let file = folder.join("world.db");
        if !file.exists() {
            return false;
        }
        let sound = self.database.is_some()
            && self
                .matches_closing_digest(folder)
                .unwrap_or_else(|| is_consistent(&database_location(folder)));
        let problem = match sound {
            false if self.is_foreign_database => "belongs to another run",
            false => "is damaged",
            true if !has_current_layout(&database_location(folder)) => {
                "was written by another version of the program"
            }
            true => return true,
        };
        self.remarks.push(format!("world.db {problem} and was rebuilt from the trajectory."));
        false
    }
}

fn database_location(folder: &Path) -> DatabaseLocation {
    DatabaseLocation::File(folder.join("world.db"))
}

/// Returns whether the database file is unchanged since the run was closed.
pub(crate) fn is_database_unchanged(folder: &Path, key: &SealKey) -> bool {
    let Ok(ManifestCheck { manifest, .. }) = ManifestCheck::read(folder) else { return false };
    Integrity::read(folder, &manifest, key).matches_closing_digest(folder).unwrap_or(true)
}

/// Returns the number, from 1, of the line that is missing or changed according to a stored position, and the problem.
fn find_contradiction(trajectory: &Trajectory, position: &ProjectionPosition) -> Option<(u64, &'static str)> {
    let last = trajectory.lines.last()?;
    // An incomplete line is removed with a message. A week without its `week` and `end` lines is simulated again.
    // These lines may therefore be missing.
    let is_open = matches!(last.record, Record::Advance(_) | Record::Voice(VoiceAnswer::Scores(_)));
    let has_model = matches!(&trajectory.lines[0].record, Record::Start(start) if start.voice.is_some());
    // If the run has a language model, two more lines may be missing, because texts and scores are not requested again.
    let of_week = if has_model { 4 } else { 2 };
    let recoverable_lines = if is_open { of_week } else { u64::from(trajectory.unfinished_bytes > 0) };
    match trajectory.lines.get(position.seq as usize) {
        None if position.seq > last.seq + recoverable_lines => Some((last.seq + 2, "the line is missing")),
        Some(line) if line.hash != position.line_hash => {
            Some((position.seq + 1, "the line differs from the recorded line: it was changed"))
        }
        None | Some(_) => None,
    }
}
