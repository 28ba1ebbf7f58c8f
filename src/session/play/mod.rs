//! An open run: its state and all operations that change it.

pub(crate) mod act;
pub(crate) mod advance;
mod ask;
pub(crate) mod companion;
pub(crate) mod drafts;
pub(crate) mod lesson;
pub(crate) mod memo;
mod mend;
pub(crate) mod once;
pub(crate) mod open;
pub(crate) mod parameters;
mod replay;
mod save;
mod scripts;
pub(crate) mod undo;
mod voice;
#[cfg(all(test, feature = "server"))]
mod voice_tests;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde_json::Value;

use self::companion::Companion;
use crate::company::history::History;
use crate::company::overrides::DerivedOfParameters;
use crate::company::simulation::Simulation;
use crate::company::surroundings::RunSurroundings;
use crate::company::xray::Xray;
use crate::database::RunDatabase;
use crate::figures::journal::JournalEntry;
use crate::model_voice::speaker::{ModelVoice, Speaker};
use crate::permission;
use crate::recording::RunLog;
use crate::recording::activity::ActivityLog;
use crate::recording::recorder::Recorder;
use crate::snapshot::sealing::SealKey;
use crate::view::CompanyView;
use novamind_database::{Position, Projector};
use novamind_record::error::RunError;
use novamind_record::figures::WeekFigures;
use novamind_record::folder::manifest::Manifest;
use novamind_record::lesson::LessonStanding;
use novamind_record::mode::Mode;
use novamind_record::rules::SessionRules;
use novamind_record::trajectory::record::Ended;
use novamind_record::trajectory::{Durability, Record};
use novamind_tools::{Notebook, Numbers, Refusal, ToolId};
use novamind_world::day::watch::DayWatch;
use novamind_world::params::Params;
use novamind_world::settings::Settings;

/// Returns the calls with which rules answer waiting enterprises. The session does not evaluate rules itself.
pub type AnswersCompanies = fn(&str, &mut Session) -> Result<Vec<(ToolId, Value)>, Refusal>;

/// An open run.
pub struct Session {
    manifest: Manifest,
    /// Folder of the run; `None` in memory.
    folder: Option<PathBuf>,
    simulation: Simulation,
    history: History,
    surroundings: RunSurroundings,
    derived: DerivedOfParameters,
    database: RunDatabase,
    seal_key: SealKey,
    /// The session replays an inspected run and reports its days with hidden state.
    is_shadow: bool,
    companion: Companion,
    /// The lesson and its progress; `None` outside lessons.
    lesson: Option<Box<LessonStanding>>,
    company_answers: Option<AnswersCompanies>,
    voice: ModelVoice,
    /// Notes of a run without a folder.
    memo_in_memory: String,
    /// Problems found when the run was opened.
    remarks: Vec<String>,
    /// The record of the run. Dropped last: it holds the lock until the database is closed.
    log: RunLog,
}

impl Session {
    /// Creates a session on day 0 without a recorder.
    fn assemble(
        manifest: Manifest,
        folder: Option<PathBuf>,
        simulation: Simulation,
        database: RunDatabase,
    ) -> Session {
        Session {
            log: RunLog::unwritten(manifest.session_rules()),
            manifest,
            folder,
            history: History::begin(&simulation.world),
            simulation,
            surroundings: RunSurroundings::default(),
            derived: DerivedOfParameters::default(),
            database,
            seal_key: SealKey::default(),
            is_shadow: false,
            companion: Companion::default(),
            lesson: None,
            company_answers: None,
            voice: ModelVoice::default(),
            memo_in_memory: String::new(),
            remarks: Vec::new(),
        }
    }

    /// Creates a session on day 0 without a recorder, for a replay.
    pub(crate) fn unwritten(
        manifest: Manifest,
        folder: Option<PathBuf>,
        params: Arc<Params>,
        projector: Option<Projector>,
    ) -> Session {
        let simulation = Simulation::open(&manifest, params);
        Session::assemble(manifest, folder, simulation, RunDatabase::of(projector))
    }

    /// Creates a copy of a run before its first line. It passes its days to `watch` and reports them with their
    /// hidden state.
    pub(crate) fn shadow_of(run: &Session, watch: Arc<dyn DayWatch>) -> Result<Session, RunError> {
        let params = Arc::new(run.manifest.params()?);
        let mut shadow = Session::unwritten(run.manifest.clone(), run.folder.clone(), params, None);
        shadow.simulation.watch = watch;
        shadow.is_shadow = true;
        Ok(shadow)
    }

    /// Creates a new run on day 0 with a recorder.
    pub(crate) fn written(
        (manifest, params): (Manifest, Arc<Params>),
        folder: Option<PathBuf>,
        projector: Option<Projector>,
        recorder: Recorder,
        seal_key: SealKey,
    ) -> Session {
        let log = RunLog::written(manifest.session_rules(), recorder);
        let session = Session::unwritten(manifest, folder, params, projector);
        let session = Session { log, seal_key, ..session };
        session.project_opening();
        session
    }

    pub(crate) fn set_speaker(&mut self, speaker: Option<Speaker>) {
        self.voice = ModelVoice { speaker, ..ModelVoice::default() };
    }

