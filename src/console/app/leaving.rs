//! Leaving a run: open views are recorded as left, the run is saved and closed, then the menu or the shell follows.

use super::{App, Busy, Order, Stage};
use crate::context::ScreenId;
use crate::dialogs::confirm::Confirm;
use crate::effect::Effect;
use crate::screens::menu::Menu;
use novamind_record::trajectory::record::LeavingCause;
use novamind_session::Access;
use novamind_worker::Job;
use novamind_worker::request::Request;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Closing {
    /// The start menu, or the participant's next page.
    ToMenu,
    ToShell,
    /// Exit because of a signal, with its number.
    BySignal(i32),
}

impl Closing {
    fn cause(self) -> LeavingCause {
        const HANGUP: i32 = 1;
        match self {
            Closing::ToMenu | Closing::ToShell => LeavingCause::Quit,
            Closing::BySignal(HANGUP) => LeavingCause::Hangup,
            Closing::BySignal(_) => LeavingCause::Signal,
        }
    }

    fn code(self) -> u8 {
        match self {
            Closing::ToMenu | Closing::ToShell => 0,
            Closing::BySignal(number) => 128u8.saturating_add(number as u8),
        }
    }
}

const KEEPS_TEXT: &str = "A form, the notes, a post or the next-week dialog has unsent text. It is saved with the run and \
                          offered when you open the run again.";
/// Nothing can be sent after the run has ended.
const DROPS_TEXT: &str = "The notes have unsaved text. The run has ended; the text will be lost.";
const DROPS_OFFERS: &str = "Unsent offers in the inbox will be lost.";

impl App {
    /// Describes what happens to drafts and asks whether to leave the run. Returns `None` if there are no drafts.
    fn unsent_question(&self) -> Option<String> {
        let run = self.run().filter(|run| run.viewer.is_none())?;
        let holds = |screen: &ScreenId| run.screens.get(*screen).holds_unsent_text();
        let (offers, texts): (Vec<ScreenId>, Vec<ScreenId>) =
            ScreenId::ALL.into_iter().filter(holds).partition(|screen| *screen == ScreenId::Inbox);
        let mut sentences = Vec::new();
        if run.filing.has_draft() || !texts.is_empty() {
            sentences.push(if run.company.is_running() { KEEPS_TEXT } else { DROPS_TEXT });
        }
        if !offers.is_empty() {
            sentences.push(DROPS_OFFERS);
        }
        let question = || format!("{} Leave this run now?", sentences.join(" "));
        (!sentences.is_empty()).then(question)
    }

    pub(super) fn quit(&mut self) {
        match self.unsent_question() {
            Some(question) => self.open(Confirm::new("Leave", question, vec![Effect::LeaveNow])),
            None => self.leave(Closing::ToShell),
        }
    }

    pub(super) fn open_other(&mut self, id: String) {
        let is_open = self.run().is_some_and(|run| run.viewer.is_none() && run.company.seen.run == id);
        if is_open {
            return self.complain(format!("run {id} is already open"));
        }
        if self.busy.is_some() {
            return self.complain("days are running; try again when they are done");
        }
        let open = Effect::Request(Request::Open(id.clone(), Access::Write));
        match self.unsent_question() {
            Some(question) => self.open(Confirm::new(format!("open run {id}"), question, vec![open])),
            None => self.follow(vec![open]),
        }
    }

    pub(super) fn leave(&mut self, closing: Closing) {
        if self.closing.is_some_and(|planned| planned != Closing::ToMenu) {
            return;
        }
        self.stop_on_the_way();
        // Leaving a run returns a participant to the study.
        let at_study = self.leads_participant() && matches!(self.stage, Stage::Run(_));
        let quits = closing == Closing::ToShell;
        let closing = if at_study && quits { Closing::ToMenu } else { closing };
        self.put_down();
        self.closing = Some(closing);
        match &self.stage {
            Stage::Run(_) => {
                self.busy = Some(Busy { stops_script: true, ..Busy::with("saving") });
                self.orders.push(Order::CancelQuery);
                self.orders.push(Order::Job(Job::Close(closing.cause())));
            }
            Stage::Menu(_) | Stage::Visit(_) => self.closed(None),
        }
    }

    pub(super) fn closed(&mut self, problem: Option<String>) {
        self.busy = None;
        let was_replay = self.is_replay();
        let code = match self.closing.take() {
            Some(closing @ (Closing::ToShell | Closing::BySignal(_))) => closing.code(),
            Some(Closing::ToMenu) | None if self.leads_participant() => return self.after_run(problem),
            Some(Closing::ToMenu) | None => {
                self.close_layers();
                self.stage = Stage::Menu(Box::new(Menu::new(&self.configuration)));
                self.orders.push(Order::Job(Job::Do(Request::ListRuns)));
                match problem {
                    Some(problem) => self.complain(problem),
                    None if was_replay => self.say("replay closed; nothing changed"),
                    None => self.say("run saved"),
                }
                return;
            }
        };
        let farewell = self.run().filter(|run| run.viewer.is_none()).map(|run| {
            let company = &run.company.seen;
            let end = match company.ended {
                Some(_) => "It has ended.".to_owned(),
                None => format!("Resume it with `{}`.", self.again),
            };
            format!("Run {} is saved at day {}. {end}", company.run, company.day)
        });
        let text = match problem {
            Some(problem) => Some(problem),
            None => farewell,
        };
        self.orders.push(Order::Exit(code, text));
    }
}
