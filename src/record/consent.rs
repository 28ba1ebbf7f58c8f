//! Consent of participants before a baseline session.
//!
//! The experimenter writes the text to `consent.md` in the configuration folder. Each participant sees it once, and again
//! after it was changed. Without the file, no consent is required.

use crate::clock::now;
use serde::{Deserialize, Serialize};

/// A recorded agreement.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Consent {
    /// BLAKE3 digest of the text, in hexadecimal digits.
    pub digest: String,
    /// Moment of the agreement, RFC 3339.
    pub at: String,
    /// How it was given; `None` in runs of format 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub given: Option<ConsentGiven>,
    /// The complete text; `None` in runs of format 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub text: Option<String>,
}

/// The circumstances of an agreement.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ConsentGiven {
    /// Means of the agreement.
    pub means: ConsentMeans,
    /// Whether the text was scrolled to its end on the screen.
    pub scrolled_to_end: bool,
    /// Milliseconds for which the text was on the screen.
    pub read_ms: u64,
}

impl ConsentGiven {
    /// Returns a consent on paper, as stated by the experimenter.
    pub fn on_paper() -> ConsentGiven {
        ConsentGiven { means: ConsentMeans::Paper, scrolled_to_end: false, read_ms: 0 }
    }
}

/// Means of an agreement.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ConsentMeans {
    /// On a screen of the console.
    Screen,
    /// At a prompt of a terminal.
    Prompt,
    /// On paper, as stated by the experimenter.
    Paper,
}

/// A text that requires agreement.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ConsentText {
    /// Path of the file.
    pub file: String,
    /// The text.
    pub text: String,
}

impl ConsentText {
    /// Returns the text with instructions for agreeing without a screen.
    pub fn instructions(&self) -> String {
        format!(
            "a baseline session needs the participant's agreement to {}: read it, then start with --consent. \
             Nothing was recorded",
            self.file
        )
    }

    /// Returns the BLAKE3 digest of the text, in hexadecimal digits.
    pub fn digest(&self) -> String {
        blake3::hash(self.text.as_bytes()).to_hex().to_string()
    }
}

/// An agreement that is not recorded in a run yet.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ConsentAgreement {
    /// How it was given.
    pub given: ConsentGiven,
    /// Moment of the agreement, RFC 3339.
    pub at: String,
}

impl ConsentGiven {
    /// Returns the agreement with the current moment.
    pub fn given_now(self) -> ConsentAgreement {
        ConsentAgreement { given: self, at: now() }
    }
}
