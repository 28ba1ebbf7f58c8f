//! Rules of a session: information that agents do not have, recorded activity, and time limits. The first line of a
//! run records these rules.

use serde::{Deserialize, Serialize};

use crate::mode::Mode;

/// Rules for the information, recording and time limits of a session.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SessionRules {
    /// Whether alerts recommend an amount and fill in the form. Otherwise, alerts only state facts.
    pub advice: bool,
    /// Whether forecast forms show the accuracy of earlier forecasts.
    pub calibration: bool,
    /// Results that the final page shows.
    pub results: ResultsDisclosure,
    /// How free text is recorded.
    pub free_text: FreeTextRecording,
    /// How abandoned texts are recorded.
    pub drafts: DraftRecording,
    /// Kinds of activity that are not recorded.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub unrecorded: Vec<String>,
    /// Whether the user must give a reason for stopping the clock.
    #[serde(default)]
    pub pause_reason: bool,
    /// A setting of earlier builds that is read and never written.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub code_words: Option<bool>,
    /// Limits of active time, and the action when a limit is reached.
    #[serde(default)]
    pub limits: TimeLimits,
}

/// Results that the final page of a run shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ResultsDisclosure {
    /// No results, only the statement that the run is over.
    None,
    /// The participant's result.
    Own,
    /// The participant's result and published results.
    Published,
}

/// How notes and free-text answers are recorded. Rationales are always recorded in full.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum FreeTextRecording {
    /// The full text is recorded.
    Kept,
    /// Only the length and the digest of a text are recorded.
    Masked,
}

/// How texts that were edited and abandoned are recorded.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum DraftRecording {
    /// Edits are not recorded.
    None,
    /// Only lengths, pauses and deletions are recorded.
    Lengths,
    /// Lengths, pauses, deletions and the abandoned text are recorded.
    Text,
}

/// Time limits in minutes of a session; `None` means no limit.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TimeLimits {
    /// Limit for one simulated week.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub week_minutes: Option<u32>,
    /// Limit for one session.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub session_minutes: Option<u32>,
    /// Limit for all sessions together.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub study_minutes: Option<u32>,
    /// Number of minutes before a limit at which the participant is warned.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub warning_minutes: Option<u32>,
    /// Action when a limit is reached.
    #[serde(default)]
    pub at_limit: LimitAction,
}

impl TimeLimits {
    /// Checks that the warning time is shorter than each limit. Otherwise, returns the invalid key and a message.
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
                    "a warning {warning} minutes before the end of {key} = {minutes} would be shown from the start"
                ),
            )),
        }
    }
}

/// Action when a time limit is reached.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum LimitAction {
    /// Remind the participant of the limit.
    #[default]
    Remind,
    /// Submit the week with naive forecasts.
    Naive,
    /// Stop the clock until the experimenter starts it.
    Pause,
}

impl SessionRules {
    /// Returns whether the final result and figures are hidden because the run is over and the study withholds results.
    pub fn hides_result(&self, is_over: bool) -> bool {
        self.withholds_results() && is_over
    }

    /// Returns whether the study withholds results from participants.
    pub fn withholds_results(&self) -> bool {
        self.results == ResultsDisclosure::None
    }

    /// Returns the default rules of a mode, for runs outside of a study.
    pub fn for_mode(mode: Mode) -> SessionRules {
        let open = SessionRules {
            advice: true,
            calibration: true,
            results: ResultsDisclosure::Published,
            free_text: FreeTextRecording::Kept,
            drafts: DraftRecording::Lengths,
            unrecorded: Vec::new(),
            pause_reason: false,
            code_words: None,
            limits: TimeLimits::default(),
        };
        match mode {
            // Agents get neither advice nor calibration, so baseline participants get neither.
            Mode::Baseline => {
                SessionRules { advice: false, calibration: false, results: ResultsDisclosure::Own, ..open }
            }
            // Advice would give away the solutions of lessons.
            Mode::Lesson => SessionRules { advice: false, ..open },
            Mode::Sandbox | Mode::Debug => open,
        }
    }

    /// Returns whether the rules record activity of this kind.
    pub fn records_activity(&self, kind: &str) -> bool {
        !self.unrecorded.iter().any(|left_out| left_out == kind)
    }
}
