//! What lies over a screen for a while.

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

/// What follows from an action in a dialog.
#[derive(Debug, Default)]
pub struct Outcome {
    /// Effects.
    pub effects: Vec<Effect>,
    /// The dialog is done with.
    pub close: bool,
    /// It is done with because the person did what it is for.
    pub confirmed: bool,
}

impl Outcome {
    /// The dialog stays.
    pub fn stay() -> Outcome {
        Outcome::default()
    }

    /// The dialog closes.
    pub fn close() -> Outcome {
        Outcome { close: true, ..Outcome::default() }
    }

    /// The dialog closes and something follows.
    pub fn close_with(effects: Vec<Effect>) -> Outcome {
        Outcome { effects, close: true, confirmed: true }
    }

    /// The dialog is left, and something follows all the same.
    pub fn leave_with(effects: Vec<Effect>) -> Outcome {
        Outcome { effects, close: true, confirmed: false }
    }

    /// Something follows; the dialog stays.
    pub fn with(effects: Vec<Effect>) -> Outcome {
        Outcome { effects, ..Outcome::default() }
    }
}

/// One dialog.
pub trait Dialog {
    /// What it is, as the record names it.
    fn what(&self) -> String;

    /// The step it is at, if it has steps.
    fn step(&self) -> Option<&'static str> {
        None
    }

    /// The term that it explains now.
    fn term(&self) -> Option<String> {
        None
    }

    /// The text that is being edited in it: its place, as the record names it, and what it says.
    fn edited(&self) -> Option<(String, String)> {
        None
    }

    /// Scopes, the innermost first.
    fn scopes(&self) -> Vec<Scope>;

    /// Actions worth showing in the footer.
    fn hints(&self) -> Vec<Action>;

    /// The same, where they depend on the company.
    fn hints_here(&self, _: &Look<'_>) -> Vec<Action> {
        self.hints()
    }

    /// Whether an action from everywhere goes before what its key means in dialogs.
    fn goes_before(&self, _: Action) -> bool {
        false
    }

    /// Does an action of its scopes.
    fn act(&mut self, action: Action, look: &Look<'_>) -> Outcome;

    /// Takes a typed key.
    fn key(&mut self, _: &KeyEvent, _: &Look<'_>) -> Outcome {
        Outcome::stay()
    }

    /// Takes pasted text.
    fn paste(&mut self, _: &str, _: &Look<'_>) -> Outcome {
        Outcome::stay()
    }

    /// Takes the answer that it waits for, if it has arrived.
    fn take_answers(&mut self) {}

    /// Takes the story of the run, which was told meanwhile.
    fn take_story(&mut self, _: &Arc<Story>) {}

    /// Takes the debrief of the lesson, which was found meanwhile.
    fn take_debrief(&mut self, _: &Arc<Result<Debrief, Refusal>>) {}

    /// A row was clicked.
    fn click(&mut self, _: usize, _: &Look<'_>) -> Outcome {
        Outcome::stay()
    }

    /// Draws itself over the screen.
    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>);
}

/// Draws a dialog over an empty screen of a size; what is seen as text.
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
