//! Creation of runs.

pub(crate) mod baseline;
pub(crate) mod consent;
pub(crate) mod lesson_entry;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use self::consent::resolve_consent;
use self::lesson_entry::LessonOptions;
use crate::company::reports::DayReport;
use crate::model_voice::client::{ModelClient, select_model};
use crate::play::Session;
use crate::recording::folders::{new_run_id, remove_stale_staging_folders};
use crate::recording::recorder::Recorder;
use crate::snapshot::sealing::SealKey;
use novamind_database::{DatabaseLocation, Projector};
use novamind_record::clock::now;
use novamind_record::consent::{ConsentAgreement, ConsentText};
use novamind_record::error::RunError;
use novamind_record::files::create_folder;
use novamind_record::folder::configuration::{Configuration, DEFAULT_SCENARIO, check_cash, check_days};
use novamind_record::folder::manifest::{FORMAT, Manifest, changed_parameters, count_runs_with_same_seed};
use novamind_record::folder::runs::{earlier_runs, participant_of_folder};
use novamind_record::mode::Mode;
use novamind_record::rules::SessionRules;
use novamind_record::stamp::{HandoutOptions, StudyStamp};
use novamind_voice::model::settings::ModelSettings;
use novamind_world::MECHANICS;
use novamind_world::fault::Fault;
use novamind_world::params::{Horizon, Params};

/// The options of a new run. A missing option gets its value from the scenario, or from the program's defaults if the
/// scenario has no value.
#[derive(Debug, Clone, PartialEq)]
pub struct NewRun {
    /// Seed of all random draws; 42 by default.
    pub seed: Option<u64>,
    /// Length in days, at least 7; 500 by default. `run.horizon_rule` derives the last day.
    pub days: Option<u32>,
    /// Cash on day 0, dollars above 0; 1,000,000 by default.
    pub cash: Option<f64>,
    /// Name of the scenario.
    pub scenario: String,
    /// Parameter overrides, each `(table.key, value)`; debug and lesson runs only.
    pub overrides: Vec<(String, String)>,
    /// Seeded fault of a mechanism; debug runs only.
    pub fault: Option<Fault>,
    /// Mode of the run.
    pub mode: Mode,
    /// Label of the participant; defaults to the participant to whom the runs folder belongs.
    pub participant: Option<String>,
    /// How and when the participant agreed to the consent text; baseline runs only.
    pub agreed: Option<ConsentAgreement>,
    /// Study to which the run belongs, with its session rules.
    pub study: Option<StudyOptions>,
    /// Lesson that the run plays; lesson runs only.
    pub lesson: Option<LessonOptions>,
    /// Handout from which the run starts, and the run id if the handout defines one.
    pub handout: Option<HandoutOptions>,
    /// Where the run is stored.
    pub storage: Storage,
    /// Whether the database is written. If the run has no database, queries are rejected.
    pub projection: bool,
    /// Whether every call is synced before it is confirmed; otherwise calls are synced once a week.
    pub sync_calls: bool,
    /// Key that seals the snapshots of the run.
    pub seal_key: SealKey,
}

/// The options of a new run that a study defines.
#[derive(Debug, Clone, PartialEq)]
pub struct StudyOptions {
    /// Stamp with the study and the participant's assignment.
    pub stamp: StudyStamp,
    /// Rules of the session.
    pub rules: SessionRules,
    /// Text to which participants agree; `None` if the study does not ask for consent.
    pub consent: Option<ConsentText>,
    /// Language model of the study, if the study uses one.
    pub voice: Option<ModelSettings>,
}

/// Where a new run is stored.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Storage {
    /// The run is stored in a new run folder in this runs folder.
    Runs(PathBuf),
    /// The run is stored in memory and is lost when the session is dropped.
    Memory,
}

impl Default for NewRun {
    fn default() -> Self {
        NewRun {
            seed: None,
            days: None,
            cash: None,
            scenario: DEFAULT_SCENARIO.to_owned(),
            overrides: Vec::new(),
            fault: None,
            mode: Mode::Sandbox,
            participant: None,
            agreed: None,
            study: None,
            lesson: None,
            handout: None,
            storage: Storage::Memory,
            projection: true,
            sync_calls: true,
            seal_key: SealKey::default(),
        }
    }
}

