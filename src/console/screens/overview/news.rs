//! News since the last week: completed projects and studies, publications and posts.

use ratatui::layout::Rect;

use super::Overview;
use super::linked_rows::{self, LinkedRow, move_selection};
use crate::action::Action;
use crate::context::{Figure, ScreenContext, ScreenId};
use crate::effect::Effect;
use crate::screens::panes::{PaneBorder, Pane, PanePlacement};
use crate::screens::product::model::Project;
use novamind_base::formatting::{grouped_number, quality_change};
use novamind_database::{QueryResult, text_at};
use novamind_tui::canvas::Canvas;
use novamind_tui::theme::Role;
use novamind_worker::company::DisplayedCompany;
use novamind_worker::posts::PostKind as Author;

pub struct NewsPane;

impl Pane<Overview> for NewsPane {
    fn hints(&self, _: &Overview) -> Vec<Action> {
        vec![Action::Open]
    }

    fn figure(&self, overview: &Overview, context: &ScreenContext<'_>) -> Option<Figure> {
        overview.news.get(overview.selected_item).map(|item| item.figure(context.company.observation.day))
    }

    fn handle_action(&self, overview: &mut Overview, action: Action, _: &ScreenContext<'_>) -> Vec<Effect> {
        if action == Action::Open {
            return overview.news.get(overview.selected_item).map(NewsItem::effect).into_iter().collect();
        }
        move_selection(&mut overview.selected_item, overview.news.len(), action);
        Vec::new()
    }

    fn handle_click(&self, overview: &mut Overview, row: usize, context: &ScreenContext<'_>) -> Vec<Effect> {
        let again = overview.selected_item == row;
        overview.selected_item = row.min(overview.news.len().saturating_sub(1));
        if again { self.handle_action(overview, Action::Open, context) } else { Vec::new() }
    }

    fn border(&self, _: &Overview, _: Rect, _: &ScreenContext<'_>) -> PaneBorder {
        PaneBorder { title: "New this week".to_owned(), ..PaneBorder::default() }
    }

    fn draw(&self, overview: &Overview, canvas: &mut Canvas<'_>, placement: PanePlacement, _: &ScreenContext<'_>) {
        if overview.news.is_empty() {
            canvas.draw_text(placement.area, "nothing", Role::Dim);
        }
        let row = |item: &NewsItem| LinkedRow::new(item.screen(), item.text.clone(), false);
        let rows: Vec<LinkedRow> = overview.news.iter().map(row).collect();
        linked_rows::draw(canvas, placement, &rows, overview.selected_item);
    }
}

/// Kind of a news item, in display order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum NewsKind {
    Research,
    Study,
    Economy,
    Posts,
    Press,
}

#[derive(Debug, Clone, PartialEq)]
pub struct NewsItem {
    pub kind: NewsKind,
    pub text: String,
}

impl NewsItem {
    /// Returns the screen that shows details of the item.
    pub fn screen(&self) -> ScreenId {
        match self.kind {
            NewsKind::Research => ScreenId::Product,
            NewsKind::Study | NewsKind::Economy => ScreenId::Market,
            NewsKind::Posts | NewsKind::Press => ScreenId::Social,
        }
    }

    /// Returns the effect that opens details of the item.
    pub fn effect(&self) -> Effect {
        Effect::Show(self.screen())
    }

    /// Returns the figure of the item, with a query for its source rows.
    pub fn figure(&self, day: u32) -> Figure {
        let (term, sql) = match self.kind {
            NewsKind::Research => {
                ("research-project", "SELECT *\nFROM research_projects\nORDER BY started_day DESC".to_owned())
            }
            NewsKind::Study => {
                ("info-level", "SELECT *\nFROM group_info_levels\nWHERE info_level > 0".to_owned())
            }
            NewsKind::Economy => {
                ("pmi", "SELECT *\nFROM macroeconomic_conditions\nORDER BY day DESC".to_owned())
            }
            NewsKind::Posts | NewsKind::Press => (
                if self.kind == NewsKind::Press { "press" } else { "post" },
                format!(
                    "SELECT post_id, day, content\nFROM social_media_posts\nWHERE day BETWEEN {} AND {day}\nORDER BY post_id DESC",
                    day.saturating_sub(6)
                ),
            ),
        };
        Figure { title: self.text.clone(), term, sql: Some(sql), week_quantity: None }
    }
}

/// Returns the news items from the notifications of a week, the newest first.
pub fn notice_items(rows: &QueryResult) -> Vec<NewsItem> {
    let mut items = Vec::new();
    for row in &rows.rows {
        let kind = match text_at(row, 1) {
            "macro_economic_update" => NewsKind::Economy,
            "market_discovery" | "group_research_complete" => NewsKind::Study,
            "social_media" => NewsKind::Posts,
            _ => continue,
        };
        items.push(NewsItem { kind, text: text_at(row, 2).trim_end_matches('.').to_owned() });
    }
    items
}

/// Returns news items for the R&D projects that were completed in the last week.
pub fn research_items(projects: &[Project], day: u32) -> Vec<NewsItem> {
    let ended = |project: &&Project| project.done && project.expected_day + 7 > day && project.expected_day <= day;
    let words = |project: &Project| NewsItem {
        kind: NewsKind::Research,
        text: format!("R&D {} completed: {} quality for every group", project.id, quality_change(project.boost)),
    };
    projects.iter().filter(ended).map(words).collect()
}

/// Returns news items with the numbers of posts and press reports in the last week.
pub fn post_items(company: &DisplayedCompany) -> Vec<NewsItem> {
    let day = company.observation.day;
    // Counts the posts of the last week and of the four weeks before it.
    let (mut number, mut before, mut press) = (0u32, 0u32, 0u32);
    for post in company.posts.iter().take_while(|post| post.day + 35 > day) {
        let weeks = day.saturating_sub(post.day) / 7;
        match (post.kind, weeks) {
            (Author::Customers | Author::Public | Author::Comments, 0) => number += 1,
            (Author::Customers | Author::Public | Author::Comments, 1..=4) => before += 1,
            (Author::Press, 0) => press += 1,
            _ => {}
        }
    }
    // Early in a run, fewer than four weeks are available for the comparison.
    let weeks = (day / 7).saturating_sub(1).min(4);
    let usual = grouped_number(f64::from(before) / f64::from(weeks.max(1)), 0);
    let compared = match weeks {
        0 => String::new(),
        1 => format!(" ({usual} the week before)"),
        2 => format!(" (two-week average {usual})"),
        3 => format!(" (three-week average {usual})"),
        _ => format!(" (four-week average {usual})"),
    };
    let mut items = Vec::new();
    if number > 0 {
        let noun = if number == 1 { "post" } else { "posts" };
        items.push(NewsItem { kind: NewsKind::Posts, text: format!("{number} new {noun} about you{compared}") });
    }
    if press > 0 {
        let noun = if press == 1 { "news item" } else { "news items" };
        items.push(NewsItem {
            kind: NewsKind::Press,
            text: format!("{press} {noun} on competitors and the economy"),
        });
    }
    items
}
