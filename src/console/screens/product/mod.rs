//! The product screen: quality, plans, capacity, service, issues and R&D.

mod capacity;
mod issues;
pub mod model;
mod panel;
mod plans;
mod quality;
mod research;
mod service;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;

use ratatui::layout::{Constraint, Layout, Rect};
use strum::VariantArray;

use self::model::{IssueAges, ServiceDay, PlanFacts, Project, ProjectOffer, CapacityTier};
use self::panel::ProductPanel;
use super::ScreenState;
use super::panes::{Pane, PaneScreen, draw_pane};
use crate::context::ScreenContext;
use novamind_database::QueryResult;
use novamind_report::plan_margins::PlanSales;
use novamind_session::Category;
use novamind_session::identifiers::Plan;
use novamind_tui::canvas::{Canvas, Click, row_rects};
use novamind_tui::theme::Role;
use novamind_worker::screen_queries::Reading;

/// Panes of the product screen in tab order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, VariantArray)]
pub enum ProductPane {
    /// Delivered quality by group.
    Quality,
    /// Costs and revenue of each plan.
    Plans,
    /// Capacity tiers and their utilization.
    #[default]
    Capacity,
    /// Latency, error rate and outages by day.
    Service,
    /// Open issues by group and age.
    Issues,
    /// Running and available R&D projects.
    Research,
}

impl ProductPane {
    fn title(self) -> &'static str {
        match self {
            ProductPane::Quality => "Quality",
            ProductPane::Plans => "Plans",
            ProductPane::Capacity => "Capacity",
            ProductPane::Service => "Service",
            ProductPane::Issues => "Issues",
            ProductPane::Research => "R&D",
        }
    }

    fn panel(self) -> &'static dyn ProductPanel {
        match self {
            ProductPane::Quality => &quality::QualityComponentsPane,
            ProductPane::Plans => &plans::PlansPane,
            ProductPane::Capacity => &capacity::CapacityPane,
            ProductPane::Service => &service::ServicePane,
            ProductPane::Issues => &issues::IssuesPane,
            ProductPane::Research => &research::ResearchPane,
        }
    }
}

/// The product screen.
#[derive(Default)]
pub struct Product {
    focus: ProductPane,
    /// Index of the selected row in each pane.
    selected_rows: [usize; ProductPane::VARIANTS.len()],
    sales: PlanSales,
    plans: [PlanFacts; 3],
    capacity_tiers: Vec<CapacityTier>,
    days: Vec<ServiceDay>,
    /// Open issues by group, or `None` until they are read.
    issues: Option<BTreeMap<String, IssueAges>>,
    selected_plan: usize,
    projects: Vec<Project>,
    offers: Vec<ProjectOffer>,
    spending: research::QualitySpending,
    /// Whether the initial selection of the capacity pane was moved to the current tier.
    has_selected_current_tier: bool,
}

impl Product {
    fn selected_row(&self, pane: ProductPane) -> usize {
        self.selected_rows[pane as usize]
    }

    fn selected_row_mut(&mut self, pane: ProductPane) -> &mut usize {
        &mut self.selected_rows[pane as usize]
    }

    fn plan(&self) -> Plan {
        Plan::ALL[self.selected_plan.min(Plan::ALL.len() - 1)]
    }

    fn move_focus(&mut self, forward: bool) {
        let panes = ProductPane::VARIANTS;
        let step = if forward { 1 } else { panes.len() - 1 };
        self.focus = panes[(self.focus as usize + step) % panes.len()];
    }
}

