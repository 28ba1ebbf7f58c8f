//! The decisions of the run, and the edits of each alternative.

use crossterm::event::KeyEvent;
use ratatui::layout::Rect;

use crate::action::Action;
use novamind_insight::{DecisionEdit, EDIT_SYNTAX, MAX_ALTERNATIVES, RecordedDecision};
use novamind_tui::canvas::{Canvas, Click, row_rects, truncate_to_width};
use novamind_tui::theme::Role;
use novamind_tui::widgets::TextField;
use novamind_tui::widgets::table::first_visible_row;

const REJECTED_CALL_ERROR: &str = "a rejected call had no effect; change its arguments instead";
const PARAMETER_EDIT_ERROR: &str = "omit this line, and add another value with set KEY VALUE";

#[derive(Debug, Clone, Copy, PartialEq)]
enum DecisionRow {
    /// Index of an edit that does not change a recorded call.
    Edit(usize),
    /// Index of a recorded decision.
    Recorded(usize),
}

struct DecisionInput {
    field: TextField,
    /// The recorded line whose call is edited, or `None` for an added decision.
    line: Option<u64>,
}

pub(super) struct DecisionList {
    week: u32,
    last_week: u32,
    days_per_week: u32,
    /// The recorded decisions, or `None` until they are loaded.
    recorded: Option<Vec<RecordedDecision>>,
    is_rejected: bool,
    alternatives: Vec<Vec<DecisionEdit>>,
    current: usize,
    selected: usize,
    input: Option<DecisionInput>,
}

impl DecisionList {
    pub(super) fn new(week: u32, last_week: u32) -> DecisionList {
        DecisionList {
            week,
            last_week,
            days_per_week: 1,
            recorded: None,
            is_rejected: false,
            alternatives: vec![Vec::new()],
            current: 0,
            selected: 0,
            input: None,
        }
    }

    pub(super) fn week(&self) -> u32 {
        self.week
    }

    pub(super) fn days_per_week(&self) -> u32 {
        self.days_per_week
    }

    pub(super) fn set_recorded(&mut self, past: Vec<RecordedDecision>, days_per_week: u32) {
        (self.recorded, self.days_per_week) = (Some(past), days_per_week);
    }

    pub(super) fn mark_rejected(&mut self) {
        self.is_rejected = self.recorded.is_none();
    }

    /// Returns the alternatives that have edits.
    pub(super) fn alternatives(&self) -> Vec<Vec<DecisionEdit>> {
        self.alternatives.iter().filter(|decision_edits| !decision_edits.is_empty()).cloned().collect()
    }

    pub(super) fn is_typing(&self) -> bool {
        self.input.is_some()
    }

    /// Returns whether there are decisions to edit, or the decisions are not loaded yet.
    pub(super) fn has_rows(&self) -> bool {
        self.recorded.is_none() || !self.rows().is_empty()
    }

    pub(super) fn position_label(&self) -> String {
        format!("alternative {} of {} · ‹ › change week", self.current + 1, self.alternatives.len())
    }

    fn current_edits(&mut self) -> &mut Vec<DecisionEdit> {
        &mut self.alternatives[self.current]
    }

    fn recorded(&self) -> &[RecordedDecision] {
        self.recorded.as_deref().unwrap_or_default()
    }

    /// Returns the edits, followed by the recorded decisions from the start week on.
    fn rows(&self) -> Vec<DecisionRow> {
        let edits = self.alternatives[self.current].iter().enumerate();
        let free = edits.filter(|(_, edit)| source_line(edit).is_none()).map(|(at, _)| DecisionRow::Edit(at));
        let from = (self.week - 1) * self.days_per_week;
        let past = self
            .recorded()
            .iter()
            .enumerate()
            .filter(|(_, recorded_decision)| recorded_decision.day() >= from);
        free.chain(past.map(|(at, _)| DecisionRow::Recorded(at))).collect()
    }

    fn position_of_edit(&self, line: u64) -> Option<usize> {
        self.alternatives[self.current].iter().position(|edit| source_line(edit) == Some(line))
    }

    pub(super) fn select(&mut self, row: usize) {
        self.selected = row.min(self.rows().len().saturating_sub(1));
    }

