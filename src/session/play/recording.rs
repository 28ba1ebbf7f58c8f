//! What a session writes: lines of the trajectory, and rows for the database.

use super::entry::entry_of;
use super::recorder::Recorder;
use crate::state::Session;
use novamind_database::Entry;
use novamind_record::clock::{now, seconds};
use novamind_record::error::RunError;
use novamind_record::trajectory::record::{Activity, View};
use novamind_record::trajectory::{Durability, Record};

impl Session {
    /// The facts of day 0 with the words that belong to them.
    pub(crate) fn entry(&self) -> Entry {
        entry_of(&self.simulation.facts, self.notice_texts(), &self.simulation.feed, &self.simulation.params)
    }

    /// Makes everything handed over visible, as of the last line.
    pub(crate) fn commit_projection(&self) {
        self.projection.commit(&self.position);
    }

    /// When the line of an accepted call has to be on the disk; a run that is only read keeps its database as one that is
    /// played.
    pub(crate) fn durability_of_calls(&self) -> Durability {
        self.recorder.as_ref().map_or(Durability::Synced, Recorder::durability_of_calls)
    }

    /// Appends a line; a run that is only read has none.
    pub(crate) fn append(&mut self, record: &Record, durability: Durability) -> Result<String, RunError> {
        let Some(recorder) = &mut self.recorder else { return Ok(String::new()) };
        if self.history.ended.is_some() {
            // The end is the last line.
            return recorder.append_afterwards(self.simulation.world.day, record, durability);
        }
        let at = recorder.append(self.simulation.world.day, record, durability)?;
        self.position = recorder.position();
        self.clock.pass(record, seconds(&at));
        Ok(at)
    }

    /// Appends a line about something that cannot be taken back. Returns what keeps it from the disk for now.
    pub(crate) fn append_done(&mut self, record: &Record) -> Option<String> {
        let recorder = self.recorder.as_mut()?;
        let problem = recorder.append_done(self.simulation.world.day, record);
        self.position = recorder.position();
        self.clock.pass(record, seconds(&now()));
        problem
    }

    /// Records what the person looked at, and for how long.
    pub fn note_view(&mut self, screen: &str, from: &str, for_ms: u64) {
        let view = View { screen: screen.to_owned(), from: from.to_owned(), for_ms };
        self.note_activity(Activity::View(view));
    }

    /// Records something that changes nothing; a disk that refuses it is no reason to stop.
    pub(crate) fn note(&mut self, record: Record) {
        let _ = self.append(&record, Durability::Written);
    }
}
