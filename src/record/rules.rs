//! Rules of a session: information beyond that of agents, recorded activity, and time limits. The first line of a run
//! records them.

use serde::{Deserialize, Serialize};

use crate::mode::Mode;

/// The rules of a session.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SessionRules {
    /// Whether alerts recommend an amount and fill in the form. Otherwise they state facts.
    pub advice: bool,
    /// Whether forecast forms show how earlier forecasts performed.
    pub calibration: bool,
    /// Content of the final page.
    pub results: ResultsShown,
    /// How free text is recorded.
    pub free_text: FreeText,
    /// How abandoned texts are recorded.
    pub drafts: DraftsKept,
    /// Kinds of activity that are not recorded.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub unrecorded: Vec<String>,
    /// Whether stopping the clock asks for a reason.
    #[serde(default)]
    pub pause_reason: bool,
    /// A setting of earlier builds. It is read and never written.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub code_words: Option<bool>,
    /// Time limits.
    #[serde(default)]
    pub limits: TimeLimits,
}

/// Content of the final page.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ResultsShown {
    /// Only that the run is over.
    None,
    /// The participant's own result.
    Own,
    /// The own result and published results.
    Published,
}

/// Recording of notes and answers in words. Rationales are always recorded in full.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum FreeText {
    /// Full text.
    Kept,
    /// Lengths and digests only.
    Masked,
}

/// Recording of texts that were edited and abandoned.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum DraftsKept {
    /// Nothing.
    None,
    /// Lengths, pauses and deletions.
    Lengths,
    /// Also the abandoned text.
    Text,
}

/// Time limits in active minutes; `None` means no limit.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TimeLimits {
    /// Limit of one week of the company.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub week_minutes: Option<u32>,
    /// Limit of one session.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub session_minutes: Option<u32>,
    /// Limit of all sessions together.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub study_minutes: Option<u32>,
    /// Minutes before a limit at which the participant is warned.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub warning_minutes: Option<u32>,
    /// Action at the limit.
    #[serde(default)]
    pub at_limit: AtLimit,
}

impl TimeLimits {
    /// Checks that the warning time is shorter than each limit. Returns the key and the message otherwise.
    pub fn check_warning(&self) -> Result<(), (&'static str, String)> {
        let Some(warning) = self.warning_minutes else { return Ok(()) };
        let limits = [
            ("week_minutes", self.week_minutes),
            ("session_minutes", self.session_minutes),
            ("study_minutes", self.study_minutes),
        ];
        match limits.iter().find_map(|(key, minutes)| {
            minutes.filter(|minutes| *minutes <= warning).map(|minutes| (key, minutes))
        }) {
            None => Ok(()),
            Some((key, minutes)) => Err((
                "limits.warning_minutes",
                format!(
                    "a warning {warning} minutes before the end of {key} = {minutes} would show from the start"
                ),
            )),
        }
    }
}

/// Action when a time limit is reached.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum AtLimit {
    /// Remind the participant.
    #[default]
    Remind,
    /// Submit the week with naive forecasts.
    Naive,
    /// Stop the clock until the experimenter starts it.
    Pause,
}

impl SessionRules {
    /// Returns whether the final result and figures are hidden: the study withholds results, and the run is over.
    pub fn hides_result(&self, is_over: bool) -> bool {
        self.withholds_results() && is_over
    }

    /// Returns whether the study withholds results from participants.
    pub fn withholds_results(&self) -> bool {
        self.results == ResultsShown::None
    }

    /// Returns the rules of a run outside of a study.
    pub fn for_mode(mode: Mode) -> SessionRules {
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
            // Agents have neither, so baseline participants have neither.
            Mode::Baseline => {
                SessionRules { advice: false, calibration: false, results: ResultsShown::Own, ..open }
            }
            // Advice would give away the solutions of lessons.
            Mode::Lesson => SessionRules { advice: false, ..open },
            Mode::Sandbox | Mode::Debug => open,
        }
    }

    /// Returns whether activity of a kind is recorded.
    pub fn records_activity(&self, kind: &str) -> bool {
        !self.unrecorded.iter().any(|left_out| left_out == kind)
    }
}
