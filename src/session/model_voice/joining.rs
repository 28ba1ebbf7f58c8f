//! Which runs have a language model: those that began with one. It speaks in them as long as whoever opens them names it.

use novamind_record::error::RunError;
use novamind_record::folder::mode::Mode;
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
