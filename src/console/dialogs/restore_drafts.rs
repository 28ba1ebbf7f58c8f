//! Dialog that offers to restore or discard the drafts that were unsent when the program stopped.

use ratatui::layout::Rect;
use ratatui::text::Line;

use super::{Dialog, DialogResponse};
use crate::action::{Action, Scope};
use crate::context::ScreenContext;
use crate::effect::Effect;
use novamind_tui::canvas::{Canvas, centered_rect, truncate_to_width};
use novamind_tui::text::wrap;
use novamind_tui::theme::Role;

const MAX_DIALOG_WIDTH: u16 = 76;

/// The dialog that offers to restore drafts.
pub struct RestoreDraftsDialog {
    texts: Vec<(String, String)>,
}

impl RestoreDraftsDialog {
    /// Opens the dialog with the recorded name and the text of each draft.
    pub fn new(texts: Vec<(String, String)>) -> RestoreDraftsDialog {
        RestoreDraftsDialog { texts }
    }
}

impl Dialog for RestoreDraftsDialog {
    fn record_name(&self) -> String {
        "restore texts".to_owned()
    }

    fn scopes(&self) -> Vec<Scope> {
        vec![Scope::Drafts]
    }

    fn hints(&self) -> Vec<Action> {
        vec![Action::RestoreDrafts, Action::DiscardDrafts]
    }

    fn handle_action(&mut self, action: Action, _: &ScreenContext<'_>) -> DialogResponse {
        match action {
            Action::RestoreDrafts => DialogResponse::confirm_with(vec![Effect::ResolveDraftOffer(true)]),
            Action::DiscardDrafts => DialogResponse::cancel_with(vec![Effect::ResolveDraftOffer(false)]),
            _ => DialogResponse::stay(),
        }
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, context: &ScreenContext<'_>) {
        let room = usize::from(area.height.saturating_sub(5)).max(1);
        let each = (room / self.texts.len().max(1)).saturating_sub(1).max(1);
        let width = usize::from(area.width.min(MAX_DIALOG_WIDTH).saturating_sub(4)).max(8);
        let mut lines = vec![Line::from(canvas.span("Unsent when the program last stopped:", Role::Text))];
        for (place, text) in &self.texts {
            lines.push(Line::from(canvas.span(truncate_to_width(place, width), Role::Header)));
            let shown = last_lines(text, width.saturating_sub(2), each).into_iter();
            lines.extend(shown.map(|line| Line::from(canvas.span(format!("  {line}"), Role::Text))));
        }
        let dialog_area = centered_rect(area, MAX_DIALOG_WIDTH, lines.len() as u16 + 2);
        canvas.clear(dialog_area, Role::Text);
        let inside = canvas.draw_pane_frame(dialog_area, "Unsent text", "", true);
        canvas.draw_lines(Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside }, &lines);
        let restore = context.keys.label(Action::RestoreDrafts).unwrap_or_default();
        let drop = context.keys.label(Action::DiscardDrafts).unwrap_or_default();
        canvas.draw_pane_keys(dialog_area, &format!("{restore} restore · {drop} discard"));
    }
}

/// Returns the last lines of a text, because the user was probably writing at its end.
fn last_lines(text: &str, width: usize, most: usize) -> Vec<String> {
    let lines: Vec<String> = wrap(text, width).into_iter().filter(|line| !line.trim().is_empty()).collect();
    let left_out = lines.len().saturating_sub(most);
    let mut shown = lines[left_out..].to_vec();
    if left_out > 0
        && let Some(first) = shown.first_mut()
    {
        let cut = wrap(first, width.saturating_sub(2)).pop().unwrap_or_default();
        *first = format!("… {cut}");
    }
    shown
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dialogs::dialog_text;
    use crate::test_kit::new_company;

    #[test]
    fn smallest_window_shows_the_end_of_every_draft() {
        let long = format!("{} stopped", "words of a reason ".repeat(60));
        let texts = vec![("rationale".to_owned(), long), ("notes".to_owned(), "one\ntwo".to_owned())];
        let dialog = RestoreDraftsDialog::new(texts);
        for (width, height) in [(60, 13), (80, 21), (120, 37)] {
            let shown = dialog_text(&dialog, &new_company(), width, height);
            for part in ["rationale", "stopped", "notes", "two", "restore"] {
                assert!(shown.contains(part), "{part}\n{shown}");
            }
        }
        assert_eq!(last_lines("aa bb cc dd", 5, 1), ["… dd"]);
        assert_eq!(last_lines("a b", 9, 3), ["a b"]);
    }
}
