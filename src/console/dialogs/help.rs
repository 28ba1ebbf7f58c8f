//! The help dialog lists the keys of the focused pane, the keys of the screen, and global keys.

use ratatui::layout::{Constraint, Layout, Rect};

use super::{Dialog, DialogContent, DialogResponse, DialogView};
use crate::action::{ACTIONS, Action, Scope};
use crate::context::{PaneKeys, ScreenContext, ScreenId};
use crate::keys::KeyBindings;
use novamind_tui::canvas::{Canvas, centered_rect, row_rects};
use novamind_tui::text::wrap;
use novamind_tui::theme::Role;
use novamind_tui::widgets::column_layout::ColumnLayout;
use novamind_tui::widgets::editor::EDITING_KEYS;
use novamind_tui::widgets::{Table, TableCell, TableColumn};

/// The help dialog.
pub struct HelpDialog {
    title: String,
    table: Table,
}

struct HelpSection {
    name: &'static str,
    scopes: Vec<Scope>,
    actions: Vec<Action>,
}

/// Heading of the descriptions of keys.
const DESCRIPTION_HEADING: &str = "effect";
/// Minimum width of the table with a column of descriptions.
const MIN_DESCRIPTION_WIDTH: u16 = 90;
/// Number of rows for the complete description of the selected key.
const DETAIL_ROWS: u16 = 3;

/// Actions that lists support but forms do not.
const LIST_ACTIONS: [Action; 2] = [Action::Filter, Action::Sort];

impl HelpDialog {
    /// Lists the keys of a screen. The keys of the focused pane are first.
    pub fn new(here: ScreenId, panes: &[PaneKeys], replay: bool, keys: &KeyBindings) -> HelpDialog {
        let mut table = key_table(screen_sections(panes, replay), keys);
        if panes.first().is_some_and(|pane| pane.scopes.contains(&Scope::Editor)) {
            let edits =
                EDITING_KEYS.map(|(key, title, doc)| styled_row("typing", (key, Role::Key), title, doc));
            table.set_rows(table.rows().iter().cloned().chain(edits).collect());
        }
        let screen = here.action().entry().title;
        let pane = panes.first().map(|pane| pane.title.as_str()).filter(|title| !title.is_empty());
        let title = pane.map_or_else(|| screen.to_owned(), |pane| format!("{screen} › {pane}"));
        HelpDialog { title: format!("Keys: {title}"), table }
    }

    /// Lists the keys of a dialog, without the keys of screens.
    pub fn for_dialog(dialog: &dyn Dialog, keys: &KeyBindings) -> HelpDialog {
        let scopes = dialog.scopes();
        let hints = dialog.hints().into_iter();
        let part = |name, actions| HelpSection { name, scopes: scopes.clone(), actions };
        let others = scopes.iter().filter(|scope| **scope != Scope::List);
        let help_section =
            part("step", hints.chain(others.flat_map(|scope| scope_actions(*scope))).collect());
        let lists = part(
            "lists",
            scope_actions(Scope::List)
                .filter(|action| scopes.contains(&Scope::List) && !LIST_ACTIONS.contains(action))
                .collect(),
        );
        let step = dialog.step().map_or(String::new(), |step| format!(" › {step}"));
        HelpDialog {
            title: format!("Keys: {}{step}", dialog.record_name()),
            table: key_table([help_section, lists], keys),
        }
    }

    /// Returns the complete description of the selected key.
    fn selected_description(&self) -> &str {
        let row = self.table.selected().and_then(|at| self.table.rows().get(at));
        row.and_then(|row| row.last()).map_or("", |cell| cell.text.as_str())
    }

    /// Returns the table without the column of descriptions, for a window in which most descriptions do not fit.
    fn without_descriptions(&self) -> Table {
        let mut table = self.table.clone();
        let hidden = std::iter::once(DESCRIPTION_HEADING.to_owned()).collect();
        table.set_layout(ColumnLayout { hidden, ..ColumnLayout::default() });
        table
    }

    #[cfg(test)]
    fn rows(&self) -> Vec<Vec<String>> {
        self.table.rows().iter().map(|row| row.iter().map(|cell| cell.text.clone()).collect()).collect()
    }
}

