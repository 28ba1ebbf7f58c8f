//! Which runs have a language model: those that began with one. It speaks in them as long as whoever opens them names it.

use std::path::Path;

use super::speaker::Speaker;
use crate::resume::open::Access;
use crate::state::Session;
use novamind_record::error::RunError;
use novamind_record::folder::configuration::Configuration;
use novamind_record::mode::Mode;
use novamind_voice::model::settings::ModelSettings;

/// The language model of a new run, if it is to have one: what its study lays down, where it belongs to one, or the one that
/// was named.
///
/// # Errors
/// It must not have the one that was named.
pub(crate) fn model_of(
    mode: Mode,
    study: Option<Option<&ModelSettings>>,
    named: Option<&ModelSettings>,
) -> Result<Option<ModelSettings>, RunError> {
    match (mode, study, named) {
        (Mode::Baseline, Some(laid_down), _) => Ok(laid_down.cloned()),
        (Mode::Baseline, None, Some(_)) => Err(RunError::NotPossible(
            "a baseline run speaks with the built-in voice, unless the configuration of its study names a language model \
             ([voice] in study.toml): leave out --voice, or take another mode. Nothing was recorded"
                .to_owned(),
        )),
        // A lesson is the same on every machine.
        (Mode::Lesson, ..) => Ok(None),
        (Mode::Baseline | Mode::Sandbox | Mode::Debug, _, named) => Ok(named.cloned()),
    }
}

impl Session {
    /// Opens a run to go on with it, with its language model if the configuration names that.
    ///
    /// # Errors
    /// As [`Session::open`].
    pub fn open_to_play(folder: &Path, configuration: &Configuration) -> Result<Session, RunError> {
        let mut session = Session::open(folder, Access::Write, true)?;
        session.join_model(configuration.voice.as_ref());
        Ok(session)
    }

    /// Lets a language model speak in a run that began with it; where it cannot, a remark says so and the built-in voice goes
    /// on.
    pub fn join_model(&mut self, named: Option<&ModelSettings>) {
        if self.history.ended.is_some() || self.recorder.is_none() {
            return;
        }
        let problem = match (&self.manifest.voice, named) {
            (None, None) => return,
            (None, Some(_)) => {
                self.remarks.push(
                    "This run began with the built-in voice and keeps it: --voice is not used.".to_owned(),
                );
                return;
            }
            (Some(_), None) => "name its file with --voice to hear it".to_owned(),
            (Some(model), Some(named)) if named.stamp() != *model => {
                format!("--voice names another: {}", named.stamp().in_words())
            }
            (Some(_), Some(named)) => match Speaker::open(named) {
                Ok(speaker) => {
                    self.voice.speaker = Some(speaker);
                    return;
                }
                Err(problem) => problem,
            },
        };
        let model = self.manifest.voice.as_ref().map(|model| model.in_words()).unwrap_or_default();
        self.remarks.push(format!(
            "In this run {model}; from here on the built-in voice does ({problem}). What the model said is kept."
        ));
    }

    /// The settings of the language model that can be asked.
    pub fn model_settings(&self) -> Option<&ModelSettings> {
        self.voice.speaker.as_ref().map(|speaker| &speaker.settings)
    }
}
