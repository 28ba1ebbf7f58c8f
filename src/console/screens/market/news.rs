//! Press reports about competitors and the economy.

use std::sync::Arc;

use ratatui::layout::Rect;

use super::{Market, true_values};
use crate::action::{Action, Scope};
use crate::context::{Figure, ScreenContext};
use crate::effect::Effect;
use crate::screens::panes::{PaneBorder, Pane, PanePlacement};
use novamind_tui::canvas::Canvas;
use novamind_tui::text::format_count;
use novamind_tui::theme::Role;
use novamind_tui::widgets::{TableCell, TableColumn, Table};
use novamind_worker::company::DisplayedCompany;
use novamind_worker::posts::{Post, PostKind};

#[derive(Debug, Clone, PartialEq)]
pub struct CompetitorNews {
    pub post: Arc<Post>,
    pub competitor: Option<String>,
}

/// Returns the press reports, the newest first.
pub fn competitor_news(company: &DisplayedCompany) -> Vec<CompetitorNews> {
    let press = company.posts.iter().filter(|post| post.kind == PostKind::Press);
    let item = |post: &Arc<Post>| {
        let competitor_name = company.tool_limits.competitors.iter().find(|name| post.text.contains(name.as_str()));
        CompetitorNews { post: post.clone(), competitor: competitor_name.cloned() }
    };
    press.map(item).collect()
}

pub struct CompetitorNewsPane;

impl Pane<Market> for CompetitorNewsPane {
    fn table<'a>(&self, market: &'a Market) -> Option<&'a Table> {
        Some(&market.headlines)
    }

    fn table_name(&self) -> Option<&'static str> {
        Some("market.news")
    }

    fn table_mut<'a>(&self, market: &'a mut Market) -> Option<&'a mut Table> {
        Some(&mut market.headlines)
    }

    fn scopes(&self, market: &Market) -> Vec<Scope> {
        super::table_scopes(&market.headlines)
    }

    fn hints(&self, _: &Market) -> Vec<Action> {
        vec![Action::Open, Action::Filter, Action::FindGroup]
    }

    fn figure(&self, market: &Market, _: &ScreenContext<'_>) -> Option<Figure> {
        let item = selected(market)?;
        let number = item.post.number;
        Some(Figure {
            title: format!("news #{number}"),
            term: if item.competitor.is_some() { "competitor" } else { "press" },
            sql: Some(format!("SELECT * FROM social_media_posts WHERE post_id = {number}")),
            week_quantity: None,
        })
    }

    fn handle_action(&self, market: &mut Market, action: Action, context: &ScreenContext<'_>) -> Vec<Effect> {
        if action == Action::Open {
            let read = |item: &CompetitorNews| {
                Effect::ShowText(format!("day {} · press", item.post.day), item.post.text.clone())
            };
            return selected(market).map(read).into_iter().collect();
        }
        super::move_in_table(&mut market.headlines, action, context);
        Vec::new()
    }

    fn border(&self, market: &Market, _: Rect, context: &ScreenContext<'_>) -> PaneBorder {
        let note = match market.headlines.summary() {
            note if note.is_empty() => format_count(market.news.len() as f64, "item"),
            note => note,
        };
        let keys = match market.news.is_empty() {
            true => String::new(),
            false => context.hints(&[Action::Open, Action::Filter]),
        };
        PaneBorder { title: "Competitors and economy in the news".to_owned(), note, keys, ..PaneBorder::default() }
    }

    fn draw(&self, market: &Market, canvas: &mut Canvas<'_>, placement: PanePlacement, context: &ScreenContext<'_>) {
        let area = match &context.company.hidden_values {
            Some(hidden) => true_values::draw_lines_above(canvas, placement.area, &true_values::competitor_lines(hidden)),
            None => placement.area,
        };
        if market.news.is_empty() {
            canvas.draw_text(area, "No news yet", Role::Dim);
            return;
        }
        market.headlines.draw(canvas, area, placement.focused, placement.index);
    }
}

fn selected(market: &Market) -> Option<&CompetitorNews> {
    market.headlines.selected().and_then(|row| market.news.get(row))
}

pub fn columns() -> Vec<TableColumn> {
    vec![TableColumn::numeric("day"), TableColumn::text("about"), TableColumn::text("news").with_max_width(u16::MAX)]
}

pub fn news_row(item: &CompetitorNews) -> Vec<TableCell> {
    vec![
        TableCell::from_number(f64::from(item.post.day), item.post.day.to_string()).with_role(Role::Dim),
        TableCell::from_text(item.competitor.as_deref().unwrap_or("economy")).with_role(match item.competitor {
            Some(_) => Role::Strong,
            None => Role::Dim,
        }),
        TableCell::from_text(item.post.text.replace('\n', " ")),
    ]
}
