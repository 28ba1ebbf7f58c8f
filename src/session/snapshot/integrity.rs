//! Checks of the end of a trajectory and of the database.
//!
//! Database and snapshot store the last line, so that a trajectory cut at a line end is detected.

use std::path::Path;

use super::file::{FILE, Snapshot};
use super::sealing::SealKey;
use novamind_database::{
    Location, Position, file_digest, has_layout_of_now, is_consistent, owner_of, position_of,
};
use novamind_record::error::RunError;
use novamind_record::folder::derived::Derived;
use novamind_record::folder::manifest::Manifest;
use novamind_record::trajectory::record::VoiceAnswer;
use novamind_record::trajectory::{BRANCH_THEM, Record, Trajectory};

/// Snapshot and database position, read before the trajectory.
pub struct Integrity {
    pub(crate) snapshot: Option<Snapshot>,
    /// Last line of the database, if it can be read.
    database: Option<Position>,
    foreign: bool,
    /// Problems that the user should know.
    pub remarks: Vec<String>,
}

impl Integrity {
    /// Reads snapshot and database position. Must be called before the trajectory is read, which can grow in between.
    pub fn of(folder: &Path, manifest: &Manifest, key: &SealKey) -> Integrity {
        let mut remarks = Vec::new();
        let snapshot = Snapshot::read(folder, key).unwrap_or_else(|problem| {
            remarks.push(format!("{FILE} {problem} and is not used: the run was simulated from its start."));
            None
        });
        // A snapshot of another run is irrelevant.
        let snapshot = snapshot.filter(|snapshot| snapshot.is_of(&manifest.id));
        let foreign = owner_of(&location(folder)).is_some_and(|owner| owner != manifest.number());
        // So is a database of another run.
        let database = if foreign { None } else { position_of(&location(folder)) };
        Integrity { snapshot, database, foreign, remarks }
    }

    /// Checks that the trajectory contains the lines of database and snapshot.
    ///
    /// # Errors
    /// [`RunError::Damaged`] with the first missing or changed line.
    pub fn check(&self, path: &Path, trajectory: &Trajectory) -> Result<(), RunError> {
        let database = self.database.clone().map(|position| ("world.db", position));
        let snapshot = self.snapshot.as_ref().map(|snapshot| (FILE, snapshot.position()));
        [database, snapshot].into_iter().flatten().try_for_each(|(file, position)| {
            let Some((line, problem)) = contradiction(trajectory, &position) else { return Ok(()) };
            let good = line - 1;
            Err(RunError::Damaged {
                path: path.to_owned(),
                line: line as usize,
                problem: format!("{problem} ({file} was made from it)"),
                safe: format!(
                    "Lines 1 to {good} are intact; nothing was changed{BRANCH_THEM}. To continue this run, restore the \
                     complete trajectory from a copy"
                ),
            })
        })
    }

    /// Whether the database has lines that the trajectory lacks.
    pub(crate) fn is_ahead_of(&self, trajectory: &Trajectory) -> bool {
        let last = trajectory.lines.last().map(|line| line.seq);
        self.database.as_ref().is_some_and(|position| Some(position.seq) > last)
    }

    /// Whether the database file is the one that was left when the run was closed; `None` if this is unknown.
    fn is_as_closed(&self, folder: &Path) -> Option<bool> {
        let position = self.database.as_ref()?;
        let closed = self.snapshot.as_ref().filter(|snapshot| snapshot.position() == *position)?;
        let digest = closed.database()?;
        Some(file_digest(&folder.join("world.db")).as_deref() == Some(digest))
    }

    /// Returns the database of an ended run, if its file is unchanged and complete.
    pub(crate) fn finished_database(&self, folder: &Path, trajectory: &Trajectory) -> Option<Location> {
        let last = trajectory.lines.last().filter(|line| matches!(line.record, Record::End(_)))?;
        let position = self.database.as_ref()?;
        let complete = position.seq == last.seq && position.line_hash == last.hash;
        let own = location(folder);
        (complete && has_layout_of_now(&own) && self.is_as_closed(folder) == Some(true)).then_some(own)
    }

    /// Returns the snapshot, if its line is in the trajectory and the database lacks no row before it.
    pub(crate) fn usable_snapshot(
        &self,
        manifest: &Manifest,
        trajectory: &Trajectory,
        rows_from: Option<u64>,
    ) -> Option<&Snapshot> {
        let snapshot = self.snapshot.as_ref().filter(|snapshot| snapshot.fits(manifest))?;
        let position = snapshot.position();
        let line = trajectory.lines.get(position.seq as usize)?;
        let complete = rows_from.is_none_or(|seq| seq >= position.seq);
        (line.hash == position.line_hash && complete).then_some(snapshot)
    }

    /// Whether the database can be continued. Compares the digest of the file if the run was closed properly,
    /// otherwise checks its structure.
    pub(crate) fn vouch_for_database(&mut self, folder: &Path) -> bool {
        let file = folder.join("world.db");
        if !file.exists() {
            return false;
        }
        let sound = self.database.is_some()
            && self.is_as_closed(folder).unwrap_or_else(|| is_consistent(&location(folder)));
        let problem = match sound {
            false if self.foreign => "belongs to another run",
            false => "is damaged",
            true if !has_layout_of_now(&location(folder)) => "was made by another version of the program",
            true => return true,
        };
        self.remarks.push(format!("world.db {problem} and was rebuilt from the trajectory."));
        false
    }
}

fn location(folder: &Path) -> Location {
    Location::File(folder.join("world.db"))
}

/// Whether the database file is unchanged since the run was closed.
pub(crate) fn is_as_left(folder: &Path, key: &SealKey) -> bool {
    let Ok(Derived { manifest, .. }) = Derived::of(folder) else { return false };
    Integrity::of(folder, &manifest, key).is_as_closed(folder).unwrap_or(true)
}

/// Returns the line, from 1, that is missing or changed according to a stored position.
fn contradiction(trajectory: &Trajectory, position: &Position) -> Option<(u64, &'static str)> {
    let last = trajectory.lines.last()?;
    // An incomplete line is removed with a notice. A week without its closing lines is simulated again: week and end.
    let is_open = matches!(last.record, Record::Advance(_) | Record::Voice(VoiceAnswer::Scores(_)));
    let has_model = matches!(&trajectory.lines[0].record, Record::Start(start) if start.voice.is_some());
    // A language model that is not asked again writes no line for its texts and its scores.
    let of_week = if has_model { 4 } else { 2 };
    let healing = if is_open { of_week } else { u64::from(trajectory.unfinished > 0) };
    match trajectory.lines.get(position.seq as usize) {
        None if position.seq > last.seq + healing => Some((last.seq + 2, "the line is missing")),
        Some(line) if line.hash != position.line_hash => {
            Some((position.seq + 1, "the line is not the one that was recorded: it was changed"))
        }
        None | Some(_) => None,
    }
}
