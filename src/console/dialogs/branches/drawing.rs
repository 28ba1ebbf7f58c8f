//! Draws the decisions of a week, the decisions that can be added, and the form of a decision.

use ratatui::layout::Rect;

use super::decisions::{DecisionList, Input, Row, Target};
use super::picker::{NewDecision, new_decisions};
use crate::action::Action;
use crate::context::ScreenContext;
use novamind_report::pluralize;
use novamind_session::EnterpriseNames;
use novamind_tui::canvas::{Canvas, Click, row_rects};
use novamind_tui::text::wrap;
use novamind_tui::theme::Role;
use novamind_tui::widgets::TextField;

/// Width of the column with the treatment of a decision.
const STATUS_WIDTH: usize = 11;
/// Width of the names in the list of decisions that can be added.
const NAME_WIDTH: usize = 21;
const FACTOR_FIELD_WIDTH: u16 = 12;

/// A drawn line, with the index of its row if it belongs to a row.
struct ListLine {
    row: Option<usize>,
    text: String,
    role: Role,
    /// Whether the line is the open field of its row.
    is_field: bool,
}

impl DecisionList {
    /// Draws the list or the open input.
    pub(super) fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, context: &ScreenContext<'_>) {
        match &self.input {
            Some(Input::Form { target, form, .. }) => {
                let title = self.form_title(*target);
                let rows = notice_rows(&title, area);
                draw_wrapped(canvas, rows, &title, Role::Dim);
                let below = area_below(area, rows.height);
                let notice = self.notice.as_deref().unwrap_or_default();
                let used = notice_rows(notice, below).height;
                form.draw(canvas, Rect { height: below.height - used, ..below });
                let row = Rect { y: below.bottom() - used, height: used, ..below };
                draw_wrapped(canvas, row, notice, Role::Bad);
            }
            Some(Input::Picker(selected)) => self.draw_picker(canvas, area, *selected, context),
            Some(Input::Factor { target: Target::New(new), field, .. }) => {
                self.draw_new_field(canvas, area, *new, field, context);
            }
            Some(Input::Parameter { target: Target::New(new), field }) => {
                self.draw_new_field(canvas, area, *new, field, context);
            }
            _ => self.draw_list(canvas, area, context),
        }
    }

    fn form_title(&self, target: Target) -> String {
        let week = self.week();
        match target {
            Target::New(_) => format!("A new decision of week {week}. \"now\" is the value that week."),
            Target::Decision(_) | Target::Change(_) => {
                format!(
                    "The decision of week {week}. \"now\" is the value before it, \"new\" the value in the what-if."
                )
            }
        }
    }

    fn draw_list(&self, canvas: &mut Canvas<'_>, area: Rect, context: &ScreenContext<'_>) {
        if self.history().is_none() {
            return;
        }
        let below = 1.min(area.height);
        let list = Rect { height: area.height - below, ..area };
        let lines = self.list_lines(list.width as usize, &context.company.enterprise_names, context);
        // The last line of the selected row stays visible, because it contains the reason for a refusal.
        let last = lines.iter().rposition(|line| line.row == Some(self.selected())).unwrap_or(0);
        let first = canvas.scroll_to_row(list, last, lines.len());
        for (rect, line) in row_rects(list).zip(lines.iter().skip(first)) {
            let here = line.row == Some(self.selected()) && self.input.is_none() && line.role != Role::Bad;
            if here {
                canvas.clear(rect, Role::Selection);
            }
            canvas.draw_text(rect, &line.text, if here { Role::Selection } else { line.role });
            if let (true, Some(Input::Factor { field, .. } | Input::Parameter { field, .. })) =
                (line.is_field, &self.input)
            {
                draw_field(canvas, rect, &line.text, field);
            }
            if let Some(row) = line.row {
                canvas.register_click(rect, Click::Row(0, row));
            }
        }
        let summary = Rect { y: list.bottom(), height: below, ..area };
        canvas.draw_text(summary, &self.summary(), Role::Dim);
    }

    /// Describes how many decisions the alternative changes, and where the simulation starts.
    fn summary(&self) -> String {
        match self.changes().len() as u32 {
            0 => "Nothing is changed yet.".to_owned(),
            count => {
                format!(
                    "{} · the simulation starts with week {}",
                    pluralize(count, "change"),
                    self.start_week()
                )
            }
        }
    }

    fn list_lines(
        &self,
        width: usize,
        names: &EnterpriseNames,
        context: &ScreenContext<'_>,
    ) -> Vec<ListLine> {
        let mut lines = Vec::new();
        let rows = self.rows();
        if !rows.iter().any(|row| matches!(row, Row::Decision(_))) {
            let offer = match rows.iter().any(|row| matches!(row, Row::Week(_))) {
                true => "Choose a week with decisions, or add a decision:",
                false => "Add a decision:",
            };
            let text = format!("You made no decisions in week {}. {offer}", self.week());
            lines.extend(wrap(&text, width).into_iter().map(|text| ListLine {
                row: None,
                text,
                role: Role::Text,
                is_field: false,
            }));
        }
        for (at, row) in rows.iter().enumerate() {
            let (status, text) = self.row_texts(*row, names);
            let role = row_role(&status, *row);
            let here = at == self.selected();
            let room = width.saturating_sub(STATUS_WIDTH + 2).max(1);
            let parts = wrap(&text, room);
            for (number, part) in parts.into_iter().enumerate() {
                let (mark, status) = match number {
                    0 => (if here { "›" } else { " " }, status.as_str()),
                    _ => (" ", ""),
                };
                let text = format!("{mark} {status:<STATUS_WIDTH$}{part}");
                lines.push(ListLine { row: Some(at), text, role, is_field: false });
            }
            if here && let Some(label) = self.field_label() {
                lines.push(ListLine { row: Some(at), text: label, role: Role::Text, is_field: true });
                let hint = format!("    {}", context.hints(&[Action::Commit, Action::Discard]));
                lines.push(ListLine { row: Some(at), text: hint, role: Role::Dim, is_field: false });
            }
            let notice = self.notice.as_ref().filter(|_| here).cloned();
            for reason in self.problem(*row).map(|problem| problem.text()).into_iter().chain(notice) {
                let reason = wrap(&format!("! {reason}"), width.saturating_sub(4).max(1));
                lines.extend(reason.into_iter().map(|line| ListLine {
                    row: Some(at),
                    text: format!("    {line}"),
                    role: Role::Bad,
                    is_field: false,
                }));
            }
        }
        lines
    }

    fn field_label(&self) -> Option<String> {
        match &self.input {
            Some(Input::Factor { .. }) => Some("    factor ".to_owned()),
            Some(Input::Parameter { .. }) => Some("    parameter and value ".to_owned()),
            _ => None,
        }
    }

    fn draw_picker(&self, canvas: &mut Canvas<'_>, area: Rect, selected: usize, context: &ScreenContext<'_>) {
        let key = |action| context.keys.label(action).unwrap_or_default();
        let (week, start) = (self.week(), self.start_week().min(self.week()));
        let head = format!(
            "Add a decision to week {week}. {} opens its form. For all weeks from week {start} on, {} multiplies its values, and {} leaves out its decisions.",
            key(Action::Open),
            key(Action::ScaleDecision),
            key(Action::OmitDecision)
        );
        let rows = notice_rows(&head, area);
        draw_wrapped(canvas, rows, &head, Role::Text);
        let notice = self.notice.as_deref().map_or(String::new(), |reason| format!("! {reason}"));
        let list = area_below(area, rows.height);
        let decisions = new_decisions(context.company);
        let reason = wrap(&notice, list.width.saturating_sub(4).max(1) as usize);
        let mut lines: Vec<ListLine> = Vec::new();
        for (at, new) in decisions.iter().enumerate() {
            let (name, summary) = new.texts();
            let mark = if at == selected { "›" } else { " " };
            let role = if new.refusal(context.company).is_some() { Role::Dim } else { Role::Text };
            let text = format!("{mark} {name:<NAME_WIDTH$}{summary}");
            lines.push(ListLine { row: Some(at), text, role, is_field: false });
            if at == selected && !notice.is_empty() {
                lines.extend(reason.iter().map(|line| ListLine {
                    row: Some(at),
                    text: format!("    {line}"),
                    role: Role::Bad,
                    is_field: false,
                }));
            }
        }
        let last = lines.iter().rposition(|line| line.row == Some(selected)).unwrap_or(0);
        let first = canvas.scroll_to_row(list, last, lines.len());
        for (rect, line) in row_rects(list).zip(lines.iter().skip(first)) {
            let here = line.row == Some(selected) && line.role != Role::Bad;
            if here {
                canvas.clear(rect, Role::Selection);
            }
            canvas.draw_text(rect, &line.text, if here { Role::Selection } else { line.role });
            if let Some(row) = line.row {
                canvas.register_click(rect, Click::Row(0, row));
            }
        }
    }

    /// Draws the field of a decision that is added.
    fn draw_new_field(
        &self,
        canvas: &mut Canvas<'_>,
        area: Rect,
        new: NewDecision,
        field: &TextField,
        context: &ScreenContext<'_>,
    ) {
        let (week, start) = (self.week(), self.start_week().min(self.week()));
        let head = match new {
            NewDecision::Parameter => format!("Set a parameter at the start of week {week}."),
            _ => format!("Multiply all values of {} from week {start} on.", new.texts().0),
        };
        let rows = notice_rows(&head, area);
        draw_wrapped(canvas, rows, &head, Role::Strong);
        let label = self.field_label().unwrap_or_default();
        let below = area_below(area, rows.height);
        let mut lines = row_rects(below);
        if let Some(row) = lines.next() {
            canvas.draw_text(row, &label, Role::Text);
            draw_field(canvas, row, &label, field);
        }
        if let Some(row) = lines.next() {
            canvas.draw_text(
                row,
                &format!("    {}", context.hints(&[Action::Commit, Action::Discard])),
                Role::Dim,
            );
        }
        let reason = self.notice.as_deref().unwrap_or_default();
        draw_wrapped(canvas, area_below(below, 2), reason, Role::Bad);
    }
}

