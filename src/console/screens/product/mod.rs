//! Quality, plans, capacity, service, issues and R&D.

mod capacity;
mod figure;
mod issues;
pub mod model;
mod plans;
mod research;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;

use ratatui::layout::{Constraint, Layout, Rect};
use serde_json::json;

use self::model::{Ages, Day, Offer, PlanFacts, Project, Rung, Sales};
use super::{Figure, Look, Screen};
use crate::console::action::{Action, Scope};
use crate::console::canvas::{Canvas, Click, rows_of};
use crate::console::company::Company;
use crate::console::effect::Effect;
use crate::console::readings::Reading;
use crate::console::text::count;
use crate::console::theme::Role;
use crate::notation::percent;
use crate::session::{Category, Rows};
use crate::tools::ToolId;
use crate::world::identifiers::Plan;

/// Panes, with their titles.
const PANES: [&str; 6] = ["Quality", "Plans", "Capacity", "Service", "Issues", "R&D"];
const QUALITY: usize = 0;
const PLANS: usize = 1;
const CAPACITY: usize = 2;
const SERVICE: usize = 3;
const ISSUES: usize = 4;
const RESEARCH: usize = 5;

/// The screen.
#[derive(Default)]
pub struct Product {
    focus: Focus,
    /// Place in the list of each pane.
    places: [usize; PANES.len()],
    sales: Sales,
    plans: [PlanFacts; 3],
    rungs: Vec<Rung>,
    days: Vec<Day>,
    /// Open issues by group; none before they were read.
    issues: Option<BTreeMap<String, Ages>>,
    /// Plan of the selected figure.
    column: usize,
    projects: Vec<Project>,
    offers: Vec<Offer>,
    spent: research::Spent,
    /// The ladder was pointed at the tier in force.
    placed: bool,
}

/// The pane with the focus; capacity is what asks for a decision most often.
struct Focus(usize);

impl Default for Focus {
    fn default() -> Self {
        Focus(CAPACITY)
    }
}

impl Product {
    fn rows(&self, pane: usize, company: &Company) -> usize {
        match pane {
            QUALITY => company.quality.len(),
            PLANS => plans::FIGURES.len(),
            CAPACITY => self.rungs.len(),
            ISSUES => self.issues.as_ref().map_or(0, BTreeMap::len),
            RESEARCH => self.projects.len() + self.offers.len(),
            _ => 1,
        }
    }

    /// Leads to the very object that is selected: its cell, or the form with it proposed.
    fn open(&self, company: &Company) -> Vec<Effect> {
        let place = self.places[self.focus.0];
        let cell = |tool: ToolId, of: Option<String>| match of {
            Some(of) => Effect::ShowCell(tool, of),
            None => Effect::ShowTool(tool),
        };
        let tier = |tool: ToolId, tier: Option<u32>| match tier {
            Some(tier) => Effect::Prefill { tool, arguments: json!({ "tier": tier }) },
            None => Effect::ShowTool(tool),
        };
        vec![match self.focus.0 {
            QUALITY => {
                let group = company.quality.get(place).map(|quality| quality.group.to_string());
                cell(ToolId::SetTargetedDevSpend, group)
            }
            PLANS => cell(plans::tool_of(place), Some(Plan::ALL[self.column.min(2)].to_string())),
            CAPACITY => tier(ToolId::SetCapacityTier, self.rungs.get(place).map(|rung| rung.tier)),
            SERVICE => Effect::EditSql("SELECT * FROM service_day ORDER BY day DESC".to_owned()),
            ISSUES => {
                let group = self.issues.as_ref().and_then(|issues| issues.keys().nth(place));
                cell(ToolId::SetTargetedOpsSpend, group.map(ToString::to_string))
            }
            _ => {
                let offer = place.checked_sub(self.projects.len()).and_then(|at| self.offers.get(at));
                tier(ToolId::StartResearchProject, offer.map(|offer| offer.tier))
            }
        }]
    }

