//! Export of a result to a file or the clipboard.

use ratatui::layout::Rect;

use super::values;
use crate::action::Action;
use crate::context::Look;
use crate::effect::Effect;
use novamind_base::notation::grouped;
use novamind_database::Rows;
use novamind_tui::canvas::{Canvas, Click, centered, rows_of};
use novamind_tui::theme::Role;

/// Maximum bytes for the clipboard; terminals silently drop longer texts.
const CLIPBOARD: usize = 64 << 10;

/// Export formats in list order.
const WAYS: [Action; 5] =
    [Action::ExportCsv, Action::ExportJson, Action::ExportMarkdown, Action::CopyTabs, Action::CopyMarkdown];

#[derive(Default)]
pub struct TakeOut {
    selected: usize,
}

impl TakeOut {
    /// Returns the format that an action stands for, or moves the selection.
    pub fn act(&mut self, action: Action) -> Option<Action> {
        match action {
            Action::Up => self.selected = self.selected.saturating_sub(1),
            Action::Down => self.selected = (self.selected + 1).min(WAYS.len() - 1),
            Action::Open => return Some(WAYS[self.selected]),
            other => return WAYS.contains(&other).then_some(other),
        }
        None
    }

    pub fn click(&mut self, row: usize) -> Action {
        self.selected = row.min(WAYS.len() - 1);
        WAYS[self.selected]
    }

    /// Draws the list over the screen. `rows` describes the exported rows.
    pub fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, pane: usize, rows: &str, look: &Look<'_>) {
        let own = centered(area, 62, WAYS.len() as u16 + 2);
        canvas.clear(own, Role::Text);
        canvas.clicks.clear();
        let inside = canvas.pane(own, "Export", rows, true);
        for (row, (at, way)) in rows_of(inside).zip(WAYS.iter().enumerate()) {
            let selected = at == self.selected;
            let role = |other| if selected { Role::Selection } else { other };
            if selected {
                canvas.clear(row, Role::Selection);
            }
            let key = look.keys.label(*way).unwrap_or_default();
            canvas.text(Rect { x: row.x + 1, width: 3.min(row.width), ..row }, &key, role(Role::Key));
            let doc = Rect { x: row.x + 5, width: row.width.saturating_sub(6), ..row };
            canvas.text(doc, way.entry().doc, role(Role::Text));
            canvas.click(row, Click::Row(pane, at));
        }
        canvas.pane_keys(own, &look.hints(&[Action::Open, Action::Close]));
    }
}

/// Exports rows in a format.
pub fn take(way: Action, rows: &Rows) -> Vec<Effect> {
    match way {
        Action::ExportCsv => match values::csv(rows) {
            Ok(bytes) => vec![Effect::Write("query-0001.csv".to_owned(), bytes)],
            Err(problem) => vec![Effect::Complain(problem)],
        },
        Action::ExportJson => vec![Effect::Write("query-0001.json".to_owned(), values::json(rows))],
        Action::ExportMarkdown => {
            vec![Effect::Write("query-0001.md".to_owned(), values::markdown(rows).into_bytes())]
        }
        Action::CopyTabs => copy(values::all_tabbed(rows), rows, "with tabs"),
        _ => copy(values::markdown(rows), rows, "as Markdown"),
    }
}

fn copy(text: String, rows: &Rows, how: &str) -> Vec<Effect> {
    let kilobytes = |bytes: usize| grouped(bytes as f64 / 1024.0, 1);
    if text.len() > CLIPBOARD {
        return vec![Effect::Complain(format!(
            "{} KB exceed the limit of the terminal's clipboard ({} KB). Write a file or filter first.",
            kilobytes(text.len()),
            CLIPBOARD >> 10
        ))];
    }
    let said = format!("Copied {} {how}, {} KB", count(rows.rows.len()), kilobytes(text.len()));
    vec![Effect::Copy(text), Effect::Say(said)]
}

/// Returns `1 row`, `3,000 rows`.
pub fn count(rows: usize) -> String {
    format!("{} {}", grouped(rows as f64, 0), if rows == 1 { "row" } else { "rows" })
}

#[cfg(test)]
mod tests {
    use super::*;
    use novamind_database::Cell;

    fn result(length: usize, rows: usize) -> Rows {
        let row = vec![Cell::Text("x".repeat(length))];
        Rows { columns: vec!["a".to_owned()], rows: vec![row; rows], ..Rows::default() }
    }

    #[test]
    fn what_is_too_long_for_the_clipboard_is_refused_with_its_size() {
        let small = take(Action::CopyTabs, &result(3, 2));
        assert!(matches!(&small[..], [Effect::Copy(text), Effect::Say(said)]
            if text == "a\nxxx\nxxx\n" && said == "Copied 2 rows with tabs, 0.0 KB"));
        let large = take(Action::CopyMarkdown, &result(1000, 90));
        assert!(matches!(&large[..], [Effect::Complain(text)] if text.starts_with("88.")), "{large:?}");
    }

    #[test]
    fn the_list_is_walked_and_every_way_has_its_key() {
        let mut list = TakeOut::default();
        assert_eq!(list.act(Action::Up), None);
        list.act(Action::Down);
        assert_eq!(list.act(Action::Open), Some(Action::ExportJson));
        assert_eq!(list.act(Action::CopyMarkdown), Some(Action::CopyMarkdown));
        assert_eq!(list.act(Action::Close), None);
        assert_eq!(list.click(99), Action::CopyMarkdown);
        let keys = crate::keys::Keys::shipped();
        assert!(WAYS.iter().all(|way| keys.label(*way).is_some()));
    }
}
