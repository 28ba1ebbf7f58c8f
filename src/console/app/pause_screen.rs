//! The pause screen: the run is hidden until the clock is started again.

use crossterm::event::{Event, KeyEvent, KeyEventKind};
use ratatui::layout::Rect;
use unicode_width::UnicodeWidthStr;

use super::{App, ExitTarget, Order, Stage};
use crate::action::{Action, Scope};
use crate::dialogs::pause_reason::PauseReasonDialog;
use crate::effect::Effect;
use crate::keys::KeyBindings;
use novamind_study::CodeOutcome;
use novamind_tui::canvas::Canvas;
use novamind_tui::chord::Chord;
use novamind_tui::theme::Role;
use novamind_tui::widgets::TextField;
use novamind_worker::Job;
use novamind_worker::request::{Request, StudyRequest};

/// The screen shown while the clock is stopped.
pub struct PauseScreen {
    /// The field for the experimenter's code, if the clock can be started only with a code.
    code: Option<TextField>,
    /// Reason why the last code was not accepted; empty while no code was rejected.
    problem: String,
    by_limit: bool,
}

impl App {
    /// Stops the clock. If the study requires a reason, asks for the reason first.
    pub(super) fn request_clock_stop(&mut self) {
        let asks = self.run().is_some_and(|run| run.company.rules.pause_reason);
        if self.is_playback() {
            return self.show_error("there is no clock in a replay");
        }
        if asks {
            return self.open_dialog(PauseReasonDialog::default());
        }
        self.stop_clock(None, false);
    }

    pub(super) fn stop_clock(&mut self, reason: Option<String>, by_limit: bool) {
        if self.pause_screen.is_some() || !matches!(self.stage, Stage::Run(_)) {
            return;
        }
        self.save_drafts();
        self.record_view();
        self.stopwatch.pause();
        self.status = None;
        self.pending_chords.clear();
        let code = (by_limit && self.has_code).then(TextField::default);
        self.pause_screen = Some(PauseScreen { code, problem: String::new(), by_limit });
        // The pause screen remains even if the event cannot be written.
        self.record(move |session| drop(session.activity().stop_clock(reason.as_deref())));
    }

    fn start_clock(&mut self) {
        self.pause_screen = None;
        self.stopwatch.resume();
        self.orders.push(Order::Job(Job::StartClock));
        self.show_status("clock started");
    }

    pub(super) fn handle_paused_event(&mut self, event: Event) {
        match event {
            Event::Key(key) if key.kind != KeyEventKind::Release => self.handle_paused_key(&key),
            _ => {}
        }
    }

    fn handle_paused_key(&mut self, key: &KeyEvent) {
        let chord = Chord::from_event(key);
        match self.keys.action(&[Scope::Paused], chord) {
            Some(Action::StartClock) => return self.try_start_clock(),
            Some(Action::QuitWhilePaused) => return self.exit_run(ExitTarget::Shell),
            _ => {}
        }
        if self.keys.action(&[Scope::Global], chord) == Some(Action::Redraw) {
            return self.orders.push(Order::Redraw);
        }
        if let Some(cover) = &mut self.pause_screen
            && let Some(code) = &mut cover.code
        {
            code.handle_key(key);
            cover.problem.clear();
        }
    }

    fn try_start_clock(&mut self) {
        let Some(cover) = &mut self.pause_screen else { return };
        match &mut cover.code {
            Some(code) => {
                let typed = std::mem::take(code).text().to_owned();
                self.execute_effects(vec![Effect::Request(Request::Study(StudyRequest::LiftLimit(typed)))]);
            }
            None => self.start_clock(),
        }
    }

    /// Starts the clock after a limit if the code was right.
    pub(super) fn handle_limit_code(&mut self, outcome: CodeOutcome) {
        match (outcome, &mut self.pause_screen) {
            (CodeOutcome::Right, Some(_)) => self.start_clock(),
            (_, Some(cover)) => cover.problem = outcome.describe(),
            (_, None) => {}
        }
    }
}

impl PauseScreen {
    /// Draws the pause screen over the whole window.
    pub fn draw(&self, keys: &KeyBindings, canvas: &mut Canvas<'_>, area: Rect) {
        let key = |action| keys.label(action).unwrap_or_default();
        let (start, quit) = (key(Action::StartClock), key(Action::QuitWhilePaused));
        let why = match self.by_limit {
            true => "The time limit is reached.",
            false => "The clock is stopped.",
        };
        let next = match (&self.code, self.problem.as_str()) {
            (None, _) => format!("{start} starts the clock · {quit} saves and quits"),
            (Some(_), "") => {
                format!("The experimenter can start the clock with a code · {quit} saves and quits")
            }
            (Some(_), problem) => format!("{problem} · {quit} saves and quits"),
        };
        let row = Rect { y: area.y + area.height / 2, height: 1, ..area };
        draw_centered_text(canvas, Rect { y: row.y - 2, ..row }, why, Role::Header);
        draw_centered_text(canvas, row, &next, Role::Text);
        if let Some(code) = &self.code {
            let width = 20.min(area.width);
            let field = Rect { x: area.x + (area.width - width) / 2, y: row.y + 2, width, height: 1 };
            // The participant must not read the code.
            TextField::with_text("•".repeat(code.text().chars().count())).draw(canvas, field);
        }
    }
}

fn draw_centered_text(canvas: &mut Canvas<'_>, row: Rect, text: &str, role: Role) {
    let width = (text.width() as u16).min(row.width);
    canvas.draw_text(Rect { x: row.x + (row.width - width) / 2, width, ..row }, text, role);
}
