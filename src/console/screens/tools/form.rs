//! The form of a tool: the focused cell, typed input, the check of the call, and the last answer.

use std::cell::Cell;
use std::collections::BTreeMap;

use crossterm::event::KeyEvent;
use serde_json::{Map, Value};

use super::earlier_calls;
use super::sheet::{CellPosition, ToolSheet};
use crate::action::{Action, Scope};
use crate::context::EditorDocument;
use crate::attention::CELL_SEPARATOR;
use crate::effect::Effect;
use novamind_base::formatting::{dollars, parse_number};
use novamind_report::pluralize;
use novamind_report::research::outlook_lines;
use novamind_session::Preview;
use novamind_tools::{ArgumentKind, MapKey, ToolKind, Rejection, ToolSpec};
use novamind_tui::widgets::field::NUMBER_HINT;
use novamind_tui::widgets::{TextEditor, TextField};
use novamind_worker::question::Pending;
use novamind_worker::company::DisplayedCompany;
use novamind_worker::page_questions::PreviewCallQuestion;

pub struct ToolForm {
    pub spec: &'static ToolSpec,
    /// Whether the run offers the tool.
    is_available: bool,
    pub sheet: ToolSheet,
    /// Values of an earlier week that the form shows in place of the current values.
    earlier_values: Option<Map<String, Value>>,
    pub focus: CellPosition,
    /// The previous draft of the focused cell, while the user types into the cell.
    pub draft_before_edit: Option<Option<TextField>>,
    /// The code editor, whose text is copied to the draft of the cell.
    code_editor: Option<Box<TextEditor>>,
    /// The cell whose value the user has just accepted with enter. Copying down then uses that value.
    committed_cell: Option<CellPosition>,
    /// The block to which the user adds a row, and the field for the customer number.
    pub new_customer: Option<(usize, TextField)>,
    /// Drafts that the last reset discarded, by path. A second reset restores these drafts.
    discarded_drafts: BTreeMap<String, String>,
    /// Values that another screen filled into a form without drafts, by path.
    suggested_values: Option<BTreeMap<String, String>>,
    /// The check of the call, if it has arrived.
    pub preview: Option<Result<Preview, Rejection>>,
    checking: Pending<PreviewCallQuestion>,
    /// The arguments of the last call; only for tools whose form keeps its values after a call.
    sent_arguments: Option<Value>,
    pub answer: Option<Result<Value, Rejection>>,
    /// Earlier calls of the tool, the newest first, as decision day and arguments.
    pub earlier_calls: Vec<(u32, String)>,
    pub text_page: TextPage,
}

/// The displayed page of a text that does not fit below the values.
#[derive(Default)]
pub struct TextPage {
    /// Number of the page. Page 0 is the normal view.
    pub number: usize,
    /// Number of the last page, determined when the last frame was drawn.
    pub last: Cell<usize>,
}

impl TextPage {
    /// Turns the page. Other actions return to the normal view. Returns whether the action was a page action.
    pub fn turn(&mut self, action: Action) -> bool {
        self.number = match action {
            Action::PageDown => (self.number + 1).min(self.last.get()),
            Action::PageUp => self.number.saturating_sub(1),
            _ => 0,
        };
        matches!(action, Action::PageDown | Action::PageUp)
    }
}

impl ToolForm {
    /// Returns the form of a tool with the current values.
    pub fn new(spec: &'static ToolSpec, company: &DisplayedCompany) -> ToolForm {
        ToolForm {
            spec,
            is_available: company.has_tool(spec.id),
            sheet: ToolSheet::new(spec, company),
            earlier_values: None,
            focus: CellPosition::default(),
            draft_before_edit: None,
            code_editor: None,
            committed_cell: None,
            new_customer: None,
            discarded_drafts: BTreeMap::new(),
            suggested_values: None,
            preview: None,
            checking: Pending::default(),
            sent_arguments: None,
            answer: None,
            earlier_calls: earlier_calls::earlier_calls(spec.id, company, earlier_calls::MAX_EARLIER_CALLS),
            text_page: TextPage::default(),
        }
    }

