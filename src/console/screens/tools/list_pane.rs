//! The pane with the list of all tools.

use crossterm::event::KeyEvent;
use ratatui::layout::Rect;

use super::{Tools, ToolsPane, figure};
use crate::action::{Action, Scope};
use crate::context::{Figure, ScreenContext};
use crate::effect::Effect;
use crate::screens::panes::{PaneBorder, Pane, PanePlacement};
use novamind_tools::{ToolModule, ToolSpec};
use novamind_tui::canvas::{Align, Canvas, Click, truncate_to_width, row_rects};
use novamind_tui::theme::Role;
use novamind_tui::widgets::TextField;

pub struct ToolListPane;

impl Pane<Tools> for ToolListPane {
    fn scopes(&self, tools: &Tools) -> Vec<Scope> {
        if tools.filter_field.is_some() { vec![Scope::Field] } else { vec![Scope::List] }
    }

    fn hints(&self, tools: &Tools) -> Vec<Action> {
        match tools.filter_field {
            Some(_) => vec![Action::Commit, Action::Discard],
            None => vec![Action::Open, Action::Filter],
        }
    }

    fn figure(&self, tools: &Tools, _: &ScreenContext<'_>) -> Option<Figure> {
        tools.selected_tool().map(figure::tool_figure)
    }

    fn handle_action(&self, tools: &mut Tools, action: Action, context: &ScreenContext<'_>) -> Vec<Effect> {
        let last = tools.visible_tools().len().saturating_sub(1);
        let (here, page) = (tools.selected, context.page_rows as usize);
        match action {
            Action::Up => tools.selected = here.saturating_sub(1),
            Action::Down => tools.selected = (here + 1).min(last),
            Action::PageUp => tools.selected = here.saturating_sub(page),
            Action::PageDown => tools.selected = (here + page).min(last),
            Action::First => tools.selected = 0,
            Action::Last => tools.selected = last,
            Action::Filter => tools.filter_field = Some(TextField::with_text(tools.filter.clone())),
            Action::Close | Action::Discard => {
                tools.filter_field = None;
                tools.filter.clear();
                tools.selected = 0;
            }
            Action::Commit | Action::CommitDown | Action::CommitNext => tools.filter_field = None,
            Action::Open | Action::Right => match tools.dedicated_screen_effect() {
                Some(effect) if action == Action::Open => return vec![effect],
                Some(_) => return Vec::new(),
                None => tools.focus = ToolsPane::Form,
            },
            _ => {}
        }
        tools.form(context.company);
        Vec::new()
    }

    fn handle_key(&self, tools: &mut Tools, key: &KeyEvent, context: &ScreenContext<'_>) -> Vec<Effect> {
        self.edit_filter(tools, &mut |field| {
            field.handle_key(key);
        });
        tools.form(context.company);
        Vec::new()
    }

    fn paste(&self, tools: &mut Tools, text: &str, context: &ScreenContext<'_>) -> Vec<Effect> {
        self.edit_filter(tools, &mut |field| field.insert(text));
        tools.form(context.company);
        Vec::new()
    }

    fn edit_filter(&self, tools: &mut Tools, edit: &mut dyn FnMut(&mut TextField)) {
        if let Some(field) = &mut tools.filter_field {
            edit(field);
            tools.filter = field.text().to_owned();
            tools.selected = 0;
        }
    }

    fn handle_click(&self, tools: &mut Tools, row: usize, context: &ScreenContext<'_>) -> Vec<Effect> {
        tools.selected = row.min(tools.visible_tools().len().saturating_sub(1));
        tools.form(context.company);
        Vec::new()
    }

    fn border(&self, tools: &Tools, _: Rect, context: &ScreenContext<'_>) -> PaneBorder {
        let note = match tools.tools_with_drafts().len() {
            _ if !tools.filter.is_empty() => format!("\"{}\"", tools.filter),
            0 => context.hint(Action::Filter),
            1 => "* 1 draft".to_owned(),
            drafts => format!("* {drafts} drafts"),
        };
        PaneBorder { title: "Tools".to_owned(), note, ..PaneBorder::default() }
    }

    fn draw(&self, tools: &Tools, canvas: &mut Canvas<'_>, placement: PanePlacement, context: &ScreenContext<'_>) {
        let lines = tool_list_lines(tools);
        if lines.is_empty() {
            let text = format!("No matching tool: {}", context.hint(Action::Close));
            canvas.draw_text(placement.area, &text, Role::Dim);
        }
        let field = u16::from(tools.filter_field.is_some());
        let list = Rect { height: placement.area.height.saturating_sub(field), ..placement.area };
        if placement.focused {
            canvas.page_rows = list.height.max(1);
        }
        let is_here = |line: &ListLine| matches!(line, ListLine::Tool(place, _) if *place == tools.selected);
        let selected = lines.iter().position(is_here).unwrap_or(0);
        let from = canvas.scroll_to_row(list, selected, lines.len());
        for (row, line) in row_rects(list).zip(lines.into_iter().skip(from)) {
            match line {
                ListLine::Module(module) => canvas.draw_text(row, module.id(), Role::Header),
                ListLine::Tool(place, spec) => {
                    let has = context.company.has_tool(spec.id);
                    let selected = (place == tools.selected).then_some(placement.focused);
                    draw_tool(tools, canvas, row, (spec, has), selected);
                    canvas.register_click(row, Click::Row(placement.index, place));
                }
            }
        }
        if let Some(field) = &tools.filter_field {
            let row = Rect { y: placement.area.bottom().saturating_sub(1), height: 1, ..placement.area };
            canvas.draw_text(row, "/", Role::Key);
            field.draw(canvas, Rect { x: row.x + 1, width: row.width.saturating_sub(1), ..row });
        }
    }
}

/// A line of the list: the heading of a module of tools, or a tool with its index.
enum ListLine {
    Module(ToolModule),
    Tool(usize, &'static ToolSpec),
}

fn tool_list_lines(tools: &Tools) -> Vec<ListLine> {
    let tool_specs = tools.visible_tools();
    let mut lines = Vec::new();
    for module in ToolModule::ALL {
        let module_specs = tool_specs.iter().enumerate().filter(|(_, spec)| spec.module == module);
        let list_lines: Vec<ListLine> = module_specs.map(|(at, spec)| ListLine::Tool(at, spec)).collect();
        if !list_lines.is_empty() {
            lines.push(ListLine::Module(module));
            lines.extend(list_lines);
        }
    }
    lines
}

/// Draws a tool of the list. A tool that the lesson locks is marked. The selected tool shows whether the list has the
/// focus.
fn draw_tool(
    tools: &Tools,
    canvas: &mut Canvas<'_>,
    row: Rect,
    (spec, has): (&ToolSpec, bool),
    selected: Option<bool>,
) {
    let role = match selected {
        Some(true) => Role::Selection,
        Some(false) => Role::InactiveSelection,
        None if !has => Role::Dim,
        None => Role::Text,
    };
    let draft =
        tools.forms.get(&spec.id).is_some_and(|form| form.sheet.is_changed() && form.spec.kind.changes_company());
    canvas.clear(row, role);
    let names = row.width.saturating_sub(9) as usize;
    let mark = if draft { '*' } else { ' ' };
    canvas.draw_text(row, &format!(" {mark}{:<names$}", truncate_to_width(spec.name(), names)), role);
    let code = if has { spec.code } else { "locked" };
    canvas.draw_aligned(Rect { width: row.width.saturating_sub(1), ..row }, code, role, Align::Right);
}
