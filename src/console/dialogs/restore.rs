//! Texts that were typed when the program was stopped: back to where they were typed, or dropped.

use ratatui::layout::Rect;
use ratatui::text::Line;

use super::{Dialog, Outcome};
use crate::console::action::{Action, Scope};
use crate::console::canvas::{Canvas, centered, fit};
use crate::console::effect::Effect;
use crate::console::screens::Look;
use crate::console::theme::Role;

/// The offer.
pub struct Restore {
    /// Place and text of each.
    texts: Vec<(String, String)>,
}

impl Restore {
    /// Offers texts with their places.
    pub fn new(texts: Vec<(String, String)>) -> Restore {
        Restore { texts }
    }
}

impl Dialog for Restore {
    fn what(&self) -> String {
        "restore texts".to_owned()
    }

    fn scopes(&self) -> Vec<Scope> {
        vec![Scope::Unsent]
    }

    fn hints(&self) -> Vec<Action> {
        vec![Action::RestoreTexts, Action::DropTexts]
    }

    fn act(&mut self, action: Action, _: &Look<'_>) -> Outcome {
        match action {
            Action::RestoreTexts => Outcome::close_with(vec![Effect::SettleOffer(true)]),
            Action::DropTexts => Outcome::leave_with(vec![Effect::SettleOffer(false)]),
            _ => Outcome::stay(),
        }
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        let own = centered(area, 76, self.texts.len() as u16 + 6);
        canvas.clear(own, Role::Text);
        let inside = canvas.pane(own, "Unsent text", "", true);
        let inside = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside };
        let width = usize::from(inside.width);
        let mut lines = vec![
            Line::from(canvas.span("Not sent when the program last stopped:", Role::Text)),
            Line::default(),
        ];
        for (place, text) in &self.texts {
            let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
            lines.push(Line::from(canvas.span(fit(&format!("{place}: {text}"), width), Role::Header)));
        }
        canvas.lines(inside, &lines);
        let restore = look.keys.label(Action::RestoreTexts).unwrap_or_default();
        let drop = look.keys.label(Action::DropTexts).unwrap_or_default();
        canvas.pane_keys(own, &format!("{restore} restore · {drop} drop"));
    }
}
