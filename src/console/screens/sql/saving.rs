//! Dialog that saves a statement under a name.

use ratatui::layout::Rect;

use crate::action::Action;
use crate::context::Look;
use crate::effect::Effect;
use novamind_record::folder::library::{Head, Library, file_name};
use novamind_tui::canvas::{Canvas, centered};
use novamind_tui::text::wrapped;
use novamind_tui::theme::Role;
use novamind_tui::widgets::Field;

pub struct Saving {
    pub field: Field,
    sql: String,
    /// The existing name that the user was warned about.
    warned: Option<String>,
}

enum NameTaken {
    /// Not a valid name.
    Wrong,
    /// Unused.
    Free(String),
    /// A query of the user.
    Own(String),
    /// A bundled query.
    Shipped(String),
}

impl Saving {
    /// Opens the dialog with the title of the statement as default name.
    pub fn of(sql: String) -> Saving {
        let title = Head::of(&sql).title.unwrap_or_default();
        Saving { field: Field::to_replace(title), sql, warned: None }
    }

    fn place(&self, library: &Library) -> NameTaken {
        let Some(name) = file_name(self.field.text()) else { return NameTaken::Wrong };
        match library.find(&name) {
            None => NameTaken::Free(name),
            Some(query) if query.own => NameTaken::Own(name),
            Some(_) => NameTaken::Shipped(name),
        }
    }

    /// Saves the statement; returns `None` if the user must confirm or change the name.
    pub fn commit(&mut self, library: &Library) -> Option<Effect> {
        let name = match self.place(library) {
            NameTaken::Wrong => return None,
            NameTaken::Own(name) | NameTaken::Shipped(name) if self.warned.as_ref() != Some(&name) => {
                self.warned = Some(name);
                return None;
            }
            NameTaken::Free(name) | NameTaken::Own(name) | NameTaken::Shipped(name) => name,
        };
        let title = self.field.text().trim().to_owned();
        Some(Effect::SaveQuery { name, title, sql: self.sql.clone() })
    }

    fn remark(&self, library: &Library) -> (String, Role) {
        let again = |name: &str| self.warned.as_deref() == Some(name);
        match self.place(library) {
            NameTaken::Wrong if self.field.is_empty() => {
                ("Type a name for the statement at the cursor.".to_owned(), Role::Dim)
            }
            NameTaken::Wrong => {
                ("Use letters, digits, spaces, - and _ (at most 60 characters).".to_owned(), Role::Warning)
            }
            NameTaken::Free(name) => {
                (format!("Saved as queries/{name}.sql in your configuration."), Role::Dim)
            }
            NameTaken::Own(name) if again(&name) => {
                (format!("! {name} already exists. Press enter again to replace it."), Role::Warning)
            }
            NameTaken::Own(name) => {
                (format!("{name} already exists. Enter asks for confirmation."), Role::Warning)
            }
            NameTaken::Shipped(name) if again(&name) => {
                (format!("! {name} is a built-in query. Press enter again to override it."), Role::Warning)
            }
            NameTaken::Shipped(name) => {
                (format!("{name} is a built-in query. Enter asks for confirmation."), Role::Warning)
            }
        }
    }

    /// Draws the dialog over the screen.
    pub fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, library: &Library, look: &Look<'_>) {
        let own = centered(area, 72, 6);
        canvas.clear(own, Role::Text);
        canvas.clicks.clear();
        let inside = canvas.pane(own, "Save query as", "", true);
        let line = Rect { height: 1.min(inside.height), ..inside };
        self.field.draw(canvas, Rect { x: line.x + 1, width: line.width.saturating_sub(2), ..line });
        let (text, role) = self.remark(library);
        let below = Rect { y: inside.y + 2, height: inside.height.saturating_sub(2), ..line };
        let rows = novamind_tui::canvas::rows_of(Rect { height: inside.height.saturating_sub(2), ..below });
        for (row, line) in rows.zip(wrapped(&text, inside.width.saturating_sub(2).into())) {
            canvas.text(Rect { x: row.x + 1, width: row.width.saturating_sub(2), ..row }, &line, role);
        }
        canvas.pane_keys(own, &look.hints(&[Action::Commit, Action::Discard]));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_taken_name_is_asked_for_twice() {
        let library = Library::shipped();
        let mut saving = Saving::of("-- title: Economy\nSELECT 1".to_owned());
        assert_eq!(saving.field.text(), "Economy");
        assert!(saving.commit(&library).is_none());
        assert!(saving.remark(&library).0.contains("enter again"));
        assert!(matches!(saving.commit(&library), Some(Effect::SaveQuery { name, .. }) if name == "economy"));
        saving.field = Field::of("a/b");
        assert!(saving.commit(&library).is_none() && saving.remark(&library).0.starts_with("Use letters"));
        saving.field = Field::of("My own");
        let saved = saving.commit(&library);
        assert!(
            matches!(saved, Some(Effect::SaveQuery { name, title, .. }) if (name.as_str(), title.as_str()) == ("my-own", "My own"))
        );
    }
}
