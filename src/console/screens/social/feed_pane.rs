//! The feed of posts by customers, the press and the player.

use ratatui::layout::Rect;

use super::feed::Post;
use super::{Social, wall};
use crate::action::{Action, Scope};
use crate::context::{Figure, Look};
use crate::effect::Effect;
use crate::screens::panes::{Border, Pane, Seat};
use novamind_tui::canvas::Canvas;
use novamind_tui::text::count;
use novamind_tui::theme::Role;
use novamind_tui::widgets::Field;

pub struct FeedPane;

impl Pane<Social> for FeedPane {
    fn scopes(&self, social: &Social) -> Vec<Scope> {
        if social.typing.is_some() { vec![Scope::Field] } else { vec![Scope::Social, Scope::List] }
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

    fn figure(&self, social: &Social, _: &Look<'_>) -> Option<Figure> {
        social.post().map(super::figure_of)
    }

    fn act(&self, social: &mut Social, action: Action, look: &Look<'_>) -> Vec<Effect> {
        let last = social.shown.len().saturating_sub(1);
        let (here, page) = (social.selected, usize::from(look.page.max(1)));
        match action {
            Action::Open => return social.open(social.post().cloned(), look.company),
            Action::Up => social.selected = here.saturating_sub(1),
            Action::Down => social.selected = (here + 1).min(last),
            Action::PageUp => social.selected = here.saturating_sub(page),
            Action::PageDown => social.selected = (here + page).min(last),
            Action::First => social.selected = 0,
            Action::Last => social.selected = last,
            Action::Filter => social.typing = Some(Field::of(social.filter.text.clone())),
            Action::Discard => {
                social.typing = None;
                social.filter.text.clear();
                social.refilter();
            }
            Action::Commit | Action::CommitDown | Action::CommitNext | Action::CommitPrevious => {
                social.typing = None;
            }
            Action::Close => {
                social.filter = super::Filter::default();
                social.refilter();
            }
            _ => {}
        }
        Vec::new()
    }

    fn filter(&self, social: &mut Social, edit: &mut dyn FnMut(&mut Field)) {
        if let Some(field) = &mut social.typing {
            edit(field);
            social.filter.text = field.text().to_owned();
            social.refilter();
        }
    }

    fn click(&self, social: &mut Social, row: usize, look: &Look<'_>) -> Vec<Effect> {
        let again = social.selected == row;
        social.selected = row.min(social.shown.len().saturating_sub(1));
        if again { self.act(social, Action::Open, look) } else { Vec::new() }
    }

    fn border(&self, social: &Social, _: Rect, look: &Look<'_>) -> Border {
        let filtered = social.filter.words();
        let note = match filtered.is_empty() {
            true => count(social.all.len() as f64, "post"),
            false => format!("{filtered}: {} of {}", social.shown.len(), social.all.len()),
        };
        let keys: &[Action] = match social.filter.thread {
            Some(_) => &[Action::Close, Action::Open, Action::Reply],
            None => &[Action::NextKind, Action::EarlierWeek, Action::LaterWeek, Action::Reply],
        };
        Border { title: "Feed".to_owned(), note, keys: look.hints(keys), ..Border::default() }
    }

    fn draw(&self, social: &Social, canvas: &mut Canvas<'_>, seat: Seat, look: &Look<'_>) {
        let mut inside = seat.area;
        if let Some(field) = social.typing.as_ref().filter(|_| inside.height > 1 && inside.width > 1) {
            let row = Rect { y: inside.bottom() - 1, height: 1, ..inside };
            canvas.text(row, "/", Role::Key);
            field.draw(canvas, Rect { x: row.x + 1, width: row.width - 1, ..row });
            inside.height -= 1;
        }
        if social.shown.is_empty() {
            let words = match social.all.is_empty() {
                true => "No posts yet. Run a week (n).".to_owned(),
                false => format!("No matching posts: {}", look.hint(Action::Close)),
            };
            canvas.text(inside, &words, Role::Text);
        }
        let posts: Vec<&Post> =
            social.shown.iter().filter_map(|at| social.all.get(*at)).map(AsRef::as_ref).collect();
        wall::draw(canvas, Seat { area: inside, ..seat }, &posts, social.selected);
    }
}
