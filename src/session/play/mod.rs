//! An open run: its state, and everything that changes it: calls, weeks, queries, what follows from them, taking back, opening
//! again.

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

/// What rules would have the companies that wait be told. A session does not know rules: whoever plays says it.
pub type AnswersCompanies = fn(&str, &mut Session) -> Result<Vec<(ToolId, Value)>, Refusal>;

/// A run that is open.
pub struct Session {
    manifest: Manifest,
    /// Folder of the run; none in memory.
    folder: Option<PathBuf>,
    /// The company and its words.
    simulation: Simulation,
    /// What has happened so far.
    history: History,
    /// What is kept with the run besides its company.
    surroundings: RunSurroundings,
    /// What follows from the parameters in force.
    derived: DerivedOfParameters,
    /// Rows that follow from what has happened.
    database: RunDatabase,
    /// What seals its snapshots.
    seal_key: SealKey,
    /// It is a run simulated again beside one that may be looked into: its days are told with their hidden state.
    is_shadow: bool,
    /// A value that a higher crate keeps with the run.
    companion: Companion,
    /// The lesson that it belongs to, and how it went; none outside lessons.
    lesson: Option<Box<LessonStanding>>,
    /// How rules answer companies; none where nobody has said it.
    company_answers: Option<AnswersCompanies>,
    /// Who speaks besides the built-in voice.
    voice: ModelVoice,
    /// Notes of a run without a folder.
    memo_in_memory: String,
    /// What the person should know about the opening of the run.
    remarks: Vec<String>,
    /// Its lines. Dropped last: the lock is held until the database is closed.
    log: RunLog,
}

impl Session {
    /// A session that nothing writes, and in which nothing has happened.
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

    /// A session on day 0 that writes nothing, for lines to be applied to.
    pub(crate) fn unwritten(
        manifest: Manifest,
        folder: Option<PathBuf>,
        params: Arc<Params>,
        projector: Option<Projector>,
    ) -> Session {
        let simulation = Simulation::open(&manifest, params);
        Session::assemble(manifest, folder, simulation, RunDatabase::of(projector))
    }

    /// A copy of a run before its first line, which passes its days to a watch and reports them with their hidden state.
    pub(crate) fn shadow_of(run: &Session, watch: Arc<dyn DayWatch>) -> Result<Session, RunError> {
        let params = Arc::new(run.manifest.params()?);
        let mut shadow = Session::unwritten(run.manifest.clone(), run.folder.clone(), params, None);
        shadow.simulation.watch = watch;
        shadow.is_shadow = true;
        Ok(shadow)
    }

    /// A new run on day 0 that a recorder writes.
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

    /// Lets a language model lend its voice.
    pub(crate) fn set_speaker(&mut self, speaker: Option<Speaker>) {
        self.voice = ModelVoice { speaker, ..ModelVoice::default() };
    }