    /// Returns the form of a tool with the values of an earlier week in place of the current values.
    pub fn with_values(spec: &'static ToolSpec, values: Map<String, Value>, company: &DisplayedCompany) -> ToolForm {
        let mut form = ToolForm::new(spec, company);
        form.earlier_values = Some(values);
        form.sheet = form.empty_sheet(company);
        form
    }

    /// Returns the sheet without drafts.
    fn empty_sheet(&self, company: &DisplayedCompany) -> ToolSheet {
        match &self.earlier_values {
            Some(values) => ToolSheet::with_values(self.spec, values, company).without_json_notes(),
            None => ToolSheet::new(self.spec, company),
        }
    }

    /// Returns the scopes of the form's keys.
    pub fn scopes(&self) -> Vec<Scope> {
        match self.code_editor {
            Some(_) => vec![Scope::Editor, Scope::Form],
            None if self.is_typing() => vec![Scope::Field, Scope::Form],
            None => vec![Scope::Form, Scope::List],
        }
    }

    /// Returns whether the form has unsent values that can be sent. Read-only tools have no drafts, and lessons lock
    /// some tools.
    pub fn has_draft(&self) -> bool {
        let is_sent = || self.sent_arguments.is_some() && self.sheet.arguments().ok() == self.sent_arguments;
        let can_be_sent = self.spec.kind.changes_company() || (self.spec.id.executes_code() && !is_sent());
        self.is_available && can_be_sent && self.sheet.is_changed()
    }

    /// Returns whether keys type characters.
    pub fn is_typing(&self) -> bool {
        self.draft_before_edit.is_some() || self.new_customer.is_some()
    }

    /// Returns the text of the cell that the user types into, and whether the next character replaces the text.
    pub fn typed_number(&self) -> Option<(String, bool)> {
        self.draft_before_edit.as_ref()?;
        let field = self.sheet.cell(self.focus)?.draft.as_ref()?;
        Some((field.text().to_owned(), field.is_selected()))
    }

    /// Returns the code editor, while it is open.
    pub fn code_editor(&self) -> Option<&TextEditor> {
        self.code_editor.as_deref()
    }

    /// Returns the code of the focused cell as a document, if the cell contains code. Code that starts with `#` is
    /// Python.
    pub fn code_document(&self) -> Option<EditorDocument> {
        self.sheet.blocks.get(self.focus.block).filter(|block| block.is_code())?;
        let text = self.sheet.cell(self.focus)?.text();
        let extension = if text.trim_start().starts_with('#') { "py" } else { "sql" };
        Some(EditorDocument { text, extension })
    }

    /// Replaces the code of the focused cell.
    pub fn replace_code(&mut self, text: &str) -> Vec<Effect> {
        if let Some(editor) = &mut self.code_editor {
            editor.set_text(text);
            return self.store_code();
        }
        if let Some(slot) = self.sheet.cell_mut(self.focus) {
            slot.draft = Some(TextField::with_text(text));
        }
        self.check()
    }

    /// Updates the current values and keeps the drafts.
    pub fn update(&mut self, company: &DisplayedCompany) {
        self.is_available = company.has_tool(self.spec.id);
        self.sheet = self.sheet.with_current_values(company);
        self.earlier_calls = earlier_calls::earlier_calls(self.spec.id, company, earlier_calls::MAX_EARLIER_CALLS);
        self.preview = None;
        self.clamp_focus();
    }

    /// Discards the drafts and selects the first cell.
    pub fn reset(&mut self, company: &DisplayedCompany) {
        self.sheet = self.empty_sheet(company);
        self.focus = CellPosition::default();
        (self.draft_before_edit, self.code_editor, self.committed_cell, self.new_customer, self.preview) = (None, None, None, None, None);
        self.checking.cancel();
        self.discarded_drafts.clear();
        self.suggested_values = None;
        self.clamp_focus();
    }

