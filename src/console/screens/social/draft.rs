//! Editor for the next post.

use crossterm::event::{KeyCode, KeyEvent};
use ratatui::layout::Rect;

use super::{POST, Social, SocialPane};
use crate::action::{Action, Scope};
use crate::context::{Figure, Look};
use crate::effect::Effect;
use crate::screens::panes::{Border, Pane, Seat, draw_framed};
use novamind_tui::canvas::Canvas;
use novamind_tui::theme::Role;

pub struct DraftPane;

impl Pane<Social> for DraftPane {
    fn scopes(&self, social: &Social) -> Vec<Scope> {
        if social.editing { vec![Scope::Editor, Scope::Social] } else { vec![Scope::Social, Scope::List] }
    }

    fn hints(&self, social: &Social) -> Vec<Action> {
        match social.editing {
            true => vec![Action::SendPost, Action::LeaveEditor],
            false => vec![Action::Compose, Action::SendPost, Action::Unreply],
        }
    }

    fn figure(&self, _: &Social, _: &Look<'_>) -> Option<Figure> {
        Some(Figure { title: "your post".to_owned(), term: POST.name(), sql: None, why: None })
    }

    fn act(&self, social: &mut Social, action: Action, _: &Look<'_>) -> Vec<Effect> {
        match action {
            Action::Open => social.editing = true,
            Action::Close => social.focus = SocialPane::Feed,
            _ => {}
        }
        Vec::new()
    }

    fn key(&self, social: &mut Social, key: &KeyEvent, _: &Look<'_>) -> Vec<Effect> {
        match key.code {
            _ if !social.editing => {}
            // A post has no columns, so tab moves the focus.
            KeyCode::Tab => return vec![Effect::Do(Action::FocusNext)],
            KeyCode::BackTab => return vec![Effect::Do(Action::FocusPrevious)],
            _ => social.draft.key(key),
        }
        Vec::new()
    }

    fn paste(&self, social: &mut Social, text: &str, _: &Look<'_>) -> Vec<Effect> {
        if social.editing {
            social.draft.insert(text);
        }
        Vec::new()
    }

    fn click(&self, social: &mut Social, _: usize, look: &Look<'_>) -> Vec<Effect> {
        self.act(social, Action::Open, look)
    }

    fn border(&self, social: &Social, _: Rect, look: &Look<'_>) -> Border {
        let title = match (social.answers, social.posted_this_week()) {
            (Some(post), _) => format!("Answer to #{post}"),
            (None, true) => "New post · 1 of 1 this week".to_owned(),
            (None, false) => "New post · 0 of 1 this week".to_owned(),
        };
        let keys: &[Action] = match (social.focus, social.editing, social.answers) {
            (SocialPane::Draft, true, _) => &[Action::SendPost, Action::LeaveEditor],
            (SocialPane::Draft, false, Some(_)) => &[Action::Compose, Action::SendPost, Action::Unreply],
            (SocialPane::Draft, false, None) => &[Action::Compose, Action::SendPost],
            _ => &[Action::Compose],
        };
        Border { title, note: length_words(social, look), keys: look.hints(keys), keys_always: true }
    }

    fn draw(&self, social: &Social, canvas: &mut Canvas<'_>, seat: Seat, look: &Look<'_>) {
        let key = look.keys.label(Action::Compose).unwrap_or_default();
        let hint = match social.posted_this_week() {
            true => "This week's post is published. Write the next one next week.".to_owned(),
            false => format!("Write a post with {key}. One a week, read by every known group."),
        };
        social.draft.draw(canvas, seat.area, social.editing, &hint);
    }

    /// Marks a post that is too long in the border.
    fn show(&self, social: &Social, canvas: &mut Canvas<'_>, seat: Seat, look: &Look<'_>) {
        let area = seat.area;
        if area.height < 3 {
            return;
        }
        draw_framed(self, social, canvas, seat, look);
        if social.length() > look.company.terms.post_characters && area.width > 8 {
            let width = (length_words(social, look).chars().count() as u16 + 1).min(area.width - 3);
            let row = Rect { x: area.right() - 2 - width, width, height: 1, ..area };
            canvas.buffer.set_style(row.intersection(canvas.area()), canvas.theme.style(Role::Bad));
        }
    }
}

fn length_words(social: &Social, look: &Look<'_>) -> String {
    let (length, most) = (social.length(), look.company.terms.post_characters);
    match length > most {
        true => format!("! {length} of {most} characters: {} too many", length - most),
        false => format!("{length} of {most} characters"),
    }
}
