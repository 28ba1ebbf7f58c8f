//! Dialogs over a screen.

pub mod again;
pub mod branches;
pub mod confirm;
pub mod curve;
pub mod debrief;
pub mod explain;
pub mod filing;
pub mod final_page;
pub mod glossary;
pub mod help;
pub mod lesson;
pub mod opponents;
pub mod palette;
pub mod pause;
pub mod reader;
pub mod report;
pub mod restore;
pub mod rows;
pub mod seek;
pub mod take_over;
mod term_picture;
pub mod why;

use std::sync::Arc;

use crossterm::event::KeyEvent;
use ratatui::layout::Rect;

use super::action::{Action, Scope};
use super::context::Look;
use super::effect::Effect;
use novamind_course::Debrief;
use novamind_report::Story;
use novamind_tools::Refusal;
use novamind_tui::canvas::Canvas;

/// The outcome of an action in a dialog.
#[derive(Debug, Default)]
pub struct Outcome {
    /// Effects to execute.
    pub effects: Vec<Effect>,
    /// Whether the dialog closes.
    pub close: bool,
    /// Whether it closes because the user completed it.
    pub confirmed: bool,
}

impl Outcome {
    /// Keeps the dialog open.
    pub fn stay() -> Outcome {
        Outcome::default()
    }

    /// Closes the dialog as completed.
    pub fn close() -> Outcome {
        Outcome { close: true, ..Outcome::default() }
    }

    /// Closes the dialog as completed and executes effects.
    pub fn close_with(effects: Vec<Effect>) -> Outcome {
        Outcome { effects, close: true, confirmed: true }
    }

    /// Cancels the dialog and executes effects.
    pub fn leave_with(effects: Vec<Effect>) -> Outcome {
        Outcome { effects, close: true, confirmed: false }
    }

    /// Executes effects and keeps the dialog open.
    pub fn with(effects: Vec<Effect>) -> Outcome {
        Outcome { effects, ..Outcome::default() }
    }
}

/// A dialog.
pub trait Dialog {
    /// Returns the name in the record.
    fn what(&self) -> String;

    /// Returns the current step, if the dialog has steps.
    fn step(&self) -> Option<&'static str> {
        None
    }

    /// Returns the term that it explains.
    fn term(&self) -> Option<String> {
        None
    }

    /// Returns the recorded place and the content of the text that is being edited.
    fn edited(&self) -> Option<(String, String)> {
        None
    }

    /// Returns the scopes, the innermost first.
    fn scopes(&self) -> Vec<Scope>;

    /// Returns the actions to show in the footer.
    fn hints(&self) -> Vec<Action>;

    /// Returns the actions to show in the footer, if they depend on the company.
    fn hints_here(&self, _: &Look<'_>) -> Vec<Action> {
        self.hints()
    }

    /// Returns whether a global action takes precedence over the dialog's own bindings.
    fn goes_before(&self, _: Action) -> bool {
        false
    }

    /// Handles an action of its scopes.
    fn act(&mut self, action: Action, look: &Look<'_>) -> Outcome;

    /// Handles a key without an action.
    fn key(&mut self, _: &KeyEvent, _: &Look<'_>) -> Outcome {
        Outcome::stay()
    }

    /// Handles pasted text.
    fn paste(&mut self, _: &str, _: &Look<'_>) -> Outcome {
        Outcome::stay()
    }

    /// Takes the awaited answer if it has arrived.
    fn take_answers(&mut self) {}

    /// Takes the run report.
    fn take_story(&mut self, _: &Arc<Story>) {}

    /// Takes the debrief of the lesson.
    fn take_debrief(&mut self, _: &Arc<Result<Debrief, Refusal>>) {}

    /// Handles a click on a row.
    fn click(&mut self, _: usize, _: &Look<'_>) -> Outcome {
        Outcome::stay()
    }

    /// Draws the dialog over the screen.
    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>);
}

/// Draws a dialog over an empty screen and returns the text.
#[cfg(test)]
fn picture(
    dialog: &dyn Dialog,
    company: &novamind_worker::company::Company,
    width: u16,
    height: u16,
) -> String {
    use super::keys::Keys;
    use novamind_tui::theme::Theme;
    let area = Rect::new(0, 0, width, height);
    let mut buffer = ratatui::buffer::Buffer::empty(area);
    let theme = Theme::bundled("mono").expect("a theme");
    let keys = Keys::shipped();
    dialog.draw(&mut Canvas::new(&mut buffer, &theme), area, &Look { company, keys: &keys, page: 5 });
    let line = |y: u16| (0..width).map(|x| buffer[(x, y)].symbol()).collect::<String>();
    (0..height).map(|y| line(y).trim_end().to_owned() + "\n").collect()
}
