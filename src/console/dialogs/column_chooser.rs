//! The dialog that shows, hides, moves and resizes the columns of a table. Changes apply immediately.

use ratatui::layout::Rect;

use super::{Dialog, DialogResponse};
use crate::action::{Action, Scope};
use crate::context::ScreenContext;
use crate::effect::Effect;
use novamind_tui::canvas::{Canvas, Click, centered_rect};
use novamind_tui::theme::Role;
use novamind_tui::widgets::column_layout::MAX_COLUMN_WIDTH;
use novamind_tui::widgets::{ColumnLayout, Table, TableCell, TableColumn};

const MAX_DIALOG_WIDTH: u16 = 58;

/// The dialog that arranges the columns of a table.
pub struct ColumnChooser {
    title: String,
    columns: Vec<TableColumn>,
    /// Displayed widths of the columns when the dialog was opened.
    widths: Vec<u16>,
    layout: ColumnLayout,
    list: Table,
}

impl ColumnChooser {
    /// Opens the dialog for a table with a title.
    pub fn new(title: String, table: &Table) -> ColumnChooser {
        let list = Table::new(vec![
            TableColumn::text(""),
            TableColumn::text("column"),
            TableColumn::numeric("width"),
        ]);
        let mut chooser = ColumnChooser {
            title,
            columns: table.columns().to_vec(),
            widths: table.widths().to_vec(),
            layout: table.layout().clone(),
            list,
        };
        chooser.rebuild_list();
        chooser
    }

    /// Returns the headings in display order.
    fn headings(&self) -> Vec<String> {
        let heading = |at: usize| self.columns[at].title.clone();
        self.layout.ordered_columns(&self.columns).into_iter().map(heading).collect()
    }

    fn selected_heading(&self) -> Option<String> {
        self.headings().into_iter().nth(self.list.selected()?)
    }

    fn rebuild_list(&mut self) {
        let row = |heading: String| {
            let is_hidden = self.layout.hidden.contains(&heading);
            let width = match self.layout.fixed_width(&heading) {
                Some(width) => width.to_string(),
                None => "automatic".to_owned(),
            };
            let role = if is_hidden { Role::Dim } else { Role::Text };
            vec![
                TableCell::from_text(if is_hidden { "[ ]" } else { "[x]" }),
                TableCell::from_text(heading).with_role(role),
                TableCell::from_text(width).with_role(Role::Dim),
            ]
        };
        let rows = self.headings().into_iter().map(row).collect();
        self.list.set_rows(rows);
    }

    /// Shows the changed layout in the dialog and in the table.
    fn apply(&mut self) -> DialogResponse {
        // The original order is not saved, so that it also applies to columns that later versions add.
        let original = self.columns.iter().map(|column| &column.title);
        if self.layout.order.iter().eq(original) {
            self.layout.order.clear();
        }
        self.rebuild_list();
        DialogResponse::stay_with(vec![Effect::ArrangeColumns(self.layout.clone())])
    }

    fn toggle(&mut self) -> DialogResponse {
        let Some(heading) = self.selected_heading() else { return DialogResponse::stay() };
        if !self.layout.hidden.remove(&heading) {
            let visible = self.layout.visible_columns(&self.columns).len();
            if visible == 1 {
                let text = "the last visible column cannot be hidden".to_owned();
                return DialogResponse::stay_with(vec![Effect::ShowError(text)]);
            }
            self.layout.hidden.insert(heading);
        }
        self.apply()
    }

    fn move_column(&mut self, down: bool) -> DialogResponse {
        let mut order = self.headings();
        let Some(from) = self.list.selected() else { return DialogResponse::stay() };
        let to = if down { from + 1 } else { from.wrapping_sub(1) };
        if to >= order.len() {
            return DialogResponse::stay();
        }
        order.swap(from, to);
        self.layout.order = order;
        let response = self.apply();
        self.list.select(to);
        response
    }

    fn change_width(&mut self, change: i16) -> DialogResponse {
        let Some(heading) = self.selected_heading() else { return DialogResponse::stay() };
        let column = self.columns.iter().position(|column| column.title == heading);
        let displayed = column.and_then(|at| self.widths.get(at).copied()).unwrap_or(1);
        let width = self.layout.fixed_width(&heading).unwrap_or(displayed);
        self.layout.widths.insert(heading, width.saturating_add_signed(change).clamp(1, MAX_COLUMN_WIDTH));
        self.apply()
    }

    fn fit_column(&mut self) -> DialogResponse {
        if let Some(heading) = self.selected_heading() {
            self.layout.widths.remove(&heading);
        }
        self.apply()
    }
}

impl Dialog for ColumnChooser {
    fn record_name(&self) -> String {
        "columns".to_owned()
    }

    fn scopes(&self) -> Vec<Scope> {
        vec![Scope::Columns, Scope::List, Scope::Dialog]
    }

    fn hints(&self) -> Vec<Action> {
        vec![
            Action::ToggleColumn,
            Action::MoveColumnUp,
            Action::MoveColumnDown,
            Action::WidenColumn,
            Action::NarrowColumn,
            Action::FitColumn,
            Action::ResetColumns,
            Action::Close,
        ]
    }

