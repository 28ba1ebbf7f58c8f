//! Who speaks in an open run besides the built-in voice, how long a week still waits for it, and what the player is told
//! where it does not speak.

use std::time::{Duration, Instant};

use super::endpoint::Endpoint;
use novamind_record::error::RunError;
use novamind_record::mode::Mode;
use novamind_record::trajectory::record::JudgedPost;
use novamind_voice::model::ModelPrompt;
use novamind_voice::model::settings::ModelSettings;

/// With less time than this left nobody is asked.
const LEAST: Duration = Duration::from_millis(50);

/// What an open run has besides the built-in voice: nothing, as a rule.
#[derive(Default)]
pub(crate) struct ModelVoice {
    /// The model.
    pub(crate) speaker: Option<Speaker>,
    /// What a model said in another run of which this one takes over decisions.
    pub(crate) inherited: Vec<JudgedPost>,
}

impl ModelVoice {
    /// A new week has all its time.
    pub(crate) fn begin_week(&mut self) {
        if let Some(speaker) = &mut self.speaker {
            speaker.left = Duration::from_secs(u64::from(speaker.settings.seconds_a_week));
        }
    }

    /// What the player has to know and was not told yet.
    pub(crate) fn take_notice(&mut self) -> Option<String> {
        self.speaker.as_mut()?.notice.take()
    }
}

/// A model that can be asked.
pub(crate) struct Speaker {
    /// Which, where, and what for.
    pub(crate) settings: ModelSettings,
    endpoint: Endpoint,
    /// What this week may still wait.
    left: Duration,
    /// The last question had no answer that could be used.
    is_failing: bool,
    notice: Option<String>,
}

/// What came of a question, and the milliseconds it took.
pub(crate) struct Reply<T> {
    /// The answer, or why there is none.
    pub(crate) answer: Result<T, String>,
    /// Milliseconds.
    pub(crate) took_ms: f64,
}

impl Speaker {
    /// The model of these settings; nothing is sent yet.
    ///
    /// # Errors
    /// It cannot be asked: its key is missing, or this build asks nobody.
    pub(crate) fn open(settings: &ModelSettings) -> Result<Speaker, String> {
        let endpoint = Endpoint::open(settings)?;
        let left = Duration::from_secs(u64::from(settings.seconds_a_week));
        Ok(Speaker { settings: settings.clone(), endpoint, left, is_failing: false, notice: None })
    }

    /// Asks within what is left of the week's time. The player is told of the first of several failures.
    pub(crate) fn ask<T>(
        &mut self,
        prompt: &ModelPrompt,
        read: impl FnOnce(&str) -> Result<T, String>,
    ) -> Reply<T> {
        let started = Instant::now();
        let answer = match self.left < LEAST {
            true => Err("the time of the week is used up".to_owned()),
            false => self.endpoint.ask(prompt, self.left),
        };
        let answer = answer
            .and_then(|text| read(&text).map_err(|problem| format!("its answer cannot be used: {problem}")));
        let took = started.elapsed();
        self.left = self.left.saturating_sub(took);
        if let (Err(problem), false) = (&answer, self.is_failing) {
            self.notice = Some(format!(
                "the language model {} at {} did not serve ({problem}): the built-in voice speaks instead; this is said once, \
                 until the model serves again",
                self.settings.model,
                self.settings.host()
            ));
        }
        self.is_failing = answer.is_err();
        Reply { answer, took_ms: (took.as_secs_f64() * 1e6).round() / 1e3 }
    }
}

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