    /// Fills in values that the user chose on another screen.
    pub fn fill_suggestion(&mut self, arguments: &Value) -> Vec<Effect> {
        let is_unchanged = !self.sheet.is_changed();
        self.sheet.fill(arguments);
        self.suggested_values = is_unchanged.then(|| self.sheet.drafts());
        self.check()
    }

    /// Discards values that another screen filled in and that the user did not change. A reset restores these values.
    pub fn discard_suggestion(&mut self, company: &DisplayedCompany) -> Vec<Effect> {
        let drafts = self.sheet.drafts();
        if self.suggested_values.as_ref() != Some(&drafts) || !self.sheet.is_changed() {
            return Vec::new();
        }
        self.reset(company);
        self.discarded_drafts = drafts;
        let text = format!("{} is unchanged: the values that were filled in are discarded", self.spec.name());
        vec![Effect::ShowStatus(text)]
    }

    /// Discards the drafts of the form. If no drafts exist, restores the drafts that were discarded last.
    fn toggle_drafts(&mut self, company: &DisplayedCompany) -> Vec<Effect> {
        if self.sheet.is_changed() {
            let typed = self.sheet.drafts();
            self.reset(company);
            self.discarded_drafts = typed;
            let dropped = pluralize(self.discarded_drafts.len() as u32, "value");
            return vec![Effect::ShowStatus(format!("{dropped} discarded. Reset again to restore them."))];
        }
        let dropped = std::mem::take(&mut self.discarded_drafts);
        if dropped.is_empty() {
            return vec![Effect::ShowError("Nothing to reset. The form shows the current values.".to_owned())];
        }
        self.reset(company);
        self.sheet.restore_drafts(&dropped);
        let mut effects = self.check();
        effects.push(Effect::ShowStatus(format!("{} restored", pluralize(dropped.len() as u32, "value"))));
        effects
    }

    fn clamp_focus(&mut self) {
        if self.sheet.cell(self.focus).is_none() {
            self.focus = self.sheet.positions().next().unwrap_or_default();
        }
    }

    /// Returns the tool call that the form would send, as text.
    pub fn call_text(&self) -> String {
        let arguments = self.sheet.arguments().map_or("…".to_owned(), |arguments| format_json(&arguments));
        format!("{}.{}({arguments})", self.spec.module.id(), self.spec.name())
    }

    /// Returns the channel and group of the focused cell in the advertising matrix.
    pub fn cell_names(&self) -> Option<(&str, &str)> {
        let block = self.sheet.blocks.get(self.focus.block)?;
        match block.argument.kind {
            ArgumentKind::Matrix(MapKey::Channel, MapKey::Group, _) => {
                Some((block.rows.get(self.focus.row)?, block.columns.get(self.focus.column)?))
            }
            _ => None,
        }
    }

    /// Checks the call without executing it.
    pub fn check(&mut self) -> Vec<Effect> {
        self.preview = None;
        self.checking.cancel();
        if self.spec.id.executes_code() {
            // The answer is removed, because it belongs to the previous code.
            self.answer = None;
        }
        let quiet = match self.spec.kind {
            ToolKind::Setting | ToolKind::OneShot => !self.sheet.is_changed(),
            ToolKind::Purchase | ToolKind::Time => false,
            ToolKind::Read | ToolKind::Engine => true,
        };
        match self.sheet.arguments() {
            Ok(arguments) if !quiet => {
                vec![Effect::Ask(self.checking.ask(PreviewCallQuestion { tool: self.spec.id, arguments }))]
            }
            _ => Vec::new(),
        }
    }

    pub fn take_preview(&mut self) {
        if let Some((_, preview)) = self.checking.try_take() {
            self.preview = Some(preview);
        }
    }

