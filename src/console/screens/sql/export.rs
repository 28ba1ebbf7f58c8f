//! Export of a query result to a file or the clipboard.

use ratatui::layout::Rect;

use super::values;
use crate::action::Action;
use crate::context::ScreenContext;
use crate::effect::Effect;
use crate::keys::KeyBindings;
use novamind_base::formatting::grouped_number;
use novamind_database::QueryResult;
use novamind_tui::canvas::{Canvas, Click, centered_rect, row_rects};
use novamind_tui::theme::Role;

/// Maximum size of a clipboard text in bytes. Terminals silently drop longer texts.
const MAX_CLIPBOARD_BYTES: usize = 64 << 10;

/// Export actions in the order of the list.
const EXPORT_ACTIONS: [Action; 5] =
    [Action::ExportCsv, Action::ExportJson, Action::ExportMarkdown, Action::CopyTabs, Action::CopyMarkdown];

pub struct ExportMenu {
    /// The formats that are available. Hosted sessions write no files.
    formats: Vec<Action>,
    selected: usize,
}

impl ExportMenu {
    /// Returns a menu with the available formats.
    pub fn new(keys: &KeyBindings) -> ExportMenu {
        let formats = EXPORT_ACTIONS.into_iter().filter(|action| keys.is_available(*action)).collect();
        ExportMenu { formats, selected: 0 }
    }

    /// Returns the export action that an action selects, or moves the selection.
    pub fn select_export(&mut self, action: Action) -> Option<Action> {
        match action {
            Action::Up => self.selected = self.selected.saturating_sub(1),
            Action::Down => self.selected = (self.selected + 1).min(self.formats.len() - 1),
            Action::Open => return Some(self.formats[self.selected]),
            other => return self.formats.contains(&other).then_some(other),
        }
        None
    }

    pub fn select_row(&mut self, row: usize) -> Action {
        self.selected = row.min(self.formats.len() - 1);
        self.formats[self.selected]
    }

    /// Draws the list of formats over the screen. `rows` describes the exported rows.
    pub fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, pane: usize, rows: &str, context: &ScreenContext<'_>) {
        let dialog_area = centered_rect(area, 62, self.formats.len() as u16 + 2);
        canvas.clear(dialog_area, Role::Text);
        canvas.clicks.clear();
        let inside = canvas.draw_pane_frame(dialog_area, "Export", rows, true);
        for (row, (at, way)) in row_rects(inside).zip(self.formats.iter().enumerate()) {
            let selected = at == self.selected;
            let role = |other| if selected { Role::Selection } else { other };
            if selected {
                canvas.clear(row, Role::Selection);
            }
            let key = context.keys.label(*way).unwrap_or_default();
            canvas.draw_text(Rect { x: row.x + 1, width: 3.min(row.width), ..row }, &key, role(Role::Key));
            let doc = Rect { x: row.x + 5, width: row.width.saturating_sub(6), ..row };
            canvas.draw_text(doc, way.entry().doc, role(Role::Text));
            canvas.register_click(row, Click::Row(pane, at));
        }
        canvas.draw_pane_keys(dialog_area, &context.hints(&[Action::Open, Action::Close]));
    }
}

/// Returns the effects that export rows in a format.
pub fn export_effects(way: Action, rows: &QueryResult) -> Vec<Effect> {
    match way {
        Action::ExportCsv => match values::to_csv(rows) {
            Ok(bytes) => vec![Effect::Write("query-0001.csv".to_owned(), bytes)],
            Err(problem) => vec![Effect::ShowError(problem)],
        },
        Action::ExportJson => vec![Effect::Write("query-0001.json".to_owned(), values::to_json(rows))],
        Action::ExportMarkdown => {
            vec![Effect::Write("query-0001.md".to_owned(), values::to_markdown(rows).into_bytes())]
        }
        Action::CopyTabs => copy_effects(values::to_tab_separated(rows), rows, "with tabs"),
        _ => copy_effects(values::to_markdown(rows), rows, "as Markdown"),
    }
}

fn copy_effects(text: String, rows: &QueryResult, how: &str) -> Vec<Effect> {
    let kilobytes = |bytes: usize| grouped_number(bytes as f64 / 1024.0, 1);
    if text.len() > MAX_CLIPBOARD_BYTES {
        return vec![Effect::ShowError(format!(
            "{} KB exceed the limit of the terminal's clipboard ({} KB). Write a file or filter first.",
            kilobytes(text.len()),
            MAX_CLIPBOARD_BYTES >> 10
        ))];
    }
    let notice = format!("Copied {} {how}, {} KB", format_row_count(rows.rows.len()), kilobytes(text.len()));
    vec![Effect::Copy(text), Effect::ShowStatus(notice)]
}

/// Formats a number of rows, for example `1 row` or `3,000 rows`.
pub fn format_row_count(rows: usize) -> String {
    format!("{} {}", grouped_number(rows as f64, 0), if rows == 1 { "row" } else { "rows" })
}

#[cfg(test)]
mod tests {
    use super::*;
    use novamind_database::Cell;

    fn result(length: usize, rows: usize) -> QueryResult {
        let row = vec![Cell::Text("x".repeat(length))];
        QueryResult { columns: vec!["a".to_owned()], rows: vec![row; rows], ..QueryResult::default() }
    }

    #[test]
    fn oversized_clipboard_text_is_rejected_with_its_size() {
        let small = export_effects(Action::CopyTabs, &result(3, 2));
        assert!(matches!(&small[..], [Effect::Copy(text), Effect::ShowStatus(notice)]
            if text == "a\nxxx\nxxx\n" && notice == "Copied 2 rows with tabs, 0.0 KB"));
        let large = export_effects(Action::CopyMarkdown, &result(1000, 90));
        assert!(matches!(&large[..], [Effect::ShowError(text)] if text.starts_with("88.")), "{large:?}");
    }

    #[test]
    fn export_menu_selects_formats_by_row_and_key() {
        let mut list = ExportMenu::new(&KeyBindings::bundled());
        assert_eq!(list.select_export(Action::Up), None);
        list.select_export(Action::Down);
        assert_eq!(list.select_export(Action::Open), Some(Action::ExportJson));
        assert_eq!(list.select_export(Action::CopyMarkdown), Some(Action::CopyMarkdown));
        assert_eq!(list.select_export(Action::Close), None);
        assert_eq!(list.select_row(99), Action::CopyMarkdown);
        let keys = KeyBindings::bundled();
        let hosted = ExportMenu::new(&crate::hosted::hosted_keys(KeyBindings::bundled()));
        assert_eq!(hosted.formats, [Action::CopyTabs, Action::CopyMarkdown], "no files");
        assert!(EXPORT_ACTIONS.iter().all(|way| keys.label(*way).is_some()));
    }
}