/// Builds a table with a row for each action that has a working key or no binding.
fn key_table(parts: impl IntoIterator<Item = HelpSection>, keys: &KeyBindings) -> Table {
    let columns = vec![
        TableColumn::text("where").with_max_width(8),
        TableColumn::text("keys").with_max_width(16),
        TableColumn::text("what").with_max_width(22),
        TableColumn::text(DESCRIPTION_HEADING).with_max_width(90),
    ];
    let mut table = Table::new(columns);
    let mut listed: Vec<Action> = Vec::new();
    let mut rows = Vec::new();
    for part in parts {
        for action in part.actions {
            let chords = keys.working_keys(action, &part.scopes);
            let unbound = keys.label(action).is_none();
            if !keys.is_available(action) || listed.contains(&action) || chords.is_empty() && !unbound {
                continue;
            }
            listed.push(action);
            rows.push(action_row(part.name, &chords, action));
        }
    }
    table.set_rows(rows);
    table
}

fn action_row(part: &str, chords: &[String], action: Action) -> Vec<TableCell> {
    let entry = action.entry();
    let chords = chords.join(", ");
    let keys = if chords.is_empty() { ("palette", Role::Dim) } else { (chords.as_str(), Role::Key) };
    styled_row(part, keys, entry.title, entry.doc)
}

fn styled_row(part: &str, (keys, role): (&str, Role), title: &str, doc: &str) -> Vec<TableCell> {
    vec![
        TableCell::from_text(part).with_role(Role::Dim),
        TableCell::from_text(keys).with_role(role),
        TableCell::from_text(title),
        TableCell::from_text(doc).with_role(Role::Text),
    ]
}

/// Returns the sections in display order. List navigation is near the end, because the navigation keys are the same in
/// all lists.
fn screen_sections(panes: &[PaneKeys], replay: bool) -> Vec<HelpSection> {
    let with_global = |scopes: &[Scope]| {
        let replayed = replay && !scopes.first().is_some_and(|scope| scope.is_text());
        let first = replayed.then_some(Scope::Playback);
        first.into_iter().chain(scopes.iter().copied()).chain([Scope::Global]).collect::<Vec<Scope>>()
    };
    let mut parts = Vec::new();
    for (at, pane) in panes.iter().enumerate() {
        let hints = pane.hints.iter().copied().filter(|action| action.entry().scope != Scope::Global);
        let scopes = pane.scopes.iter().filter(|scope| **scope != Scope::List);
        parts.push(HelpSection {
            name: if at == 0 { "pane" } else { "screen" },
            scopes: with_global(&pane.scopes),
            actions: hints.chain(scopes.flat_map(|scope| scope_actions(*scope))).collect(),
        });
    }
    let pane_scopes = panes.first().map_or(Vec::new(), |pane| with_global(&pane.scopes));
    for (scope, name) in [(Scope::Playback, "replay"), (Scope::List, "lists"), (Scope::Global, "always")] {
        if pane_scopes.contains(&scope) {
            // A form has the navigation of a list but cannot be filtered or sorted.
            let is_unusable =
                |action: &Action| pane_scopes.contains(&Scope::Form) && LIST_ACTIONS.contains(action);
            let actions = scope_actions(scope).filter(|action| !is_unusable(action)).collect();
            parts.push(HelpSection { name, scopes: pane_scopes.clone(), actions });
        }
    }
    parts
}

fn scope_actions(scope: Scope) -> impl Iterator<Item = Action> {
    ACTIONS.iter().filter(move |entry| entry.scope == scope).map(|entry| entry.action)
}

impl Dialog for HelpDialog {
    fn record_name(&self) -> String {
        "keys".to_owned()
    }

    fn tour_view(&self) -> Option<DialogView> {
        Some(DialogView::new(DialogContent::Help, true))
    }

    fn scopes(&self) -> Vec<Scope> {
        if self.table.is_filter_open() { vec![Scope::Field] } else { vec![Scope::List, Scope::Dialog] }
    }

    fn hints(&self) -> Vec<Action> {
        vec![Action::Filter, Action::Close]
    }

    fn handle_action(&mut self, action: Action, context: &ScreenContext<'_>) -> DialogResponse {
        if self.table.handle_action(action, context.page_rows) {
            return DialogResponse::stay();
        }
        match action {
            Action::Close | Action::Cancel => DialogResponse::close(),
            _ => DialogResponse::stay(),
        }
    }

    fn handle_key(&mut self, key: &crossterm::event::KeyEvent, _: &ScreenContext<'_>) -> DialogResponse {
        self.table.edit_filter(|field| {
            field.handle_key(key);
        });
        DialogResponse::stay()
    }

