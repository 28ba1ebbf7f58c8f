//! Settings of a language model: its endpoint, its name and its tasks.

use serde::{Deserialize, Serialize};

use novamind_base::formatting::escape_control_characters;
use novamind_world::params::ParameterError;

/// Default limit on the time that a simulated week waits for the model, in seconds.
const DEFAULT_SECONDS_PER_WEEK: u32 = 30;
/// Largest permitted limit on the waiting time per week, in seconds.
const MAX_SECONDS_PER_WEEK: u32 = 600;
/// Maximum length of a model name, in characters.
const MAX_NAME_CHARACTERS: usize = 200;

/// A language model that is configured in a settings file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ModelSettings {
    /// Base URL of an OpenAI-compatible API, without `/chat/completions`.
    pub endpoint: String,
    /// Name of the model at the endpoint.
    pub model: String,
    /// Environment variable that contains the API key; `None` for an endpoint without a key. The key itself is never
    /// stored.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub key_variable: Option<String>,
    /// Maximum time that a simulated week waits for the model, in seconds.
    #[serde(default = "seconds_a_week")]
    pub seconds_a_week: u32,
    /// Whether the model judges the player's posts.
    #[serde(default)]
    pub judge: bool,
    /// Whether the model rewords posts that the player did not write.
    #[serde(default = "words")]
    pub words: bool,
}

fn seconds_a_week() -> u32 {
    DEFAULT_SECONDS_PER_WEEK
}

fn words() -> bool {
    true
}

/// The model settings that a run records.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RecordedModelSettings {
    /// Host and port of the endpoint.
    pub host: String,
    /// Name of the model.
    pub model: String,
    /// Whether the model judges the player's posts.
    pub judge: bool,
    /// Whether the model rewords posts that the player did not write.
    pub words: bool,
}

impl RecordedModelSettings {
    /// Describes the tasks of the model in the run, for example `llama3 at 127.0.0.1:11434 rewords posts and judges the
    /// player's posts`.
    pub fn describe(&self) -> String {
        let tasks = match (self.words, self.judge) {
            (true, true) => "rewords posts and judges the player's posts",
            (_, false) => "rewords posts",
            (false, true) => "judges the player's posts",
        };
        format!(
            "{} at {} {tasks}",
            escape_control_characters(&self.model),
            escape_control_characters(&self.host)
        )
    }
}

impl ModelSettings {
    /// Parses a settings file.
    ///
    /// # Errors
    /// Returns an error for the first invalid setting, with its line and key.
    pub fn parse(source: &str, text: &str) -> Result<ModelSettings, ParameterError> {
        let settings: ModelSettings =
            toml::from_str(text).map_err(|error| ParameterError::from_toml(source, text, &error))?;
        settings.check().map_err(|(key, problem)| ParameterError::for_key(source, text, key, problem))?;
        Ok(settings)
    }

    /// Checks all values.
    ///
    /// # Errors
    /// Returns the key of the first invalid setting and the reason why the setting is invalid.
    pub fn check(&self) -> Result<(), (&'static str, String)> {
        self.check_endpoint().map_err(|problem| ("endpoint", problem))?;
        let letters = self.model.chars().count();
        if self.model.trim().is_empty()
            || letters > MAX_NAME_CHARACTERS
            || self.model.chars().any(char::is_control)
        {
            return Err(("model", format!("must have 1 to {MAX_NAME_CHARACTERS} characters in one line")));
        }
        let is_letter = |letter: char| letter.is_ascii_alphanumeric() || letter == '_';
        if self.key_variable.as_ref().is_some_and(|name| name.is_empty() || !name.chars().all(is_letter)) {
            let problem = "must be the name of the environment variable that contains the key, for instance MODEL_KEY, not the key";
            return Err(("key_variable", problem.to_owned()));
        }
        if !(1..=MAX_SECONDS_PER_WEEK).contains(&self.seconds_a_week) {
            let problem = format!("must be 1 to {MAX_SECONDS_PER_WEEK} seconds");
            return Err(("seconds_a_week", problem));
        }
        if !self.judge && !self.words {
            return Err(("words", "the model has no task; set words or judge to true".to_owned()));
        }
        Ok(())
    }

