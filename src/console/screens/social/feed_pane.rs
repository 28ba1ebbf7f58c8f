//! The pane with the feed of posts by customers, the press and the player.

use ratatui::layout::Rect;

use super::feed::Post;
use super::{Social, feed_rows};
use crate::action::{Action, Scope};
use crate::context::{Figure, ScreenContext};
use crate::effect::Effect;
use crate::screens::panes::{PaneBorder, Pane, PanePlacement};
use novamind_tui::canvas::Canvas;
use novamind_tui::text::format_count;
use novamind_tui::theme::Role;
use novamind_tui::widgets::TextField;

pub struct FeedPane;

impl Pane<Social> for FeedPane {
    fn scopes(&self, social: &Social) -> Vec<Scope> {
        if social.filter_field.is_some() { vec![Scope::Field] } else { vec![Scope::Social, Scope::List] }
    }

    fn hints(&self, _: &Social) -> Vec<Action> {
        vec![
            Action::Open,
            Action::Reply,
            Action::Compose,
            Action::Filter,
            Action::NextKind,
            Action::EarlierWeek,
        ]
    }

    fn figure(&self, social: &Social, _: &ScreenContext<'_>) -> Option<Figure> {
        social.selected_post().map(super::post_figure)
    }

    fn handle_action(&self, social: &mut Social, action: Action, context: &ScreenContext<'_>) -> Vec<Effect> {
        let last = social.visible_posts.len().saturating_sub(1);
        let (here, page) = (social.selected, usize::from(context.page_rows.max(1)));
        match action {
            Action::Open => return social.open_post(social.selected_post().cloned(), context.company),
            Action::Up => social.selected = here.saturating_sub(1),
            Action::Down => social.selected = (here + 1).min(last),
            Action::PageUp => social.selected = here.saturating_sub(page),
            Action::PageDown => social.selected = (here + page).min(last),
            Action::First => social.selected = 0,
            Action::Last => social.selected = last,
            Action::Filter => social.filter_field = Some(TextField::with_text(social.filter.text.clone())),
            Action::Discard => {
                social.filter_field = None;
                social.filter.text.clear();
                social.apply_filter();
            }
            Action::Commit | Action::CommitDown | Action::CommitNext | Action::CommitPrevious => {
                social.filter_field = None;
            }
            Action::Close => {
                social.filter = super::PostFilter::default();
                social.apply_filter();
            }
            _ => {}
        }
        Vec::new()
    }

    fn edit_filter(&self, social: &mut Social, edit: &mut dyn FnMut(&mut TextField)) {
        if let Some(field) = &mut social.filter_field {
            edit(field);
            social.filter.text = field.text().to_owned();
            social.apply_filter();
        }
    }

    fn handle_click(&self, social: &mut Social, row: usize, context: &ScreenContext<'_>) -> Vec<Effect> {
        let again = social.selected == row;
        social.selected = row.min(social.visible_posts.len().saturating_sub(1));
        if again { self.handle_action(social, Action::Open, context) } else { Vec::new() }
    }

    fn border(&self, social: &Social, _: Rect, context: &ScreenContext<'_>) -> PaneBorder {
        let filtered = social.filter.label();
        let note = match filtered.is_empty() {
            true => format_count(social.feed.len() as f64, "post"),
            false => format!("{filtered}: {} of {}", social.visible_posts.len(), social.feed.len()),
        };
        let keys: &[Action] = match social.filter.thread {
            Some(_) => &[Action::Close, Action::Open, Action::Reply],
            None => &[Action::NextKind, Action::EarlierWeek, Action::LaterWeek, Action::Reply],
        };
        PaneBorder { title: "Feed".to_owned(), note, keys: context.hints(keys), ..PaneBorder::default() }
    }

    fn draw(&self, social: &Social, canvas: &mut Canvas<'_>, placement: PanePlacement, context: &ScreenContext<'_>) {
        let mut inside = placement.area;
        if let Some(field) = social.filter_field.as_ref().filter(|_| inside.height > 1 && inside.width > 1) {
            let row = Rect { y: inside.bottom() - 1, height: 1, ..inside };
            canvas.draw_text(row, "/", Role::Key);
            field.draw(canvas, Rect { x: row.x + 1, width: row.width - 1, ..row });
            inside.height -= 1;
        }
        if social.visible_posts.is_empty() {
            let words = match social.feed.is_empty() {
                true => "No posts yet. Run a week (n).".to_owned(),
                false => format!("No matching posts: {}", context.hint(Action::Close)),
            };
            canvas.draw_text(inside, &words, Role::Text);
        }
        let posts: Vec<&Post> =
            social.visible_posts.iter().filter_map(|at| social.feed.get(*at)).map(AsRef::as_ref).collect();
        feed_rows::draw(canvas, PanePlacement { area: inside, ..placement }, &posts, social.selected);
    }
}