    fn handle_click(&mut self, row: usize, _: &ScreenContext<'_>) -> DialogResponse {
        self.table.select_visible_row(row);
        DialogResponse::stay()
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, context: &ScreenContext<'_>) {
        let dialog_area =
            centered_rect(area, area.width.saturating_sub(4).min(110), area.height.saturating_sub(2));
        canvas.clear(dialog_area, Role::Text);
        let inside = canvas.draw_pane_frame(dialog_area, &self.title, &self.table.summary(), true);
        let inside = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside };
        let detail = wrap(self.selected_description(), usize::from(inside.width));
        let rows = (DETAIL_ROWS.min(inside.height / 2)).max(detail.len() as u16).min(inside.height);
        let [list, below] =
            Layout::vertical([Constraint::Min(0), Constraint::Length(rows)]).areas::<2>(inside);
        match inside.width < MIN_DESCRIPTION_WIDTH {
            true => self.without_descriptions().draw(canvas, list, true, 0),
            false => self.table.draw(canvas, list, true, 0),
        }
        for (row, line) in row_rects(below).zip(&detail) {
            canvas.draw_text(row, line, Role::Dim);
        }
        canvas.draw_pane_keys(dialog_area, &context.hints(&[Action::Filter, Action::Close]));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_kit::{dialog_action, dialog_text, new_company};

    fn pane(title: &str, scopes: &[Scope], hints: &[Action]) -> PaneKeys {
        PaneKeys { title: title.to_owned(), scopes: scopes.to_vec(), hints: hints.to_vec() }
    }

    #[test]
    fn focused_pane_is_first_and_overridden_keys_are_omitted() {
        let form = pane("set_prices", &[Scope::Form, Scope::List], &[Action::EditCell, Action::Close]);
        let list = pane("Tools", &[Scope::List], &[Action::Open, Action::Filter]);
        let keys = KeyBindings::bundled();
        let help = HelpDialog::new(ScreenId::Tools, &[form, list], false, &keys);
        assert_eq!(help.title, "Keys: Tools › set_prices");
        let rows = help.rows();
        assert_eq!(rows[0][..3], ["pane", "enter, e", "edit"]);
        let filters: Vec<&str> =
            rows.iter().filter(|row| row[2] == "filter").map(|row| row[0].as_str()).collect();
        assert_eq!(filters, ["screen"], "a form has nothing to filter");
        assert_eq!(rows[1][..3], ["pane", "esc", "close"], "the most common action comes first");
        let place = |title: &str| rows.iter().position(|row| row[2] == title).expect(title);
        assert_eq!(rows[place("open")][..2], ["screen", "enter"], "enter opens in the list only");
        assert!(
            place("submit") < place("open") && place("open") < place("up") && place("up") < place("quit")
        );
        assert_eq!(rows[place("quit")][0], "always");
        let parts: Vec<&str> = rows.iter().map(|row| row[0].as_str()).collect();
        let mut order = parts.clone();
        order.dedup();
        assert_eq!(order, ["pane", "screen", "lists", "always"]);
        let mut titles: Vec<&String> = rows.iter().map(|row| &row[3]).collect();
        titles.sort_unstable();
        titles.dedup();
        assert_eq!(titles.len(), rows.len(), "no action is listed twice");
        // A key that an inner scope binds is not listed for an outer scope.
        let query = pane("Results", &[Scope::Result, Scope::List], &[]);
        let rows = HelpDialog::new(ScreenId::Sql, &[query], false, &keys).rows();
        assert!(rows.iter().all(|row| row[2] != "open"), "enter shows the full value here");
    }

    #[test]
    fn every_description_can_be_read_in_the_smallest_window() {
        let list = pane("Decisions", &[Scope::List], &[Action::Open]);
        let mut help = HelpDialog::new(ScreenId::Journal, &[list], false, &KeyBindings::bundled());
        let company = new_company();
        for row in help.rows() {
            let shown = dialog_text(&help, &company, 60, 13);
            let words =
                shown.replace(['┃', '↓', '↑', '\n'], " ").split_whitespace().collect::<Vec<_>>().join(" ");
            assert!(words.contains(&row[3]) && !words.contains('…'), "{}:\n{shown}", row[3]);
            dialog_action(&mut help, Action::Down, &company);
        }
    }

    #[test]
    fn playback_has_its_own_section() {
        let list = pane("Decisions", &[Scope::List], &[Action::Open]);
        let rows = HelpDialog::new(ScreenId::Journal, &[list], true, &KeyBindings::bundled()).rows();
        let first = |name: &str| rows.iter().position(|row| row[0] == name).expect(name);
        assert!(first("pane") < first("replay") && first("replay") < first("always"));
    }
}
