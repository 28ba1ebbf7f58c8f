//! Time limits: warns the user and applies the consequence that the study defines for a reached limit.

use super::App;
use crate::effect::Effect;
use novamind_record::rules::{DraftRecording, SessionRules};
use novamind_record::trajectory::record::{Limit, LimitEvent, LimitScope, TextEditOutcome};
use novamind_session::{TIME_LIMIT_RATIONALE, TimeLeft};
use novamind_worker::request::Request;

#[derive(Default)]
pub(super) struct TimeLimitState {
    /// The time limit to show above the screen until the week has run, and whether the limit was reached.
    notice: Option<(LimitScope, bool)>,
    /// Whether the time for the week has ended. The week is then submitted as soon as no work blocks it.
    must_submit_week: bool,
    /// Notice about a draft that was not submitted when the time for the week ended.
    draft_notice: Option<String>,
}

impl App {
    pub(super) fn handle_limit(&mut self, limit: &Limit) {
        match limit.event {
            LimitEvent::Warned => self.time_limit.notice = Some((limit.limit, false)),
            LimitEvent::Reminded => self.time_limit.notice = Some((limit.limit, true)),
            LimitEvent::FiledNaively => self.time_limit.must_submit_week = true,
            LimitEvent::Paused => {
                self.time_limit.notice = None;
                self.stop_clock(Some(TIME_LIMIT_RATIONALE.to_owned()), true);
            }
        }
    }

    /// Stops the clock if a limit had stopped the clock when the run was last open.
    pub(super) fn pause_for_limit(&mut self) {
        self.stop_clock(Some(TIME_LIMIT_RATIONALE.to_owned()), true);
    }

    /// Returns the time limit notice above the screen. The notice handles no keys, so that the user can continue
    /// typing.
    pub fn limit_notice(&self) -> Option<String> {
        let (scope, reached) = self.time_limit.notice?;
        let run = self.run().filter(|run| run.company.is_running())?;
        let left = run.time_left.iter().find(|left| left.scope == scope)?;
        Some(match reached {
            true => format!("{}: please finish", left.describe()),
            false => limit_notice_text(left, &run.company.rules),
        })
    }

    /// Submits the week when the time for the week has ended. The participant must answer due questions of the study
    /// first.
    pub(super) fn enforce_week_limit(&mut self) {
        if !self.time_limit.must_submit_week
            || self.has_due_questions()
            || self.pause_screen.is_some()
            || self.exit_target.is_some()
        {
            return;
        }
        match &self.busy {
            // A week that is already running was submitted in time.
            Some(busy) if busy.progress.is_some() => self.time_limit.must_submit_week = false,
            Some(_) => {}
            None => self.submit_naive_week(),
        }
    }

    /// Submits the week with the naive forecasts. Drafts are not sent.
    fn submit_naive_week(&mut self) {
        self.time_limit.must_submit_week = false;
        let Some(run) = self.run().filter(|run| run.company.is_running()) else { return };
        let mut forecasts = run.company.naive_forecasts;
        forecasts.filled_naively = [true; 4];
        self.time_limit.draft_notice =
            run.next_week.has_draft().then(|| draft_retention_text(&run.company.rules));
        self.close_layers();
        self.end_next_week_drafts(TextEditOutcome::Left);
        let rationale = TIME_LIMIT_RATIONALE.to_owned();
        self.execute_effects(vec![Effect::Request(Request::Advance { rationale, forecasts })]);
        self.show_status("time for this week is up; the week was submitted with naive forecasts");
    }

    /// Clears the notices of the week. Returns the notice about a draft that was not submitted.
    pub(super) fn take_week_draft_notice(&mut self) -> Option<String> {
        std::mem::take(&mut self.time_limit).draft_notice
    }
}

fn limit_notice_text(left: &TimeLeft, rules: &SessionRules) -> String {
    format!("{}; {}", left.describe(), left.describe_consequence(rules.limits.at_limit))
}

fn draft_retention_text(rules: &SessionRules) -> String {
    let kept = match rules.drafts {
        _ if !rules.records_activity("draft") => "the text is lost",
        DraftRecording::None => "the text is lost",
        DraftRecording::Lengths => "the length was recorded, but not the text",
        DraftRecording::Text => "the text was recorded as a draft",
    };
    format!("Your draft was not submitted; {kept}.")
}
