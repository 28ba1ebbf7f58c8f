//! HTTP requests to a language model, with a time limit.

use std::time::Duration;

use novamind_voice::model::ModelPrompt;
use novamind_voice::model::settings::ModelSettings;

#[cfg(feature = "server")]
pub(super) use over_http::Endpoint;
#[cfg(not(feature = "server"))]
pub(super) use without::Endpoint;

#[cfg(feature = "server")]
mod over_http {
    use serde_json::{Value, json};
    use ureq::{Agent, Error};

    use super::{Duration, ModelPrompt, ModelSettings};
    use novamind_base::formatting::escape_control_characters;

    const MAX_RESPONSE_BYTES: u64 = 1024 * 1024;
    const TEMPERATURE: f64 = 0.3;

    pub(crate) struct Endpoint {
        agent: Agent,
        address: String,
        model: String,
        key: Option<String>,
    }

    impl Endpoint {
        /// Creates the endpoint from settings without sending a request.
        ///
        /// # Errors
        /// The environment variable with the API key is not set.
        pub(crate) fn new(settings: &ModelSettings) -> Result<Endpoint, String> {
            let key = settings.key_variable.as_deref().map(read_key).transpose()?;
            let configuration = Agent::config_builder()
                .http_status_as_error(false)
                // Prompts must be sent only to the configured host.
                .max_redirects(0)
                .max_redirects_will_error(false)
                .proxy(None)
                .max_idle_connections(0)
                .user_agent("novamind")
                .build();
            let (address, model) = (settings.completions_url(), settings.model.clone());
            Ok(Endpoint { agent: configuration.into(), address, model, key })
        }

        /// Sends a prompt and waits at most `within` for the response.
        ///
        /// # Errors
        /// The request failed; returns a description of the failure.
        pub(crate) fn request(&self, prompt: &ModelPrompt, within: Duration) -> Result<String, String> {
            let body = json!({
                "model": self.model,
                "messages": [
                    { "role": "system", "content": prompt.task },
                    { "role": "user", "content": prompt.input },
                ],
                "temperature": TEMPERATURE,
                "stream": false,
            });
            let mut request = self.agent.post(&self.address).header("content-type", "application/json");
            if let Some(key) = &self.key {
                request = request.header("authorization", format!("Bearer {key}"));
            }
            let request = request.config().timeout_global(Some(within)).build();
            let mut response = request.send(body.to_string()).map_err(describe_error)?;
            let status = response.status().as_u16();
            if status != 200 {
                return Err(format!("its response has status {status}"));
            }
            let read = response.body_mut().with_config().limit(MAX_RESPONSE_BYTES).read_to_string();
            let value: Value = serde_json::from_str(&read.map_err(describe_error)?)
                .map_err(|_| "its response is not JSON".to_owned())?;
            let content = value.pointer("/choices/0/message/content").and_then(Value::as_str);
            content.map(str::to_owned).ok_or_else(|| "its response has no message".to_owned())
        }
    }

    fn read_key(variable: &str) -> Result<String, String> {
        let key = std::env::var(variable).unwrap_or_default();
        match key.trim() {
            "" => Err(format!(
                "the environment variable {variable}, which must contain the API key, is not set"
            )),
            key => Ok(key.to_owned()),
        }
    }

    fn describe_error(error: Error) -> String {
        match error {
            Error::Timeout(_) => "it did not answer in time".to_owned(),
            Error::BodyExceedsLimit(_) => format!("its response is longer than {MAX_RESPONSE_BYTES} bytes"),
            other => format!("it could not be reached: {}", escape_control_characters(&other.to_string())),
        }
    }
}

#[cfg(not(feature = "server"))]
mod without {
    use super::{Duration, ModelPrompt, ModelSettings};

    /// Placeholder for builds without HTTP.
    pub(crate) struct Endpoint;

    impl Endpoint {
        /// Returns an error, because this build cannot send requests.
        ///
        /// # Errors
        /// Always fails.
        pub(crate) fn new(_: &ModelSettings) -> Result<Endpoint, String> {
            Err("this program was built without the feature server and cannot use a language model"
                .to_owned())
        }

        /// Returns an error. The function is never called, because the endpoint cannot be created.
        ///
        /// # Errors
        /// Always fails.
        pub(crate) fn request(&self, _: &ModelPrompt, _: Duration) -> Result<String, String> {
            Err("this program cannot send requests".to_owned())
        }
    }
}