    /// Sends the call, or explains why the call cannot be sent.
    pub fn submit(&mut self) -> Vec<Effect> {
        (self.draft_before_edit, self.code_editor) = (None, None);
        let arguments = match self.sheet.arguments() {
            Ok(arguments) => arguments,
            Err(place) => {
                self.focus = place;
                let block = &self.sheet.blocks[place.block];
                let path = block.path(place.row, place.column);
                return vec![Effect::ShowError(format!("{path}: {}", block.expected()))];
            }
        };
        let tool = self.spec.id;
        self.sent_arguments = tool.executes_code().then(|| arguments.clone());
        match self.spec.kind {
            ToolKind::Setting if !self.sheet.is_changed() => {
                vec![Effect::ShowError("Nothing has changed. Enter a value first.".to_owned())]
            }
            ToolKind::Purchase => match &self.preview {
                Some(Ok(preview)) => {
                    let mut text = format!(
                        "{tool} {arguments} costs {} at once and cannot be undone.",
                        dollars(preview.cost_now)
                    );
                    for line in preview.research.iter().flat_map(outlook_lines) {
                        text += &format!("\n{line}");
                    }
                    vec![Effect::ConfirmCall { tool, arguments, text }]
                }
                _ => vec![Effect::call(tool, arguments)],
            },
            ToolKind::OneShot if self.sheet.is_changed() => {
                let text = format!("{tool} {arguments} cannot be undone.");
                vec![Effect::ConfirmCall { tool, arguments, text }]
            }
            _ => vec![Effect::call(tool, arguments)],
        }
    }

    pub fn handle_action(&mut self, action: Action, company: &DisplayedCompany) -> Vec<Effect> {
        let left = self.committed_cell.take();
        match action {
            Action::Apply => return self.submit(),
            Action::EditCell if self.sheet.blocks.is_empty() => return self.submit(),
            Action::EditCell => self.start_typing(),
            Action::CopyDown => return self.copy_down(left.unwrap_or(self.focus)),
            Action::ClearCell => return self.clear_cell(),
            Action::ResetForm => return self.toggle_drafts(company),
            Action::CopyCall => return vec![Effect::Copy(self.call_text())],
            Action::Discard => {
                if let Some(before) = self.draft_before_edit.take()
                    && let Some(slot) = self.sheet.cell_mut(self.focus)
                {
                    slot.draft = before;
                }
                self.new_customer = None;
                return self.check();
            }
            Action::LeaveEditor => {
                self.stop_typing();
                return self.check();
            }
            Action::Commit | Action::CommitDown | Action::CommitNext | Action::CommitPrevious => {
                return self.commit(action);
            }
            _ => self.move_focus(action),
        }
        Vec::new()
    }

    fn start_typing(&mut self) {
        if let Some(block) = self.add_row_block() {
            self.new_customer = Some((block, TextField::default()));
            return;
        }
        let text = self.is_at_text();
        let is_code = self.sheet.blocks.get(self.focus.block).is_some_and(super::sheet::ArgumentBlock::is_code);
        if let Some(slot) = self.sheet.cell_mut(self.focus) {
            self.draft_before_edit = Some(slot.draft.clone());
            let held = slot.text();
            self.code_editor = is_code.then(|| Box::new(TextEditor::with_text(&held).without_wrapping()));
            // Typing replaces a number but edits a text.
            slot.draft = Some(if text { TextField::with_text(held) } else { TextField::with_selected_text(held) });
        }
    }

    /// Resumes typing at the end of the text in the cell.
    fn resume_typing(&mut self) {
        if let Some(slot) = self.sheet.cell_mut(self.focus) {
            self.draft_before_edit = Some(slot.draft.clone());
            slot.draft = Some(TextField::with_text(slot.text()));
        }
    }

    fn is_at_text(&self) -> bool {
        self.sheet.blocks.get(self.focus.block).is_some_and(super::sheet::ArgumentBlock::is_text)
    }

    /// Returns the block whose last line adds a row, if that line has the focus.
    pub fn add_row_block(&self) -> Option<usize> {
        let block = self.sheet.blocks.get(self.focus.block)?;
        (block.accepts_new_rows() && self.focus.row == block.rows.len()).then_some(self.focus.block)
    }

