//! A form: position in the sheet, typed input, check of the call, and the last answer.

use std::collections::BTreeMap;

use crossterm::event::KeyEvent;
use serde_json::Value;

use super::earlier;
use super::sheet::{CellPlace, Sheet};
use crate::action::Action;
use crate::attention::BETWEEN_CELLS;
use crate::effect::Effect;
use novamind_base::notation::{dollars, parse_number};
use novamind_report::count;
use novamind_report::research::outlook_lines;
use novamind_session::Preview;
use novamind_tools::{ArgumentKind, Key, Kind, Refusal, Spec};
use novamind_tui::chord::Chord;
use novamind_tui::widgets::field::ONLY_NUMBERS;
use novamind_tui::widgets::{Editor, Field};
use novamind_worker::asking::Pending;
use novamind_worker::company::Company;
use novamind_worker::questions::CallCheck;

pub struct Form {
    pub spec: &'static Spec,
    /// Whether the run offers the tool.
    is_offered: bool,
    pub sheet: Sheet,
    pub at: CellPlace,
    /// While the user types into the cell: its previous draft.
    pub typing: Option<Option<Field>>,
    /// The code editor; the draft of the cell follows its text.
    writing: Option<Box<Editor>>,
    /// The cell that enter has just left. Copying down then uses the typed value.
    left: Option<CellPlace>,
    /// The customer number being typed to add a row to a block.
    pub adding: Option<(usize, Field)>,
    /// Drafts that the last reset discarded, by path. A second reset restores them.
    dropped: BTreeMap<String, String>,
    /// The check of the call, if it has arrived.
    pub preview: Option<Result<Preview, Refusal>>,
    checking: Pending<CallCheck>,
    /// The last sent arguments of a tool that keeps its form.
    sent: Option<Value>,
    pub answer: Option<Result<Value, Refusal>>,
    /// Earlier calls of the tool: decision day and arguments, newest first.
    pub earlier: Vec<(u32, String)>,
}

impl Form {
    /// Returns the form with the current values.
    pub fn of(spec: &'static Spec, company: &Company) -> Form {
        Form {
            spec,
            is_offered: company.has_tool(spec.id),
            sheet: Sheet::of(spec, company),
            at: CellPlace::default(),
            typing: None,
            writing: None,
            left: None,
            adding: None,
            dropped: BTreeMap::new(),
            preview: None,
            checking: Pending::default(),
            sent: None,
            answer: None,
            earlier: earlier::calls(spec.id, company, earlier::MOST),
        }
    }

    /// Returns whether it has unsent values that can be sent. Reading tools have none, and lessons lock some
    /// tools.
    pub fn is_draft(&self) -> bool {
        let is_sent = || self.sent.is_some() && self.sheet.arguments().ok() == self.sent;
        let can_be_sent = self.spec.kind.acts() || (self.spec.id.runs_code() && !is_sent());
        self.is_offered && can_be_sent && self.sheet.is_changed()
    }

    /// Returns whether keys type characters.
    pub fn is_typing(&self) -> bool {
        self.typing.is_some() || self.adding.is_some()
    }

    /// Returns the code editor, while it is open.
    pub fn writing(&self) -> Option<&Editor> {
        self.writing.as_deref()
    }

    /// Updates the current values and keeps the drafts.
    pub fn renew(&mut self, company: &Company) {
        self.is_offered = company.has_tool(self.spec.id);
        self.sheet = self.sheet.renewed(company);
        self.earlier = earlier::calls(self.spec.id, company, earlier::MOST);
        self.preview = None;
        self.keep_inside();
    }

    /// Discards the drafts and selects the first cell.
    pub fn reset(&mut self, company: &Company) {
        self.sheet = Sheet::of(self.spec, company);
        self.at = CellPlace::default();
        (self.typing, self.writing, self.left, self.adding, self.preview) = (None, None, None, None, None);
        self.checking.cancel();
        self.dropped.clear();
        self.keep_inside();
    }

    /// Discards the drafts. Repeated before other input, it restores them.
    fn drop_drafts(&mut self, company: &Company) -> Vec<Effect> {
        if self.sheet.is_changed() {
            let typed = self.sheet.typed();
            self.reset(company);
            self.dropped = typed;
            let dropped = count(self.dropped.len() as u32, "value");
            return vec![Effect::Say(format!("{dropped} discarded. Reset again to restore them."))];
        }
        let dropped = std::mem::take(&mut self.dropped);
        if dropped.is_empty() {
            return vec![Effect::Complain("Nothing to reset. The form shows the current values.".to_owned())];
        }
        self.reset(company);
        self.sheet.retype(&dropped);
        let mut effects = self.check();
        effects.push(Effect::Say(format!("{} restored", count(dropped.len() as u32, "value"))));
        effects
    }

