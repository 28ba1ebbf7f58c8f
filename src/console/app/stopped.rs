//! The pause screen: the run is hidden until the clock is started again.

use crossterm::event::{Event, KeyEvent, KeyEventKind};
use ratatui::layout::Rect;
use unicode_width::UnicodeWidthStr;

use super::{App, Closing, Order, Stage};
use crate::action::{Action, Scope};
use crate::dialogs::pause::PauseReason;
use crate::keys::Keys;
use novamind_tui::canvas::Canvas;
use novamind_tui::chord::Chord;
use novamind_tui::theme::Role;
use novamind_tui::widgets::Field;
use novamind_worker::Job;

/// The screen shown while the clock is stopped.
pub struct Cover {
    /// The experimenter's code being typed, if starting the clock requires one.
    code: Option<Field>,
    wrong: bool,
    by_limit: bool,
}

impl App {
    /// Stops the clock; asks for a reason first if the study requires one.
    pub(super) fn ask_to_stop_clock(&mut self) {
        let asks = self.run().is_some_and(|run| run.company.rules.pause_reason);
        if self.is_replay() {
            return self.complain("there is no clock in a replay");
        }
        if asks {
            return self.open(PauseReason::default());
        }
        self.stop_clock(None, false);
    }

    pub(super) fn stop_clock(&mut self, reason: Option<String>, by_limit: bool) {
        if self.cover.is_some() || !matches!(self.stage, Stage::Run(_)) {
            return;
        }
        self.keep_texts();
        self.close_view();
        self.stopwatch.halt();
        self.note = None;
        self.pending.clear();
        let code = self.code_check.as_ref().filter(|_| by_limit).map(|_| Field::default());
        self.cover = Some(Cover { code, wrong: false, by_limit });
        // The screen is hidden already; a failed write does not undo that.
        self.record(move |session| drop(session.activity().stop_clock(reason.as_deref())));
    }

    fn start_clock(&mut self) {
        self.cover = None;
        self.stopwatch.run();
        self.orders.push(Order::Job(Job::StartClock));
        self.say("clock started");
    }

    pub(super) fn input_under_cover(&mut self, event: Event) {
        match event {
            Event::Key(key) if key.kind != KeyEventKind::Release => self.key_under_cover(&key),
            _ => {}
        }
    }

    fn key_under_cover(&mut self, key: &KeyEvent) {
        let chord = Chord::of(key);
        match self.keys.action(&[Scope::Cover], chord) {
            Some(Action::StartClock) => return self.try_to_start(),
            Some(Action::QuitStopped) => return self.leave(Closing::ToShell),
            _ => {}
        }
        if self.keys.action(&[Scope::Global], chord) == Some(Action::Redraw) {
            return self.orders.push(Order::Redraw);
        }
        if let Some(cover) = &mut self.cover
            && let Some(code) = &mut cover.code
        {
            code.key(key);
            cover.wrong = false;
        }
    }

    fn try_to_start(&mut self) {
        let Some(cover) = &mut self.cover else { return };
        let right = match (&cover.code, &self.code_check) {
            (Some(code), Some(check)) => check(code.text().trim()),
            _ => true,
        };
        if right {
            return self.start_clock();
        }
        (cover.code, cover.wrong) = (Some(Field::default()), true);
    }
}

impl Cover {
    /// Draws the pause screen over the whole window.
    pub fn draw(&self, keys: &Keys, canvas: &mut Canvas<'_>, area: Rect) {
        let key = |action| keys.label(action).unwrap_or_default();
        let (start, quit) = (key(Action::StartClock), key(Action::QuitStopped));
        let why = match self.by_limit {
            true => "The time limit is reached.",
            false => "The clock is stopped.",
        };
        let next = match (&self.code, self.wrong) {
            (None, _) => format!("{start} starts the clock · {quit} saves and quits"),
            (Some(_), false) => {
                format!("The experimenter can start the clock with a code · {quit} saves and quits")
            }
            (Some(_), true) => format!("Wrong code, try again · {quit} saves and quits"),
        };
        let row = Rect { y: area.y + area.height / 2, height: 1, ..area };
        write_centered(canvas, Rect { y: row.y - 2, ..row }, why, Role::Header);
        write_centered(canvas, row, &next, Role::Text);
        if let Some(code) = &self.code {
            let width = 20.min(area.width);
            let field = Rect { x: area.x + (area.width - width) / 2, y: row.y + 2, width, height: 1 };
            // The participant must not read the code.
            Field::of("•".repeat(code.text().chars().count())).draw(canvas, field);
        }
    }
}

fn write_centered(canvas: &mut Canvas<'_>, row: Rect, text: &str, role: Role) {
    let width = (text.width() as u16).min(row.width);
    canvas.text(Rect { x: row.x + (row.width - width) / 2, width, ..row }, text, role);
}
