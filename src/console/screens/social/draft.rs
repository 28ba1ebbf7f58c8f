//! The editor for the next post of the company.

use crossterm::event::{KeyCode, KeyEvent};
use ratatui::layout::Rect;

use super::{POST_TOOL, Social, SocialPane};
use crate::action::{Action, Scope};
use crate::context::{EditorDocument, Figure, ScreenContext};
use crate::effect::Effect;
use crate::screens::panes::{PaneBorder, Pane, PanePlacement, draw_framed};
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
            false => vec![Action::Compose, Action::SendPost, Action::ClearReply],
        }
    }

    fn figure(&self, _: &Social, _: &ScreenContext<'_>) -> Option<Figure> {
        Some(Figure { title: "your post".to_owned(), term: POST_TOOL.name(), sql: None, week_quantity: None })
    }

    fn handle_action(&self, social: &mut Social, action: Action, context: &ScreenContext<'_>) -> Vec<Effect> {
        match action {
            Action::Open => social.editing = true,
            Action::Close => social.focus = SocialPane::Feed,
            _ => social.draft.scroll(action, context.page_rows.into()),
        }
        Vec::new()
    }

    fn handle_key(&self, social: &mut Social, key: &KeyEvent, _: &ScreenContext<'_>) -> Vec<Effect> {
        match key.code {
            _ if !social.editing => {}
            // A post has no indentation, so tab moves the focus.
            KeyCode::Tab => return vec![Effect::Execute(Action::FocusNext)],
            KeyCode::BackTab => return vec![Effect::Execute(Action::FocusPrevious)],
            _ => social.draft.handle_key(key),
        }
        Vec::new()
    }

    fn paste(&self, social: &mut Social, text: &str, _: &ScreenContext<'_>) -> Vec<Effect> {
        if social.editing {
            social.draft.insert(text);
        }
        Vec::new()
    }

    fn editor_document(&self, social: &Social) -> Option<EditorDocument> {
        Some(EditorDocument { text: social.draft.text(), extension: "md" })
    }

    fn replace_document(&self, social: &mut Social, text: &str) -> Vec<Effect> {
        social.draft.set_text(text);
        Vec::new()
    }

    fn handle_click(&self, social: &mut Social, _: usize, context: &ScreenContext<'_>) -> Vec<Effect> {
        self.handle_action(social, Action::Open, context)
    }

    fn border(&self, social: &Social, _: Rect, context: &ScreenContext<'_>) -> PaneBorder {
        let title = match (social.reply_to, social.has_posted_this_week()) {
            (Some(post), _) => format!("Reply to #{post}"),
            (None, true) => "New post · 1 of 1 this week".to_owned(),
            (None, false) => "New post · 0 of 1 this week".to_owned(),
        };
        let keys: &[Action] = match (social.focus, social.editing, social.reply_to) {
            (SocialPane::Draft, true, _) => &[Action::SendPost, Action::LeaveEditor],
            (SocialPane::Draft, false, Some(_)) => &[Action::Compose, Action::SendPost, Action::ClearReply],
            (SocialPane::Draft, false, None) => &[Action::Compose, Action::SendPost],
            _ => &[Action::Compose],
        };
        PaneBorder { title, note: length_text(social, context), keys: context.hints(keys), shows_keys_always: true }
    }

    fn draw(&self, social: &Social, canvas: &mut Canvas<'_>, placement: PanePlacement, context: &ScreenContext<'_>) {
        let key = context.keys.label(Action::Compose).unwrap_or_default();
        let hint = match social.has_posted_this_week() {
            true => "This week's post is published. Write the next one next week.".to_owned(),
            false => format!("Write a post with {key}. One post per week; every known group reads it."),
        };
        if placement.focused {
            canvas.page_rows = placement.area.height.max(1);
        }
        social.draft.draw(canvas, placement.area, social.editing, &hint);
    }

    /// Draws the length of the post in the warning style if the post is too long.
    fn draw_with_border(&self, social: &Social, canvas: &mut Canvas<'_>, placement: PanePlacement, context: &ScreenContext<'_>) {
        let area = placement.area;
        if area.height < 3 {
            return;
        }
        draw_framed(self, social, canvas, placement, context);
        if social.draft_length() > context.company.tool_limits.post_characters && area.width > 8 {
            let width = (length_text(social, context).chars().count() as u16 + 1).min(area.width - 3);
            let row = Rect { x: area.right() - 2 - width, width, height: 1, ..area };
            canvas.buffer.set_style(row.intersection(canvas.area()), canvas.theme.style(Role::Bad));
        }
    }
}

fn length_text(social: &Social, context: &ScreenContext<'_>) -> String {
    let (length, most) = (social.draft_length(), context.company.tool_limits.post_characters);
    match length > most {
        true => format!("! {length} of {most} characters: {} too many", length - most),
        false => format!("{length} of {most} characters"),
    }
}
