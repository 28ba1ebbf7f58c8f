//! The dialog that saves a statement as a named query.

use ratatui::layout::Rect;

use crate::action::Action;
use crate::context::ScreenContext;
use crate::effect::Effect;
use novamind_record::folder::query_library::{QueryHeader, QueryLibrary, to_file_name};
use novamind_tui::canvas::{Canvas, centered_rect};
use novamind_tui::text::wrap;
use novamind_tui::theme::Role;
use novamind_tui::widgets::TextField;

pub struct SaveQueryForm {
    pub field: TextField,
    sql: String,
    /// The existing name for which a warning is shown.
    confirmed_name: Option<String>,
}

enum NameStatus {
    /// The text is not a valid name.
    Invalid,
    /// A name that no query uses yet.
    Free(String),
    /// The name of a query that the user saved.
    OwnQuery(String),
    /// The name of a bundled query.
    BundledQuery(String),
}

impl SaveQueryForm {
    /// Opens the dialog with the title of the statement as default name.
    pub fn new(sql: String) -> SaveQueryForm {
        let title = QueryHeader::parse(&sql).title.unwrap_or_default();
        SaveQueryForm { field: TextField::with_selected_text(title), sql, confirmed_name: None }
    }

    fn name_status(&self, library: &QueryLibrary) -> NameStatus {
        let Some(name) = to_file_name(self.field.text()) else { return NameStatus::Invalid };
        match library.find(&name) {
            None => NameStatus::Free(name),
            Some(query) if query.is_user_query => NameStatus::OwnQuery(name),
            Some(_) => NameStatus::BundledQuery(name),
        }
    }

    /// Returns the effect that saves the statement, or `None` if the user must confirm or change the name.
    pub fn submit(&mut self, library: &QueryLibrary) -> Option<Effect> {
        let name = match self.name_status(library) {
            NameStatus::Invalid => return None,
            NameStatus::OwnQuery(name) | NameStatus::BundledQuery(name) if self.confirmed_name.as_ref() != Some(&name) => {
                self.confirmed_name = Some(name);
                return None;
            }
            NameStatus::Free(name) | NameStatus::OwnQuery(name) | NameStatus::BundledQuery(name) => name,
        };
        let title = self.field.text().trim().to_owned();
        Some(Effect::SaveQuery { name, title, sql: self.sql.clone() })
    }

    fn hint(&self, library: &QueryLibrary) -> (String, Role) {
        let again = |name: &str| self.confirmed_name.as_deref() == Some(name);
        match self.name_status(library) {
            NameStatus::Invalid if self.field.is_empty() => {
                ("Type a name for the statement at the cursor.".to_owned(), Role::Dim)
            }
            NameStatus::Invalid => {
                ("Use letters, digits, spaces, - and _ (at most 60 characters).".to_owned(), Role::Warning)
            }
            NameStatus::Free(name) => {
                (format!("Saves to queries/{name}.sql in your configuration."), Role::Dim)
            }
            NameStatus::OwnQuery(name) if again(&name) => {
                (format!("! {name} already exists. Press enter again to replace it."), Role::Warning)
            }
            NameStatus::OwnQuery(name) => {
                (format!("{name} already exists. Enter asks for confirmation."), Role::Warning)
            }
            NameStatus::BundledQuery(name) if again(&name) => {
                (format!("! {name} is a built-in query. Press enter again to override it."), Role::Warning)
            }
            NameStatus::BundledQuery(name) => {
                (format!("{name} is a built-in query. Enter asks for confirmation."), Role::Warning)
            }
        }
    }

    /// Draws the dialog over the screen.
    pub fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, library: &QueryLibrary, context: &ScreenContext<'_>) {
        let dialog_area = centered_rect(area, 72, 6);
        canvas.clear(dialog_area, Role::Text);
        canvas.clicks.clear();
        let inside = canvas.draw_pane_frame(dialog_area, "Save query as", "", true);
        let line = Rect { height: 1.min(inside.height), ..inside };
        self.field.draw(canvas, Rect { x: line.x + 1, width: line.width.saturating_sub(2), ..line });
        let (text, role) = self.hint(library);
        let below = Rect { y: inside.y + 2, height: inside.height.saturating_sub(2), ..line };
        let rows = novamind_tui::canvas::row_rects(Rect { height: inside.height.saturating_sub(2), ..below });
        for (row, line) in rows.zip(wrap(&text, inside.width.saturating_sub(2).into())) {
            canvas.draw_text(Rect { x: row.x + 1, width: row.width.saturating_sub(2), ..row }, &line, role);
        }
        canvas.draw_pane_keys(dialog_area, &context.hints(&[Action::Commit, Action::Discard]));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn taken_name_requires_confirmation() {
        let library = QueryLibrary::bundled();
        let mut saving = SaveQueryForm::new("-- title: Economy\nSELECT 1".to_owned());
        assert_eq!(saving.field.text(), "Economy");
        assert!(saving.submit(&library).is_none());
        assert!(saving.hint(&library).0.contains("enter again"));
        assert!(matches!(saving.submit(&library), Some(Effect::SaveQuery { name, .. }) if name == "economy"));
        saving.field = TextField::with_text("a/b");
        assert!(saving.submit(&library).is_none() && saving.hint(&library).0.starts_with("Use letters"));
        saving.field = TextField::with_text("My own");
        let saved = saving.submit(&library);
        assert!(
            matches!(saved, Some(Effect::SaveQuery { name, title, .. }) if (name.as_str(), title.as_str()) == ("my-own", "My own"))
        );
    }
}
