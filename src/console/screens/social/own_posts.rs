//! Table of the player's posts with views and comments.

use ratatui::layout::Rect;

use super::Social;
use crate::action::{Action, Scope};
use crate::context::{Figure, ScreenContext};
use crate::effect::Effect;
use crate::screens::panes::{PaneBorder, Pane, PanePlacement};
use novamind_base::formatting::grouped_number;
use novamind_tui::canvas::Canvas;
use novamind_tui::theme::Role;
use novamind_tui::widgets::Table;

pub struct OwnPostsPane;

impl Pane<Social> for OwnPostsPane {
    fn table<'a>(&self, social: &'a Social) -> Option<&'a Table> {
        Some(&social.table)
    }

    fn table_name(&self) -> Option<&'static str> {
        Some("social.posts")
    }

    fn table_mut<'a>(&self, social: &'a mut Social) -> Option<&'a mut Table> {
        Some(&mut social.table)
    }

    fn scopes(&self, social: &Social) -> Vec<Scope> {
        if social.table.is_filter_open() { vec![Scope::Field] } else { vec![Scope::Social, Scope::List] }
    }

    fn hints(&self, _: &Social) -> Vec<Action> {
        vec![Action::Open, Action::Compose, Action::Sort, Action::Filter]
    }

    fn figure(&self, social: &Social, _: &ScreenContext<'_>) -> Option<Figure> {
        let post = social.selected_own_post()?;
        if social.table.selected_column() != 2 {
            return Some(super::post_figure(post));
        }
        let number = post.number;
        let sql = format!(
            "SELECT post_id, day, content FROM social_media_posts WHERE reply_to_agent_post_id = {number}"
        );
        Some(Figure {
            title: format!("comments on your post {number}"),
            term: "comment",
            sql: Some(sql),
            week_quantity: None,
        })
    }

    fn handle_action(&self, social: &mut Social, action: Action, context: &ScreenContext<'_>) -> Vec<Effect> {
        let action = match action {
            Action::Open => return social.open_post(social.selected_own_post().cloned(), context.company),
            // In this pane, tab and shift-tab accept the filter text.
            Action::CommitNext | Action::CommitPrevious => Action::Commit,
            other => other,
        };
        social.table.handle_action(action, context.page_rows);
        Vec::new()
    }

    fn border(&self, social: &Social, _: Rect, context: &ScreenContext<'_>) -> PaneBorder {
        let views: u32 = social.own_posts.iter().map(|post| post.views).sum();
        let note = match social.table.summary() {
            note if !note.is_empty() => note,
            _ if social.own_posts.is_empty() => String::new(),
            _ => format!("{} · {} views", social.own_posts.len(), grouped_number(f64::from(views), 0)),
        };
        let keys = match social.own_posts.is_empty() {
            true => String::new(),
            false => context.hints(&[Action::Open, Action::Sort, Action::Filter]),
        };
        PaneBorder { title: "Your posts".to_owned(), note, keys, ..PaneBorder::default() }
    }

    fn draw(&self, social: &Social, canvas: &mut Canvas<'_>, placement: PanePlacement, context: &ScreenContext<'_>) {
        if social.own_posts.is_empty() {
            let key = context.keys.label(Action::Compose).unwrap_or_default();
            canvas.draw_text(placement.area, &format!("No posts yet. Write one with {key}."), Role::Dim);
            return;
        }
        social.table.draw(canvas, placement.area, placement.focused, placement.index);
    }
}
