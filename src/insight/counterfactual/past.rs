//! A recorded run whose days can be re-simulated.

use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::branch::counterfactual;
use super::edits::Edits;
use super::kept_state::KeptState;
use super::script::{Move, between, moves};
use novamind_record::error::RunError;
use novamind_record::folder::manifest::Manifest;
use novamind_record::lesson::is_lesson_over;
use novamind_session::{Origin, read_recorded as read};

/// Maximum number of states in memory besides day 0; each is as large as the company.
const KEPT: usize = 4;

/// The recorded steps of a run, and states from which they can be repeated.
pub(crate) struct Past {
    /// Trajectory file.
    path: PathBuf,
    /// Length of the file when it was read, bytes.
    length: u64,
    pub(crate) manifest: Manifest,
    moves: Vec<Move>,
    /// Whether the run and, if any, its lesson have ended.
    pub(crate) ended: bool,
    kept: BTreeMap<u32, Arc<KeptState>>,
}

impl Past {
    /// Opens the run in a folder, or a trajectory file.
    ///
    /// # Errors
    /// Returns an error if the record is missing, damaged or has another version.
    pub(crate) fn read(path: &Path) -> Result<Past, RunError> {
        let (Origin { path, manifest, params, .. }, trajectory) = read(path)?;
        let length = trajectory.length;
        let ended = trajectory.end().is_some() && is_lesson_over(path.parent(), &manifest);
        let opening = Arc::new(KeptState::opening(&manifest, params));
        Ok(Past {
            path,
            length,
            manifest,
            moves: moves(&trajectory.lines),
            ended,
            kept: BTreeMap::from([(0, opening)]),
        })
    }

    /// Reads new events and keeps the states that are still valid.
    ///
    /// # Errors
    /// As [`Past::read`].
    pub(crate) fn renew(&mut self) -> Result<(), RunError> {
        let length = std::fs::metadata(&self.path).map_err(RunError::io(&self.path))?.len();
        if length == self.length {
            return Ok(());
        }
        let now = Past::read(&self.path)?;
        let kept =
            if now.moves.starts_with(&self.moves) { std::mem::take(&mut self.kept) } else { BTreeMap::new() };
        *self = Past { kept: if kept.is_empty() { now.kept } else { kept }, ..now };
        Ok(())
    }

    /// Returns the steps after one day up to another.
    pub(crate) fn between(&self, from: u32, until: u32) -> &[Move] {
        between(&self.moves, from, until)
    }

    pub(crate) fn last_day(&self) -> u32 {
        self.last_end(u32::MAX)
    }

    pub(crate) fn days_per_week(&self) -> u32 {
        self.kept[&0].params.run.days_per_week
    }

    /// Whether recorded days end on a day.
    pub(crate) fn ends_on(&self, day: u32) -> bool {
        day == 0 || self.moves.iter().any(|step| matches!(step, Move::Days(days) if days.until == day))
    }

    /// Returns the last day up to another on which recorded days end.
    pub(crate) fn last_end(&self, until: u32) -> u32 {
        let ends = self.moves.iter().filter_map(|step| match step {
            Move::Days(days) => Some(days.until),
            Move::Call(_) | Move::Parameter(_) => None,
        });
        ends.take_while(|day| *day <= until).last().unwrap_or(0)
    }

    /// Returns the state at the end of a day on which recorded days end, simulated from the nearest stored state. `progress` is
    /// called once per simulated day. Returns `None` if it stops the simulation.
    ///
    /// # Errors
    /// Returns an error if the simulation does not reproduce the recorded state.
    pub(crate) fn moment(
        &mut self,
        day: u32,
        progress: &mut dyn FnMut(u32) -> ControlFlow<()>,
    ) -> Result<Option<Arc<KeptState>>, RunError> {
        let (from, nearest) = self.kept.range(..=day).next_back().expect("day 0 is always stored");
        if *from == day {
            return Ok(Some(nearest.clone()));
        }
        let way = between(&self.moves, *from, day);
        let Some(outcome) = counterfactual(nearest, way, &Edits::default(), day, progress) else {
            return Ok(None);
        };
        self.compare(day, &outcome.end)?;
        let moment = Arc::new(outcome.end);
        if self.kept.len() > KEPT {
            let oldest = self.kept.keys().copied().nth(1);
            oldest.and_then(|day| self.kept.remove(&day));
        }
        self.kept.insert(day, moment.clone());
        Ok(Some(moment))
    }

    /// Compares a state with the recorded hash of its day.
    ///
    /// # Errors
    /// Returns an error if they differ.
    pub(crate) fn compare(&self, day: u32, reached: &KeptState) -> Result<(), RunError> {
        let recorded = self.moves.iter().find_map(|step| match step {
            Move::Days(days) if days.until == day => Some(&days.parts),
            _ => None,
        });
        let own = reached.world.part_hashes();
        let differs = own.iter().find(|own| {
            let known = recorded.and_then(|parts| parts.get(own.part));
            known.is_none_or(|known| own.hash.to_hex()[..16] != **known)
        });
        let Some(differs) = differs.filter(|_| day > 0) else { return Ok(()) };
        Err(RunError::NotPossible(format!(
            "{}: the re-simulation of day {day} differs from the record (different: {}). Nothing was changed; \
             `novamind verify` names the line",
            self.path.display(),
            differs.part
        )))
    }
}
