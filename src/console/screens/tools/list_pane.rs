//! List of all tools.

use crossterm::event::KeyEvent;
use ratatui::layout::Rect;

use super::{Tools, ToolsPane, figure};
use crate::action::{Action, Scope};
use crate::context::{Figure, Look};
use crate::effect::Effect;
use crate::screens::panes::{Border, Pane, Seat};
use novamind_tools::{Module, Spec};
use novamind_tui::canvas::{Align, Canvas, Click, fit, rows_of};
use novamind_tui::theme::Role;
use novamind_tui::widgets::Field;
use novamind_tui::widgets::table::first_row;

pub struct ToolListPane;

impl Pane<Tools> for ToolListPane {
    fn scopes(&self, tools: &Tools) -> Vec<Scope> {
        if tools.typing.is_some() { vec![Scope::Field] } else { vec![Scope::List] }
    }

    fn hints(&self, tools: &Tools) -> Vec<Action> {
        match tools.typing {
            Some(_) => vec![Action::Commit, Action::Discard],
            None => vec![Action::Open, Action::Filter],
        }
    }

    fn figure(&self, tools: &Tools, _: &Look<'_>) -> Option<Figure> {
        tools.here().map(figure::of_tool)
    }

    fn act(&self, tools: &mut Tools, action: Action, look: &Look<'_>) -> Vec<Effect> {
        let last = tools.shown().len().saturating_sub(1);
        let (here, page) = (tools.selected, look.page as usize);
        match action {
            Action::Up => tools.selected = here.saturating_sub(1),
            Action::Down => tools.selected = (here + 1).min(last),
            Action::PageUp => tools.selected = here.saturating_sub(page),
            Action::PageDown => tools.selected = (here + page).min(last),
            Action::First => tools.selected = 0,
            Action::Last => tools.selected = last,
            Action::Filter => tools.typing = Some(Field::of(tools.filter.clone())),
            Action::Close | Action::Discard => {
                tools.typing = None;
                tools.filter.clear();
                tools.selected = 0;
            }
            Action::Commit | Action::CommitDown | Action::CommitNext => tools.typing = None,
            Action::Open | Action::Right => match tools.elsewhere() {
                Some(effect) if action == Action::Open => return vec![effect],
                Some(_) => return Vec::new(),
                None => tools.focus = ToolsPane::Form,
            },
            _ => {}
        }
        tools.form(look.company);
        Vec::new()
    }

    fn key(&self, tools: &mut Tools, key: &KeyEvent, look: &Look<'_>) -> Vec<Effect> {
        self.filter(tools, &mut |field| {
            field.key(key);
        });
        tools.form(look.company);
        Vec::new()
    }

    fn paste(&self, tools: &mut Tools, text: &str, look: &Look<'_>) -> Vec<Effect> {
        self.filter(tools, &mut |field| field.insert(text));
        tools.form(look.company);
        Vec::new()
    }

    fn filter(&self, tools: &mut Tools, edit: &mut dyn FnMut(&mut Field)) {
        if let Some(field) = &mut tools.typing {
            edit(field);
            tools.filter = field.text().to_owned();
            tools.selected = 0;
        }
    }

    fn click(&self, tools: &mut Tools, row: usize, look: &Look<'_>) -> Vec<Effect> {
        tools.selected = row.min(tools.shown().len().saturating_sub(1));
        tools.form(look.company);
        Vec::new()
    }

    fn border(&self, tools: &Tools, _: Rect, look: &Look<'_>) -> Border {
        let note = match tools.unsent().len() {
            _ if !tools.filter.is_empty() => format!("\"{}\"", tools.filter),
            0 => look.hint(Action::Filter),
            1 => "* 1 draft".to_owned(),
            drafts => format!("* {drafts} drafts"),
        };
        Border { title: "Tools".to_owned(), note, ..Border::default() }
    }

    fn draw(&self, tools: &Tools, canvas: &mut Canvas<'_>, seat: Seat, look: &Look<'_>) {
        let lines = lines_of(tools);
        if lines.is_empty() {
            let text = format!("No matching tool: {}", look.hint(Action::Close));
            canvas.text(seat.area, &text, Role::Dim);
        }
        let field = u16::from(tools.typing.is_some());
        let list = Rect { height: seat.area.height.saturating_sub(field), ..seat.area };
        if seat.focused {
            canvas.page = list.height.max(1);
        }
        let is_here = |line: &ListLine| matches!(line, ListLine::Tool(place, _) if *place == tools.selected);
        let selected = lines.iter().position(is_here).unwrap_or(0);
        let from = first_row(selected, list.height as usize, lines.len());
        for (row, line) in rows_of(list).zip(lines.into_iter().skip(from)) {
            match line {
                ListLine::Module(module) => canvas.text(row, module.id(), Role::Header),
                ListLine::Tool(place, spec) => {
                    let has = look.company.has_tool(spec.id);
                    let selected = (place == tools.selected).then_some(seat.focused);
                    draw_tool(tools, canvas, row, (spec, has), selected);
                    canvas.click(row, Click::Row(seat.number, place));
                }
            }
        }
        if let Some(field) = &tools.typing {
            let row = Rect { y: seat.area.bottom().saturating_sub(1), height: 1, ..seat.area };
            canvas.text(row, "/", Role::Key);
            field.draw(canvas, Rect { x: row.x + 1, width: row.width.saturating_sub(1), ..row });
        }
    }
}

/// A line of the list: the heading of a module, or a tool with its index.
enum ListLine {
    Module(Module),
    Tool(usize, &'static Spec),
}

fn lines_of(tools: &Tools) -> Vec<ListLine> {
    let shown = tools.shown();
    let mut lines = Vec::new();
    for module in Module::ALL {
        let own = shown.iter().enumerate().filter(|(_, spec)| spec.module == module);
        let own: Vec<ListLine> = own.map(|(at, spec)| ListLine::Tool(at, spec)).collect();
        if !own.is_empty() {
            lines.push(ListLine::Module(module));
            lines.extend(own);
        }
    }
    lines
}

/// Draws a tool, marked if the lesson locks it; the selected one shows whether the list has the focus.
fn draw_tool(
    tools: &Tools,
    canvas: &mut Canvas<'_>,
    row: Rect,
    (spec, has): (&Spec, bool),
    selected: Option<bool>,
) {
    let role = match selected {
        Some(true) => Role::Selection,
        Some(false) => Role::SelectionIdle,
        None if !has => Role::Dim,
        None => Role::Text,
    };
    let draft =
        tools.forms.get(&spec.id).is_some_and(|form| form.sheet.is_changed() && form.spec.kind.acts());
    canvas.clear(row, role);
    let names = row.width.saturating_sub(9) as usize;
    let mark = if draft { '*' } else { ' ' };
    canvas.text(row, &format!(" {mark}{:<names$}", fit(spec.name(), names)), role);
    let code = if has { spec.code } else { "locked" };
    canvas.aligned(Rect { width: row.width.saturating_sub(1), ..row }, code, role, Align::Right);
}
