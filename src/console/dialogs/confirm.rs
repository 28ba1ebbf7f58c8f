//! Confirmation before an irreversible action. The default is to cancel.

use ratatui::layout::Rect;
use ratatui::text::Line;

use super::{Dialog, DialogResponse};
use crate::action::{Action, Scope};
use crate::context::ScreenContext;
use crate::effect::Effect;
use novamind_base::formatting::pluralize;
use novamind_tui::canvas::{Canvas, Click, centered_rect};
use novamind_tui::text::wrap;
use novamind_tui::theme::Role;

/// A dialog that asks for confirmation.
pub struct ConfirmDialog {
    title: String,
    text: String,
    effects: Vec<Effect>,
    /// A third answer and its effects.
    alternative: Option<(Action, Vec<Effect>)>,
}

impl ConfirmDialog {
    /// Returns a dialog that asks whether to execute effects.
    pub fn new(title: impl Into<String>, text: impl Into<String>, effects: Vec<Effect>) -> ConfirmDialog {
        ConfirmDialog { title: title.into(), text: text.into(), effects, alternative: None }
    }

    /// Adds a third answer, an action of lessons.
    pub fn with_alternative(self, action: Action, effects: Vec<Effect>) -> ConfirmDialog {
        ConfirmDialog { alternative: Some((action, effects)), ..self }
    }

    fn answer_actions(&self) -> Vec<Action> {
        let other = self.alternative.iter().map(|(action, _)| *action);
        std::iter::once(Action::Confirm).chain(other).chain([Action::Cancel]).collect()
    }
}

impl Dialog for ConfirmDialog {
    fn record_name(&self) -> String {
        format!("confirm {}", self.title)
    }

    fn scopes(&self) -> Vec<Scope> {
        match self.alternative {
            Some(_) => vec![Scope::Dialog, Scope::Lesson],
            None => vec![Scope::Dialog],
        }
    }

    fn hints(&self) -> Vec<Action> {
        self.answer_actions()
    }

    fn handle_action(&mut self, action: Action, context: &ScreenContext<'_>) -> DialogResponse {
        match (action, &mut self.alternative) {
            (Action::Confirm, _) => DialogResponse::confirm_with(std::mem::take(&mut self.effects)),
            // The status message informs a user who pressed a wrong key.
            (Action::Cancel, _) => {
                let yes = context.keys.label(Action::Confirm).unwrap_or_default();
                let text = format!("{}: cancelled; {yes} confirms", self.title);
                DialogResponse::cancel_with(vec![Effect::ShowStatus(text)])
            }
            (action, Some((other, effects))) if action == *other => {
                DialogResponse::confirm_with(std::mem::take(effects))
            }
            _ => DialogResponse::stay(),
        }
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, context: &ScreenContext<'_>) {
        let mut lines = wrap(&self.text, 56);
        let dialog_area = centered_rect(area, 60, lines.len() as u16 + 4);
        // The answers are in the last row inside the border.
        let room = usize::from(dialog_area.height.saturating_sub(3));
        if lines.len() > room && room > 0 {
            let hidden = lines.len() - (room - 1);
            lines.truncate(room - 1);
            lines.push(format!("… {} in a larger window", pluralize(hidden as u32, "more line")));
        }
        canvas.clear(dialog_area, Role::Text);
        let inside = canvas.draw_pane_frame(dialog_area, &self.title, "", true);
        let shown: Vec<Line<'_>> =
            lines.iter().map(|line| Line::from(canvas.span(line.as_str(), Role::Text))).collect();
        canvas.draw_lines(Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside }, &shown);
        let row = Rect {
            y: inside.bottom().saturating_sub(1),
            height: 1,
            x: inside.x + 1,
            width: inside.width.saturating_sub(2),
        };
        for (at, action) in self.answer_actions().into_iter().enumerate() {
            let place = Rect { x: row.x + at as u16 * 14, width: 12.min(row.width), ..row };
            canvas.draw_text(place.intersection(row), &context.hint(action), Role::Key);
            canvas.register_click(place, Click::Command(action.into()));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dialogs::dialog_text;
    use crate::test_kit::new_company;

    #[test]
    fn enter_is_not_an_answer() {
        let keys = crate::keys::KeyBindings::bundled();
        let confirm = ConfirmDialog::new("lines", "Send?", Vec::new());
        let enter = novamind_tui::chord::Chord::parse("enter").expect("a key");
        assert_eq!(keys.action(&confirm.scopes(), enter), None);
    }

    #[test]
    fn long_texts_keep_the_answers_visible() {
        let text: Vec<String> = (1..=30).map(|line| format!("line {line}.")).collect();
        let confirm = ConfirmDialog::new("lines", text.join("\n"), Vec::new());
        let shown = dialog_text(&confirm, &new_company(), 60, 13);
        assert!(shown.contains("y yes") && shown.contains("more lines in a larger window"), "{shown}");
        assert!(shown.contains("line 9.") && !shown.contains("line 10."), "{shown}");
        let all = dialog_text(&confirm, &new_company(), 80, 40);
        assert!(all.contains("line 30.") && !all.contains("larger window"), "{all}");
    }
}