    fn opens(&self) -> &'static str {
        match self.focus.0 {
            QUALITY => "set_targeted_dev_spend",
            PLANS => plans::tool_of(self.places[PLANS]).name(),
            CAPACITY => "set_capacity_tier",
            SERVICE => "service_day",
            ISSUES => "set_targeted_ops_spend",
            _ => "start_research_project",
        }
    }
}

impl Screen for Product {
    fn scopes(&self) -> Vec<Scope> {
        vec![Scope::List]
    }

    fn hints(&self) -> Vec<Action> {
        vec![Action::FocusNext, Action::Open]
    }

    fn panes(&self) -> usize {
        PANES.len()
    }

    fn focus(&self) -> usize {
        self.focus.0
    }

    fn set_focus(&mut self, pane: usize) {
        self.focus = Focus(pane.min(PANES.len() - 1));
    }

    fn figure(&self, look: &Look<'_>) -> Option<Figure> {
        figure::of(self, look.company)
    }

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
        self.plans = self.sales.plans(look.company);
    }

    fn renew(&mut self, look: &Look<'_>) {
        let spent = |category| model::spent(&look.company.weeks, category);
        self.spent = research::Spent {
            development: spent(Category::Development),
            operations: spent(Category::Operations),
        };
        self.rungs = model::ladder(look.company);
        self.offers = model::offers(look.company);
        self.plans = self.sales.plans(look.company);
        if !self.placed {
            let (_, set) = capacity::tiers(look.company, &self.days);
            self.places[CAPACITY] = self.rungs.iter().position(|rung| rung.tier == set).unwrap_or(0);
            self.placed = true;
        }
    }

    fn act(&mut self, action: Action, look: &Look<'_>) -> Vec<Effect> {
        let last = self.rows(self.focus.0, look.company).saturating_sub(1);
        let page = look.page.max(1) as usize;
        let place = &mut self.places[self.focus.0];
        match action {
            Action::Up => *place = place.saturating_sub(1),
            Action::Down => *place = (*place + 1).min(last),
            Action::PageUp => *place = place.saturating_sub(page),
            Action::PageDown => *place = (*place + page).min(last),
            Action::First => *place = 0,
            Action::Last => *place = last,
            Action::Left if self.focus.0 == PLANS && self.column > 0 => self.column -= 1,
            Action::Right if self.focus.0 == PLANS && self.column < 2 => self.column += 1,
            Action::Left => self.set_focus((self.focus.0 + PANES.len() - 1) % PANES.len()),
            Action::Right => self.set_focus((self.focus.0 + 1) % PANES.len()),
            Action::Open => return self.open(look.company),
            _ => {}
        }
        Vec::new()
    }

    fn click(&mut self, pane: usize, row: usize, look: &Look<'_>) -> Vec<Effect> {
        let Some(place) = self.places.get_mut(pane) else { return Vec::new() };
        let again = *place == row;
        *place = row;
        if again { self.act(Action::Open, look) } else { Vec::new() }
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        if canvas.zoomed {
            self.draw_pane(canvas, area, self.focus.0, look);
        } else if area.width >= 104 && area.height >= 32 {
            self.draw_all(canvas, area, look);
        } else {
            self.draw_one(canvas, area, look);
        }
    }
}

impl Product {
    /// Every pane at once, in two columns.
    fn draw_all(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        let [left, right] = Layout::horizontal([Constraint::Percentage(48), Constraint::Min(0)]).areas(area);
        let quality = (look.company.quality.len() as u16 + 3).min(left.height / 3);
        let figures = (plans::FIGURES.len() as u16 + 3).min(left.height / 3 + 2);
        let [top, middle, bottom] =
            Layout::vertical([Constraint::Length(quality), Constraint::Length(figures), Constraint::Min(0)])
                .areas(left);
        for (pane, place) in [(QUALITY, top), (PLANS, middle), (RESEARCH, bottom)] {
            self.draw_pane(canvas, place, pane, look);
        }
        let groups = self.issues.as_ref().map_or(0, BTreeMap::len) as u16;
        let issues = (groups.max(1) + 4).min(right.height / 4);
        let [top, middle, bottom] =
            Layout::vertical([Constraint::Min(0), Constraint::Length(8), Constraint::Length(issues)])
                .areas(right);
        for (pane, place) in [(CAPACITY, top), (SERVICE, middle), (ISSUES, bottom)] {
            self.draw_pane(canvas, place, pane, look);
        }
    }

