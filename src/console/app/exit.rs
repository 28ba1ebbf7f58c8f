//! Leaving a run: open views are recorded as left, the run is saved and closed, and then the menu opens or the program
//! exits.

use super::{App, BusyState, Order, Stage};
use crate::context::ScreenId;
use crate::dialogs::confirm::ConfirmDialog;
use crate::effect::Effect;
use crate::screens::menu::StartMenu;
use novamind_record::trajectory::record::DetachCause;
use novamind_session::Access;
use novamind_study::CLOSE_WINDOW_NOTICE;
use novamind_worker::Job;
use novamind_worker::request::Request;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ExitTarget {
    /// The start menu, or the participant's next page.
    Menu,
    Shell,
    /// Exit because of the signal with this number.
    Signal(i32),
}

impl ExitTarget {
    fn leaving_cause(self) -> DetachCause {
        const HANGUP: i32 = 1;
        match self {
            ExitTarget::Menu | ExitTarget::Shell => DetachCause::Quit,
            ExitTarget::Signal(HANGUP) => DetachCause::Hangup,
            ExitTarget::Signal(_) => DetachCause::Signal,
        }
    }

    fn exit_code(self) -> u8 {
        match self {
            ExitTarget::Menu | ExitTarget::Shell => 0,
            ExitTarget::Signal(number) => 128u8.saturating_add(number as u8),
        }
    }
}

const DRAFTS_KEPT: &str = "Unsent text in a form, the notes, a post, an offer or the next-week dialog is saved with the run and offered when you open the run again.";
/// Warning for a run that has ended, in which drafts can no longer be sent.
const DRAFTS_DISCARDED: &str = "The notes have unsaved text. The run has ended; the text will be lost.";

impl App {
    /// Describes what happens to drafts and asks whether to leave the run. Returns `None` if there are no drafts.
    fn draft_warning(&self) -> Option<String> {
        let run = self.run().filter(|run| run.playback.is_none())?;
        let is_running = run.company.is_running();
        let has_text = ScreenId::ALL.into_iter().any(|screen| {
            // Offers cannot be sent after the end of the run.
            (is_running || screen != ScreenId::Inbox) && run.screens.get(screen).has_unsent_text()
        });
        let outcome = match self.draft_save_error() {
            _ if !is_running => DRAFTS_DISCARDED.to_owned(),
            None => DRAFTS_KEPT.to_owned(),
            Some(error) => format!(
                "Unsent text could not be saved with the run ({error}), and will be lost if you leave. Send it first, or free space on the disk and change the text, so that it is saved again."
            ),
        };
        (run.next_week.has_draft() || has_text).then(|| format!("{outcome} Leave this run now?"))
    }

    pub(super) fn quit(&mut self) {
        match self.draft_warning() {
            Some(question) => self.open_dialog(ConfirmDialog::new("Leave", question, vec![Effect::LeaveNow])),
            None => self.exit_run(ExitTarget::Shell),
        }
    }

    pub(super) fn open_other_run(&mut self, id: String) {
        let is_open =
            self.run().is_some_and(|run| run.playback.is_none() && run.company.observation.run == id);
        if is_open {
            return self.show_error(format!("run {id} is already open"));
        }
        if self.busy.is_some() {
            return self.show_error("days are being simulated; try again when the simulation has ended");
        }
        let open = Effect::Request(Request::Open(id.clone(), Access::Write));
        match self.draft_warning() {
            Some(question) => {
                self.open_dialog(ConfirmDialog::new(format!("open run {id}"), question, vec![open]))
            }
            None => self.execute_effects(vec![open]),
        }
    }

    pub(super) fn exit_run(&mut self, closing: ExitTarget) {
        if self.exit_target.is_some_and(|planned| planned != ExitTarget::Menu) {
            return;
        }
        self.stop_seeking();
        // Leaving a run returns a participant to the study.
        let returns_to_study = self.has_participant() && matches!(self.stage, Stage::Run(_));
        // The last page of a hosted session is shown before the program exits.
        if self.is_hosted
            && closing == ExitTarget::Shell
            && matches!(&self.stage, Stage::Study(page) if !page.is_last_page())
        {
            return self.continue_after_run(None);
        }
        let quits = closing == ExitTarget::Shell;
        let closing = if returns_to_study && quits { ExitTarget::Menu } else { closing };
        self.detach_from_run();
        self.exit_target = Some(closing);
        match &self.stage {
            Stage::Run(_) => {
                self.busy = Some(BusyState { is_stopping_script: true, ..BusyState::new("saving") });
                self.orders.push(Order::CancelQuery);
                self.orders.push(Order::Job(Job::Close(closing.leaving_cause())));
            }
            Stage::Menu(_) | Stage::Study(_) => self.on_run_closed(None),
        }
    }

    pub(super) fn on_run_closed(&mut self, problem: Option<String>) {
        self.busy = None;
        let was_replay = self.is_playback();
        let code = match self.exit_target.take() {
            Some(closing @ (ExitTarget::Shell | ExitTarget::Signal(_))) => closing.exit_code(),
            Some(ExitTarget::Menu) | None if self.has_participant() => {
                return self.continue_after_run(problem);
            }
            Some(ExitTarget::Menu) | None => {
                self.close_layers();
                self.stage = Stage::Menu(Box::new(StartMenu::new(&self.configuration)));
                self.orders.push(Order::Job(Job::Execute(Request::ListRuns)));
                match problem {
                    Some(problem) => self.show_error(problem),
                    None if was_replay => self.show_status("replay closed; nothing changed"),
                    None => self.show_status("run saved"),
                }
                return;
            }
        };
        if self.is_hosted {
            return self.orders.push(Order::Exit(code, Some(CLOSE_WINDOW_NOTICE.to_owned())));
        }
        let farewell = self.run().filter(|run| run.playback.is_none()).map(|run| {
            let company = &run.company.observation;
            let end = match company.ended {
                Some(_) => "The run has ended.".to_owned(),
                None => format!("Resume the run with `{}`.", self.resume_command),
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
