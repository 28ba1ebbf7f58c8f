//! Time limits: the person is warned, and what the study says happens when one is reached.

use super::App;
use crate::effect::Effect;
use novamind_record::rules::{DraftsKept, SessionRules};
use novamind_record::trajectory::record::{DraftOutcome, Limit, LimitEvent, LimitScope};
use novamind_session::{TIME_LIMIT, TimeLeft};
use novamind_worker::request::Request;

/// What was told of time limits.
#[derive(Default)]
pub(super) struct LimitTold {
    /// The limit that is near, or was reached, and whether it was reached: said above the screen until the week has run.
    notice: Option<(LimitScope, bool)>,
    /// The time for the week is over: it is filed as soon as nothing is in the way.
    files: bool,
    /// What became of a text that was being written when the week was filed.
    text: Option<String>,
}

impl App {
    /// A limit is near or reached.
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

    /// A limit that has stopped the clock holds when the run is opened again.
    pub(super) fn hold_limit(&mut self) {
        self.stop_clock(Some(TIME_LIMIT.to_owned()), true);
    }

    /// What is said of a limit above the screen. It takes no keys: the person types on below it.
    pub fn limit_notice(&self) -> Option<String> {
        let (scope, reached) = self.limit.notice?;
        let run = self.run().filter(|run| run.company.is_running())?;
        let left = run.time_left.iter().find(|left| left.scope == scope)?;
        Some(match reached {
            true => format!("{}: please come to an end", left.in_words()),
            false => in_full(left, &run.company.rules),
        })
    }

    /// Files the week of which the time is over. Questions of the study are answered first.
    pub(super) fn settle_limit(&mut self) {
        if !self.limit.files || self.owes_answers() || self.cover.is_some() || self.closing.is_some() {
            return;
        }
        match &self.busy {
            // A week that runs already was filed in time.
            Some(busy) if busy.days.is_some() => self.limit.files = false,
            Some(_) => {}
            None => self.file_for_the_person(),
        }
    }

    /// Files the week with the naive projection. What was typed for it was not sent.
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
        self.say("the time for this week is over: it is filed with the naive projection");
    }

    /// The week has run: what was told of limits is over. What became of a text that was not filed.
    pub(super) fn end_limit_of_week(&mut self) -> Option<String> {
        std::mem::take(&mut self.limit).text
    }
}

fn in_full(left: &TimeLeft, rules: &SessionRules) -> String {
    format!("{}; {}", left.in_words(), left.what_follows(rules.limits.at_limit))
}

/// What the record keeps of a text that was not filed.
fn kept_in_words(rules: &SessionRules) -> String {
    let kept = match rules.drafts {
        _ if !rules.records("draft") => "it is not kept",
        DraftsKept::None => "it is not kept",
        DraftsKept::Lengths => "the record keeps how long it was, not its words",
        DraftsKept::Text => "the record keeps it as a draft",
    };
    format!("What you had typed for it was not filed; {kept}.")
}