    fn keep_inside(&mut self) {
        if self.sheet.slot(self.at).is_none() {
            self.at = self.sheet.places().next().unwrap_or_default();
        }
    }

    /// Returns the equivalent call in a program.
    pub fn call(&self) -> String {
        let arguments = self.sheet.arguments().map_or("…".to_owned(), |arguments| spaced(&arguments));
        format!("{}.{}({arguments})", self.spec.module.id(), self.spec.name())
    }

    /// Returns the channel and group of the focused cell in the advertising matrix.
    pub fn cell_names(&self) -> Option<(&str, &str)> {
        let block = self.sheet.blocks.get(self.at.block)?;
        match block.argument.kind {
            ArgumentKind::Matrix(Key::Channel, Key::Group, _) => {
                Some((block.rows.get(self.at.row)?, block.columns.get(self.at.column)?))
            }
            _ => None,
        }
    }

    /// Checks the call without executing it.
    pub fn check(&mut self) -> Vec<Effect> {
        self.preview = None;
        self.checking.cancel();
        if self.spec.id.runs_code() {
            // The answer belonged to the previous code.
            self.answer = None;
        }
        let quiet = match self.spec.kind {
            Kind::Setting | Kind::OneShot => !self.sheet.is_changed(),
            Kind::Purchase | Kind::Time => false,
            Kind::Read | Kind::Engine => true,
        };
        match self.sheet.arguments() {
            Ok(arguments) if !quiet => {
                vec![Effect::Ask(self.checking.ask(CallCheck { tool: self.spec.id, arguments }))]
            }
            _ => Vec::new(),
        }
    }

    pub fn take_preview(&mut self) {
        if let Some((_, preview)) = self.checking.try_take() {
            self.preview = Some(preview);
        }
    }

