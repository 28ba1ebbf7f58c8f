//! One run: open, act, query, advance, record, resume, replay. The only door to a world.
//!
//! Plan, log, apply: a call is planned without effect, its line is on the disk, and only then the world
//! changes; applying cannot fail. So memory is never ahead of the trajectory, the trajectory never ahead of
//! what was confirmed, and a run can always be rebuilt from `run.toml` and `trajectory.jsonl`.

mod act;
mod advance;
mod aftermath;
pub mod archive;
mod ask;
mod booked;
mod branch;
mod changes;
mod configuration;
mod consent;
mod course;
mod create;
mod dashboard;
mod error;
mod estimates;
mod feed;
mod groups;
mod journal;
pub mod library;
mod manifest;
mod memo;
mod mend;
mod mode;
mod notices;
mod observe;
mod open;
mod pace;
mod place;
mod playback;
mod rebuild;
mod record_view;
mod recording;
mod rescue;
mod runs;
mod scored_forecast;
mod scripts;
mod setting;
mod snapshot;
mod terms;
mod trajectory;
mod undo;
mod verify;
mod week;
mod witness;
mod xray;

#[cfg(test)]
mod power_cut_tests;

use std::collections::BTreeMap;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

use serde::{Deserialize, Serialize};

pub use act::{Preview, Via};
pub use advance::{DayReport, Week};
pub use archive::{Export, Imported, Seal, import_run};
pub use ask::{desk_of_file, rows_as_json};
pub use booked::Booked;
pub use changes::{Change, Decisions};
pub use configuration::{Configuration, DEFAULT_SCENARIO, Scenario};
pub use consent::{Consent, ConsentText};
pub use course::{RunCourse, run_course};
pub use create::{NewRun, Storage};
pub use dashboard::DeliveredQuality;
pub use error::RunError;
pub use estimates::Estimates;
pub use groups::GroupWeek;
pub use journal::JournalEntry;
pub use library::Library;
pub use manifest::{FORMAT, Manifest, Parent};
pub use mode::Mode;
pub use observe::{Observation, WaitingThread};
pub use open::Access;
pub use pace::Pace;
pub use place::{Chapter, Goal, Place, Went};
pub use playback::Playback;
pub use rebuild::rebuild_database;
pub use record_view::RecordView;
pub use rescue::{Rescued, rescue};
pub use runs::{
    RunSummary, all_run_folders, delete_run, end_run, find_run, find_run_to_read, list_runs,
    participant_folder, run_folder,
};
pub use scored_forecast::{ForecastScore, ScoredForecast, Verdict, filed_forecasts};
pub use scripts::Calculated;
pub use setting::{Audience, SettingId};
pub use terms::{CapacityTier, ModelTier, RunningStudy, StudyLevel, Terms};
pub use trajectory::{Line, Record, Trajectory, record, seconds as moment_of};
pub use undo::{Reversal, undone_calls};
pub use verify::{Verification, verify};
pub use week::{Forecasts, WEEK_OF_ENTRY, WeekFigures, entries_of_weeks, naively, week_of};
pub use xray::Xray;

pub use crate::database::{Cell, Desk, Interrupt, QueryError, Rows, Ticket, number_at, text_at};
pub use crate::tools::{Numbers, PublicPost, Refusal, ToolId};
pub use crate::voice::judge::Judgement;
pub use crate::world::events::Category;
pub use crate::world::settings::{CoreSettings, Settings};

use crate::database::{Position, Projector};
use crate::world::day::DayTrace;
use crate::world::events::{Facts, LedgerEntry};
use crate::world::identifiers::ByGroup;
use crate::world::params::Params;
use crate::world::random::Streams;
use crate::world::state::World;
use feed::Feed;
use recording::FactsChain;
use scripts::Office;
use trajectory::TrajectoryWriter;
use undo::Step;

/// How a run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Ended {
    /// It reached its last day.
    Horizon,
    /// Cash fell below zero.
    Bankruptcy,
    /// Somebody gave it up.
    Abandoned,
}

impl Ended {
    /// Word as trajectories write it.
    pub fn id(self) -> &'static str {
        match self {
            Ended::Horizon => "horizon",
            Ended::Bankruptcy => "bankruptcy",
            Ended::Abandoned => "abandoned",
        }
    }
}

