//! The overview screen: cash with a fan of forecasts, items that need action, figures of the week, quality and news.

mod cash;
pub mod figures;
pub mod action_items;
mod news;
mod quality;
mod linked_rows;
#[cfg(test)]
mod tests;
mod trends;
mod week;

use ratatui::layout::{Constraint, Layout, Rect};
use strum::VariantArray;

use self::figures::METRICS;
use self::news::NewsItem;
use super::ScreenState;
use super::panes::{Pane, PaneScreen, draw_pane, draw_stack};
use super::product::model::{ServiceDay, parse_projects, parse_service_days};
use crate::action::Action;
use crate::context::ScreenContext;
use novamind_database::QueryResult;
use novamind_session::identifiers::Group;
use novamind_tui::canvas::Canvas;
use novamind_tui::widgets::Table;
use novamind_worker::company::DisplayedCompany;
use novamind_worker::screen_queries::Reading;

/// Panes of the overview in tab order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, VariantArray)]
pub enum OverviewPane {
    /// Items that need action.
    #[default]
    ActionItems,
    /// The figures of the week.
    Week,
    /// Delivered quality by group.
    Quality,
    /// Curve of cash by day.
    Cash,
    /// News of the week.
    News,
}

/// The overview screen.
#[derive(Default)]
pub struct Overview {
    focus: OverviewPane,
    selected_need: usize,
    week: Table,
    quality: Table,
    days: Vec<ServiceDay>,
    /// News items from the notifications in the database.
    notices: Vec<NewsItem>,
    research: Vec<NewsItem>,
    news: Vec<NewsItem>,
    selected_item: usize,
}

impl Overview {
    fn rebuild_news(&mut self, company: &DisplayedCompany) {
        self.news = self.research.iter().chain(&self.notices).cloned().collect();
        self.news.extend(news::post_items(company));
        self.news.sort_by_key(|item| item.kind);
        self.selected_item = self.selected_item.min(self.news.len().saturating_sub(1));
    }
}

impl ScreenState for Overview {
    fn selected_group(&self, context: &ScreenContext<'_>) -> Option<Group> {
        let row = self.quality.selected().filter(|_| self.focus == OverviewPane::Quality)?;
        context.company.quality.get(row).map(|delivered_quality| delivered_quality.group)
    }

    fn screen_queries(&self) -> &'static [Reading] {
        &[Reading::Service, Reading::WeekNotices, Reading::Research]
    }

    fn apply_rows(&mut self, reading: Reading, rows: &QueryResult, context: &ScreenContext<'_>) {
        match reading {
            Reading::Service => self.days = parse_service_days(rows),
            Reading::WeekNotices => self.notices = news::notice_items(rows),
            _ => self.research = news::research_items(&parse_projects(rows), context.company.observation.day),
        }
        self.rebuild_news(context.company);
    }

    fn on_company_change(&mut self, context: &ScreenContext<'_>) {
        let company = context.company;
        self.rebuild_news(company);
        self.selected_need = self.selected_need.min(company.action_items.len().saturating_sub(1));
        let rows = METRICS.iter().map(|metric| figures::metric_row(metric, company)).collect();
        let first = self.week.rows().is_empty();
        if first {
            self.week = Table::default().with_cell_selection();
            self.quality = Table::default().with_cell_selection();
        }
        self.week.set_columns_and_rows(figures::columns(), rows);
        let (columns, rows) = quality::quality_table(company);
        self.quality.set_columns_and_rows(columns, rows);
        if first {
            self.week.handle_action(Action::Right, 1);
            self.quality.handle_action(Action::Right, 1);
        }
    }
}

impl PaneScreen for Overview {
    type PaneId = OverviewPane;

    fn panes(&self) -> &'static [OverviewPane] {
        OverviewPane::VARIANTS
    }

    fn pane(name: OverviewPane) -> &'static dyn Pane<Overview> {
        match name {
            OverviewPane::ActionItems => &action_items::ActionItemsPane,
            OverviewPane::Week => &week::WeekPane,
            OverviewPane::Quality => &quality::QualityPane,
            OverviewPane::Cash => &cash::CashCurvePane,
            OverviewPane::News => &news::NewsPane,
        }
    }

    fn focused_pane(&self) -> OverviewPane {
        self.focus
    }

    fn set_focused_pane(&mut self, name: OverviewPane) {
        self.focus = name;
    }

    fn draw_panes(&self, canvas: &mut Canvas<'_>, area: Rect, context: &ScreenContext<'_>) {
        if area.width >= 104 {
            self.draw_wide_layout(canvas, area, context);
        } else {
            self.draw_small_layout(canvas, area, context);
        }
    }
}

impl Overview {
    fn draw_wide_layout(&self, canvas: &mut Canvas<'_>, area: Rect, context: &ScreenContext<'_>) {
        let [left, right] = Layout::horizontal([Constraint::Percentage(50), Constraint::Min(0)]).areas(area);
        let quality = (self.quality.rows().len() as u16 + 3).min(left.height / 2);
        // Usage has a separate chart if enough rows remain for cash.
        let usage = if left.height >= quality + 26 { (left.height - quality) * 2 / 5 } else { 0 };
        let [cash, used, below] =
            Layout::vertical([Constraint::Min(8), Constraint::Length(usage), Constraint::Length(quality)])
                .areas(left);
        draw_pane(self, OverviewPane::Cash, canvas, cash, context);
        if usage > 0 {
            trends::draw_usage(canvas, used, &self.days);
        }
        draw_pane(self, OverviewPane::Quality, canvas, below, context);
        let needs = action_items::pane_height(context.company, right.width, right.height / 3);
        let table = (METRICS.len() as u16 + 3).min(right.height.saturating_sub(needs));
        let left = right.height.saturating_sub(needs + table);
        let news = if left >= 3 { (self.news.len().max(1) as u16 + 2).min(left) } else { 0 };
        let charts = trends::charts_height(left - news);
        let [above, new, week, small] = Layout::vertical([
            Constraint::Length(needs),
            Constraint::Length(news),
            Constraint::Min(6),
            Constraint::Length(charts),
        ])
        .areas(right);
        draw_pane(self, OverviewPane::ActionItems, canvas, above, context);
        if news > 0 {
            draw_pane(self, OverviewPane::News, canvas, new, context);
        }
        draw_pane(self, OverviewPane::Week, canvas, week, context);
        trends::draw(canvas, small, context.company);
    }

    fn draw_small_layout(&self, canvas: &mut Canvas<'_>, area: Rect, context: &ScreenContext<'_>) {
        let needs = action_items::pane_height(context.company, area.width, area.height * 2 / 5);
        let [above, below] = Layout::vertical([Constraint::Length(needs), Constraint::Min(0)]).areas(area);
        draw_pane(self, OverviewPane::ActionItems, canvas, above, context);
        // The week pane needs space for the name and the value of each figure, and for its change.
        let left = 48.min(area.width * 3 / 5);
        let [week, side] = Layout::horizontal([Constraint::Length(left), Constraint::Min(0)]).areas(below);
        draw_pane(self, OverviewPane::Week, canvas, week, context);
        let stack = [OverviewPane::Cash, OverviewPane::Quality, OverviewPane::News];
        draw_stack(self, &stack, canvas, side, context);
    }
}