    /// The company as the player may see it.
    pub fn company(&self) -> CompanyView<'_> {
        let Session { manifest, simulation, history, surroundings, derived, .. } = self;
        CompanyView { manifest, simulation, history, surroundings, derived }
    }

    /// The lines of the run: clock, time that is left, answers, whether they are safe.
    pub fn log(&self) -> &RunLog {
        &self.log
    }

    /// Records what a person does besides acting.
    pub fn activity(&mut self) -> ActivityLog<'_> {
        let (day, is_over) = self.stand();
        ActivityLog::new(&mut self.log, day, is_over)
    }

    /// A value that a higher crate keeps with the run.
    pub fn companion(&mut self) -> &mut Companion {
        &mut self.companion
    }

    /// What the run is.
    pub fn manifest(&self) -> &Manifest {
        &self.manifest
    }

    /// By which rules it is played.
    pub fn rules(&self) -> SessionRules {
        self.manifest.session_rules()
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

    /// What the person should know about the opening of the run.
    pub fn remarks(&self) -> &[String] {
        &self.remarks
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
        self.derived.numbers(&self.simulation)
    }

    /// Calculations and scripts of the run.
    pub fn notebook(&self) -> &Notebook {
        &self.surroundings.notebook
    }

    /// The effective parameters.
    pub fn params(&self) -> &Params {
        &self.simulation.params
    }

    /// Score: cash after the last day, 0 after a bankruptcy, none before the end or when abandoned.
    pub fn score(&self) -> Option<f64> {
        self.company().score()
    }

    /// Hash of the whole state with one hash per part, by name. Right after a week it is the one that the
    /// trajectory recorded.
    pub fn state_hash(&self) -> (String, BTreeMap<String, String>) {
        self.simulation.state_hash()
    }

    /// Whether its hidden state may be shown, as [`may_look_inside`](permission::may_look_inside) says.
    pub fn may_look_inside(&self) -> bool {
        permission::may_look_inside(&self.manifest, self.history.ended, self.folder())
    }

    /// Refuses to look where hidden state stays hidden; the answer depends on nothing but the mode of the run, its study, its
    /// lesson and whether they are over.
    ///
    /// # Errors
    /// `not_in_this_mode`.
    pub fn refuse_to_look_inside(&self) -> Result<(), Refusal> {
        permission::refuse_to_look_inside(&self.manifest, self.history.ended, self.folder())
    }

    /// The hidden state; only in debug runs.
    ///
    /// # Errors
    /// `not_in_this_mode`.
    pub fn xray(&self) -> Result<Xray<'_>, Refusal> {
        if self.manifest.mode != Mode::Debug {
            return Err(Refusal::new("not_in_this_mode", "hidden state is shown in debug runs only"));
        }
        Ok(self.hidden_state())
    }

    /// The hidden state, for a look that was permitted.
    pub(crate) fn hidden_state(&self) -> Xray<'_> {
        Xray::new(&self.simulation, &self.history)
    }

    /// The company and its words, for the parts of the session that build readings from it.
    pub(crate) fn simulation(&self) -> &Simulation {
        &self.simulation
    }

    /// Passes the days that are simulated from now on to a watch.
    pub(crate) fn set_watch(&mut self, watch: Arc<dyn DayWatch>) {
        self.simulation.watch = watch;
    }

    /// The last line that was written, or applied again.
    pub(crate) fn position(&self) -> &Position {
        self.log.position()
    }

    /// What seals its snapshots.
    pub(crate) fn seal_key(&self) -> &SealKey {
        &self.seal_key
    }

    /// Makes everything handed over visible, as of the last line.
    pub(crate) fn commit_projection(&self) {
        self.database.commit(self.log.position());
    }

    /// Hands the set-up of day 0 to the database.
    fn project_opening(&self) {
        self.database.entries().write(|| self.simulation.entry());
        self.commit_projection();
    }

    /// Appends a line; a run that is only read has none.
    pub(crate) fn append(&mut self, record: &Record, durability: Durability) -> Result<String, RunError> {
        self.log.append(self.stand(), record, durability)
    }

    /// Appends a line about something that cannot be taken back. Returns what keeps it from the disk for now.
    fn append_done(&mut self, record: &Record) -> Option<String> {
        self.log.append_done(self.simulation.world.day, record)
    }

    /// Records something that changes nothing; a disk that refuses it is no reason to stop.
    fn note(&mut self, record: Record) {
        let _ = self.append(&record, Durability::Written);
    }

    /// The last day, and whether the run is over.
    fn stand(&self) -> (u32, bool) {
        (self.simulation.world.day, self.history.ended.is_some())
    }
}

/// Access of tests.
#[cfg(test)]
impl Session {
    /// Puts another medium in place of the trajectory.
    pub(crate) fn write_to(&mut self, medium: Box<dyn novamind_record::trajectory::Medium>) {
        self.log.write_to(medium);
    }

    /// The manifest, to be changed.
    pub(crate) fn manifest_mut(&mut self) -> &mut Manifest {
        &mut self.manifest
    }
}
