//! Dialogs that are drawn over a screen.

pub mod branches;
pub mod causes;
pub mod column_chooser;
pub mod confirm;
pub mod curve;
pub mod debrief;
pub mod explanation;
pub mod final_page;
pub mod glossary;
mod glossary_picture;
pub mod help;
pub mod lesson;
pub mod next_week;
pub mod opponents;
pub mod palette;
pub mod pause_reason;
pub mod restore_drafts;
pub mod retry_step;
pub mod seek_week;
pub mod source_rows;
pub mod take_over;
pub mod text_dialog;
pub mod week_report;

use std::sync::Arc;

use crossterm::event::KeyEvent;
use ratatui::layout::Rect;

use super::action::{Action, Scope};
use super::context::ScreenContext;
use super::effect::Effect;
use novamind_course::Debrief;
use novamind_report::RunReport;
use novamind_tools::Rejection;
use novamind_tui::canvas::Canvas;

/// The outcome of an action in a dialog.
#[derive(Debug, Default)]
pub struct DialogResponse {
    /// Effects that the application executes.
    pub effects: Vec<Effect>,
    /// Whether the dialog closes.
    pub closes: bool,
    /// Whether the dialog closes because the user completed it.
    pub is_confirmed: bool,
}

impl DialogResponse {
    /// Keeps the dialog open.
    pub fn stay() -> DialogResponse {
        DialogResponse::default()
    }

    /// Closes the dialog as completed.
    pub fn close() -> DialogResponse {
        DialogResponse { closes: true, ..DialogResponse::default() }
    }

    /// Closes the dialog as completed and executes effects.
    pub fn confirm_with(effects: Vec<Effect>) -> DialogResponse {
        DialogResponse { effects, closes: true, is_confirmed: true }
    }

    /// Cancels the dialog and executes effects.
    pub fn cancel_with(effects: Vec<Effect>) -> DialogResponse {
        DialogResponse { effects, closes: true, is_confirmed: false }
    }

    /// Executes effects and keeps the dialog open.
    pub fn stay_with(effects: Vec<Effect>) -> DialogResponse {
        DialogResponse { effects, ..DialogResponse::default() }
    }
}

/// Content of a dialog that a step of the tour shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DialogContent {
    /// The participation curve of a group.
    Curve,
    /// The report on the last week.
    WeekReport,
    /// The causes of a change in cancellations.
    CancellationCauses,
    /// The comparison of alternatives.
    WhatIf,
    /// The keys of a screen.
    Help,
}

/// The state of a dialog, for the tour.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DialogView {
    /// The content of the dialog.
    pub content: DialogContent,
    /// Whether the content is visible. Some dialogs need actions or an answer of the worker first.
    pub is_shown: bool,
    /// Actions that lead to the content. The list is empty while the dialog waits for an answer.
    pub actions: Vec<Action>,
}

impl DialogView {
    /// Returns the view of a dialog that needs no actions.
    pub fn new(content: DialogContent, is_shown: bool) -> DialogView {
        DialogView { content, is_shown, actions: Vec::new() }
    }
}

/// A dialog that is drawn over a screen and handles keys before the screen.
pub trait Dialog {
    /// Returns the name of the dialog in the record.
    fn record_name(&self) -> String;

    /// Returns the current step, if the dialog has steps.
    fn step(&self) -> Option<&'static str> {
        None
    }

    /// Returns the state of the dialog that the tour needs, if a step of the tour uses the dialog.
    fn tour_view(&self) -> Option<DialogView> {
        None
    }

    /// Returns the term that the dialog explains.
    fn term(&self) -> Option<String> {
        None
    }

    /// Returns the recorded name and the content of the text that is being edited.
    fn edited_text(&self) -> Option<(String, String)> {
        None
    }

    /// Returns the scopes of the dialog's keys, the innermost first.
    fn scopes(&self) -> Vec<Scope>;

    /// Returns the actions to show in the footer.
    fn hints(&self) -> Vec<Action>;

    /// Returns the actions to show in the footer. Dialogs whose actions depend on the company override this method.
    fn hints_in_context(&self, _: &ScreenContext<'_>) -> Vec<Action> {
        self.hints()
    }

    /// Returns whether a global action takes precedence over the dialog's own bindings.
    fn overrides_dialog_keys(&self, _: Action) -> bool {
        false
    }

    /// Handles an action of the dialog's scopes.
    fn handle_action(&mut self, action: Action, context: &ScreenContext<'_>) -> DialogResponse;

    /// Handles a key that is not bound to an action.
    fn handle_key(&mut self, _: &KeyEvent, _: &ScreenContext<'_>) -> DialogResponse {
        DialogResponse::stay()
    }

    /// Handles text that is pasted into the dialog.
    fn paste(&mut self, _: &str, _: &ScreenContext<'_>) -> DialogResponse {
        DialogResponse::stay()
    }

    /// Takes the answer of the worker if the answer has arrived.
    fn take_answers(&mut self) {}

    /// Sets the run report, for dialogs that show it.
    fn set_run_report(&mut self, _: &Arc<RunReport>) {}

    /// Sets the debrief of the lesson, for dialogs that show it.
    fn set_debrief(&mut self, _: &Arc<Result<Debrief, Rejection>>) {}

    /// Handles a click on the row with an index.
    fn handle_click(&mut self, _: usize, _: &ScreenContext<'_>) -> DialogResponse {
        DialogResponse::stay()
    }

    /// Draws the dialog over the screen.
    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, screen_context: &ScreenContext<'_>);
}

/// Draws a dialog over an empty screen and returns the drawn text.
#[cfg(test)]
fn dialog_text(
    dialog: &dyn Dialog,
    company: &novamind_worker::company::DisplayedCompany,
    width: u16,
    height: u16,
) -> String {
    use super::keys::KeyBindings;
    use novamind_tui::theme::Theme;
    let area = Rect::new(0, 0, width, height);
    let mut buffer = ratatui::buffer::Buffer::empty(area);
    let theme = Theme::bundled("mono").expect("a theme");
    let keys = KeyBindings::bundled();
    dialog.draw(
        &mut Canvas::new(&mut buffer, &theme),
        area,
        &ScreenContext { company, keys: &keys, page_rows: 5 },
    );
    let line = |y: u16| (0..width).map(|x| buffer[(x, y)].symbol()).collect::<String>();
    (0..height).map(|y| line(y).trim_end().to_owned() + "\n").collect()
}