    /// Handles an action in the list of decisions. Returns an error message if the action is not possible.
    pub(super) fn handle_action(&mut self, action: Action) -> Result<(), String> {
        match action {
            Action::Commit => return self.commit(),
            Action::Discard => self.input = None,
            Action::Up => self.select(self.selected.saturating_sub(1)),
            Action::Down => self.select(self.selected + 1),
            Action::PageUp => self.select(self.selected.saturating_sub(10)),
            Action::PageDown => self.select(self.selected + 10),
            Action::First => self.select(0),
            Action::Last => self.select(usize::MAX),
            Action::Left | Action::Right => self.set_start_week(match action {
                Action::Left => self.week.saturating_sub(1),
                _ => self.week + 1,
            }),
            Action::NextAlternative => self.next_alternative()?,
            Action::AddDecision => {
                self.input = Some(DecisionInput { field: TextField::default(), line: None })
            }
            Action::OmitDecision => return self.toggle_selected(),
            Action::Open => return self.edit_selected(),
            _ => {}
        }
        Ok(())
    }

    /// Moves the start of the branches to another week. Edits of earlier decisions are dropped.
    fn set_start_week(&mut self, week: u32) {
        self.week = week.clamp(1, self.last_week);
        let from = (self.week - 1) * self.days_per_week;
        let past = self.recorded.as_deref().unwrap_or_default();
        let later = |line: u64| {
            past.iter()
                .any(|recorded_decision| recorded_decision.seq() == line && recorded_decision.day() >= from)
        };
        for edits in &mut self.alternatives {
            edits.retain(|edit| source_line(edit).is_none_or(later));
        }
        self.select(self.selected);
    }

    fn next_alternative(&mut self) -> Result<(), String> {
        let is_last = self.current + 1 == self.alternatives.len();
        let is_empty = self.alternatives[self.current].is_empty();
        if is_last && !is_empty && self.alternatives.len() < MAX_ALTERNATIVES {
            self.alternatives.push(Vec::new());
        }
        let before = self.current;
        self.current = (self.current + 1) % self.alternatives.len();
        self.select(0);
        match (before == self.current, is_empty) {
            (true, true) => Err("change a decision before you add another alternative".to_owned()),
            _ => Ok(()),
        }
    }

    /// Omits or restores the selected recorded decision, or removes the selected edit. Returns an error message for a rejected call.
    fn toggle_selected(&mut self) -> Result<(), String> {
        match self.rows().get(self.selected) {
            Some(DecisionRow::Edit(at)) => drop(self.current_edits().remove(*at)),
            Some(DecisionRow::Recorded(at)) => {
                let line = self.recorded()[*at].seq();
                let is_rejected = self.recorded()[*at].call().is_some_and(|call| !call.accepted);
                match self.position_of_edit(line) {
                    Some(edit) => drop(self.current_edits().remove(edit)),
                    None if is_rejected => return Err(REJECTED_CALL_ERROR.to_owned()),
                    None => self.current_edits().push(DecisionEdit::Drop(line)),
                }
            }
            None => {}
        }
        self.select(self.selected);
        Ok(())
    }

    fn edit_selected(&mut self) -> Result<(), String> {
        let (text, line) = match self.rows().get(self.selected) {
            Some(DecisionRow::Edit(at)) => {
                let edit = self.current_edits().remove(*at);
                (edit.to_string(), None)
            }
            Some(DecisionRow::Recorded(at)) => {
                let RecordedDecision::Call(call) = &self.recorded()[*at] else {
                    return Err(PARAMETER_EDIT_ERROR.to_owned());
                };
                let changed =
                    self.position_of_edit(call.seq).map(|edit| self.alternatives[self.current][edit].clone());
                let args = match changed {
                    Some(DecisionEdit::Change { args, .. }) => args,
                    _ => call.args.clone(),
                };
                (args.to_string(), Some(call.seq))
            }
            None => return Ok(()),
        };
        self.input = Some(DecisionInput { field: TextField::with_text(text), line });
        Ok(())
    }

