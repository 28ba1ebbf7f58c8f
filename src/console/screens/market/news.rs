//! News of the press about competitors and the economy.

use std::sync::Arc;

use ratatui::layout::Rect;

use super::{Market, hidden};
use crate::action::{Action, Scope};
use crate::context::{Figure, Look};
use crate::effect::Effect;
use crate::screens::panes::{Border, Pane, Seat};
use novamind_tui::canvas::Canvas;
use novamind_tui::theme::Role;
use novamind_tui::widgets::{Cell, Column, Table};
use novamind_worker::company::Company;
use novamind_worker::posts::{Post, PostKind};

#[derive(Debug, Clone, PartialEq)]
pub struct RivalNews {
    pub post: Arc<Post>,
    pub rival: Option<String>,
}

/// Returns the news of the press, newest first.
pub fn of(company: &Company) -> Vec<RivalNews> {
    let press = company.posts.iter().filter(|post| post.kind == PostKind::Press);
    let item = |post: &Arc<Post>| {
        let rival = company.terms.rivals.iter().find(|name| post.text.contains(name.as_str()));
        RivalNews { post: post.clone(), rival: rival.cloned() }
    };
    press.map(item).collect()
}

pub struct RivalNewsPane;

impl Pane<Market> for RivalNewsPane {
    fn table<'a>(&self, market: &'a Market) -> Option<&'a Table> {
        Some(&market.headlines)
    }

    fn table_mut<'a>(&self, market: &'a mut Market) -> Option<&'a mut Table> {
        Some(&mut market.headlines)
    }

    fn scopes(&self, market: &Market) -> Vec<Scope> {
        super::scopes(&market.headlines)
    }

    fn hints(&self, _: &Market) -> Vec<Action> {
        vec![Action::Open, Action::Filter, Action::FindGroup]
    }

    fn figure(&self, market: &Market, _: &Look<'_>) -> Option<Figure> {
        let item = selected(market)?;
        let number = item.post.number;
        Some(Figure {
            title: format!("news #{number}"),
            term: if item.rival.is_some() { "competitor" } else { "press" },
            sql: Some(format!("SELECT * FROM social_media_posts WHERE post_id = {number}")),
            why: None,
        })
    }

    fn act(&self, market: &mut Market, action: Action, look: &Look<'_>) -> Vec<Effect> {
        if action == Action::Open {
            let read = |item: &RivalNews| {
                Effect::ShowText(format!("day {} · press", item.post.day), item.post.text.clone())
            };
            return selected(market).map(read).into_iter().collect();
        }
        super::walk(&mut market.headlines, action, look);
        Vec::new()
    }

    fn border(&self, market: &Market, _: Rect, look: &Look<'_>) -> Border {
        let note = match market.headlines.note() {
            note if note.is_empty() => format!("{} in the press", market.news.len()),
            note => note,
        };
        let keys = match market.news.is_empty() {
            true => String::new(),
            false => look.hints(&[Action::Open, Action::Filter]),
        };
        Border { title: "Competitors and economy in the news".to_owned(), note, keys, ..Border::default() }
    }

    fn draw(&self, market: &Market, canvas: &mut Canvas<'_>, seat: Seat, look: &Look<'_>) {
        let area = match &look.company.hidden {
            Some(hidden) => hidden::draw_above(canvas, seat.area, &hidden::of_rivals(hidden)),
            None => seat.area,
        };
        if market.news.is_empty() {
            canvas.text(area, "No news yet", Role::Dim);
            return;
        }
        market.headlines.draw(canvas, area, seat.focused, seat.number);
    }
}

fn selected(market: &Market) -> Option<&RivalNews> {
    market.headlines.selected().and_then(|row| market.news.get(row))
}

pub fn columns() -> Vec<Column> {
    vec![Column::numbers("day"), Column::words("about"), Column::words("news").at_most(u16::MAX)]
}

pub fn row_of(item: &RivalNews) -> Vec<Cell> {
    vec![
        Cell::number(f64::from(item.post.day), item.post.day.to_string()).role(Role::Dim),
        Cell::words(item.rival.as_deref().unwrap_or("economy")).role(match item.rival {
            Some(_) => Role::Strong,
            None => Role::Dim,
        }),
        Cell::words(item.post.text.replace('\n', " ")),
    ]
}