    fn handle_action(&mut self, action: Action, context: &ScreenContext<'_>) -> DialogResponse {
        match action {
            Action::Close | Action::Cancel | Action::Columns => return DialogResponse::close(),
            Action::ToggleColumn | Action::Open => return self.toggle(),
            Action::MoveColumnUp => return self.move_column(false),
            Action::MoveColumnDown => return self.move_column(true),
            Action::WidenColumn | Action::Right => return self.change_width(1),
            Action::NarrowColumn | Action::Left => return self.change_width(-1),
            Action::FitColumn => return self.fit_column(),
            Action::ResetColumns => {
                self.layout = ColumnLayout::default();
                return self.apply();
            }
            Action::Sort | Action::Filter => {}
            _ => {
                self.list.handle_action(action, context.page_rows);
            }
        }
        DialogResponse::stay()
    }

    fn handle_click(&mut self, row: usize, _: &ScreenContext<'_>) -> DialogResponse {
        let before = self.list.selected();
        self.list.select_visible_row(row);
        if before == self.list.selected() { self.toggle() } else { DialogResponse::stay() }
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, context: &ScreenContext<'_>) {
        let height = self.columns.len() as u16 + 3;
        let dialog_area = centered_rect(area, MAX_DIALOG_WIDTH.min(area.width), height.min(area.height));
        canvas.clear(dialog_area, Role::Text);
        let shown = self.layout.visible_columns(&self.columns).len();
        let note = format!("{shown} of {} shown", self.columns.len());
        // A title that starts with a count is not the name of a table.
        let title = match self.title.starts_with(|first: char| first.is_ascii_digit()) {
            true => format!("Columns · {}", self.title),
            false => format!("Columns of {}", self.title),
        };
        let inside = canvas.draw_pane_frame(dialog_area, &title, &note, true);
        canvas.register_click(dialog_area, Click::Pane(0));
        let inside = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside };
        self.list.draw(canvas, inside, true, 0);
        let keys = [Action::ToggleColumn, Action::MoveColumnUp, Action::MoveColumnDown, Action::Close];
        canvas.draw_pane_keys(dialog_area, &context.hints(&keys));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dialogs::dialog_text;
    use crate::keys::KeyBindings;
    use crate::test_kit::new_company;
    use novamind_worker::company::DisplayedCompany;

    fn chooser() -> ColumnChooser {
        let columns = ["group", "leads", "churn"].map(TableColumn::numeric);
        ColumnChooser::new("Groups".to_owned(), &Table::new(columns.to_vec()))
    }

    /// Performs actions and returns the layout that the last action applied.
    fn layout_after(chooser: &mut ColumnChooser, actions: &[Action]) -> Option<ColumnLayout> {
        let company = new_company();
        let keys = KeyBindings::bundled();
        let context = ScreenContext { company: &company, keys: &keys, page_rows: 5 };
        let mut applied = None;
        for action in actions {
            for effect in chooser.handle_action(*action, &context).effects {
                if let Effect::ArrangeColumns(layout) = effect {
                    applied = Some(layout);
                }
            }
        }
        applied
    }

    #[test]
    fn actions_hide_move_and_resize_columns() {
        let mut chooser = chooser();
        let hidden = layout_after(&mut chooser, &[Action::Down, Action::ToggleColumn]).expect("applied");
        assert_eq!(hidden.hidden, ["leads".to_owned()].into());
        let moved = layout_after(&mut chooser, &[Action::MoveColumnUp]).expect("applied");
        assert_eq!(moved.order, ["leads", "group", "churn"]);
        let back =
            layout_after(&mut chooser, &[Action::MoveColumnDown, Action::ToggleColumn]).expect("applied");
        assert!(back.is_default(), "the selection moves with the column: {back:?}");
        let wide = layout_after(&mut chooser, &[Action::WidenColumn, Action::WidenColumn]).expect("applied");
        assert_eq!(wide.widths, [("leads".to_owned(), 7)].into());
        assert!(layout_after(&mut chooser, &[Action::FitColumn]).expect("applied").is_default());
    }

    #[test]
    fn last_visible_column_cannot_be_hidden() {
        let mut chooser = chooser();
        let toggle_all = [Action::ToggleColumn, Action::Down, Action::ToggleColumn, Action::Down];
        layout_after(&mut chooser, &toggle_all);
        assert_eq!(layout_after(&mut chooser, &[Action::ToggleColumn]), None);
        assert!(layout_after(&mut chooser, &[Action::ResetColumns]).expect("applied").is_default());
    }

    #[test]
    fn dialog_lists_all_columns_at_every_size() {
        let company: DisplayedCompany = new_company();
        let mut chooser = chooser();
        layout_after(&mut chooser, &[Action::ToggleColumn]);
        let text = dialog_text(&chooser, &company, 60, 14);
        assert!(text.contains("Columns of Groups") && text.contains("2 of 3 shown"), "{text}");
        assert!(text.contains("[ ]  group") && text.contains("[x]  leads"), "{text}");
        for (width, height) in [(0, 0), (2, 2), (20, 5), (60, 13), (200, 57)] {
            dialog_text(&chooser, &company, width, height);
        }
    }
}