    fn commit(&mut self) -> Result<(), String> {
        let Some(typing) = &self.input else { return Ok(()) };
        let text = typing.field.text().trim();
        let edit: DecisionEdit = match typing.line {
            Some(line) => format!("change {line} {text}").parse()?,
            None => text.parse()?,
        };
        if let Some(at) = source_line(&edit).and_then(|line| self.position_of_edit(line)) {
            self.current_edits().remove(at);
        }
        self.current_edits().push(edit);
        self.input = None;
        Ok(())
    }

    pub(super) fn handle_key(&mut self, key: &KeyEvent) {
        if let Some(typing) = &mut self.input {
            typing.field.handle_key(key);
        }
    }

    pub(super) fn paste(&mut self, text: &str) {
        if let Some(typing) = &mut self.input {
            typing.field.insert(text.trim());
        }
    }

    pub(super) fn draw(&self, canvas: &mut Canvas<'_>, area: Rect) {
        let below = 2.min(area.height);
        let list = Rect { height: area.height - below, ..area };
        let rows = self.rows();
        match (&self.recorded, rows.is_empty()) {
            (None, _) if self.is_rejected => {}
            (None, _) => canvas.draw_text(list, "reading the record …", Role::Warning),
            (Some(_), true) => canvas.draw_text(list, "no decisions in these weeks", Role::Dim),
            _ => {}
        }
        let first = first_visible_row(self.selected, list.height as usize, rows.len());
        for (row, (at, decision_row)) in row_rects(list).zip(rows.iter().enumerate().skip(first)) {
            let here = at == self.selected && self.input.is_none();
            let (text, role) = self.row_text(*decision_row);
            if here {
                canvas.clear(row, Role::Selection);
            }
            let mark = if here { "›" } else { " " };
            let text = truncate_to_width(&format!("{mark} {text}"), row.width as usize);
            canvas.draw_text(row, &text, if here { Role::Selection } else { role });
            canvas.register_click(row, Click::Row(0, at));
        }
        let field = Rect { y: list.y + list.height + below / 2, height: below / 2, ..area };
        self.draw_field(canvas, field);
    }

    fn draw_field(&self, canvas: &mut Canvas<'_>, row: Rect) {
        let Some(typing) = &self.input else {
            let forms = format!("for example {}", EDIT_SYNTAX.join("  ·  "));
            return canvas.draw_text(row, &truncate_to_width(&forms, row.width as usize), Role::Dim);
        };
        let label = typing.line.map_or("decision".to_owned(), |line| format!("line {line}"));
        canvas.draw_text(row, &label, Role::Dim);
        let used = (label.len() as u16 + 1).min(row.width);
        typing.field.draw(canvas, Rect { x: row.x + used, width: row.width - used, ..row });
    }

    fn row_text(&self, row: DecisionRow) -> (String, Role) {
        let at = match row {
            DecisionRow::Edit(at) => {
                return (format!("+ {}", self.alternatives[self.current][at]), Role::Strong);
            }
            DecisionRow::Recorded(at) => at,
        };
        let recorded_decision = &self.recorded()[at];
        let week = recorded_decision.day() / self.days_per_week + 1;
        let edit =
            self.position_of_edit(recorded_decision.seq()).map(|edit| &self.alternatives[self.current][edit]);
        let (sign, rest, role) = match edit {
            Some(DecisionEdit::Drop(_)) => ("×", " · omitted".to_owned(), Role::Bad),
            Some(DecisionEdit::Change { args, .. }) => ("~", format!(" → {args}"), Role::Strong),
            _ => {
                let is_refused = recorded_decision.call().is_some_and(|call| !call.accepted);
                let remark = recorded_decision.describe_status();
                let remark = if remark.is_empty() { remark } else { format!(" · {remark}") };
                (" ", remark, if is_refused { Role::Dim } else { Role::Text })
            }
        };
        let decided = match recorded_decision {
            RecordedDecision::Call(call) => format!("{} {}", call.tool.name(), call.args),
            RecordedDecision::Parameter { key, value, .. } => format!("set {key} {value}"),
        };
        (format!("{sign} week {week:>2}  {decided}{rest}"), role)
    }
}

fn source_line(edit: &DecisionEdit) -> Option<u64> {
    match edit {
        DecisionEdit::Drop(line) | DecisionEdit::Change { seq: line, .. } => Some(*line),
        _ => None,
    }
}
