//! Consent of participants before a baseline session.
//!
//! The experimenter writes the consent text to `consent.md` in the configuration folder. Each participant sees the text
//! once, and again after each change. If this file does not exist, no consent is required.

use crate::clock::now;
use serde::{Deserialize, Serialize};

/// A participant's recorded agreement to the consent text.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Consent {
    /// BLAKE3 digest of the consent text, in hexadecimal digits.
    pub digest: String,
    /// Time of the agreement, RFC 3339.
    pub at: String,
    /// Circumstances of the agreement; `None` in runs of format 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub given: Option<ConsentDetails>,
    /// The complete consent text; `None` in runs of format 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub text: Option<String>,
}

/// How and in what circumstances a participant agreed to the consent text.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ConsentDetails {
    /// How the participant agreed: on a screen, at a prompt or on paper.
    pub means: ConsentMeans,
    /// Whether the participant scrolled the text to its end on the screen.
    pub scrolled_to_end: bool,
    /// How long the text was on the screen, in milliseconds.
    pub read_ms: u64,
}

impl ConsentDetails {
    /// Returns the details of a consent that was given on paper, according to the experimenter.
    pub fn on_paper() -> ConsentDetails {
        ConsentDetails { means: ConsentMeans::Paper, scrolled_to_end: false, read_ms: 0 }
    }
}

/// How a participant agreed to the consent text.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ConsentMeans {
    /// The participant agreed on a screen of the console.
    Screen,
    /// The participant agreed at a prompt of a terminal.
    Prompt,
    /// The participant agreed on paper, according to the experimenter.
    Paper,
}

/// A text that requires agreement.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ConsentText {
    /// Path of the file with the consent text.
    pub file: String,
    /// Content of the consent file.
    pub text: String,
}

impl ConsentText {
    /// Returns a message that explains how to agree without a screen.
    pub fn instructions(&self) -> String {
        format!(
            "a baseline session needs the participant's agreement to {}: read this file, then start again with \
             --consent. Nothing was recorded",
            self.file
        )
    }

    /// Returns the BLAKE3 digest of the consent text, in hexadecimal digits.
    pub fn digest(&self) -> String {
        blake3::hash(self.text.as_bytes()).to_hex().to_string()
    }
}

/// An agreement to the consent text that is not recorded in a run yet.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ConsentAgreement {
    /// Circumstances of the agreement.
    pub given: ConsentDetails,
    /// Time of the agreement, RFC 3339.
    pub at: String,
}

impl ConsentDetails {
    /// Returns an agreement with these circumstances at the current time.
    pub fn agree_now(self) -> ConsentAgreement {
        ConsentAgreement { given: self, at: now() }
    }
}
