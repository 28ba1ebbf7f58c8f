//! An open run: its state and all operations that change it.

pub(crate) mod advance;
pub(crate) mod drafts;
pub(crate) mod extension;
pub(crate) mod idempotent;
pub(crate) mod lesson;
pub(crate) mod notes;
pub(crate) mod open;
pub(crate) mod parameters;
mod query;
mod repair;
mod replay;
mod save;
mod scripts;
pub(crate) mod tool_call;
pub(crate) mod undo;
mod voice;
#[cfg(all(test, feature = "server"))]
mod voice_tests;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde_json::Value;

use self::extension::Extension;
use crate::company::hidden_state::HiddenState;
use crate::company::history::History;
use crate::company::overrides::DerivedValues;
use crate::company::run_context::RunContext;
use crate::company::simulation::Simulation;
use crate::database::RunDatabase;
use crate::figures::journal::JournalEntry;
use crate::model_voice::client::{ModelClient, ModelVoice};
use crate::permission;
use crate::recording::RunLog;
use crate::recording::activity::ActivityLog;
use crate::recording::recorder::Recorder;
use crate::snapshot::sealing::SealKey;
use crate::view::CompanyView;
use novamind_database::{ProjectionPosition, Projector};
use novamind_record::error::RunError;
use novamind_record::figures::WeekFigures;
use novamind_record::folder::manifest::Manifest;
use novamind_record::lesson::LessonProgress;
use novamind_record::mode::Mode;
use novamind_record::rules::SessionRules;
use novamind_record::trajectory::record::RunEndReason;
use novamind_record::trajectory::{Durability, Record};
use novamind_tools::{Notebook, ParameterNumbers, Rejection, ToolId};
use novamind_world::day::observer::DayObserver;
use novamind_world::params::Params;
use novamind_world::settings::Settings;

/// A function that evaluates rules and returns the calls that answer waiting enterprises. The session itself does not
/// evaluate rules.
pub type RuleEvaluator = fn(&str, &mut Session) -> Result<Vec<(ToolId, Value)>, Rejection>;

/// An open run, with its state and its record.
pub struct Session {
    manifest: Manifest,
    /// Folder of the run; `None` for a run in memory.
    folder: Option<PathBuf>,
    simulation: Simulation,
    history: History,
    context: RunContext,
    derived_values: DerivedValues,
    database: RunDatabase,
    seal_key: SealKey,
    /// Whether the session replays an inspected run and reports its days with hidden state.
    is_replay: bool,
    extension: Extension,
    /// The lesson and its progress; `None` outside lessons.
    lesson: Option<Box<LessonProgress>>,
    rule_evaluator: Option<RuleEvaluator>,
    voice: ModelVoice,
    /// Notes of a run without a folder.
    notes_in_memory: String,
    /// Problems found when the run was opened.
    remarks: Vec<String>,
    /// The record of the run. This field is dropped last, because it keeps the run locked until the database is closed.
    log: RunLog,
}

impl Session {
    /// Creates a session from a simulation and a database, without a recorder.
    fn assemble(
        manifest: Manifest,
        folder: Option<PathBuf>,
        simulation: Simulation,
        database: RunDatabase,
    ) -> Session {
        Session {
            log: RunLog::new_read_only(manifest.session_rules()),
            manifest,
            folder,
            history: History::new(&simulation.world),
            simulation,
            context: RunContext::default(),
            derived_values: DerivedValues::default(),
            database,
            seal_key: SealKey::default(),
            is_replay: false,
            extension: Extension::default(),
            lesson: None,
            rule_evaluator: None,
            voice: ModelVoice::default(),
            notes_in_memory: String::new(),
            remarks: Vec::new(),
        }
    }

    /// Creates a session on day 0 without a recorder, for a replay.
    pub(crate) fn new_read_only(
        manifest: Manifest,
        folder: Option<PathBuf>,
        params: Arc<Params>,
        projector: Option<Projector>,
    ) -> Session {
        let simulation = Simulation::new(&manifest, params);
        Session::assemble(manifest, folder, simulation, RunDatabase::new(projector))
    }

    /// Creates a copy of a run that starts before the first line. The copy passes its days to `watch` and reports the
    /// days with their hidden state.
    pub(crate) fn new_replay(run: &Session, watch: Arc<dyn DayObserver>) -> Result<Session, RunError> {
        let params = Arc::new(run.manifest.load_params()?);
        let mut shadow = Session::new_read_only(run.manifest.clone(), run.folder.clone(), params, None);
        shadow.simulation.watch = watch;
        shadow.is_replay = true;
        Ok(shadow)
    }

    /// Creates the session of a new run on day 0, with a recorder.
    pub(crate) fn with_recorder(
        (manifest, params): (Manifest, Arc<Params>),
        folder: Option<PathBuf>,
        projector: Option<Projector>,
        recorder: Recorder,
        seal_key: SealKey,
    ) -> Session {
        let log = RunLog::with_recorder(manifest.session_rules(), recorder);
        let session = Session::new_read_only(manifest, folder, params, projector);
        let session = Session { log, seal_key, ..session };
        session.write_initial_rows();
        session
    }

    pub(crate) fn set_model_client(&mut self, client: Option<ModelClient>) {
        self.voice = ModelVoice { client, ..ModelVoice::default() };
    }

