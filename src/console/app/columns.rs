//! Layouts of the columns of tables: the dialog that changes them, and the saved layouts.

use super::App;
use crate::dialogs::column_chooser::ColumnChooser;
use novamind_tui::widgets::ColumnLayout;
use novamind_worker::preferences::Preferences;

impl App {
    pub(super) fn open_column_chooser(&mut self) {
        let focused = self.with_screen(|screen, context| {
            let (title, table) = screen.focused_table(context)?;
            Some(ColumnChooser::new(title, table))
        });
        match focused.flatten() {
            Some(chooser) => self.open_dialog(chooser),
            None => self.show_error("the focused pane has no columns to arrange; choose a table with tab"),
        }
    }

    /// Arranges the columns of the focused table, and saves the layout for the next start.
    pub(super) fn arrange_columns(&mut self, layout: ColumnLayout) {
        let name = self.with_screen(|screen, _| screen.set_focused_layout(layout.clone())).flatten();
        let Some(name) = name else { return };
        self.column_layouts.insert(name.to_owned(), layout.clone());
        let tables = [(name.to_owned(), layout)].into();
        self.save_preferences(Preferences { tables, ..Preferences::default() });
    }

    /// Applies the saved layouts to the tables of the current screen, which may have been rebuilt.
    pub(super) fn apply_column_layouts(&mut self) {
        let layouts = std::mem::take(&mut self.column_layouts);
        self.with_screen(|screen, _| screen.set_layouts(&layouts));
        self.column_layouts = layouts;
    }
}