    fn commit(&mut self, action: Action) -> Vec<Effect> {
        if let Some((block, field)) = self.new_customer.take() {
            if field.text().trim().is_empty() {
                return Vec::new();
            }
            if !self.sheet.add_customer(block, field.text()) {
                return vec![Effect::ShowError("Type a customer number, for example 17".to_owned())];
            }
            self.focus = CellPosition { block, row: self.sheet.blocks[block].rows.len() - 1, column: 0 };
            self.start_typing();
            return Vec::new();
        }
        self.store_draft();
        let left = self.focus;
        match action {
            Action::CommitNext => self.move_focus(Action::Right),
            Action::CommitPrevious => self.move_focus(Action::Up),
            _ => self.move_focus(Action::Down),
        }
        // Enter ends typing. Movement keys continue typing in the next cell. In the last row, the down key keeps
        // typing active so that further digits are typed.
        match action {
            Action::CommitDown if self.focus == left => self.resume_typing(),
            Action::Commit => self.committed_cell = Some(left),
            _ if self.focus == left => {}
            _ => self.start_typing(),
        }
        self.check()
    }

    /// Stores the typed text as the draft of its cell.
    fn store_draft(&mut self) {
        self.draft_before_edit = None;
        let scalar = self.sheet.blocks.get(self.focus.block).is_some_and(super::sheet::ArgumentBlock::is_scalar);
        if let Some(slot) = self.sheet.cell_mut(self.focus) {
            let text = slot.draft.as_ref().map_or("", TextField::text).trim();
            let same = !slot.is_changed() && parse_number(text).is_some();
            // The cell has no draft if its text equals the current value or if a number was cleared.
            if same || (scalar && text.is_empty()) {
                slot.draft = None;
            }
        }
    }

    /// Ends typing and keeps the draft.
    pub fn stop_typing(&mut self) {
        self.new_customer = None;
        self.code_editor = None;
        if self.draft_before_edit.is_some() {
            self.store_draft();
        }
    }

    /// Returns the texts of all drafts in the order of the cells.
    pub fn typed_text(&self) -> String {
        let adding = self.new_customer.iter().map(|(_, field)| field.text());
        let drafts = self.sheet.positions().filter_map(|place| self.sheet.cell(place)?.draft.as_ref());
        drafts.map(TextField::text).chain(adding).collect::<Vec<_>>().join(CELL_SEPARATOR)
    }

    /// Copies the value of a cell to the cells below.
    fn copy_down(&mut self, from: CellPosition) -> Vec<Effect> {
        let text = self.sheet.cell(from).map(super::sheet::EditableCell::text).unwrap_or_default();
        if text.trim().is_empty() {
            return vec![Effect::ShowError("This cell is empty. There is no value to copy down.".to_owned())];
        }
        let below = self.sheet.blocks[from.block].rows.len();
        // A scalar block has only one row, so the value is copied to the scalar blocks below.
        let blocks = if self.sheet.blocks[from.block].is_scalar() {
            (from.block..self.sheet.blocks.len()).filter(|at| self.sheet.blocks[*at].is_scalar()).collect()
        } else {
            vec![from.block]
        };
        for block in blocks {
            let rows = if block == from.block { from.row..below } else { 0..1 };
            for row in rows {
                if let Some(slot) = self.sheet.cell_mut(CellPosition { block, row, column: from.column }) {
                    slot.draft = Some(TextField::with_text(text.clone()));
                }
            }
        }
        self.check()
    }

    fn clear_cell(&mut self) -> Vec<Effect> {
        let scalar = self.sheet.blocks.get(self.focus.block).is_some_and(super::sheet::ArgumentBlock::is_scalar);
        if let Some(slot) = self.sheet.cell_mut(self.focus) {
            slot.draft = Some(TextField::with_text(if scalar { "0" } else { "" }));
        }
        self.check()
    }

