//! What a participant agrees to before a baseline session.
//!
//! The text is the experimenter's: `consent.md` in the configuration folder. It is shown once to a participant; a
//! text that was changed is shown again. Without the file nothing is asked.

use serde::{Deserialize, Serialize};

/// That somebody has agreed.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Consent {
    /// blake3 digest of the text, in hexadecimal digits.
    pub digest: String,
    /// When, RFC 3339.
    pub at: String,
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
    pub(in crate::session) fn explained(&self) -> String {
        format!(
            "a baseline session needs the participant's agreement to {}: read it, then start with --consent. \
             Nothing was recorded",
            self.file
        )
    }

    pub(in crate::session) fn digest(&self) -> String {
        blake3::hash(self.text.as_bytes()).to_hex().to_string()
    }
}