    /// A line on every pane, and the one with the focus below.
    fn draw_one(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        let lines = (PANES.len() as u16).min(area.height / 3);
        let [list, below] = Layout::vertical([Constraint::Length(lines), Constraint::Min(0)]).areas(area);
        let from = (self.focus.0 + 1).saturating_sub(lines as usize);
        for (row, pane) in rows_of(list).zip(from..PANES.len()) {
            let (mark, role) = match pane == self.focus.0 {
                true => ("▸", Role::Title),
                false => (" ", Role::Text),
            };
            let text = format!("{mark} {:<9} {}", PANES[pane], self.summary(pane, look.company));
            canvas.text(row, &text, role);
            canvas.click(row, Click::Pane(pane));
        }
        self.draw_pane(canvas, below, self.focus.0, look);
    }

    fn summary(&self, pane: usize, company: &Company) -> String {
        match pane {
            QUALITY => {
                let (base, shared) = company.quality_base;
                let best = company
                    .quality
                    .iter()
                    .max_by(|left, right| left.group_bonus.total_cmp(&right.group_bonus));
                let best = best.filter(|best| best.group_bonus > 0.0);
                let best = best
                    .map_or(String::new(), |best| format!(" · {} {:+.4}", best.group.id(), best.group_bonus));
                format!("base {base:.2} · general {shared:+.4}{best}")
            }
            PLANS => {
                let plan = |(name, plan): (char, &PlanFacts)| {
                    let margin = plan.margin().map_or("–".to_owned(), |margin| percent(margin, 0));
                    format!("{name} {}, margin {margin}", count(plan.customers, "customer"))
                };
                ['A', 'B', 'C'].into_iter().zip(&self.plans).map(plan).collect::<Vec<_>>().join(" · ")
            }
            CAPACITY => capacity::summary(company, &self.rungs, &self.days),
            SERVICE => capacity::service_summary(&self.days),
            ISSUES => issues::summary(self.issues.as_ref()),
            _ => research::summary(&self.projects),
        }
    }

    fn draw_pane(&self, canvas: &mut Canvas<'_>, area: Rect, pane: usize, look: &Look<'_>) {
        canvas.click(area, Click::Pane(pane));
        let (company, focused) = (look.company, self.focus.0 == pane);
        let note = match pane {
            PLANS => "last day's usage, 30 days a month".to_owned(),
            RESEARCH if focused => summary_of_cash(company),
            pane => self.summary(pane, company),
        };
        let inside = canvas.pane(area, PANES[pane], &note, focused);
        let place = self.places[pane];
        match pane {
            QUALITY => plans::draw_quality(canvas, inside, company, place, focused, pane),
            PLANS => plans::draw_plans(canvas, inside, &self.plans, (place, self.column), focused, pane),
            CAPACITY => {
                capacity::draw(canvas, inside, company, &self.rungs, &self.days, place, focused, pane);
            }
            SERVICE => capacity::draw_service(canvas, inside, &self.days),
            ISSUES => {
                let issues = self.issues.as_ref();
                let list = issues::List { issues, selected: place, focused, pane };
                issues::draw(canvas, inside, &list);
            }
            _ => research::draw(
                canvas,
                inside,
                company,
                &self.projects,
                &self.offers,
                &self.spent,
                place,
                focused,
                pane,
            ),
        }
        if focused {
            let open = look.keys.label(Action::Open).unwrap_or_default();
            canvas.pane_keys(area, &format!("{open} {}", self.opens()));
        }
    }
}

fn summary_of_cash(company: &Company) -> String {
    format!("{} to spend", crate::notation::dollars(company.seen.cash))
}
