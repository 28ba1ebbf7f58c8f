//! The decisions of the run, and the edits of each alternative.

use crossterm::event::KeyEvent;
use ratatui::layout::Rect;

use crate::action::Action;
use novamind_insight::{DecisionEdit, FORMS, MOST_ALTERNATIVES, PastDecision};
use novamind_tui::canvas::{Canvas, Click, fit, rows_of};
use novamind_tui::theme::Role;
use novamind_tui::widgets::Field;
use novamind_tui::widgets::table::first_row;

const PARAMETER_IS_SET_ANEW: &str = "omit it, and add another value with set KEY VALUE";

#[derive(Debug, Clone, Copy, PartialEq)]
enum Row {
    /// Index of an edit that applies to no recorded call.
    Edit(usize),
    /// Index of a recorded decision.
    Past(usize),
}

struct TypedDecision {
    field: Field,
    /// The recorded line whose call is edited; `None` for an added decision.
    line: Option<u64>,
}

pub(super) struct Decisions {
    week: u32,
    last_week: u32,
    days_per_week: u32,
    /// `None` until the decisions are loaded.
    past: Option<Vec<PastDecision>>,
    is_refused: bool,
    alternatives: Vec<Vec<DecisionEdit>>,
    shown: usize,
    selected: usize,
    typing: Option<TypedDecision>,
}

impl Decisions {
    pub(super) fn new(week: u32, last_week: u32) -> Decisions {
        Decisions {
            week,
            last_week,
            days_per_week: 1,
            past: None,
            is_refused: false,
            alternatives: vec![Vec::new()],
            shown: 0,
            selected: 0,
            typing: None,
        }
    }

    pub(super) fn week(&self) -> u32 {
        self.week
    }

    pub(super) fn days_per_week(&self) -> u32 {
        self.days_per_week
    }

    pub(super) fn take(&mut self, past: Vec<PastDecision>, days_per_week: u32) {
        (self.past, self.days_per_week) = (Some(past), days_per_week);
    }

    pub(super) fn refuse(&mut self) {
        self.is_refused = self.past.is_none();
    }

    /// Returns the alternatives that have edits.
    pub(super) fn alternatives(&self) -> Vec<Vec<DecisionEdit>> {
        self.alternatives.iter().filter(|own| !own.is_empty()).cloned().collect()
    }

    pub(super) fn is_typing(&self) -> bool {
        self.typing.is_some()
    }

    pub(super) fn note(&self) -> String {
        format!("alternative {} of {} · ‹ › change week", self.shown + 1, self.alternatives.len())
    }

    fn edits(&mut self) -> &mut Vec<DecisionEdit> {
        &mut self.alternatives[self.shown]
    }

    fn past(&self) -> &[PastDecision] {
        self.past.as_deref().unwrap_or_default()
    }

    /// Edits first, then the recorded decisions from the start week.
    fn rows(&self) -> Vec<Row> {
        let edits = self.alternatives[self.shown].iter().enumerate();
        let free = edits.filter(|(_, edit)| line_of(edit).is_none()).map(|(at, _)| Row::Edit(at));
        let from = (self.week - 1) * self.days_per_week;
        let past = self.past().iter().enumerate().filter(|(_, own)| own.day() >= from);
        free.chain(past.map(|(at, _)| Row::Past(at))).collect()
    }

    fn edit_of(&self, line: u64) -> Option<usize> {
        self.alternatives[self.shown].iter().position(|edit| line_of(edit) == Some(line))
    }

    pub(super) fn select(&mut self, row: usize) {
        self.selected = row.min(self.rows().len().saturating_sub(1));
    }

    /// Handles an action. Returns an error message if the action is not possible.
    pub(super) fn act(&mut self, action: Action) -> Result<(), String> {
        match action {
            Action::Commit => return self.commit(),
            Action::Discard => self.typing = None,
            Action::Up => self.select(self.selected.saturating_sub(1)),
            Action::Down => self.select(self.selected + 1),
            Action::PageUp => self.select(self.selected.saturating_sub(10)),
            Action::PageDown => self.select(self.selected + 10),
            Action::First => self.select(0),
            Action::Last => self.select(usize::MAX),
            Action::Left | Action::Right => self.begin_in(match action {
                Action::Left => self.week.saturating_sub(1),
                _ => self.week + 1,
            }),
            Action::NextAlternative => self.next_alternative()?,
            Action::AddDecision => self.typing = Some(TypedDecision { field: Field::default(), line: None }),
            Action::DropDecision => self.drop_selected(),
            Action::Open => return self.edit_selected(),
            _ => {}
        }
        Ok(())
    }

    /// Moves the start of the branches to another week. Edits of earlier decisions are dropped.
    fn begin_in(&mut self, week: u32) {
        self.week = week.clamp(1, self.last_week);
        let from = (self.week - 1) * self.days_per_week;
        let past = self.past.as_deref().unwrap_or_default();
        let later = |line: u64| past.iter().any(|own| own.seq() == line && own.day() >= from);
        for edits in &mut self.alternatives {
            edits.retain(|edit| line_of(edit).is_none_or(later));
        }
        self.select(self.selected);
    }

    fn next_alternative(&mut self) -> Result<(), String> {
        let is_last = self.shown + 1 == self.alternatives.len();
        let is_empty = self.alternatives[self.shown].is_empty();
        if is_last && !is_empty && self.alternatives.len() < MOST_ALTERNATIVES {
            self.alternatives.push(Vec::new());
        }
        let before = self.shown;
        self.shown = (self.shown + 1) % self.alternatives.len();
        self.select(0);
        match (before == self.shown, is_empty) {
            (true, true) => Err("change a decision before you add another alternative".to_owned()),
            _ => Ok(()),
        }
    }