impl Session {
    /// Creates a run and returns its session.
    ///
    /// # Errors
    /// The scenario, parameters or options are not allowed, or the folder cannot be written. After an error, the run
    /// does not exist.
    pub fn create(new: NewRun, configuration: &Configuration) -> Result<Session, RunError> {
        Session::create_with_progress(new, configuration, &mut |_| {})
    }

    /// Creates a run like [`Session::create`], and calls `progress` for each day that is simulated at the start of a
    /// lesson.
    ///
    /// # Errors
    /// The same errors as [`Session::create`].
    pub fn create_with_progress(
        new: NewRun,
        configuration: &Configuration,
        progress: &mut dyn FnMut(&DayReport<'_>),
    ) -> Result<Session, RunError> {
        let new = new.lesson.clone().map_or_else(|| new.clone(), |entry| entry.apply_to(new.clone()));
        let bundled = Configuration::bundled();
        // Use the bundled configuration: lessons must not depend on the configuration of the machine.
        let configuration = if new.lesson.is_some() { &bundled } else { configuration };
        // Runs of handouts must not depend on the configuration of the machine.
        let named = configuration.voice.as_ref().filter(|_| new.handout.is_none());
        let study_voice = new.study.as_ref().map(|study| study.voice.as_ref());
        let model = select_model(new.mode, study_voice, named)?;
        let model_client = model.as_ref().map(ModelClient::new).transpose().map_err(model_voice_error)?;
        let (manifest, params) = build_manifest(&new, configuration)?;
        let manifest = Manifest { voice: model.map(|model| model.recorded_settings()), ..manifest };
        let mut started = Session::create_stored(manifest, params, &new, progress)?;
        started.set_model_client(model_client);
        Ok(started)
    }

    fn create_stored(
        manifest: Manifest,
        params: Params,
        new: &NewRun,
        progress: &mut dyn FnMut(&DayReport<'_>),
    ) -> Result<Session, RunError> {
        match &new.storage {
            Storage::Memory => Session::create_run(manifest, params, None, new, progress),
            Storage::Runs(runs) => {
                remove_stale_staging_folders(runs);
                let folder = runs.join(&manifest.id);
                create_folder(&folder)?;
                let started = Session::create_run(manifest, params, Some(folder.clone()), new, progress);
                if started.is_err() {
                    let _ = std::fs::remove_dir_all(&folder);
                }
                started
            }
        }
    }

    /// Creates a run with this manifest in memory, without a database.
    ///
    /// # Errors
    /// The program does not support the parameters of the manifest.
    pub fn create_in_memory(manifest: Manifest) -> Result<Session, RunError> {
        let params = manifest.load_params()?;
        let new = NewRun { projection: false, sync_calls: false, ..NewRun::default() };
        Session::create_run(manifest, params, None, &new, &mut |_| {})
    }

    pub(crate) fn create_run(
        manifest: Manifest,
        params: Params,
        folder: Option<PathBuf>,
        new: &NewRun,
        progress: &mut dyn FnMut(&DayReport<'_>),
    ) -> Result<Session, RunError> {
        let params = Arc::new(params);
        if let (Some(entry), Some(folder)) = (&new.lesson, &folder) {
            // Write the lesson before the first line, so that every lesson run has its lesson.
            entry.lesson.write_to_run(folder)?;
        }
        let recorder = Recorder::create(&manifest, folder.as_deref(), new.sync_calls)?;
        let projector = start_projector(new.projection, folder.as_deref(), manifest.id_number(), &params)?;
        let seal_key = new.seal_key.clone();
        let mut session = Session::with_recorder((manifest, params), folder, projector, recorder, seal_key);
        if let Some(entry) = &new.lesson {
            session.start_lesson(entry, progress)?;
        }
        Ok(session)
    }
}

fn start_projector(
    wanted: bool,
    folder: Option<&Path>,
    owner: u32,
    params: &Arc<Params>,
) -> Result<Option<Projector>, RunError> {
    if !wanted {
        return Ok(None);
    }
    let location = folder.map_or_else(DatabaseLocation::new_in_memory, |folder| {
        DatabaseLocation::File(folder.join("world.db"))
    });
    let (projector, _) = Projector::start(location, owner, params.clone(), |_| false)?;
    Ok(Some(projector))
}

fn build_manifest(new: &NewRun, configuration: &Configuration) -> Result<(Manifest, Params), RunError> {
    let scenario = configuration.load_scenario(&new.scenario)?;
    if new.mode == Mode::Baseline && !scenario.is_bundled {
        let message =
            format!("a baseline run needs a bundled scenario; {} is a user scenario", scenario.name);
        return Err(RunError::InvalidRequest(message));
    }
    if new.lesson.is_some() && new.mode != Mode::Lesson {
        let message = format!("a lesson needs mode lesson; the mode is {}", new.mode);
        return Err(RunError::InvalidRequest(message));
    }
    if !new.overrides.is_empty() && !matches!(new.mode, Mode::Debug | Mode::Lesson) {
        let message = format!("parameters can be set in debug runs only; the mode is {}", new.mode);
        return Err(RunError::InvalidRequest(message));
    }
    if new.fault.is_some() && new.mode != Mode::Debug {
        let message = format!("a fault can be seeded in debug runs only; the mode is {}", new.mode);
        return Err(RunError::InvalidRequest(message));
    }
    let sound = configuration.load_parameters(&scenario, &new.overrides, new.mode != Mode::Baseline)?;
    let params = Params { fault: new.fault, ..sound };
    let (days, cash) = scenario.days_and_cash_with(&params);
    let days = new.days.unwrap_or(days);
    check_days(days).map_err(RunError::InvalidRequest)?;
    let Horizon { last_day, total_days } = params.run.horizon(days);
    let cash = new.cash.unwrap_or(cash);
    check_cash(cash).map_err(RunError::InvalidRequest)?;
    let seed = new.seed.unwrap_or(params.run.seed);
    if seed > i64::MAX as u64 {
        return Err(RunError::InvalidRequest(format!("a seed can be at most {}, not {seed}", i64::MAX)));
    }
    let of_folder = match &new.storage {
        Storage::Runs(runs) => participant_of_folder(runs),
        Storage::Memory => None,
    };
    let participant = new.participant.clone().or(of_folder);
    let earlier = match &new.storage {
        Storage::Runs(runs) => earlier_runs(runs, participant.as_deref()),
        Storage::Memory => Vec::new(),
    };
    let (study, rules) = new.study.clone().map(|entry| (entry.stamp, entry.rules)).unzip();
    let consent = match new.mode {
        Mode::Baseline => resolve_consent(new, participant.as_deref(), configuration)?,
        Mode::Sandbox | Mode::Lesson | Mode::Debug => None,
    };
    let handout = new.handout.clone().map_or((None, None), |entry| (entry.run, Some(entry.stamp)));
    let manifest = Manifest {
        format: FORMAT,
        version: env!("CARGO_PKG_VERSION").to_owned(),
        mechanics: MECHANICS,
        id: handout.0.unwrap_or_else(new_run_id),
        created: now(),
        seed,
        days: last_day,
        total_days: Some(total_days).filter(|days| *days != last_day),
        cash,
        earlier_runs: count_runs_with_same_seed(&earlier, seed, &scenario.name),
        scenario: scenario.name,
        mode: new.mode,
        participant,
        consent,
        parameters_digest: params.digest(),
        parent: None,
        study,
        lesson: new.lesson.as_ref().map(LessonOptions::stamp),
        handout: handout.1,
        voice: None,
        rules: Some(rules.unwrap_or_else(|| SessionRules::for_mode(new.mode))),
        earlier,
        fault: new.fault,
        parameters: changed_parameters(&params),
    };
    Ok((manifest, params))
}

fn model_voice_error(problem: String) -> RunError {
    RunError::InvalidRequest(format!("the language model cannot be used: {problem}. Nothing was recorded"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use novamind_record::folder::runs::{all_run_folders, delete_run, list_runs, participant_folder};
    use novamind_record::trajectory::record::Via;

    #[test]
    fn participants_have_separate_folders_and_labels() {
        let place = tempfile::tempdir().expect("a folder");
        let base = place.path().join("runs");
        let play = |runs: &Path| {
            let storage = Storage::Runs(runs.to_owned());
            let new = NewRun { storage, projection: false, days: Some(28), ..NewRun::default() };
            Session::create(new, &Configuration::bundled()).expect("a run").manifest().clone()
        };
        let [first, second] = ["P01", "P02"].map(|label| participant_folder(&base, label).expect("a label"));
        assert_eq!(play(&base).participant, None);
        assert_eq!(play(&first).participant.as_deref(), Some("P01"));
        let last = play(&second);
        assert_eq!(
            (last.participant.as_deref(), last.earlier_runs),
            (Some("P02"), 0),
            "runs of other participants do not count"
        );
        assert_eq!(play(&second).earlier_runs, 1);
        delete_run(&second, &last.id).expect("deleted");
        for folder in [&base, &first, &second] {
            assert_eq!(list_runs(folder).expect("a list").len(), 1, "each folder lists its own runs only");
            assert_eq!(all_run_folders(folder), [base.clone(), first.clone(), second.clone()]);
        }
        for label in ["", ".", "..", "a/b", "a\\b", "P 01", "\u{fc}", &"x".repeat(41)] {
            assert!(participant_folder(&base, label).is_err(), "{label}");
        }
    }

    /// Plays a run without decisions to its end. Returns the session and the state hash after each week.
    fn play_to_the_end(runs: &Path, days: u32, rule: &str) -> (Session, Vec<(u32, String)>) {
        let new = NewRun {
            seed: Some(7),
            days: Some(days),
            overrides: vec![("run.horizon_rule".to_owned(), rule.to_owned())],
            mode: Mode::Debug,
            storage: Storage::Runs(runs.to_owned()),
            projection: false,
            ..NewRun::default()
        };
        let mut session = Session::create(new, &Configuration::bundled()).expect("a run");
        let mut states = Vec::new();
        while session.ended().is_none() {
            let forecasts = session.company().naive_forecasts();
            session.advance("wait", &forecasts, Via::Form, &mut |_| {}).expect("a week");
            states.push((session.day(), session.state_hash().0));
        }
        (session, states)
    }

    #[test]
    fn horizon_rule_sets_the_last_day_and_the_scale_of_competitors() {
        let runs = tempfile::tempdir().expect("a folder");
        let play = |days: u32, rule: &str| play_to_the_end(runs.path(), days, rule);
        let (exact, exact_states) = play(100, "exact");
        let (above, above_states) = play(100, "whole_weeks_above");
        let (below, below_states) = play(100, "whole_weeks_below");
        let days = |session: &Session| {
            let manifest = session.manifest();
            (session.day(), manifest.days, manifest.total_days())
        };
        assert_eq!(days(&exact), (100, 100, 100));
        assert_eq!(days(&above), (105, 105, 100));
        assert_eq!(days(&below), (98, 98, 98));
        // With `whole_weeks_above`, the market is that of the exact length. With `whole_weeks_below`, the market is
        // that of the shorter length.
        assert_eq!(above_states[..14], exact_states[..14]);
        assert_eq!(below_states, play(98, "exact").1);
        assert_ne!(below_states.last(), exact_states.get(13));
        for (session, states) in [(above, above_states), (below, below_states)] {
            let (folder, manifest) =
                (session.folder().expect("a folder").to_owned(), session.manifest().clone());
            drop(session);
            let again = Session::open(&folder, crate::Access::Read, false).expect("it opens");
            assert_eq!((again.day(), again.state_hash().0), states.last().cloned().expect("a state"));
            assert_eq!(again.manifest(), &manifest);
            assert!(!manifest.has_changed_parameters(), "the rule only determines the length");
        }
    }
}
