//! An open run: all it holds, and what can be read of it at once.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

use crate::database::Position;
use crate::session::error::RunError;
use crate::session::figures::changes::Decisions;
use crate::session::figures::groups::GroupWeek;
use crate::session::figures::journal::JournalEntry;
use crate::session::figures::week::WeekFigures;
use crate::session::folder::manifest::Manifest;
use crate::session::play::facts_chain::{FactsChain, state_hash};
use crate::session::play::feed::Feed;
use crate::session::play::office::{Calculated, Office};
use crate::session::play::projection::Projection;
use crate::session::play::recorder::Recorder;
use crate::session::play::this_week::ThisWeek;
use crate::session::trajectory::record::Ended;
use crate::tools::Numbers;
use crate::world::day::DayTrace;
use crate::world::events::{Facts, LedgerEntry};
use crate::world::identifiers::ByGroup;
use crate::world::params::Params;
use crate::world::random::Streams;
use crate::world::settings::Settings;
use crate::world::state::World;

/// A run that is open.
pub struct Session {
    pub(super) manifest: Manifest,
    /// Folder of the run; none in memory.
    pub(super) folder: Option<PathBuf>,
    pub(super) params: Arc<Params>,
    /// The numbers of the parameters, once they were asked for.
    pub(super) numbers: OnceLock<Arc<Numbers>>,
    /// Whether the parameters are not those of a shipped scenario, once that was asked for.
    pub(super) own_parameters: OnceLock<bool>,
    pub(super) streams: Streams,
    pub(super) world: World,
    /// Facts of the last day or call.
    pub(super) facts: Arc<Facts>,
    /// Those of the day before it, which are filled again once nobody reads them.
    pub(super) facts_before: Arc<Facts>,
    pub(super) trace: DayTrace,
    /// The last line that was written, or applied again.
    pub(super) position: Position,
    pub(super) projection: Projection,
    /// Cash at the end of each day, day 0 first.
    pub(super) cash_by_day: Vec<f64>,
    /// Every full or shortened week that ran.
    pub(super) weeks: Vec<WeekFigures>,
    /// The week that has begun with single steps.
    pub(super) running_week: WeekFigures,
    /// What every week that ran brought of each group.
    pub(super) group_weeks: Vec<ByGroup<GroupWeek>>,
    /// The same of the week that has begun.
    pub(super) running_groups: ByGroup<GroupWeek>,
    /// What was decided before each of them, or before single steps.
    pub(super) decisions: Vec<Decisions>,
    /// What the last days put into the inbox: day and text.
    pub(super) notices: Vec<(u32, String)>,
    /// What people wrote in public, in words.
    pub(super) feed: Feed,
    /// What has been set since the last week.
    pub(super) this_week: ThisWeek,
    /// Everything that was done, in order.
    pub(super) journal: Vec<JournalEntry>,
    /// Statements the database was asked in this run, each once, the newest last.
    pub(super) asked: Vec<String>,
    /// What is kept with the run besides its company.
    pub(super) office: Office,
    /// What the calculations said before the last week.
    pub(super) calculated: Vec<Calculated>,
    /// The dashboard as it was when the last days had run; none before the first.
    pub(super) last_dashboard: Option<String>,
    /// Money that calls moved since the last day.
    pub(super) called: Vec<LedgerEntry>,
    /// Notes of a run without a folder.
    pub(super) memo_in_memory: String,
    /// Hashes of this week's facts.
    pub(super) facts_chain: FactsChain,
    pub(super) ended: Option<Ended>,
    /// What the person should know about the opening of the run.
    pub(super) remarks: Vec<String>,
    /// What writes the run; none when it is only read. Dropped last: the lock is held until the database is closed.
    pub(super) recorder: Option<Recorder>,
}

impl Session {
    /// What the run is.
    pub fn manifest(&self) -> &Manifest {
        &self.manifest
    }

    /// Folder of the run; none in memory.
    pub fn folder(&self) -> Option<&Path> {
        self.folder.as_deref()
    }

    /// Last simulated day.
    pub fn day(&self) -> u32 {
        self.world.day
    }

    /// How the run ended, if it did.
    pub fn ended(&self) -> Option<Ended> {
        self.ended
    }

    /// Cash at the end of each day, day 0 first.
    pub fn cash_by_day(&self) -> &[f64] {
        &self.cash_by_day
    }

    /// Figures of every week that ran.
    pub fn weeks(&self) -> &[WeekFigures] {
        &self.weeks
    }

    /// What was decided before each week that ran, in order; single steps count for themselves.
    pub fn decisions(&self) -> &[Decisions] {
        &self.decisions
    }

    /// What the last days put into the inbox: day and text.
    pub fn notices(&self) -> &[(u32, String)] {
        &self.notices
    }

    /// What the person should know about the opening of the run.
    pub fn remarks(&self) -> &[String] {
        &self.remarks
    }

    /// Figures of the groups for every week that ran.
    pub fn group_weeks(&self) -> &[ByGroup<GroupWeek>] {
        &self.group_weeks
    }

    /// Everything that was done, in order.
    pub fn journal(&self) -> &[JournalEntry] {
        &self.journal
    }

    /// The settings in force from tomorrow on.
    pub fn settings(&self) -> &Settings {
        &self.world.settings
    }

    /// The numbers that documentation names, as they are in this run.
    pub fn numbers(&self) -> Arc<Numbers> {
        self.numbers.get_or_init(|| Numbers::of(&self.params).into()).clone()
    }

    /// The effective parameters.
    pub fn params(&self) -> &Params {
        &self.params
    }

    /// Score: cash after the last day, 0 after a bankruptcy, none before the end or when abandoned.
    pub fn score(&self) -> Option<f64> {
        match self.ended {
            Some(Ended::Horizon) => Some(self.world.finance.cash),
            Some(Ended::Bankruptcy) => Some(0.0),
            Some(Ended::Abandoned) | None => None,
        }
    }

    /// Hash of the whole state with one hash per part, by name. Right after a week it is the one that the
    /// trajectory recorded.
    pub fn state_hash(&self) -> (String, BTreeMap<String, String>) {
        state_hash(self.world.part_hashes(), self.facts_chain.hash())
    }

    /// Whether everything that happened stands in the run's trajectory: not where a run is only read, or its file took no
    /// more lines.
    pub fn is_recorded_to_its_end(&self) -> bool {
        self.recorder.as_ref().is_some_and(Recorder::is_complete)
    }

    /// Puts everything on the disk.
    ///
    /// # Errors
    /// The disk refuses.
    pub fn save(&mut self) -> Result<(), RunError> {
        if let Some(recorder) = &mut self.recorder {
            recorder.sync()?;
        }
        self.keep_snapshot(|| self.state_hash().0, true);
        Ok(self.projection.wait()?)
    }
}
