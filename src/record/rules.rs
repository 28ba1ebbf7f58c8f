//! By which rules a session is played: what the program shows beyond what agents have, what it records, how long a person
//! may take. They stand in the first line of the run.

use serde::{Deserialize, Serialize};

use crate::mode::Mode;

/// The rules of a session.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SessionRules {
    /// Alerts recommend: they name an amount and fill in the form. Otherwise they state facts.
    pub advice: bool,
    /// The person sees how their own forecasts have done while they make new ones.
    pub calibration: bool,
    /// What the final page shows.
    pub results: ResultsShown,
    /// What is kept of the texts that a person writes.
    pub free_text: FreeText,
    /// What is kept of texts that were edited and left.
    pub drafts: DraftsKept,
    /// Kinds of activity that are not recorded.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub unrecorded: Vec<String>,
    /// The person is asked why they stop the clock.
    #[serde(default)]
    pub pause_reason: bool,
    /// A setting that earlier builds had: it is read and never written.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub code_words: Option<bool>,
    /// How long a person may take.
    #[serde(default)]
    pub limits: TimeLimits,
}

/// What the final page shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ResultsShown {
    /// That the run is over.
    None,
    /// The person's own result.
    Own,
    /// It, beside published ones.
    Published,
}

/// What is kept of the texts that a person writes: notes, rationales are always kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum FreeText {
    /// Everything.
    Kept,
    /// Lengths and digests of notes and answers in words.
    Masked,
}

/// What is kept of texts that were edited and left.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum DraftsKept {
    /// Nothing.
    None,
    /// How they came to be: lengths, pauses, deletions.
    Lengths,
    /// Also the text that was left.
    Text,
}

/// How long a person may take, in active minutes; none: as long as they like.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TimeLimits {
    /// For a week of the company.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub week_minutes: Option<u32>,
    /// For a sitting.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub session_minutes: Option<u32>,
    /// For all sittings.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub study_minutes: Option<u32>,
    /// How long before a limit the person is warned.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub warning_minutes: Option<u32>,
    /// What happens when it is reached.
    #[serde(default)]
    pub at_limit: AtLimit,
}

impl TimeLimits {
    /// Checks that a warning comes after the time that it warns of has begun.
    pub fn check_warning(&self) -> Result<(), (&'static str, String)> {
        let Some(warning) = self.warning_minutes else { return Ok(()) };
        let limits = [
            ("week_minutes", self.week_minutes),
            ("session_minutes", self.session_minutes),
            ("study_minutes", self.study_minutes),
        ];
        match limits.iter().find_map(|(key, own)| own.filter(|own| *own <= warning).map(|own| (key, own))) {
            None => Ok(()),
            Some((key, own)) => Err((
                "limits.warning_minutes",
                format!(
                    "a warning {warning} minutes before the end of {key} = {own} would stand from the beginning"
                ),
            )),
        }
    }
}

/// What happens when a time limit is reached.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum AtLimit {
    /// The person is reminded.
    #[default]
    Remind,
    /// The week is filed with the naive projection.
    Naive,
    /// The clock is stopped, until the experimenter starts it.
    Pause,
}

impl SessionRules {
    /// Whether neither result nor figures are shown any more: results are kept from participants, and the run is over.
    pub fn hide_result(&self, is_over: bool) -> bool {
        self.hides_results() && is_over
    }

    /// Whether results are kept from participants.
    pub fn hides_results(&self) -> bool {
        self.results == ResultsShown::None
    }

    /// The rules of a run that belongs to no study.
    pub fn of_mode(mode: Mode) -> SessionRules {
        let open = SessionRules {
            advice: true,
            calibration: true,
            results: ResultsShown::Published,
            free_text: FreeText::Kept,
            drafts: DraftsKept::Lengths,
            unrecorded: Vec::new(),
            pause_reason: false,
            code_words: None,
            limits: TimeLimits::default(),
        };
        match mode {
            // What agents do not have, a comparable person does not have.
            Mode::Baseline => {
                SessionRules { advice: false, calibration: false, results: ResultsShown::Own, ..open }
            }
            // What is to be found out is not told beside it.
            Mode::Lesson => SessionRules { advice: false, ..open },
            Mode::Sandbox | Mode::Debug => open,
        }
    }

    /// Whether activity of a kind is recorded.
    pub fn records(&self, kind: &str) -> bool {
        !self.unrecorded.iter().any(|left_out| left_out == kind)
    }
}