    /// Sends the call, or explains why it cannot be sent.
    pub fn apply(&mut self) -> Vec<Effect> {
        (self.typing, self.writing) = (None, None);
        let arguments = match self.sheet.arguments() {
            Ok(arguments) => arguments,
            Err(place) => {
                self.at = place;
                let block = &self.sheet.blocks[place.block];
                let path = block.path(place.row, place.column);
                return vec![Effect::Complain(format!("{path}: {}", block.expected()))];
            }
        };
        let tool = self.spec.id;
        self.sent = tool.runs_code().then(|| arguments.clone());
        match self.spec.kind {
            Kind::Setting if !self.sheet.is_changed() => {
                vec![Effect::Complain("Nothing has changed. Enter a value first.".to_owned())]
            }
            Kind::Purchase => match &self.preview {
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
            Kind::OneShot if self.sheet.is_changed() => {
                let text = format!("{tool} {arguments} cannot be undone.");
                vec![Effect::ConfirmCall { tool, arguments, text }]
            }
            _ => vec![Effect::call(tool, arguments)],
        }
    }

    pub fn act(&mut self, action: Action, company: &Company) -> Vec<Effect> {
        let left = self.left.take();
        match action {
            Action::Apply => return self.apply(),
            Action::EditCell if self.sheet.blocks.is_empty() => return self.apply(),
            Action::EditCell => self.edit(),
            Action::SameDown => return self.same_down(left.unwrap_or(self.at)),
            Action::ClearCell => return self.clear(),
            Action::ResetForm => return self.drop_drafts(company),
            Action::CopyCall => return vec![Effect::Copy(self.call())],
            Action::Discard => {
                if let Some(before) = self.typing.take()
                    && let Some(slot) = self.sheet.slot_mut(self.at)
                {
                    slot.draft = before;
                }
                self.adding = None;
                return self.check();
            }
            Action::LeaveEditor => {
                self.stop_typing();
                return self.check();
            }
            Action::Commit | Action::CommitDown | Action::CommitNext | Action::CommitPrevious => {
                return self.commit(action);
            }
            _ => self.walk(action),
        }
        Vec::new()
    }

    fn edit(&mut self) {
        if let Some(block) = self.at_adding_row() {
            self.adding = Some((block, Field::default()));
            return;
        }
        let text = self.is_at_text();
        let is_code = self.sheet.blocks.get(self.at.block).is_some_and(super::sheet::Block::is_code);
        if let Some(slot) = self.sheet.slot_mut(self.at) {
            self.typing = Some(slot.draft.clone());
            let held = slot.text();
            self.writing = is_code.then(|| Box::new(Editor::of(&held).unwrapped()));
            // Typing replaces a number but edits a text.
            slot.draft = Some(if text { Field::of(held) } else { Field::to_replace(held) });
        }
    }

    /// Continues typing after the text of the cell.
    fn go_on_here(&mut self) {
        if let Some(slot) = self.sheet.slot_mut(self.at) {
            self.typing = Some(slot.draft.clone());
            slot.draft = Some(Field::of(slot.text()));
        }
    }

    /// Returns whether a digit starts a number in the focused cell.
    pub fn takes_numbers(&self) -> bool {
        let is_cell = self.sheet.slot(self.at).is_some() && !self.is_at_text();
        !self.is_typing() && (is_cell || self.at_adding_row().is_some())
    }

    fn is_at_text(&self) -> bool {
        self.sheet.blocks.get(self.at.block).is_some_and(super::sheet::Block::is_text)
    }

    /// Returns the block whose last line adds a row, if that line has the focus.
    pub fn at_adding_row(&self) -> Option<usize> {
        let block = self.sheet.blocks.get(self.at.block)?;
        (block.is_open() && self.at.row == block.rows.len()).then_some(self.at.block)
    }

    fn commit(&mut self, action: Action) -> Vec<Effect> {
        if let Some((block, field)) = self.adding.take() {
            if field.text().trim().is_empty() {
                return Vec::new();
            }
            if !self.sheet.add_customer(block, field.text()) {
                return vec![Effect::Complain("Type a customer number, for example 17".to_owned())];
            }
            self.at = CellPlace { block, row: self.sheet.blocks[block].rows.len() - 1, column: 0 };
            self.edit();
            return Vec::new();
        }
        self.settle();
        let left = self.at;
        match action {
            Action::CommitNext => self.walk(Action::Right),
            Action::CommitPrevious => self.walk(Action::Up),
            _ => self.walk(Action::Down),
        }
        // Enter ends typing; movement keys continue typing in the next cell. Below the last row, typing stays
        // open so that further digits do not switch screens.
        match action {
            Action::CommitDown if self.at == left => self.go_on_here(),
            Action::Commit => self.left = Some(left),
            _ if self.at == left => {}
            _ => self.edit(),
        }
        self.check()
    }

    /// Stores the typed text as the draft of its cell.
    fn settle(&mut self) {
        self.typing = None;
        let scalar = self.sheet.blocks.get(self.at.block).is_some_and(super::sheet::Block::is_scalar);
        if let Some(slot) = self.sheet.slot_mut(self.at) {
            let text = slot.draft.as_ref().map_or("", Field::text).trim();
            let same = !slot.is_changed() && parse_number(text).is_some();
            // The text equals the current value, or a number was cleared: the cell is unchanged.
            if same || (scalar && text.is_empty()) {
                slot.draft = None;
            }
        }
    }

    /// Ends typing and keeps the draft.
    pub fn stop_typing(&mut self) {
        self.adding = None;
        self.writing = None;
        if self.typing.is_some() {
            self.settle();
        }
    }

    /// Returns the typed text in the order of the cells.
    pub fn typed_text(&self) -> String {
        let adding = self.adding.iter().map(|(_, field)| field.text());
        let drafts = self.sheet.places().filter_map(|place| self.sheet.slot(place)?.draft.as_ref());
        drafts.map(Field::text).chain(adding).collect::<Vec<_>>().join(BETWEEN_CELLS)
    }

    /// Copies the value of a cell to the cells below.
    fn same_down(&mut self, from: CellPlace) -> Vec<Effect> {
        let text = self.sheet.slot(from).map(super::sheet::Slot::text).unwrap_or_default();
        if text.trim().is_empty() {
            return vec![Effect::Complain("This cell is empty. There is no value to copy down.".to_owned())];
        }
        let below = self.sheet.blocks[from.block].rows.len();
        // A block of one row is a single argument, so the blocks below are filled.
        let blocks = if self.sheet.blocks[from.block].is_scalar() {
            (from.block..self.sheet.blocks.len()).filter(|at| self.sheet.blocks[*at].is_scalar()).collect()
        } else {
            vec![from.block]
        };
        for block in blocks {
            let rows = if block == from.block { from.row..below } else { 0..1 };
            for row in rows {
                if let Some(slot) = self.sheet.slot_mut(CellPlace { block, row, column: from.column }) {
                    slot.draft = Some(Field::of(text.clone()));
                }
            }
        }
        self.check()
    }

    fn clear(&mut self) -> Vec<Effect> {
        let scalar = self.sheet.blocks.get(self.at.block).is_some_and(super::sheet::Block::is_scalar);
        if let Some(slot) = self.sheet.slot_mut(self.at) {
            slot.draft = Some(Field::of(if scalar { "0" } else { "" }));
        }
        self.check()
    }

    /// Returns the focusable lines in reading order: block, row, number of cells.
    fn lines(&self) -> Vec<(usize, usize, usize)> {
        let mut lines = Vec::new();
        for (at, block) in self.sheet.blocks.iter().enumerate() {
            lines.extend((0..block.rows.len()).map(|row| (at, row, block.columns.len())));
            if block.is_open() {
                lines.push((at, block.rows.len(), 1));
            }
        }
        lines
    }

    fn walk(&mut self, action: Action) {
        let lines = self.lines();
        let Some(line) =
            lines.iter().position(|(block, row, _)| (*block, *row) == (self.at.block, self.at.row))
        else {
            return self.keep_inside();
        };
        let last = lines.len() - 1;
        let to = match action {
            Action::Up => line.saturating_sub(1),
            Action::Down => (line + 1).min(last),
            Action::PageUp => line.saturating_sub(8),
            Action::PageDown => (line + 8).min(last),
            Action::First => 0,
            Action::Last => last,
            Action::Right if self.at.column + 1 < lines[line].2 => {
                self.at.column += 1;
                line
            }
            Action::Right if line < last => {
                self.at.column = 0;
                line + 1
            }
            Action::Left => {
                self.at.column = self.at.column.saturating_sub(1);
                line
            }
            _ => line,
        };
        let (block, row, cells) = lines[to];
        self.at = CellPlace { block, row, column: self.at.column.min(cells - 1) };
    }

    pub fn key(&mut self, key: &KeyEvent) -> Vec<Effect> {
        self.left = None;
        if self.takes_numbers() && Chord::of(key).begins_number() {
            self.edit();
        }
        if let Some((_, field)) = &mut self.adding {
            field.key(key);
            return Vec::new();
        }
        if let Some(editor) = &mut self.writing {
            editor.key(key);
            return self.take_written();
        }
        let text = self.is_at_text();
        if self.typing.is_some()
            && let Some(slot) = self.sheet.slot_mut(self.at)
            && let Some(field) = &mut slot.draft
        {
            if text {
                field.key(key);
            } else if !field.number_key(key) {
                return vec![Effect::Complain(ONLY_NUMBERS.to_owned())];
            }
            return self.check();
        }
        Vec::new()
    }

    /// Stores the code as the draft of its cell.
    fn take_written(&mut self) -> Vec<Effect> {
        if let (Some(editor), Some(slot)) = (&self.writing, self.sheet.slot_mut(self.at)) {
            slot.draft = Some(Field::of(editor.text()));
        }
        self.check()
    }

    pub fn paste(&mut self, text: &str) -> Vec<Effect> {
        if self.typing.is_none() && self.adding.is_none() {
            self.edit();
            let typing = self.typing.is_some() && !self.is_at_text();
            if let Some(slot) = self.sheet.slot_mut(self.at).filter(|_| typing) {
                slot.draft = Some(Field::default());
            }
        }
        if let Some(editor) = &mut self.writing {
            editor.insert(text);
            return self.take_written();
        }
        if let Some((_, field)) = &mut self.adding {
            field.insert(text.trim());
        } else if let Some(field) = self.sheet.slot_mut(self.at).and_then(|slot| slot.draft.as_mut()) {
            field.insert(text.trim());
        }
        self.check()
    }
}

/// Returns the JSON with spaces after commas and colons, so that lines can wrap.
pub(super) fn spaced(value: &Value) -> String {
    match value {
        Value::Object(fields) => {
            let one = |(name, value): (&String, &Value)| {
                format!("{}: {}", Value::String(name.clone()), spaced(value))
            };
            format!("{{{}}}", fields.iter().map(one).collect::<Vec<_>>().join(", "))
        }
        Value::Array(items) => format!("[{}]", items.iter().map(spaced).collect::<Vec<_>>().join(", ")),
        plain => plain.to_string(),
    }
}
