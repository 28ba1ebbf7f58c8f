//! Time limits: warns the user and does what the study requires when a limit is reached.

use super::App;
use crate::effect::Effect;
use novamind_record::rules::{DraftsKept, SessionRules};
use novamind_record::trajectory::record::{DraftOutcome, Limit, LimitEvent, LimitScope};
use novamind_session::{TIME_LIMIT, TimeLeft};
use novamind_worker::request::Request;

#[derive(Default)]
pub(super) struct LimitTold {
    /// The limit to show above the screen until the week has run, and whether it was reached.
    notice: Option<(LimitScope, bool)>,
    /// The time for the week has ended: the week is submitted as soon as nothing blocks it.
    files: bool,
    /// What happened to a text that the user was writing when the week was submitted.
    text: Option<String>,
}

impl App {
    pub(super) fn reach_limit(&mut self, limit: &Limit) {
        match limit.event {
            LimitEvent::Warned => self.limit.notice = Some((limit.limit, false)),
            LimitEvent::Reminded => self.limit.notice = Some((limit.limit, true)),
            LimitEvent::FiledNaively => self.limit.files = true,
            LimitEvent::Paused => {
                self.limit.notice = None;
                self.stop_clock(Some(TIME_LIMIT.to_owned()), true);
            }
        }
    }

    /// Stops the clock again if a limit had stopped it when the run was last open.
    pub(super) fn hold_limit(&mut self) {
        self.stop_clock(Some(TIME_LIMIT.to_owned()), true);
    }

    /// Returns the notice above the screen. It takes no keys, so the user can continue typing.
    pub fn limit_notice(&self) -> Option<String> {
        let (scope, reached) = self.limit.notice?;
        let run = self.run().filter(|run| run.company.is_running())?;
        let left = run.time_left.iter().find(|left| left.scope == scope)?;
        Some(match reached {
            true => format!("{}: please finish", left.in_words()),
            false => in_full(left, &run.company.rules),
        })
    }

    /// Submits the week when its time has ended. Questions of the study are answered first.
    pub(super) fn settle_limit(&mut self) {
        if !self.limit.files || self.owes_answers() || self.cover.is_some() || self.closing.is_some() {
            return;
        }
        match &self.busy {
            // A week that is already running was submitted in time.
            Some(busy) if busy.days.is_some() => self.limit.files = false,
            Some(_) => {}
            None => self.file_for_the_person(),
        }
    }

    /// Submits the week with the naive forecasts. Drafts are not sent.
    fn file_for_the_person(&mut self) {
        self.limit.files = false;
        let Some(run) = self.run().filter(|run| run.company.is_running()) else { return };
        let mut forecasts = run.company.naive;
        forecasts.filled_naively = [true; 4];
        self.limit.text = run.filing.has_draft().then(|| kept_in_words(&run.company.rules));
        self.close_layers();
        self.leave_filing(DraftOutcome::Left);
        let rationale = TIME_LIMIT.to_owned();
        self.follow(vec![Effect::Request(Request::Advance { rationale, forecasts })]);
        self.say("time for this week is up; it was submitted with the projection");
    }

    /// Clears the notices of the week. Returns what happened to a draft that was not submitted.
    pub(super) fn end_limit_of_week(&mut self) -> Option<String> {
        std::mem::take(&mut self.limit).text
    }
}

fn in_full(left: &TimeLeft, rules: &SessionRules) -> String {
    format!("{}; {}", left.in_words(), left.what_follows(rules.limits.at_limit))
}

fn kept_in_words(rules: &SessionRules) -> String {
    let kept = match rules.drafts {
        _ if !rules.records("draft") => "it is lost",
        DraftsKept::None => "it is lost",
        DraftsKept::Lengths => "the record keeps its length, not its text",
        DraftsKept::Text => "the record keeps it as a draft",
    };
    format!("Your draft was not submitted; {kept}.")
}