impl ScreenState for Product {
    fn screen_queries(&self) -> &'static [Reading] {
        &[Reading::Service, Reading::Research, Reading::Subscribers, Reading::Usage, Reading::OpenIssues]
    }

    fn apply_rows(&mut self, reading: Reading, rows: &QueryResult, context: &ScreenContext<'_>) {
        match reading {
            Reading::Service => self.days = model::parse_service_days(rows),
            Reading::Research => self.projects = model::parse_projects(rows),
            Reading::Subscribers => self.sales.set_subscribers(rows),
            Reading::Usage => self.sales.set_usage(rows),
            Reading::OpenIssues => self.issues = Some(model::parse_issues(rows)),
            _ => {}
        }
        self.plans = model::plans(&self.sales, context.company);
    }

    fn on_company_change(&mut self, context: &ScreenContext<'_>) {
        let spent = |category| model::weekly_spending(&context.company.weeks, category);
        self.spending = research::QualitySpending {
            development: spent(Category::Development),
            operations: spent(Category::Operations),
        };
        self.capacity_tiers = model::capacity_tiers(context.company);
        self.offers = model::offers(context.company);
        self.plans = model::plans(&self.sales, context.company);
        if !self.has_selected_current_tier {
            let (_, set) = capacity::used_and_set_tiers(context.company, &self.days);
            let tier_index = self.capacity_tiers.iter().position(|tier_index| tier_index.tier == set);
            *self.selected_row_mut(ProductPane::Capacity) = tier_index.unwrap_or(0);
            self.has_selected_current_tier = true;
        }
    }
}

impl PaneScreen for Product {
    type PaneId = ProductPane;

    fn panes(&self) -> &'static [ProductPane] {
        ProductPane::VARIANTS
    }

    fn pane(name: ProductPane) -> &'static dyn Pane<Product> {
        name.panel()
    }

    fn focused_pane(&self) -> ProductPane {
        self.focus
    }

    fn set_focused_pane(&mut self, name: ProductPane) {
        self.focus = name;
    }

    fn draw_panes(&self, canvas: &mut Canvas<'_>, area: Rect, context: &ScreenContext<'_>) {
        if area.width >= 104 && area.height >= 32 {
            self.draw_wide_layout(canvas, area, context);
        } else {
            self.draw_small_layout(canvas, area, context);
        }
    }
}

impl Product {
    /// Draws all panes in two columns.
    fn draw_wide_layout(&self, canvas: &mut Canvas<'_>, area: Rect, context: &ScreenContext<'_>) {
        use ProductPane::{Capacity, Issues, Plans, Quality, Research, Service};
        let [left, right] = Layout::horizontal([Constraint::Percentage(48), Constraint::Min(0)]).areas(area);
        let rows = |pane: ProductPane| pane.panel().row_count(self, context.company) as u16;
        let quality = (rows(Quality) + 3).min(left.height / 3);
        let plans = (rows(Plans) + 3).min(left.height / 3 + 2);
        let [top, middle, bottom] =
            Layout::vertical([Constraint::Length(quality), Constraint::Length(plans), Constraint::Min(0)])
                .areas(left);
        for (pane, place) in [(Quality, top), (Plans, middle), (Research, bottom)] {
            draw_pane(self, pane, canvas, place, context);
        }
        let issues = (rows(Issues).max(1) + 4).min(right.height / 4);
        let [top, middle, bottom] =
            Layout::vertical([Constraint::Min(0), Constraint::Length(8), Constraint::Length(issues)])
                .areas(right);
        for (pane, place) in [(Capacity, top), (Service, middle), (Issues, bottom)] {
            draw_pane(self, pane, canvas, place, context);
        }
    }

    /// Draws one line per pane, with the focused pane below.
    fn draw_small_layout(&self, canvas: &mut Canvas<'_>, area: Rect, context: &ScreenContext<'_>) {
        let panes = ProductPane::VARIANTS;
        let lines = (panes.len() as u16).min(area.height / 3);
        let [list, below] = Layout::vertical([Constraint::Length(lines), Constraint::Min(0)]).areas(area);
        let from = (self.focus as usize + 1).saturating_sub(lines as usize);
        for (row, (number, pane)) in row_rects(list).zip(panes.iter().enumerate().skip(from)) {
            let (mark, role) = match *pane == self.focus {
                true => ("▸", Role::Title),
                false => (" ", Role::Text),
            };
            let head = format!("{mark} {:<9} ", pane.title());
            let room = usize::from(row.width).saturating_sub(head.chars().count());
            let text = head + &pane.panel().summary(self, context.company, room);
            canvas.draw_text(row, &text, role);
            canvas.register_click(row, Click::Pane(number));
        }
        draw_pane(self, self.focus, canvas, below, context);
    }
}