    /// Returns the focusable lines in reading order, as block, row and number of cells.
    fn lines(&self) -> Vec<(usize, usize, usize)> {
        let mut lines = Vec::new();
        for (at, block) in self.sheet.blocks.iter().enumerate() {
            lines.extend((0..block.rows.len()).map(|row| (at, row, block.columns.len())));
            if block.accepts_new_rows() {
                lines.push((at, block.rows.len(), 1));
            }
        }
        lines
    }

    fn move_focus(&mut self, action: Action) {
        let lines = self.lines();
        let Some(line) =
            lines.iter().position(|(block, row, _)| (*block, *row) == (self.focus.block, self.focus.row))
        else {
            return self.clamp_focus();
        };
        let last = lines.len() - 1;
        let to = match action {
            Action::Up => line.saturating_sub(1),
            Action::Down => (line + 1).min(last),
            Action::PageUp => line.saturating_sub(8),
            Action::PageDown => (line + 8).min(last),
            Action::First => 0,
            Action::Last => last,
            Action::Right if self.focus.column + 1 < lines[line].2 => {
                self.focus.column += 1;
                line
            }
            Action::Right if line < last => {
                self.focus.column = 0;
                line + 1
            }
            Action::Left => {
                self.focus.column = self.focus.column.saturating_sub(1);
                line
            }
            _ => line,
        };
        let (block, row, cells) = lines[to];
        self.focus = CellPosition { block, row, column: self.focus.column.min(cells - 1) };
    }

    pub fn handle_key(&mut self, key: &KeyEvent) -> Vec<Effect> {
        self.committed_cell = None;
        if let Some((_, field)) = &mut self.new_customer {
            field.handle_key(key);
            return Vec::new();
        }
        if let Some(editor) = &mut self.code_editor {
            editor.handle_key(key);
            return self.store_code();
        }
        let text = self.is_at_text();
        if self.draft_before_edit.is_some()
            && let Some(slot) = self.sheet.cell_mut(self.focus)
            && let Some(field) = &mut slot.draft
        {
            if text {
                field.handle_key(key);
            } else if !field.handle_number_key(key) {
                return vec![Effect::ShowError(NUMBER_HINT.to_owned())];
            }
            return self.check();
        }
        Vec::new()
    }

    /// Stores the code as the draft of its cell.
    fn store_code(&mut self) -> Vec<Effect> {
        if let (Some(editor), Some(slot)) = (&self.code_editor, self.sheet.cell_mut(self.focus)) {
            slot.draft = Some(TextField::with_text(editor.text()));
        }
        self.check()
    }

    pub fn paste(&mut self, text: &str) -> Vec<Effect> {
        if self.draft_before_edit.is_none() && self.new_customer.is_none() {
            self.start_typing();
            let typing = self.draft_before_edit.is_some() && !self.is_at_text();
            if let Some(slot) = self.sheet.cell_mut(self.focus).filter(|_| typing) {
                slot.draft = Some(TextField::default());
            }
        }
        if let Some(editor) = &mut self.code_editor {
            editor.insert(text);
            return self.store_code();
        }
        let is_text = self.is_at_text();
        let mut pasted = Ok(());
        if let Some((_, field)) = &mut self.new_customer {
            field.insert(text.trim());
        } else if let Some(field) = self.sheet.cell_mut(self.focus).and_then(|slot| slot.draft.as_mut()) {
            match is_text {
                true => field.insert(text.trim()),
                false => pasted = field.paste_number(text),
            }
        }
        let mut effects = self.check();
        effects.extend(pasted.err().map(Effect::ShowError));
        effects
    }
}

/// Formats a JSON value with spaces after commas and colons, so that lines can be wrapped.
pub(super) fn format_json(value: &Value) -> String {
    match value {
        Value::Object(fields) => {
            let one = |(name, value): (&String, &Value)| {
                format!("{}: {}", Value::String(name.clone()), format_json(value))
            };
            format!("{{{}}}", fields.iter().map(one).collect::<Vec<_>>().join(", "))
        }
        Value::Array(items) => format!("[{}]", items.iter().map(format_json).collect::<Vec<_>>().join(", ")),
        plain => plain.to_string(),
    }
}
