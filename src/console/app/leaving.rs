//! Leaving a run: what is open counts as left, the run is saved and closed, and then comes the menu or the shell.

use super::{App, Busy, Order, Stage};
use crate::context::ScreenId;
use crate::dialogs::confirm::Confirm;
use crate::effect::Effect;
use crate::screens::menu::Menu;
use novamind_record::trajectory::record::LeavingCause;
use novamind_session::Access;
use novamind_worker::Job;
use novamind_worker::request::Request;

/// What follows once the run is closed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Closing {
    /// The start menu, or the participant's next page.
    ToMenu,
    /// The shell.
    ToShell,
    /// The end of the program that a signal asks for.
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

/// Said of unsent text before a run is left.
const KEEPS_TEXT: &str = "A form, the notes, a post or the next-week dialog holds unsent text. It is kept with this run and \
                          offered when you open the run again.";
/// The same once the run is over: nothing can be sent any more.
const DROPS_TEXT: &str = "The notes hold unsaved text. The run is over: the text is not kept.";
/// Said of unsent offers.
const DROPS_OFFERS: &str = "Unsent offers in the inbox are not kept.";

impl App {
    /// What happens to unsent text when the run is left, with the question whether to leave. `None` if there is none.
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

    /// Leaves the program, after a question if there is unsent text.
    pub(super) fn quit(&mut self) {
        match self.unsent_question() {
            Some(question) => self.open(Confirm::new("Leave", question, vec![Effect::LeaveNow])),
            None => self.leave(Closing::ToShell),
        }
    }

    /// Opens another run of the folder in place of what is open.
    pub(super) fn open_other(&mut self, id: String) {
        let is_open = self.run().is_some_and(|run| run.viewer.is_none() && run.company.seen.run == id);
        if is_open {
            return self.complain(format!("run {id} is the one that is open"));
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

    /// Saves, closes the run, and goes on to something.
    pub(super) fn leave(&mut self, closing: Closing) {
        if self.closing.is_some_and(|planned| planned != Closing::ToMenu) {
            return;
        }
        self.stop_on_the_way();
        // A participant who leaves a run is still at the study.
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

    /// The run is closed.
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
                    None => self.say("the run is saved"),
                }
                return;
            }
        };
        let farewell = self.run().filter(|run| run.viewer.is_none()).map(|run| {
            let company = &run.company.seen;
            let end = match company.ended {
                Some(_) => "It is over.".to_owned(),
                None => format!("`{}` continues.", self.again),
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
