//! What vouches for the end of a trajectory, and for the database.
//!
//! Nothing follows the last line, but the database and the snapshot remember how far it went: a cut at a line end
//! shows here.

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

/// What stood beside the trajectory before it was read.
pub struct Integrity {
    /// The snapshot, if there is one that is whole.
    pub(crate) snapshot: Option<Snapshot>,
    /// How far the database has come, if it can be read.
    database: Option<Position>,
    /// The database is one of another run.
    foreign: bool,
    /// What the person should know about them.
    pub remarks: Vec<String>,
}

impl Integrity {
    /// Asks them. Has to come before the trajectory is read, which may grow in between.
    pub fn of(folder: &Path, manifest: &Manifest, key: &SealKey) -> Integrity {
        let mut remarks = Vec::new();
        let snapshot = Snapshot::read(folder, key).unwrap_or_else(|problem| {
            remarks
                .push(format!("{FILE} {problem} and is not used: the run was simulated from its beginning."));
            None
        });
        // A stranger's snapshot says nothing about this run.
        let snapshot = snapshot.filter(|snapshot| snapshot.is_of(&manifest.id));
        let foreign = owner_of(&location(folder)).is_some_and(|owner| owner != manifest.number());
        // Nor does a stranger's database.
        let database = if foreign { None } else { position_of(&location(folder)) };
        Integrity { snapshot, database, foreign, remarks }
    }

    /// Whether the trajectory goes as far as they remember.
    ///
    /// # Errors
    /// The first line that is missing or is not the one they saw.
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
                    "Lines 1 to {good} are good; nothing was changed{BRANCH_THEM}. To continue this run, restore the \
                     whole trajectory from a copy"
                ),
            })
        })
    }

    /// Whether the database was made from more lines than the trajectory has.
    pub(crate) fn is_ahead_of(&self, trajectory: &Trajectory) -> bool {
        let last = trajectory.lines.last().map(|line| line.seq);
        self.database.as_ref().is_some_and(|position| Some(position.seq) > last)
    }

    /// Whether the database's file is the one that an orderly end left; none where no end tells.
    fn is_as_closed(&self, folder: &Path) -> Option<bool> {
        let position = self.database.as_ref()?;
        let closed = self.snapshot.as_ref().filter(|snapshot| snapshot.position() == *position)?;
        let digest = closed.database()?;
        Some(file_digest(&folder.join("world.db")).as_deref() == Some(digest))
    }

    /// The database of a run that has ended, if its file is the one that the end left and holds every line.
    pub(crate) fn finished_database(&self, folder: &Path, trajectory: &Trajectory) -> Option<Location> {
        let last = trajectory.lines.last().filter(|line| matches!(line.record, Record::End(_)))?;
        let position = self.database.as_ref()?;
        let complete = position.seq == last.seq && position.line_hash == last.hash;
        let own = location(folder);
        (complete && has_layout_of_now(&own) && self.is_as_closed(folder) == Some(true)).then_some(own)
    }

    /// The snapshot from which the run can go on: its line is in the trajectory, and the database lacks no row before it.
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

    /// Whether the database can be gone on with. After an orderly end its whole file is compared; after a crash
    /// its structure is.
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

/// Whether nobody has changed the database's file since the run was closed.
pub(crate) fn is_as_left(folder: &Path, key: &SealKey) -> bool {
    let Ok(Derived { manifest, .. }) = Derived::of(folder) else { return false };
    Integrity::of(folder, &manifest, key).is_as_closed(folder).unwrap_or(true)
}

/// Line, from 1, that a remembered position shows to be missing or changed.
fn contradiction(trajectory: &Trajectory, position: &Position) -> Option<(u64, &'static str)> {
    let last = trajectory.lines.last()?;
    // A torn line is cut off with a notice, and a week that lacks its closing lines is simulated again: week and end.
    let is_open = matches!(last.record, Record::Advance(_) | Record::Voice(VoiceAnswer::Scores(_)));
    let has_model = matches!(&trajectory.lines[0].record, Record::Start(start) if start.voice.is_some());
    // A language model that is not asked again leaves out the line of its words, and of its scores.
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
