//! The language model of an open run: time limit per week, and notices about failures.

use std::time::{Duration, Instant};

use super::endpoint::Endpoint;
use novamind_record::error::RunError;
use novamind_record::mode::Mode;
use novamind_record::trajectory::record::JudgedPost;
use novamind_voice::model::ModelPrompt;
use novamind_voice::model::settings::ModelSettings;

/// Minimum remaining time for which a request is sent.
const MIN_REQUEST_TIME: Duration = Duration::from_millis(50);

#[derive(Default)]
pub(crate) struct ModelVoice {
    pub(crate) client: Option<ModelClient>,
    /// Recorded scores of the run whose decisions this run repeats.
    pub(crate) inherited_scores: Vec<JudgedPost>,
}

impl ModelVoice {
    pub(crate) fn start_week(&mut self) {
        if let Some(client) = &mut self.client {
            client.time_left = Duration::from_secs(u64::from(client.settings.seconds_a_week));
        }
    }

    /// Returns the notice about a failure that the player has not seen yet, if any.
    pub(crate) fn take_notice(&mut self) -> Option<String> {
        self.client.as_mut()?.notice.take()
    }
}

pub(crate) struct ModelClient {
    pub(crate) settings: ModelSettings,
    endpoint: Endpoint,
    time_left: Duration,
    /// Whether the last request had no usable response.
    is_failing: bool,
    notice: Option<String>,
}

/// The result of a request to the model, and its duration.
pub(crate) struct ModelReply<T> {
    /// The parsed response, or the reason for the failure.
    pub(crate) answer: Result<T, String>,
    pub(crate) took_ms: f64,
}

impl ModelClient {
    /// Creates the client without sending a request.
    ///
    /// # Errors
    /// The API key is missing, or this build cannot send requests.
    pub(crate) fn new(settings: &ModelSettings) -> Result<ModelClient, String> {
        let endpoint = Endpoint::new(settings)?;
        let left = Duration::from_secs(u64::from(settings.seconds_a_week));
        Ok(ModelClient {
            settings: settings.clone(),
            endpoint,
            time_left: left,
            is_failing: false,
            notice: None,
        })
    }

    /// Sends a request within the remaining time of this week. The player is notified only of the first of consecutive
    /// failures.
    pub(crate) fn request<T>(
        &mut self,
        prompt: &ModelPrompt,
        read: impl FnOnce(&str) -> Result<T, String>,
    ) -> ModelReply<T> {
        let started = Instant::now();
        let answer = match self.time_left < MIN_REQUEST_TIME {
            true => Err("the time limit of the week was reached".to_owned()),
            false => self.endpoint.request(prompt, self.time_left),
        };
        let answer = answer
            .and_then(|text| read(&text).map_err(|problem| format!("its answer cannot be used: {problem}")));
        let took = started.elapsed();
        self.time_left = self.time_left.saturating_sub(took);
        if let (Err(problem), false) = (&answer, self.is_failing) {
            self.notice = Some(format!(
                "the language model {} at {} failed ({problem}). The built-in voice is used instead. This notice is \
                 shown again only after the model has responded successfully",
                self.settings.model,
                self.settings.host()
            ));
        }
        self.is_failing = answer.is_err();
        ModelReply { answer, took_ms: (took.as_secs_f64() * 1e6).round() / 1e3 }
    }
}

/// Returns the language model of a new run: the model of its study, or the model that the user named.
///
/// # Errors
/// A run of this mode cannot use the named model.
pub(crate) fn select_model(
    mode: Mode,
    study: Option<Option<&ModelSettings>>,
    named: Option<&ModelSettings>,
) -> Result<Option<ModelSettings>, RunError> {
    match (mode, study, named) {
        (Mode::Baseline, Some(laid_down), _) => Ok(laid_down.cloned()),
        (Mode::Baseline, None, Some(_)) => Err(RunError::InvalidRequest(
            "a baseline run uses the built-in voice, unless its study names a language model ([voice] in study.toml): \
             omit --voice, or choose another mode. Nothing was recorded"
                .to_owned(),
        )),
        // Lessons must not depend on the configuration of the machine.
        (Mode::Lesson, ..) => Ok(None),
        (Mode::Baseline | Mode::Sandbox | Mode::Debug, _, named) => Ok(named.cloned()),
    }
}
