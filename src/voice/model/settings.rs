//! Settings of a language model: endpoint, name and purpose.

use serde::{Deserialize, Serialize};

use novamind_base::notation::printable;
use novamind_world::params::ParameterError;

/// Default maximum wait per week, in seconds.
const SECONDS_A_WEEK: u32 = 30;
/// Upper limit of the wait per week, in seconds.
const MOST_SECONDS_A_WEEK: u32 = 600;
/// Maximum length of a name, in characters.
const MOST_LETTERS: usize = 200;

/// A language model as configured in a file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ModelSettings {
    /// Base URL of an OpenAI-compatible API, without `/chat/completions`.
    pub endpoint: String,
    /// Name of the model at the endpoint.
    pub model: String,
    /// Environment variable with the API key; `None` to send no key. The key itself is never stored.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub key_variable: Option<String>,
    /// Maximum wait per week, in seconds.
    #[serde(default = "seconds_a_week")]
    pub seconds_a_week: u32,
    /// Whether it judges the player's posts.
    #[serde(default)]
    pub judge: bool,
    /// Whether it words the posts of others.
    #[serde(default = "words")]
    pub words: bool,
}

fn seconds_a_week() -> u32 {
    SECONDS_A_WEEK
}

fn words() -> bool {
    true
}

/// The part of the settings that a run records.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ModelStamp {
    /// Host of the endpoint, with its port.
    pub host: String,
    /// Name of the model.
    pub model: String,
    /// Whether it judges the player's posts.
    pub judge: bool,
    /// Whether it words the posts of others.
    pub words: bool,
}

impl ModelStamp {
    /// Describes its purpose in the run: `llama3 at 127.0.0.1:11434 rewords posts and judges the player's posts`.
    pub fn in_words(&self) -> String {
        let deeds = match (self.words, self.judge) {
            (true, true) => "rewords posts and judges the player's posts",
            (_, false) => "rewords posts",
            (false, true) => "judges the player's posts",
        };
        format!("{} at {} {deeds}", printable(&self.model), printable(&self.host))
    }
}

impl ModelSettings {
    /// Parses a settings file.
    ///
    /// # Errors
    /// The first problem, with its line and key.
    pub fn read(source: &str, text: &str) -> Result<ModelSettings, ParameterError> {
        let settings: ModelSettings =
            toml::from_str(text).map_err(|error| ParameterError::of_toml(source, text, &error))?;
        settings.check().map_err(|(key, problem)| ParameterError::of_key(source, text, key, problem))?;
        Ok(settings)
    }

    /// Checks all values.
    ///
    /// # Errors
    /// Key and problem of the first invalid value.
    pub fn check(&self) -> Result<(), (&'static str, String)> {
        self.check_endpoint().map_err(|problem| ("endpoint", problem))?;
        let letters = self.model.chars().count();
        if self.model.trim().is_empty() || letters > MOST_LETTERS || self.model.chars().any(char::is_control)
        {
            return Err(("model", format!("must have 1 to {MOST_LETTERS} characters in one line")));
        }
        let is_letter = |letter: char| letter.is_ascii_alphanumeric() || letter == '_';
        if self.key_variable.as_ref().is_some_and(|name| name.is_empty() || !name.chars().all(is_letter)) {
            let problem = "must be the name of the environment variable with the key, for instance \
                           MODEL_KEY, not the key itself";
            return Err(("key_variable", problem.to_owned()));
        }
        if !(1..=MOST_SECONDS_A_WEEK).contains(&self.seconds_a_week) {
            let problem = format!("must be 1 to {MOST_SECONDS_A_WEEK} seconds");
            return Err(("seconds_a_week", problem));
        }
        if !self.judge && !self.words {
            return Err(("words", "the model has nothing to do; set words or judge to true".to_owned()));
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
        if !endpoint.starts_with("http://") || endpoint.len() > MOST_LETTERS {
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

    /// Returns the host of the endpoint with its port.
    pub fn host(&self) -> &str {
        let rest = self.endpoint.strip_prefix("http://").unwrap_or(&self.endpoint);
        rest.split('/').next().unwrap_or_default()
    }

    /// Returns the URL of requests.
    pub fn address(&self) -> String {
        format!("{}/chat/completions", self.endpoint.trim_end_matches('/'))
    }

    /// Returns the part of the settings that a run records.
    pub fn stamp(&self) -> ModelStamp {
        let ModelSettings { model, judge, words, .. } = self.clone();
        ModelStamp { host: self.host().to_owned(), model, judge, words }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WHOLE: &str = "endpoint = \"http://127.0.0.1:11434/v1/\"\nmodel = \"llama3\"\n";

    #[test]
    fn what_is_left_out_has_defaults_and_a_run_records_no_key() {
        let settings = ModelSettings::read("voice.toml", &format!("{WHOLE}key_variable = \"MODEL_KEY\"\n"));
        let settings = settings.expect("settings");
        assert_eq!((settings.seconds_a_week, settings.judge, settings.words), (30, false, true));
        assert_eq!(settings.address(), "http://127.0.0.1:11434/v1/chat/completions");
        let stamp = settings.stamp();
        assert_eq!(stamp.in_words(), "llama3 at 127.0.0.1:11434 rewords posts");
        assert!(!toml::to_string(&stamp).expect("a table").contains("KEY"));
        for endpoint in ["http://[::1]:8080", "http://box/v1", "http://box.example:80/a-b/v1"] {
            let text = WHOLE.replace("http://127.0.0.1:11434/v1/", endpoint);
            ModelSettings::read("voice.toml", &text).expect(endpoint);
        }
    }

    #[test]
    fn what_is_wrong_is_named_with_line_and_key() {
        let local = "http://127.0.0.1:11434/v1/";
        for (text, line, part) in [
            (format!("{WHOLE}modell = 1\n"), 3, "modell"),
            (format!("{WHOLE}judge = \"yes\"\n"), 3, "boolean"),
            (WHOLE.replace("http:", "https:"), 1, "gateway on this machine"),
            (WHOLE.replace(local, "127.0.0.1:11434"), 1, "endpoint"),
            (WHOLE.replace(local, "http://me:secret@box/v1"), 1, "without user name, password"),
            (WHOLE.replace(local, "http://box:99999/v1"), 1, "http://127.0.0.1:11434/v1"),
            (WHOLE.replace(local, "http://box/v1?key=1"), 1, "or query"),
            (WHOLE.replace(local, "http:///v1"), 1, "endpoint"),
            (WHOLE.replace("llama3", " "), 2, "model"),
            (format!("{WHOLE}key_variable = \"sk-1234\"\n"), 3, "environment variable"),
            (format!("{WHOLE}seconds_a_week = 0\n"), 3, "1 to 600 seconds"),
            (format!("{WHOLE}words = false\n"), 3, "nothing to do"),
        ] {
            let error = ModelSettings::read("voice.toml", &text).expect_err(&text).to_string();
            assert!(error.contains(&format!("voice.toml, line {line}")) && error.contains(part), "{error}");
        }
    }
}
