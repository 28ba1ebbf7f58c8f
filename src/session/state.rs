//! An open run: all it holds, and what can be read of it at once.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

use serde_json::Value;

use crate::figures::changes::Decisions;
use crate::figures::groups::GroupWeek;
use crate::figures::journal::JournalEntry;
use crate::inside::companion::Companion;
use crate::model_voice::speaker::ModelVoice;
use crate::play::history::History;
use crate::play::personal_clock::PersonalClock;
use crate::play::projection::Projection;
use crate::play::recorder::Recorder;
use crate::play::simulation::Simulation;
use crate::play::surroundings::RunSurroundings;
use crate::resume::sealing::SealKey;
use novamind_database::Position;
use novamind_record::answer_book::AnswerBook;
use novamind_record::error::RunError;
use novamind_record::figures::WeekFigures;
use novamind_record::folder::manifest::Manifest;
use novamind_record::lesson::LessonStanding;
use novamind_record::rules::SessionRules;
use novamind_record::trajectory::record::Ended;
use novamind_tools::{Numbers, Refusal, ToolId};
use novamind_voice::CompanyNames;
use novamind_world::customers::numbers::CustomerNumbers;
use novamind_world::identifiers::ByGroup;
use novamind_world::params::Params;
use novamind_world::settings::Settings;

/// What rules would have the companies that wait be told. A session does not know rules: whoever plays says it.
pub type AnswersCompanies = fn(&str, &mut Session) -> Result<Vec<(ToolId, Value)>, Refusal>;

/// A run that is open.
pub struct Session {
    pub(super) manifest: Manifest,
    /// Folder of the run; none in memory.
    pub(super) folder: Option<PathBuf>,
    /// The numbers of the parameters, once they were asked for.
    pub(super) numbers: OnceLock<Arc<Numbers>>,
    /// Whether the parameters are not those of a shipped scenario, once that was asked for.
    pub(super) own_parameters: OnceLock<bool>,
    /// The company and its words.
    pub(super) simulation: Simulation,
    /// What has happened so far.
    pub(super) history: History,
    /// What is kept with the run besides its company.
    pub(super) surroundings: RunSurroundings,
    /// Whether the person has stopped the clock, and what was told of limits.
    pub(super) clock: PersonalClock,
    /// The last line that was written, or applied again.
    pub(super) position: Position,
    /// Rows that follow from what has happened.
    pub(super) projection: Projection,
    /// The last day on which each screen of the console was left, in the sittings before this one.
    pub(super) viewed: BTreeMap<String, u32>,
    /// What the record says about questions of a study.
    pub(super) answers: AnswerBook,
    /// What seals its snapshots.
    pub(super) seal_key: SealKey,
    /// It is a run simulated again beside one that may be looked into: its days are told with their hidden state.
    pub(super) is_shadow: bool,
    /// A value that a higher crate keeps with the run.
    pub(super) companion: Companion,
    /// The lesson that it belongs to, and how it went; none outside lessons.
    pub(super) lesson: Option<Box<LessonStanding>>,
    /// Who speaks besides the built-in voice.
    pub(super) voice: ModelVoice,
    /// How rules answer companies; none where nobody has said it.
    pub(super) company_answers: Option<AnswersCompanies>,
    /// Notes of a run without a folder.
    pub(super) memo_in_memory: String,
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

    /// The last day on which each screen of the console was left in an earlier sitting.
    pub fn viewed(&self) -> &BTreeMap<String, u32> {
        &self.viewed
    }

    /// By which rules it is played.
    pub fn rules(&self) -> SessionRules {
        self.manifest.session_rules()
    }

    /// Whether it is the practice of a study.
    pub fn is_practice(&self) -> bool {
        self.manifest.is_practice()
    }

    /// Folder of the run; none in memory.
    pub fn folder(&self) -> Option<&Path> {
        self.folder.as_deref()
    }

    /// Last simulated day.
    pub fn day(&self) -> u32 {
        self.simulation.world.day
    }

    /// How the run ended, if it did.
    pub fn ended(&self) -> Option<Ended> {
        self.history.ended
    }

    /// Cash at the end of each day, day 0 first.
    pub fn cash_by_day(&self) -> &[f64] {
        &self.history.cash_by_day
    }

    /// Figures of every week that ran.
    pub fn weeks(&self) -> &[WeekFigures] {
        &self.history.weeks
    }

    /// What was decided before each week that ran, in order; single steps count for themselves.
    pub fn decisions(&self) -> &[Decisions] {
        &self.history.decisions
    }

    /// What the last days put into the inbox: day and text.
    pub fn notices(&self) -> &[(u32, String)] {
        &self.history.notices
    }

    /// What the person should know about the opening of the run.
    pub fn remarks(&self) -> &[String] {
        &self.remarks
    }

    /// Figures of the groups for every week that ran.
    pub fn group_weeks(&self) -> &[ByGroup<GroupWeek>] {
        &self.history.group_weeks
    }

    /// Everything that was done, in order.
    pub fn journal(&self) -> &[JournalEntry] {
        &self.history.journal
    }

    /// The settings in force from tomorrow on.
    pub fn settings(&self) -> &Settings {
        &self.simulation.world.settings
    }

    /// The numbers that documentation names, as they are in this run.
    pub fn numbers(&self) -> Arc<Numbers> {
        self.numbers.get_or_init(|| Numbers::of(&self.simulation.params).into()).clone()
    }

    /// What the companies of the run are called.
    pub fn company_names(&self) -> &CompanyNames {
        &self.simulation.names
    }

    /// The customers that customer numbers refer to.
    pub fn customer_numbers(&self) -> &CustomerNumbers {
        &self.simulation.world.customers.numbers
    }

    /// The effective parameters.
    pub fn params(&self) -> &Params {
        &self.simulation.params
    }

    /// Answers to the questions of a study that the record holds.
    pub fn answer_book(&self) -> &AnswerBook {
        &self.answers
    }

    /// Score: cash after the last day, 0 after a bankruptcy, none before the end or when abandoned.
    pub fn score(&self) -> Option<f64> {
        match self.history.ended {
            Some(Ended::Horizon) => Some(self.simulation.world.finance.cash),
            Some(Ended::Bankruptcy) => Some(0.0),
            Some(Ended::Abandoned | Ended::Lesson) | None => None,
        }
    }

    /// Hash of the whole state with one hash per part, by name. Right after a week it is the one that the
    /// trajectory recorded.
    pub fn state_hash(&self) -> (String, BTreeMap<String, String>) {
        self.simulation.state_hash()
    }

    /// Whether everything that happened stands in the run's trajectory: not where a run is only read, or its file took no
    /// more lines.
    pub fn is_recorded_to_its_end(&self) -> bool {
        self.recorder.as_ref().is_some_and(Recorder::is_complete)
    }

    /// Why the run has to stop: its file is no longer the one it was, so nothing more is saved. None while all is well.
    pub fn record_loss(&self) -> Option<&str> {
        self.recorder.as_ref()?.loss()
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
