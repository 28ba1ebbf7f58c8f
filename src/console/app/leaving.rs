//! Leaving a run: what is open counts as left, the run is saved and closed, and then comes the menu or the shell.

use super::{App, Busy, Order, Stage};
use crate::console::dialogs::confirm::Confirm;
use crate::console::effect::Effect;
use crate::console::request::Request;
use crate::console::screens::ScreenId;
use crate::console::screens::menu::Menu;
use crate::console::worker::Job;
use crate::session::Access;
use crate::session::record::LeavingCause;

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

/// Asked before a run is left with text that was not sent.
const KEEPS_TEXT: &str = "A form, the notes or the next-week dialog holds unsent text. It is kept with this run and offered \
                          when you open it again. Leave this run now?";

impl App {
    /// Whether text was typed and not sent.
    pub(super) fn holds_unsent_text(&self) -> bool {
        self.run().filter(|run| run.viewer.is_none()).is_some_and(|run| {
            run.filing.has_draft()
                || ScreenId::ALL.iter().any(|screen| run.screens.get(*screen).holds_unsent_text())
        })
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
        match self.holds_unsent_text() {
            true => self.open(Confirm::new(format!("open run {id}"), KEEPS_TEXT, vec![open])),
            false => self.follow(vec![open]),
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
