//! What a participant agrees to before a baseline session.
//!
//! The text is the experimenter's: `consent.md` in the configuration folder. It is shown once to a participant; a
//! text that was changed is shown again. Without the file nothing is asked.

use crate::clock::now;
use serde::{Deserialize, Serialize};

/// That somebody has agreed.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Consent {
    /// blake3 digest of the text, in hexadecimal digits.
    pub digest: String,
    /// When, RFC 3339.
    pub at: String,
    /// How it was given; none in runs of format 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub given: Option<ConsentGiven>,
    /// The text, whole; none in runs of format 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub text: Option<String>,
}

/// How somebody has agreed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ConsentGiven {
    /// By which means.
    pub means: ConsentMeans,
    /// The text was scrolled to its end on the screen before.
    pub scrolled_to_end: bool,
    /// Milliseconds the text was on the screen.
    pub read_ms: u64,
}

impl ConsentGiven {
    /// Signed on paper, as the experimenter says.
    pub fn on_paper() -> ConsentGiven {
        ConsentGiven { means: ConsentMeans::Paper, scrolled_to_end: false, read_ms: 0 }
    }
}

/// By which means somebody agrees.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ConsentMeans {
    /// On a screen of the console.
    Screen,
    /// At a prompt of a terminal.
    Prompt,
    /// On paper, as the experimenter says.
    Paper,
}

/// A text that somebody has to agree to.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ConsentText {
    /// Where it was read.
    pub file: String,
    /// The text.
    pub text: String,
}

impl ConsentText {
    /// The text, and how to agree without a screen.
    pub fn explained(&self) -> String {
        format!(
            "a baseline session needs the participant's agreement to {}: read it, then start with --consent. \
             Nothing was recorded",
            self.file
        )
    }

    /// Returns its blake3 digest, in hexadecimal digits.
    pub fn digest(&self) -> String {
        blake3::hash(self.text.as_bytes()).to_hex().to_string()
    }
}

/// An agreement that no run records yet.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Agreed {
    /// How it was given.
    pub given: ConsentGiven,
    /// When, RFC 3339.
    pub at: String,
}

impl ConsentGiven {
    /// That it was given at the present moment.
    pub fn now(self) -> Agreed {
        Agreed { given: self, at: now() }
    }
}
