//! Customer groups: a table, advertising results, and a detail view of each group.

mod cohorts;
mod columns;
pub mod costs;
mod facts;
mod fit;
mod groups;
mod heat;
mod hidden;
mod model;
mod opened;
mod quality;
mod steps;
mod study;
#[cfg(test)]
mod tests;
mod ways;
mod weeks;

use ratatui::layout::{Constraint, Layout, Rect};

use self::cohorts::Cohorts;
use self::columns::{columns, row_of};
use self::model::MarketRows;
use self::opened::Opened;
use super::ScreenState;
use super::panes::{Pane, Paned, draw_pane};
use crate::action::Action;
use crate::context::Look;
use crate::effect::Effect;
use novamind_database::Rows;
use novamind_session::identifiers::Group;
use novamind_tui::canvas::Canvas;
use novamind_tui::widgets::Table;
use novamind_worker::company::Company;
use novamind_worker::readings::Reading;

/// Panes of the screen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum CustomersPane {
    /// Table of the known groups.
    #[default]
    Groups,
    /// Leads per $1,000 by channel.
    Channels,
    /// Cost of leads and first bills by channel and group.
    Costs,
    /// Links from the open group to tools, its study and its customers.
    Ways,
    /// Estimated requirements next to the plans.
    Fit,
    /// Delivered and required quality by week.
    Quality,
    /// Facts about the group.
    Facts,
    /// Its weeks.
    Weeks,
    /// Retention by cohort.
    Cohorts,
    /// Estimates of its market study.
    Study,
}

/// Panes without an open group, then panes of an open group.
const LISTED: [CustomersPane; 3] = [CustomersPane::Groups, CustomersPane::Channels, CustomersPane::Costs];
const OPENED: [CustomersPane; 7] = [
    CustomersPane::Ways,
    CustomersPane::Fit,
    CustomersPane::Quality,
    CustomersPane::Facts,
    CustomersPane::Weeks,
    CustomersPane::Cohorts,
    CustomersPane::Study,
];

/// The customers screen.
#[derive(Default)]
pub struct Customers {
    /// Focused pane while no group is open.
    focus: CustomersPane,
    market: MarketRows,
    table: Table,
    costs: Table,
    place: heat::HeatPlace,
    cohorts: Cohorts,
    /// Index of the open group among the known ones.
    open: Option<usize>,
    opened: Opened,
}

impl Customers {
    /// Opens a group if it is known.
    pub fn show(&mut self, group: Group, company: &Company) {
        self.focus = CustomersPane::Groups;
        self.open = company.seen.known_groups.iter().position(|own| *own == group);
        self.opened = Opened::default();
        self.select_open();
    }

    /// Returns the open group, or the group selected in the list.
    fn group(&self, company: &Company) -> Option<Group> {
        company.seen.known_groups.get(self.open.or(self.table.selected())?).copied()
    }

    fn turn_to(&mut self, other: impl Fn(usize) -> usize, company: &Company) {
        let last = company.seen.known_groups.len().saturating_sub(1);
        self.open = self.open.map(|open| other(open).min(last));
        self.select_open();
    }

    fn select_open(&mut self) {
        if let Some(open) = self.open {
            self.table.select(open);
        }
    }

    fn is_on(&self, pane: CustomersPane) -> bool {
        self.focused() == pane
    }

    fn refresh(&mut self, company: &Company) {
        let groups = &company.seen.known_groups;
        let row = |group: &Group| row_of(*group, &self.market.of(*group), company, &self.market);
        let rows: Vec<_> = groups.iter().map(row).collect();
        if self.table.rows().is_empty() {
            self.table = Table::new(Vec::new()).by_cell();
        }
        self.table.set(columns(company), rows);
        self.costs.set(costs::columns(), company.lead_costs.iter().map(costs::row_of).collect());
        let last = groups.len().saturating_sub(1);
        self.open = self.open.map(|open| open.min(last)).filter(|_| !groups.is_empty());
        self.place.group = self.place.group.min(last);
    }
}

