//! Time limits: the person is warned, and what the study says happens when one is reached.

use super::App;
use crate::console::dialogs::reader::Reader;
use crate::console::effect::Effect;
use crate::console::request::Request;
use crate::session::TIME_LIMIT;
use crate::session::record::{Limit, LimitEvent, LimitScope};

impl App {
    /// A limit is near or reached.
    pub(super) fn reach_limit(&mut self, limit: &Limit) {
        let scope = match limit.limit {
            LimitScope::Week => "this week",
            LimitScope::Session => "this session",
            LimitScope::Study => "the study",
        };
        let minutes = limit.minutes;
        match limit.event {
            LimitEvent::Warned => {
                let left = self.time_left_of(limit.limit);
                self.open(Reader::new("Time limit", left.unwrap_or_default()));
            }
            LimitEvent::Reminded => {
                let text = format!("You have used the {minutes} minutes for {scope}. Please come to an end.");
                self.open(Reader::new("Time limit", text));
            }
            LimitEvent::FiledNaively => self.file_for_the_person(),
            LimitEvent::Paused => self.stop_clock(Some(TIME_LIMIT.to_owned()), true),
        }
    }

    /// A limit that has stopped the clock holds when the run is opened again.
    pub(super) fn hold_limit(&mut self) {
        self.stop_clock(Some(TIME_LIMIT.to_owned()), true);
    }

    fn time_left_of(&self, scope: LimitScope) -> Option<String> {
        let left = self.run()?.time_left.iter().find(|left| left.scope == scope)?;
        Some(left.in_words())
    }

    /// Files the week with the naive projection.
    fn file_for_the_person(&mut self) {
        let Some(run) = self.run().filter(|run| run.company.is_running()) else { return };
        if self.busy.is_some() {
            // A week that runs already was filed in time.
            return;
        }
        let mut forecasts = run.company.naive;
        forecasts.filled_naively = [true; 4];
        let rationale = TIME_LIMIT.to_owned();
        self.close_layers();
        self.follow(vec![Effect::Request(Request::Advance { rationale, forecasts })]);
        self.say("the time for this week is over: it is filed with the naive projection");
    }
}