fn row_role(status: &str, row: Row) -> Role {
    match row {
        Row::Add => Role::Key,
        Row::Decision(_) if status == "keep" => Role::Text,
        Row::Decision(_) | Row::Change(_) => Role::Changed,
        Row::Week(_) => Role::Text,
    }
}

fn draw_field(canvas: &mut Canvas<'_>, row: Rect, label: &str, field: &TextField) {
    let used = (label.chars().count() as u16).min(row.width);
    let rest = row.width - used;
    let width = if label.contains("factor") { rest.min(FACTOR_FIELD_WIDTH) } else { rest };
    field.draw(canvas, Rect { x: row.x + used, width, ..row });
}

/// Returns the rows at the top of an area that a text needs.
fn notice_rows(text: &str, area: Rect) -> Rect {
    let lines = if text.is_empty() { 0 } else { wrap(text, area.width as usize).len() as u16 };
    Rect { height: lines.min(area.height), ..area }
}

fn draw_wrapped(canvas: &mut Canvas<'_>, area: Rect, text: &str, role: Role) {
    for (row, line) in row_rects(area).zip(wrap(text, area.width as usize)) {
        canvas.draw_text(row, &line, role);
    }
}

fn area_below(area: Rect, rows: u16) -> Rect {
    let rows = rows.min(area.height);
    Rect { y: area.y + rows, height: area.height - rows, ..area }
}