    /// Omits or restores the selected decision; removes a selected edit.
    fn drop_selected(&mut self) {
        match self.rows().get(self.selected) {
            Some(Row::Edit(at)) => drop(self.edits().remove(*at)),
            Some(Row::Past(at)) => {
                let line = self.past()[*at].seq();
                match self.edit_of(line) {
                    Some(edit) => drop(self.edits().remove(edit)),
                    None => self.edits().push(DecisionEdit::Drop(line)),
                }
            }
            None => {}
        }
        self.select(self.selected);
    }

    fn edit_selected(&mut self) -> Result<(), String> {
        let (text, line) = match self.rows().get(self.selected) {
            Some(Row::Edit(at)) => {
                let edit = self.edits().remove(*at);
                (edit.to_string(), None)
            }
            Some(Row::Past(at)) => {
                let PastDecision::Call(call) = &self.past()[*at] else {
                    return Err(PARAMETER_IS_SET_ANEW.to_owned());
                };
                let changed = self.edit_of(call.seq).map(|edit| self.alternatives[self.shown][edit].clone());
                let args = match changed {
                    Some(DecisionEdit::Change { args, .. }) => args,
                    _ => call.args.clone(),
                };
                (args.to_string(), Some(call.seq))
            }
            None => return Ok(()),
        };
        self.typing = Some(TypedDecision { field: Field::of(text), line });
        Ok(())
    }

    fn commit(&mut self) -> Result<(), String> {
        let Some(typing) = &self.typing else { return Ok(()) };
        let text = typing.field.text().trim();
        let edit: DecisionEdit = match typing.line {
            Some(line) => format!("change {line} {text}").parse()?,
            None => text.parse()?,
        };
        if let Some(at) = line_of(&edit).and_then(|line| self.edit_of(line)) {
            self.edits().remove(at);
        }
        self.edits().push(edit);
        self.typing = None;
        Ok(())
    }

    pub(super) fn key(&mut self, key: &KeyEvent) {
        if let Some(typing) = &mut self.typing {
            typing.field.key(key);
        }
    }

    pub(super) fn paste(&mut self, text: &str) {
        if let Some(typing) = &mut self.typing {
            typing.field.insert(text.trim());
        }
    }

    pub(super) fn draw(&self, canvas: &mut Canvas<'_>, area: Rect) {
        let below = 2.min(area.height);
        let list = Rect { height: area.height - below, ..area };
        let rows = self.rows();
        match (&self.past, rows.is_empty()) {
            (None, _) if self.is_refused => {}
            (None, _) => canvas.text(list, "reading the record …", Role::Warning),
            (Some(_), true) => canvas.text(list, "no decisions in these weeks", Role::Dim),
            _ => {}
        }
        let first = first_row(self.selected, list.height as usize, rows.len());
        for (row, (at, own)) in rows_of(list).zip(rows.iter().enumerate().skip(first)) {
            let here = at == self.selected && self.typing.is_none();
            let (text, role) = self.written(*own);
            if here {
                canvas.clear(row, Role::Selection);
            }
            let mark = if here { "›" } else { " " };
            let text = fit(&format!("{mark} {text}"), row.width as usize);
            canvas.text(row, &text, if here { Role::Selection } else { role });
            canvas.click(row, Click::Row(0, at));
        }
        let field = Rect { y: list.y + list.height + below / 2, height: below / 2, ..area };
        self.draw_field(canvas, field);
    }

    fn draw_field(&self, canvas: &mut Canvas<'_>, row: Rect) {
        let Some(typing) = &self.typing else {
            let forms = format!("for example {}", FORMS.join("  ·  "));
            return canvas.text(row, &fit(&forms, row.width as usize), Role::Dim);
        };
        let label = typing.line.map_or("decision".to_owned(), |line| format!("line {line}"));
        canvas.text(row, &label, Role::Dim);
        let used = (label.len() as u16 + 1).min(row.width);
        typing.field.draw(canvas, Rect { x: row.x + used, width: row.width - used, ..row });
    }

    fn written(&self, row: Row) -> (String, Role) {
        let at = match row {
            Row::Edit(at) => return (format!("+ {}", self.alternatives[self.shown][at]), Role::Strong),
            Row::Past(at) => at,
        };
        let own = &self.past()[at];
        let week = own.day() / self.days_per_week + 1;
        let edit = self.edit_of(own.seq()).map(|edit| &self.alternatives[self.shown][edit]);
        let (sign, rest, role) = match edit {
            Some(DecisionEdit::Drop(_)) => ("×", " · omitted".to_owned(), Role::Bad),
            Some(DecisionEdit::Change { args, .. }) => ("~", format!(" → {args}"), Role::Strong),
            _ => {
                let is_refused = own.call().is_some_and(|call| !call.accepted);
                let remark = own.remark();
                let remark = if remark.is_empty() { remark } else { format!(" · {remark}") };
                (" ", remark, if is_refused { Role::Dim } else { Role::Text })
            }
        };
        let decided = match own {
            PastDecision::Call(call) => format!("{} {}", call.tool.name(), call.args),
            PastDecision::Parameter { key, value, .. } => format!("set {key} {value}"),
        };
        (format!("{sign} week {week:>2}  {decided}{rest}"), role)
    }
}

fn line_of(edit: &DecisionEdit) -> Option<u64> {
    match edit {
        DecisionEdit::Drop(line) | DecisionEdit::Change { seq: line, .. } => Some(*line),
        _ => None,
    }
}