    /// Returns a view of the company that contains only visible information.
    pub fn company(&self) -> CompanyView<'_> {
        let Session { manifest, simulation, history, context: surroundings, derived_values: derived, .. } =
            self;
        CompanyView { manifest, simulation, history, surroundings, derived }
    }

    /// Returns the record of the run, with clock, time limits, answers and durability.
    pub fn log(&self) -> &RunLog {
        &self.log
    }

    /// Returns the log that records activities of the user.
    pub fn activity(&mut self) -> ActivityLog<'_> {
        let (day, is_over) = self.day_and_has_ended();
        ActivityLog::new(&mut self.log, day, is_over)
    }

    /// Returns the storage for a value of a dependent crate.
    pub fn extension(&mut self) -> &mut Extension {
        &mut self.extension
    }

    /// Returns the manifest of the run.
    pub fn manifest(&self) -> &Manifest {
        &self.manifest
    }

    /// Returns the rules of the session.
    pub fn rules(&self) -> SessionRules {
        self.manifest.session_rules()
    }

    /// Returns the folder of the run, or `None` for a run in memory.
    pub fn folder(&self) -> Option<&Path> {
        self.folder.as_deref()
    }

    /// Returns the last simulated day.
    pub fn day(&self) -> u32 {
        self.simulation.world.day
    }

    /// Returns the reason for the end of the run, or `None` if the run is unfinished.
    pub fn ended(&self) -> Option<RunEndReason> {
        self.history.ended
    }

    /// Returns the cash at the end of each day, starting with day 0.
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

    /// Returns the parameter values of this run that the tool documentation quotes.
    pub fn numbers(&self) -> Arc<ParameterNumbers> {
        self.derived_values.parameter_numbers(&self.simulation)
    }

    /// Returns the calculations and scripts of the run.
    pub fn notebook(&self) -> &Notebook {
        &self.context.notebook
    }

    /// Returns the parameters in force on the current day.
    pub fn params(&self) -> &Params {
        &self.simulation.params
    }

    /// Returns whether the run has the interface of release 2.
    pub fn has_release_2_interface(&self) -> bool {
        self.params().fidelity.interface == novamind_world::params::Interface::Release2
    }

    /// Returns the score: cash after the last day, 0 after a bankruptcy. Returns `None` before the end and for
    /// abandoned runs.
    pub fn score(&self) -> Option<f64> {
        self.company().score()
    }

    /// Returns the hash of the complete state, and the hash of each part by name. Directly after a week, the hash
    /// equals the recorded hash.
    pub fn state_hash(&self) -> (String, BTreeMap<String, String>) {
        self.simulation.state_hash()
    }

    /// Rejects an inspection if hidden state must not be shown. The decision depends only on the mode, the study, the
    /// lesson, and whether the run and the lesson have ended.
    ///
    /// # Errors
    /// The rejection `not_in_this_mode`.
    pub fn check_inspection(&self) -> Result<(), Rejection> {
        permission::check_inspection(&self.manifest, self.history.ended, self.folder())
    }

    /// Returns the hidden state of a debug run.
    ///
    /// # Errors
    /// The rejection `not_in_this_mode`.
    pub fn debug_hidden_state(&self) -> Result<HiddenState<'_>, Rejection> {
        if self.manifest.mode != Mode::Debug {
            return Err(Rejection::new("not_in_this_mode", "hidden state is shown in debug runs only"));
        }
        Ok(self.hidden_state())
    }

    pub(crate) fn hidden_state(&self) -> HiddenState<'_> {
        HiddenState::new(&self.simulation, &self.history)
    }

    pub(crate) fn simulation(&self) -> &Simulation {
        &self.simulation
    }

    pub(crate) fn set_observer(&mut self, watch: Arc<dyn DayObserver>) {
        self.simulation.watch = watch;
    }

    pub(crate) fn position(&self) -> &ProjectionPosition {
        self.log.position()
    }

    pub(crate) fn seal_key(&self) -> &SealKey {
        &self.seal_key
    }

    pub(crate) fn commit_projection(&self) {
        self.database.commit(self.log.position());
    }

    fn write_initial_rows(&self) {
        self.database.entry_writer().send(|| self.simulation.database_entry());
        self.commit_projection();
    }

    /// Appends a line. Does nothing if the run is open read-only.
    pub(crate) fn append(&mut self, record: &Record, durability: Durability) -> Result<String, RunError> {
        self.log.append(self.day_and_has_ended(), record, durability)
    }

    /// Appends a line about an irrevocable action, even if it cannot be saved yet. Returns a description of the
    /// problem if the line is not saved yet.
    fn append_irrevocable(&mut self, record: &Record) -> Option<String> {
        self.log.append_irrevocable(self.simulation.world.day, record)
    }

    /// Records an event that does not change the world. Ignores disk errors.
    fn record_event(&mut self, record: Record) {
        let _ = self.append(&record, Durability::Written);
    }

    /// Returns the last simulated day, and whether the run has ended.
    fn day_and_has_ended(&self) -> (u32, bool) {
        (self.simulation.world.day, self.history.ended.is_some())
    }
}

#[cfg(test)]
impl Session {
    pub(crate) fn set_medium(&mut self, medium: Box<dyn novamind_record::trajectory::Medium>) {
        self.log.set_medium(medium);
    }

    pub(crate) fn manifest_mut(&mut self) -> &mut Manifest {
        &mut self.manifest
    }
}
