//! A recorded run whose days can be re-simulated.

use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::branch::simulate_branch;
use super::edits::Edits;
use super::memory_snapshot::MemorySnapshot;
use super::recorded_steps::{RecordedStep, steps_between, steps_from_lines};
use novamind_record::error::RunError;
use novamind_record::folder::manifest::Manifest;
use novamind_record::lesson::is_lesson_over;
use novamind_session::{Origin, read_origin};
use novamind_world::settings::Settings;

/// Maximum number of states that are kept in memory, in addition to the state of day 0. Each state contains the
/// complete company.
const MAX_SNAPSHOTS: usize = 4;

/// The recorded steps of a run, with states from which the steps can be re-simulated.
pub(crate) struct RecordedRun {
    /// Path of the trajectory file.
    path: PathBuf,
    /// Length of the trajectory at the time of the last read, in bytes.
    length_bytes: u64,
    pub(crate) manifest: Manifest,
    steps: Vec<RecordedStep>,
    /// Whether the run has ended. For a run of a lesson, the lesson must also be over.
    pub(crate) is_ended: bool,
    snapshots: BTreeMap<u32, Arc<MemorySnapshot>>,
}

impl RecordedRun {
    /// Opens a run for re-simulation. `path` is a run folder or a trajectory file.
    ///
    /// # Errors
    /// Returns an error if the record is missing, damaged or has another version.
    pub(crate) fn open(path: &Path) -> Result<RecordedRun, RunError> {
        let (Origin { path, manifest, params, .. }, trajectory) = read_origin(path)?;
        let length = trajectory.length;
        let ended = trajectory.end_line().is_some() && is_lesson_over(path.parent(), &manifest);
        let opening = Arc::new(MemorySnapshot::at_day_0(&manifest, params));
        Ok(RecordedRun {
            path,
            length_bytes: length,
            manifest,
            steps: steps_from_lines(&trajectory.lines),
            is_ended: ended,
            snapshots: BTreeMap::from([(0, opening)]),
        })
    }

    /// Reads new events. Keeps the cached states that are still valid.
    ///
    /// # Errors
    /// Same errors as [`RecordedRun::open`].
    pub(crate) fn refresh(&mut self) -> Result<(), RunError> {
        let length = std::fs::metadata(&self.path).map_err(RunError::io(&self.path))?.len();
        if length == self.length_bytes {
            return Ok(());
        }
        let now = RecordedRun::open(&self.path)?;
        let kept = if now.steps.starts_with(&self.steps) {
            std::mem::take(&mut self.snapshots)
        } else {
            BTreeMap::new()
        };
        *self = RecordedRun { snapshots: if kept.is_empty() { now.snapshots } else { kept }, ..now };
        Ok(())
    }

    /// Returns the steps after day `from` up to day `until`.
    pub(crate) fn steps_between(&self, from: u32, until: u32) -> &[RecordedStep] {
        steps_between(&self.steps, from, until)
    }

    pub(crate) fn last_day(&self) -> u32 {
        self.last_recorded_day_up_to(u32::MAX)
    }

    pub(crate) fn days_per_week(&self) -> u32 {
        self.snapshots[&0].params.run.days_per_week
    }

    /// Returns the settings before the first decision.
    pub(crate) fn initial_settings(&self) -> &Settings {
        &self.snapshots[&0].world.settings
    }

    /// Returns whether the record contains the state hash of a day; true for day 0.
    pub(crate) fn has_recorded_state_on(&self, day: u32) -> bool {
        day == 0
            || self.steps.iter().any(|step| matches!(step, RecordedStep::Days(days) if days.until == day))
    }

    /// Returns the last day, at most `until`, whose state hash is recorded.
    pub(crate) fn last_recorded_day_up_to(&self, until: u32) -> u32 {
        let ends = self.steps.iter().filter_map(|step| match step {
            RecordedStep::Days(days) => Some(days.until),
            RecordedStep::Call(_) | RecordedStep::Parameter(_) => None,
        });
        ends.take_while(|day| *day <= until).last().unwrap_or(0)
    }

    /// Returns the state at the end of a day whose state hash is recorded. The state is simulated from the nearest
    /// stored state. `progress` is called once per simulated day. Returns `None` if `progress` stops the simulation.
    ///
    /// # Errors
    /// Returns an error if the simulation does not reproduce the recorded state.
    pub(crate) fn snapshot_at(
        &mut self,
        day: u32,
        progress: &mut dyn FnMut(u32) -> ControlFlow<()>,
    ) -> Result<Option<Arc<MemorySnapshot>>, RunError> {
        let (from, nearest) = self.snapshots.range(..=day).next_back().expect("day 0 is always stored");
        if *from == day {
            return Ok(Some(nearest.clone()));
        }
        let way = steps_between(&self.steps, *from, day);
        let Some(outcome) = simulate_branch(nearest, way, &Edits::default(), day, progress) else {
            return Ok(None);
        };
        self.verify_state(day, &outcome.final_state)?;
        let moment = Arc::new(outcome.final_state);
        if self.snapshots.len() > MAX_SNAPSHOTS {
            let oldest = self.snapshots.keys().copied().nth(1);
            oldest.and_then(|day| self.snapshots.remove(&day));
        }
        self.snapshots.insert(day, moment.clone());
        Ok(Some(moment))
    }

    /// Compares a state with the recorded hash of its day.
    ///
    /// # Errors
    /// Returns an error if the state and the record differ.
    pub(crate) fn verify_state(&self, day: u32, reached: &MemorySnapshot) -> Result<(), RunError> {
        let recorded = self.steps.iter().find_map(|step| match step {
            RecordedStep::Days(days) if days.until == day => Some(&days.parts),
            _ => None,
        });
        let part_hashes = reached.world.part_hashes();
        let differs = part_hashes.iter().find(|part_hash| {
            let known = recorded.and_then(|parts| parts.get(part_hash.part));
            known.is_none_or(|known| part_hash.hash.to_hex()[..16] != **known)
        });
        let Some(differs) = differs.filter(|_| day > 0) else { return Ok(()) };
        Err(RunError::InvalidRequest(format!(
            "{}: the re-simulation of day {day} differs from the record (different: {}). Nothing was changed. To find the line, run `novamind verify`",
            self.path.display(),
            differs.part
        )))
    }
}
