//! Quality, plans, capacity, service, issues and R&D.

mod capacity;
mod issues;
pub mod model;
mod part;
mod plans;
mod quality;
mod research;
mod service;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;

use ratatui::layout::{Constraint, Layout, Rect};
use strum::VariantArray;

use self::model::{Ages, Day, PlanFacts, Project, ProjectOffer, Rung};
use self::part::ProductPart;
use super::ScreenState;
use super::panes::{Pane, Paned, draw_pane};
use crate::context::Look;
use novamind_database::Rows;
use novamind_report::plan_margins::Sales;
use novamind_session::Category;
use novamind_session::identifiers::Plan;
use novamind_tui::canvas::{Canvas, Click, rows_of};
use novamind_tui::theme::Role;
use novamind_worker::readings::Reading;

/// Panes in tab order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, VariantArray)]
pub enum ProductPane {
    /// Delivered quality by group.
    Quality,
    /// Costs and revenue of each plan.
    Plans,
    /// Capacity tiers, the most frequent decision.
    #[default]
    Capacity,
    /// Service measures by day.
    Service,
    /// Open issues by group and age.
    Issues,
    /// R&D projects, running and available.
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

    fn part(self) -> &'static dyn ProductPart {
        match self {
            ProductPane::Quality => &quality::Quality,
            ProductPane::Plans => &plans::Plans,
            ProductPane::Capacity => &capacity::Capacity,
            ProductPane::Service => &service::Service,
            ProductPane::Issues => &issues::Issues,
            ProductPane::Research => &research::Research,
        }
    }
}

/// The product screen.
#[derive(Default)]
pub struct Product {
    focus: ProductPane,
    /// Selected row of each pane.
    places: [usize; ProductPane::VARIANTS.len()],
    sales: Sales,
    plans: [PlanFacts; 3],
    rungs: Vec<Rung>,
    days: Vec<Day>,
    /// Open issues by group; `None` before they are read.
    issues: Option<BTreeMap<String, Ages>>,
    column: usize,
    projects: Vec<Project>,
    offers: Vec<ProjectOffer>,
    spent: research::Spent,
    /// Whether the selection was moved to the current capacity tier once.
    placed: bool,
}

impl Product {
    fn place(&self, pane: ProductPane) -> usize {
        self.places[pane as usize]
    }

    fn place_mut(&mut self, pane: ProductPane) -> &mut usize {
        &mut self.places[pane as usize]
    }

    fn plan(&self) -> Plan {
        Plan::ALL[self.column.min(Plan::ALL.len() - 1)]
    }

    fn move_focus(&mut self, forward: bool) {
        let panes = ProductPane::VARIANTS;
        let step = if forward { 1 } else { panes.len() - 1 };
        self.focus = panes[(self.focus as usize + step) % panes.len()];
    }
}

impl ScreenState for Product {
    fn readings(&self) -> &'static [Reading] {
        &[Reading::Service, Reading::Research, Reading::Subscribers, Reading::Usage, Reading::OpenIssues]
    }

    fn take(&mut self, reading: Reading, rows: &Rows, look: &Look<'_>) {
        match reading {
            Reading::Service => self.days = model::service(rows),
            Reading::Research => self.projects = model::projects(rows),
            Reading::Subscribers => self.sales.take_subscribers(rows),
            Reading::Usage => self.sales.take_usage(rows),
            Reading::OpenIssues => self.issues = Some(model::issues(rows)),
            _ => {}
        }
        self.plans = model::plans(&self.sales, look.company);
    }

    fn renew(&mut self, look: &Look<'_>) {
        let spent = |category| model::spent(&look.company.weeks, category);
        self.spent = research::Spent {
            development: spent(Category::Development),
            operations: spent(Category::Operations),
        };
        self.rungs = model::ladder(look.company);
        self.offers = model::offers(look.company);
        self.plans = model::plans(&self.sales, look.company);
        if !self.placed {
            let (_, set) = capacity::tiers(look.company, &self.days);
            let rung = self.rungs.iter().position(|rung| rung.tier == set);
            *self.place_mut(ProductPane::Capacity) = rung.unwrap_or(0);
            self.placed = true;
        }
    }
}

impl Paned for Product {
    type Name = ProductPane;

    fn panes(&self) -> &'static [ProductPane] {
        ProductPane::VARIANTS
    }

    fn pane(name: ProductPane) -> &'static dyn Pane<Product> {
        name.part()
    }

    fn focused(&self) -> ProductPane {
        self.focus
    }

    fn focus_on(&mut self, name: ProductPane) {
        self.focus = name;
    }

    fn arrange(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        if area.width >= 104 && area.height >= 32 {
            self.arrange_all(canvas, area, look);
        } else {
            self.arrange_one(canvas, area, look);
        }
    }
}

impl Product {
    /// Draws all panes in two columns.
    fn arrange_all(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        use ProductPane::{Capacity, Issues, Plans, Quality, Research, Service};
        let [left, right] = Layout::horizontal([Constraint::Percentage(48), Constraint::Min(0)]).areas(area);
        let rows = |pane: ProductPane| pane.part().rows(self, look.company) as u16;
        let quality = (rows(Quality) + 3).min(left.height / 3);
        let plans = (rows(Plans) + 3).min(left.height / 3 + 2);
        let [top, middle, bottom] =
            Layout::vertical([Constraint::Length(quality), Constraint::Length(plans), Constraint::Min(0)])
                .areas(left);
        for (pane, place) in [(Quality, top), (Plans, middle), (Research, bottom)] {
            draw_pane(self, pane, canvas, place, look);
        }
        let issues = (rows(Issues).max(1) + 4).min(right.height / 4);
        let [top, middle, bottom] =
            Layout::vertical([Constraint::Min(0), Constraint::Length(8), Constraint::Length(issues)])
                .areas(right);
        for (pane, place) in [(Capacity, top), (Service, middle), (Issues, bottom)] {
            draw_pane(self, pane, canvas, place, look);
        }
    }

    /// Draws one line per pane, with the focused pane below.
    fn arrange_one(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        let panes = ProductPane::VARIANTS;
        let lines = (panes.len() as u16).min(area.height / 3);
        let [list, below] = Layout::vertical([Constraint::Length(lines), Constraint::Min(0)]).areas(area);
        let from = (self.focus as usize + 1).saturating_sub(lines as usize);
        for (row, (number, pane)) in rows_of(list).zip(panes.iter().enumerate().skip(from)) {
            let (mark, role) = match *pane == self.focus {
                true => ("▸", Role::Title),
                false => (" ", Role::Text),
            };
            let head = format!("{mark} {:<9} ", pane.title());
            let room = usize::from(row.width).saturating_sub(head.chars().count());
            let text = head + &pane.part().summary(self, look.company, room);
            canvas.text(row, &text, role);
            canvas.click(row, Click::Pane(number));
        }
        draw_pane(self, self.focus, canvas, below, look);
    }
}