    /// Returns the company as the player may see it.
    pub fn company(&self) -> CompanyView<'_> {
        let Session { manifest, simulation, history, surroundings, derived, .. } = self;
        CompanyView { manifest, simulation, history, surroundings, derived }
    }

    /// Returns the record of the run: clock, time limits, answers, durability.
    pub fn log(&self) -> &RunLog {
        &self.log
    }

    /// Returns the log for activities of the user.
    pub fn activity(&mut self) -> ActivityLog<'_> {
        let (day, is_over) = self.stand();
        ActivityLog::new(&mut self.log, day, is_over)
    }

    /// Returns the storage for a value of a higher crate.
    pub fn companion(&mut self) -> &mut Companion {
        &mut self.companion
    }

    /// Returns the manifest.
    pub fn manifest(&self) -> &Manifest {
        &self.manifest
    }

    /// Returns the rules of the session.
    pub fn rules(&self) -> SessionRules {
        self.manifest.session_rules()
    }

    /// Returns the folder of the run; `None` in memory.
    pub fn folder(&self) -> Option<&Path> {
        self.folder.as_deref()
    }

    /// Returns the last simulated day.
    pub fn day(&self) -> u32 {
        self.simulation.world.day
    }

    /// Returns how the run ended.
    pub fn ended(&self) -> Option<Ended> {
        self.history.ended
    }

    /// Returns the cash at the end of each day, day 0 first.
    pub fn cash_by_day(&self) -> &[f64] {
        &self.history.cash_by_day
    }

    /// Returns the figures of every simulated week.
    pub fn weeks(&self) -> &[WeekFigures] {
        &self.history.weeks
    }

    /// Returns the problems found when the run was opened.
    pub fn remarks(&self) -> &[String] {
        &self.remarks
    }

    /// Returns the journal: all confirmed actions, in order.
    pub fn journal(&self) -> &[JournalEntry] {
        &self.history.journal
    }

    /// Returns the settings in force from the next day.
    pub fn settings(&self) -> &Settings {
        &self.simulation.world.settings
    }

    /// Returns the numbers that the documentation of the tools quotes, for this run.
    pub fn numbers(&self) -> Arc<Numbers> {
        self.derived.numbers(&self.simulation)
    }

    /// Returns the calculations and scripts of the run.
    pub fn notebook(&self) -> &Notebook {
        &self.surroundings.notebook
    }

    /// Returns the parameters in force.
    pub fn params(&self) -> &Params {
        &self.simulation.params
    }

    /// Returns the score: cash after the last day, 0 after a bankruptcy. `None` before the end and for abandoned
    /// runs.
    pub fn score(&self) -> Option<f64> {
        self.company().score()
    }

    /// Returns the hash of the complete state, and the hash of each part by name. Right after a week it equals the
    /// recorded one.
    pub fn state_hash(&self) -> (String, BTreeMap<String, String>) {
        self.simulation.state_hash()
    }

    /// Whether hidden state may be shown; see [`may_look_inside`](permission::may_look_inside).
    pub fn may_look_inside(&self) -> bool {
        permission::may_look_inside(&self.manifest, self.history.ended, self.folder())
    }

    /// Rejects an inspection if hidden state must not be shown. The result depends only on the mode, the study, the
    /// lesson and whether they have ended.
    ///
    /// # Errors
    /// `not_in_this_mode`.
    pub fn refuse_to_look_inside(&self) -> Result<(), Refusal> {
        permission::refuse_to_look_inside(&self.manifest, self.history.ended, self.folder())
    }

    /// Returns the hidden state of a debug run.
    ///
    /// # Errors
    /// `not_in_this_mode`.
    pub fn xray(&self) -> Result<Xray<'_>, Refusal> {
        if self.manifest.mode != Mode::Debug {
            return Err(Refusal::new("not_in_this_mode", "hidden state is shown in debug runs only"));
        }
        Ok(self.hidden_state())
    }

    pub(crate) fn hidden_state(&self) -> Xray<'_> {
        Xray::new(&self.simulation, &self.history)
    }

    pub(crate) fn simulation(&self) -> &Simulation {
        &self.simulation
    }

    pub(crate) fn set_watch(&mut self, watch: Arc<dyn DayWatch>) {
        self.simulation.watch = watch;
    }

    pub(crate) fn position(&self) -> &Position {
        self.log.position()
    }

    pub(crate) fn seal_key(&self) -> &SealKey {
        &self.seal_key
    }

    pub(crate) fn commit_projection(&self) {
        self.database.commit(self.log.position());
    }

    fn project_opening(&self) {
        self.database.entries().write(|| self.simulation.entry());
        self.commit_projection();
    }

    /// Appends a line. Does nothing if the run is open read-only.
    pub(crate) fn append(&mut self, record: &Record, durability: Durability) -> Result<String, RunError> {
        self.log.append(self.stand(), record, durability)
    }

    /// Appends a line about an irrevocable action. Returns the problem if it is not saved yet.
    fn append_done(&mut self, record: &Record) -> Option<String> {
        self.log.append_done(self.simulation.world.day, record)
    }

    /// Records an event without effect; ignores disk errors.
    fn note(&mut self, record: Record) {
        let _ = self.append(&record, Durability::Written);
    }

    /// Returns the last day, and whether the run has ended.
    fn stand(&self) -> (u32, bool) {
        (self.simulation.world.day, self.history.ended.is_some())
    }
}

/// Functions for tests.
#[cfg(test)]
impl Session {
    pub(crate) fn write_to(&mut self, medium: Box<dyn novamind_record::trajectory::Medium>) {
        self.log.write_to(medium);
    }

    pub(crate) fn manifest_mut(&mut self) -> &mut Manifest {
        &mut self.manifest
    }
}
