//! The form of a tool with the values of an earlier week, for a what-if.

use crossterm::event::KeyEvent;
use ratatui::layout::Rect;
use serde_json::{Map, Value};

use super::form::ToolForm;
use super::grid::{draw_sheet, form_lines};
use crate::action::{Action, Scope};
use crate::effect::Effect;
use novamind_tools::{ToolId, ToolKind};
use novamind_tui::canvas::{Canvas, row_rects};
use novamind_tui::text::wrap;
use novamind_tui::theme::Role;
use novamind_worker::company::DisplayedCompany;

/// A form whose call is not sent, but used in a what-if.
pub struct DecisionForm {
    form: ToolForm,
    /// Arguments of the recorded call. The form returns them even if their values do not change.
    recorded: Vec<&'static str>,
}

impl DecisionForm {
    /// Returns the form of a tool with the values in force before the decision, filled with the arguments of a call.
    pub fn new(
        tool: ToolId,
        values: Map<String, Value>,
        call: Option<&Value>,
        company: &DisplayedCompany,
    ) -> DecisionForm {
        let mut form = ToolForm::with_values(tool.spec(), values, company);
        let recorded = call.map_or(Vec::new(), |arguments| form.sheet.fill_recorded(arguments));
        DecisionForm { form, recorded }
    }

    /// Returns the tool of the form.
    pub fn tool(&self) -> ToolId {
        self.form.spec.id
    }

    /// Returns the scopes of the form's keys.
    pub fn scopes(&self) -> Vec<Scope> {
        self.form.scopes()
    }

    /// Returns whether keys type characters.
    pub fn is_typing(&self) -> bool {
        self.form.is_typing()
    }

    /// Handles an action of the form. Returns a message for the user, if there is one.
    pub fn handle_action(&mut self, action: Action, company: &DisplayedCompany) -> Option<String> {
        match action {
            Action::CopyCall | Action::SaveCalls => {
                Some("A what-if sends no call. Submit the form to use its values.".to_owned())
            }
            _ => message(self.form.handle_action(action, company)),
        }
    }

    /// Handles a key that is not bound to an action. Returns a message for the user, if there is one.
    pub fn handle_key(&mut self, key: &KeyEvent) -> Option<String> {
        message(self.form.handle_key(key))
    }

    /// Inserts pasted text. Returns a message for the user, if there is one.
    pub fn paste(&mut self, text: &str) -> Option<String> {
        message(self.form.paste(text))
    }

    /// Focuses the cell with an index, or starts typing if the cell has the focus.
    pub fn handle_click(&mut self, cell: usize, company: &DisplayedCompany) {
        let Some(place) = self.form.sheet.positions().nth(cell).filter(|_| !self.form.is_typing()) else {
            return;
        };
        if place == self.form.focus {
            self.form.handle_action(Action::EditCell, company);
        }
        self.form.focus = place;
    }

    /// Returns the arguments of the call.
    ///
    /// # Errors
    /// A cell is invalid, or no value was entered. The error is a message that names the first invalid cell.
    pub fn arguments(&mut self) -> Result<Value, String> {
        self.form.stop_typing();
        let is_empty = self.recorded.is_empty() && !self.form.sheet.is_changed();
        if is_empty && (self.form.spec.kind == ToolKind::Setting || !self.form.spec.arguments.is_empty()) {
            return Err("Nothing has changed. Enter a value first.".to_owned());
        }
        self.form.sheet.arguments_including(&self.recorded).map_err(|place| {
            self.form.focus = place;
            let block = &self.form.sheet.blocks[place.block];
            format!("{}: {}", block.path(place.row, place.column), block.expected())
        })
    }

    /// Draws the summary of the tool and the values.
    pub fn draw(&self, canvas: &mut Canvas<'_>, area: Rect) {
        let spec = self.form.spec;
        let lines = form_lines(&self.form);
        let mut head = wrap(&format!("{}.", spec.summary), area.width as usize);
        // In a small window, the values have precedence over the summary.
        if head.len() + lines.len() > area.height as usize {
            head.clear();
        }
        let mut rows = row_rects(area);
        for line in &head {
            if let Some(row) = rows.next() {
                canvas.draw_text(row, line, Role::Strong);
            }
        }
        let used = (head.len() as u16).min(area.height);
        let below = Rect { y: area.y + used, height: area.height - used, ..area };
        let sheet = Rect { height: (lines.len() as u16).min(below.height), ..below };
        draw_sheet(&self.form, None, &lines, canvas, sheet, true);
    }
}

/// Returns the message among the effects of a form. Other effects concern the current company.
fn message(effects: Vec<Effect>) -> Option<String> {
    effects.into_iter().find_map(|effect| match effect {
        Effect::ShowError(text) | Effect::ShowStatus(text) => Some(text),
        _ => None,
    })
}