/// A run that is open.
pub struct Session {
    manifest: Manifest,
    /// Folder of the run; none in memory.
    folder: Option<PathBuf>,
    /// Held while the run may be written.
    _lock: Option<File>,
    params: Arc<Params>,
    /// The numbers of the parameters, once they were asked for.
    numbers: OnceLock<Arc<Numbers>>,
    /// Whether the parameters are not those of a shipped scenario, once that was asked for.
    own_parameters: OnceLock<bool>,
    streams: Streams,
    world: World,
    /// Facts of the last day or call.
    facts: Arc<Facts>,
    /// Those of the day before it, which are filled again once nobody reads them.
    facts_before: Arc<Facts>,
    trace: DayTrace,
    /// None when the run is only read.
    trajectory: Option<TrajectoryWriter>,
    /// The last line that was written, or applied again.
    position: Position,
    /// Every confirmed call is on the disk before it is confirmed; headless runs sync once a week.
    sync_calls: bool,
    projector: Option<Projector>,
    desk: Option<Desk>,
    /// Cash at the end of each day, day 0 first.
    cash_by_day: Vec<f64>,
    /// Every full or shortened week that ran.
    weeks: Vec<WeekFigures>,
    /// The week that has begun with single steps.
    running_week: WeekFigures,
    /// What every week that ran brought of each group.
    group_weeks: Vec<ByGroup<GroupWeek>>,
    /// The same of the week that has begun.
    running_groups: ByGroup<GroupWeek>,
    /// What was decided before each of them, or before single steps.
    decisions: Vec<Decisions>,
    /// What the last days put into the inbox: day and text.
    notices: Vec<(u32, String)>,
    /// What people wrote in public, in words.
    feed: Feed,
    /// What has been set since the last week.
    this_week: ThisWeek,
    /// Everything that was done, in order.
    journal: Vec<JournalEntry>,
    /// Statements the database was asked in this run, each once, the newest last.
    asked: Vec<String>,
    /// What is kept with the run besides its company.
    office: Office,
    /// What the calculations said before the last week.
    calculated: Vec<Calculated>,
    /// The dashboard as it was when the last days had run; none before the first.
    last_dashboard: Option<String>,
    /// Money that calls moved since the last day.
    called: Vec<LedgerEntry>,
    /// Notes of a run without a folder.
    memo_in_memory: String,
    /// Hashes of this week's facts.
    facts_chain: FactsChain,
    ended: Option<Ended>,
    /// What the person should know about the opening of the run.
    remarks: Vec<String>,
}

/// What happened since the last week ran.
#[derive(Debug, Clone)]
struct ThisWeek {
    /// Settings before the first call.
    settings: Settings,
    /// Setting calls that can be taken back, newest last.
    undo: Vec<Step>,
    /// Calls that took settings back and can be reversed themselves, newest last.
    redo: Vec<Step>,
    /// Purchases and the like, in words.
    done: Vec<String>,
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
        recording::state_hash(self.world.part_hashes(), self.facts_chain.hash())
    }

    /// The hidden state; only in debug runs.
    ///
    /// # Errors
    /// `not_in_this_mode`.
    pub fn xray(&self) -> Result<Xray<'_>, Refusal> {
        if self.manifest.mode != Mode::Debug {
            return Err(Refusal::new("not_in_this_mode", "hidden state is shown in debug runs only"));
        }
        Ok(Xray::new(self))
    }

    /// Whether everything that happened stands in the run's trajectory: not where a run is only read, or its file took no
    /// more lines.
    pub fn is_recorded_to_its_end(&self) -> bool {
        self.trajectory.as_ref().is_some_and(TrajectoryWriter::is_complete)
    }

    /// Puts everything on the disk.
    ///
    /// # Errors
    /// The disk refuses.
    pub fn save(&mut self) -> Result<(), RunError> {
        if let Some(trajectory) = &mut self.trajectory {
            trajectory.sync()?;
        }
        self.keep_snapshot(|| self.state_hash().0, true);
        match &self.projector {
            Some(projector) => Ok(projector.wait()?),
            None => Ok(()),
        }
    }
}