impl ScreenState for Customers {
    fn readings(&self) -> &'static [Reading] {
        &[
            Reading::Subscribers,
            Reading::Arrivals,
            Reading::Departures,
            Reading::LeadsByChannel,
            Reading::Usage,
            Reading::Cohorts,
        ]
    }

    fn take(&mut self, reading: Reading, rows: &Rows, look: &Look<'_>) {
        match reading {
            Reading::Cohorts => self.cohorts = Cohorts::of(rows),
            reading => self.market.take(reading, rows),
        }
        self.refresh(look.company);
    }

    fn renew(&mut self, look: &Look<'_>) {
        self.refresh(look.company);
    }

    fn open_here(&self, look: &Look<'_>) -> Option<String> {
        self.open.and_then(|_| self.group(look.company)).map(|group| group.to_string())
    }

    fn covers_list(&self) -> bool {
        self.open.is_some()
    }

    fn opened(&self) -> usize {
        usize::from(self.open.is_some())
    }

    fn open_object(&self, look: &Look<'_>) -> Option<(&'static str, String)> {
        let group = look.company.seen.known_groups.get(self.open?)?;
        Some(("group", group.id().to_owned()))
    }
}

impl Paned for Customers {
    type Name = CustomersPane;

    fn panes(&self) -> &'static [CustomersPane] {
        if self.open.is_some() { &OPENED } else { &LISTED }
    }

    fn pane(name: CustomersPane) -> &'static dyn Pane<Customers> {
        match name {
            CustomersPane::Groups => &groups::CustomerGroupsPane,
            CustomersPane::Channels => &heat::ChannelsPane,
            CustomersPane::Costs => &costs::CostsPane,
            CustomersPane::Fit => &fit::FitPane,
            CustomersPane::Quality => &quality::QualityByWeekPane,
            CustomersPane::Ways => &ways::WaysPane,
            CustomersPane::Facts => &facts::FactsPane,
            CustomersPane::Weeks => &weeks::WeeksPane,
            CustomersPane::Cohorts => &cohorts::CohortsPane,
            CustomersPane::Study => &study::StudyPane,
        }
    }

    fn focused(&self) -> CustomersPane {
        if self.open.is_some() { self.opened.focus } else { self.focus }
    }

    fn focus_on(&mut self, name: CustomersPane) {
        match self.open {
            Some(_) => self.opened.focus = name,
            None => self.focus = name,
        }
    }

    fn act_anywhere(&mut self, action: Action, _: &Look<'_>) -> Option<Vec<Effect>> {
        (action == Action::Close && self.open.take().is_some()).then(Vec::new)
    }

    fn arrange(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        if self.open.is_some() {
            return opened::arrange(self, canvas, area, look);
        }
        let map = (heat::HEIGHT + 2).min(area.height / 2);
        let list = (look.company.seen.known_groups.len() as u16 + 3).min(area.height - map);
        let rest = area.height - map - list;
        // A preview of the selected group takes the remaining rows if it fits.
        let (list, rest) = if rest >= 14 { (list, rest) } else { (list + rest, 0) };
        let [table, channels, preview] =
            Layout::vertical([Constraint::Length(list), Constraint::Length(map), Constraint::Length(rest)])
                .areas(area);
        draw_pane(self, CustomersPane::Groups, canvas, table, look);
        // Both halves if they fit, otherwise the focused one.
        if channels.width >= 150 {
            let halves = [Constraint::Percentage(50), Constraint::Min(0)];
            let [left, right] = Layout::horizontal(halves).areas(channels);
            draw_pane(self, CustomersPane::Channels, canvas, left, look);
            draw_pane(self, CustomersPane::Costs, canvas, right, look);
        } else if self.focus == CustomersPane::Costs {
            draw_pane(self, CustomersPane::Costs, canvas, channels, look);
        } else {
            draw_pane(self, CustomersPane::Channels, canvas, channels, look);
        }
        if rest > 0 && self.table.selected().is_some() {
            opened::draw_preview(self, canvas, preview, look);
        }
    }
}