    fn check_endpoint(&self) -> Result<(), String> {
        let endpoint = self.endpoint.as_str();
        if endpoint.starts_with("https://") {
            let problem = "https is not supported; run a gateway on this machine that supports it, and enter \
                           the gateway's address, for instance http://127.0.0.1:4000/v1";
            return Err(problem.to_owned());
        }
        let example = || {
            "enter an address like http://127.0.0.1:11434/v1, without user name, password or query".to_owned()
        };
        if !endpoint.starts_with("http://") || endpoint.len() > MAX_NAME_CHARACTERS {
            return Err(example());
        }
        let plain = |letter: u8| letter.is_ascii_alphanumeric() || b"-._~:/[]%".contains(&letter);
        let host = self.host();
        let (name, port) = match host.rsplit_once(':') {
            Some((name, port)) if !port.ends_with(']') => (name, Some(port)),
            _ => (host, None),
        };
        let has_port = port.is_none_or(|port| port.parse::<u16>().is_ok_and(|port| port > 0));
        let fits = !name.is_empty() && has_port && endpoint.bytes().all(plain);
        if fits { Ok(()) } else { Err(example()) }
    }

    /// Returns the host and port of the endpoint.
    pub fn host(&self) -> &str {
        let rest = self.endpoint.strip_prefix("http://").unwrap_or(&self.endpoint);
        rest.split('/').next().unwrap_or_default()
    }

    /// Returns the URL to which requests are sent.
    pub fn completions_url(&self) -> String {
        format!("{}/chat/completions", self.endpoint.trim_end_matches('/'))
    }

    /// Returns the settings that a run records.
    pub fn recorded_settings(&self) -> RecordedModelSettings {
        let ModelSettings { model, judge, words, .. } = self.clone();
        RecordedModelSettings { host: self.host().to_owned(), model, judge, words }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const REQUIRED_SETTINGS: &str = "endpoint = \"http://127.0.0.1:11434/v1/\"\nmodel = \"llama3\"\n";

    #[test]
    fn recorded_settings_exclude_the_key() {
        let settings =
            ModelSettings::parse("voice.toml", &format!("{REQUIRED_SETTINGS}key_variable = \"MODEL_KEY\"\n"));
        let settings = settings.expect("settings");
        assert_eq!((settings.seconds_a_week, settings.judge, settings.words), (30, false, true));
        assert_eq!(settings.completions_url(), "http://127.0.0.1:11434/v1/chat/completions");
        let stamp = settings.recorded_settings();
        assert_eq!(stamp.describe(), "llama3 at 127.0.0.1:11434 rewords posts");
        assert!(!toml::to_string(&stamp).expect("a table").contains("KEY"));
        for endpoint in ["http://[::1]:8080", "http://box/v1", "http://box.example:80/a-b/v1"] {
            let text = REQUIRED_SETTINGS.replace("http://127.0.0.1:11434/v1/", endpoint);
            ModelSettings::parse("voice.toml", &text).expect(endpoint);
        }
    }

    #[test]
    fn errors_name_line_and_key() {
        let local = "http://127.0.0.1:11434/v1/";
        for (text, line, part) in [
            (format!("{REQUIRED_SETTINGS}modell = 1\n"), 3, "modell"),
            (format!("{REQUIRED_SETTINGS}judge = \"yes\"\n"), 3, "boolean"),
            (REQUIRED_SETTINGS.replace("http:", "https:"), 1, "gateway on this machine"),
            (REQUIRED_SETTINGS.replace(local, "127.0.0.1:11434"), 1, "endpoint"),
            (REQUIRED_SETTINGS.replace(local, "http://me:secret@box/v1"), 1, "without user name, password"),
            (REQUIRED_SETTINGS.replace(local, "http://box:99999/v1"), 1, "http://127.0.0.1:11434/v1"),
            (REQUIRED_SETTINGS.replace(local, "http://box/v1?key=1"), 1, "or query"),
            (REQUIRED_SETTINGS.replace(local, "http:///v1"), 1, "endpoint"),
            (REQUIRED_SETTINGS.replace("llama3", " "), 2, "model"),
            (format!("{REQUIRED_SETTINGS}key_variable = \"sk-1234\"\n"), 3, "environment variable"),
            (format!("{REQUIRED_SETTINGS}seconds_a_week = 0\n"), 3, "1 to 600 seconds"),
            (format!("{REQUIRED_SETTINGS}words = false\n"), 3, "no task"),
        ] {
            let error = ModelSettings::parse("voice.toml", &text).expect_err(&text).to_string();
            assert!(error.contains(&format!("voice.toml, line {line}")) && error.contains(part), "{error}");
        }
    }
}
