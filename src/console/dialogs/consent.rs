//! What a participant agrees to before a session. The default is not to.

use ratatui::layout::Rect;

use super::reader::Reader;
use super::{Dialog, Outcome};
use crate::console::action::{Action, Scope};
use crate::console::canvas::Canvas;
use crate::console::effect::Effect;
use crate::console::screens::Look;
use crate::session::NewRun;

/// A text to agree to, and the run that begins then.
pub struct Consent {
    text: Reader,
    new: Option<NewRun>,
}

impl Consent {
    /// Asks for agreement.
    pub fn new(new: NewRun, text: &str) -> Consent {
        let asked = format!(
            "{}\n\n────\ny  I agree: the session begins\nesc  I do not: nothing is recorded",
            text.trim_end()
        );
        Consent { text: Reader::new("Before the session", asked), new: Some(new) }
    }
}

impl Dialog for Consent {
    fn scopes(&self) -> Vec<Scope> {
        vec![Scope::Dialog, Scope::List]
    }

    fn hints(&self) -> Vec<Action> {
        vec![Action::Confirm, Action::Cancel, Action::ScrollDown]
    }

    fn act(&mut self, action: Action, look: &Look<'_>) -> Outcome {
        match action {
            Action::Confirm => {
                let agreed = self.new.take().map(|new| NewRun { agreed: true, ..new });
                Outcome::close_with(agreed.map(|new| Effect::Create(Box::new(new))).into_iter().collect())
            }
            other => self.text.act(other, look),
        }
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        self.text.draw(canvas, area, look);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::console::test_kit::{company, dialog_picture, in_dialog};

    #[test]
    fn only_agreeing_begins_the_session() {
        let company = company();
        let asked = || Consent::new(NewRun::default(), "We keep what you do.\n\nYou can stop at any time.");
        let picture = dialog_picture(&asked(), &company, 60, 20);
        for part in
            ["Before the session", "We keep what you do.", "stop at any time", "y  I agree", "esc  I do not"]
        {
            assert!(picture.contains(part), "{part} is missing in\n{picture}");
        }
        for action in [Action::Cancel, Action::Close] {
            let outcome = in_dialog(&mut asked(), action, &company);
            assert!(outcome.close && outcome.effects.is_empty());
        }
        assert!(!in_dialog(&mut asked(), Action::ScrollDown, &company).close, "reading on is no answer");
        let outcome = in_dialog(&mut asked(), Action::Confirm, &company);
        assert!(outcome.close && matches!(&outcome.effects[..], [Effect::Create(new)] if new.agreed));
    }
}
