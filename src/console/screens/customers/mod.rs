//! Customer groups: a table, advertising results, and a detail view of each group.

mod cohorts;
mod columns;
pub mod costs;
mod group_curve;
mod facts;
mod fit;
mod groups;
mod channel_map;
mod true_values;
mod model;
mod open_group;
mod quality;
mod selection;
mod study;
#[cfg(test)]
mod tests;
mod group_actions;
mod weeks;

use ratatui::layout::{Constraint, Layout, Rect};

use self::cohorts::Cohorts;
use self::columns::{columns, group_row};
use self::group_curve::GroupCurve;
use self::model::CustomerData;
use self::open_group::OpenGroupState;
use super::ScreenState;
use super::panes::{Pane, PaneScreen, draw_pane, draw_stack};
use crate::action::Action;
use crate::context::ScreenContext;
use crate::effect::Effect;
use crate::tour::CustomersFacts;
use novamind_database::QueryResult;
use novamind_session::identifiers::Group;
use novamind_tui::canvas::Canvas;
use novamind_tui::widgets::Table;
use novamind_worker::company::DisplayedCompany;
use novamind_worker::screen_queries::Reading;

/// Panes of the customers screen.
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
    Actions,
    /// Estimated requirements next to the plans.
    Fit,
    /// Delivered and required quality by week.
    Quality,
    /// Known facts about the open group.
    Facts,
    /// Customers and their changes in the open group by week.
    Weeks,
    /// Retention in the open group by cohort.
    Cohorts,
    /// Estimates of the open group's market study.
    Study,
}

/// Panes that are shown while no group is open.
const LIST_PANES: [CustomersPane; 3] = [CustomersPane::Groups, CustomersPane::Channels, CustomersPane::Costs];
const GROUP_PANES: [CustomersPane; 7] = [
    CustomersPane::Actions,
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
    data: CustomerData,
    table: Table,
    costs: Table,
    map_cell: channel_map::ChannelMapCell,
    cohorts: Cohorts,
    /// Index of the open group in the list of known groups.
    open_group: Option<usize>,
    group_state: OpenGroupState,
    curve: GroupCurve,
}

impl Customers {
    /// Opens a group if the group is known.
    pub fn show_group(&mut self, group: Group, company: &DisplayedCompany) {
        self.focus = CustomersPane::Groups;
        self.open_group = company.observation.known_groups.iter().position(|known_group| *known_group == group);
        self.group_state = OpenGroupState::default();
        self.select_open();
    }

    /// Returns the position of the user for the tour, whose example is the first known group.
    pub fn tour_facts(&self, company: &DisplayedCompany) -> CustomersFacts {
        let index = |panes: &[CustomersPane], pane| panes.iter().position(|other| *other == pane).unwrap_or(0);
        let steps = |panes: &[CustomersPane], from, to| {
            (index(panes, to) + panes.len() - index(panes, from)) % panes.len()
        };
        let to_list = steps(&LIST_PANES, self.focus, CustomersPane::Groups);
        let opened = OpenGroupState::default().focus;
        let row = |wanted: Option<usize>| {
            let rows = self.table.visible_rows().iter();
            rows.enumerate().find(|(_, row)| Some(**row) == wanted).map_or(0, |(at, _)| at as isize)
        };
        // The user may have moved or hidden columns.
        let column = |wanted: usize| {
            self.table.displayed_columns().iter().position(|column| *column == wanted).unwrap_or(0) as isize
        };
        let (cancellations, cancellations_heading) = columns::cancellations_column(company);
        CustomersFacts {
            is_group_open: self.open_group.is_some(),
            panes_to_goal: match self.open_group {
                Some(_) => steps(&GROUP_PANES, self.group_state.focus, CustomersPane::Fit),
                None => to_list,
            },
            panes_to_fit: steps(&GROUP_PANES, opened, CustomersPane::Fit),
            panes_to_list: to_list,
            rows_to_example: row(Some(0)) - row(self.table.selected()),
            columns_to_cancellations: column(cancellations) - column(self.table.selected_column()),
            cancellations_heading,
        }
    }

    /// Returns the open group, or the group selected in the list.
    fn group(&self, company: &DisplayedCompany) -> Option<Group> {
        company.observation.known_groups.get(self.open_group.or(self.table.selected())?).copied()
    }

    /// Requests the curve of the open or selected group if it is missing or outdated.
    fn request_curve(&mut self, company: &DisplayedCompany) -> Vec<Effect> {
        self.group(company).map_or_else(Vec::new, |group| self.curve.request(group))
    }

    fn change_group(&mut self, other: impl Fn(usize) -> usize, company: &DisplayedCompany) {
        let last = company.observation.known_groups.len().saturating_sub(1);
        self.open_group = self.open_group.map(|open| other(open).min(last));
        self.select_open();
    }

    fn select_open(&mut self) {
        if let Some(open) = self.open_group {
            self.table.select(open);
        }
    }

    fn has_focus(&self, pane: CustomersPane) -> bool {
        self.focused_pane() == pane
    }

    fn rebuild_tables(&mut self, company: &DisplayedCompany) {
        let groups = &company.observation.known_groups;
        let row = |group: &Group| group_row(*group, &self.data.facts_of_group(*group), company, &self.data);
        let rows: Vec<_> = groups.iter().map(row).collect();
        if self.table.rows().is_empty() {
            self.table = Table::new(Vec::new()).with_cell_selection();
        }
        self.table.set_columns_and_rows(columns(company), rows);
        self.costs.set_columns_and_rows(costs::columns(), company.lead_costs.iter().map(costs::cost_row).collect());
        let last = groups.len().saturating_sub(1);
        self.open_group = self.open_group.map(|open| open.min(last)).filter(|_| !groups.is_empty());
        self.map_cell.group = self.map_cell.group.min(last);
    }
}

impl ScreenState for Customers {
    fn screen_queries(&self) -> &'static [Reading] {
        &[
            Reading::Subscribers,
            Reading::Arrivals,
            Reading::Departures,
            Reading::LeadsByChannel,
            Reading::Usage,
            Reading::Cohorts,
        ]
    }

    fn apply_rows(&mut self, reading: Reading, rows: &QueryResult, context: &ScreenContext<'_>) {
        match reading {
            Reading::Cohorts => self.cohorts = Cohorts::from_rows(rows),
            reading => self.data.apply_rows(reading, rows),
        }
        self.rebuild_tables(context.company);
    }

    fn on_company_change(&mut self, context: &ScreenContext<'_>) {
        self.curve.set_outdated();
        self.rebuild_tables(context.company);
    }

    fn request_data(&mut self, context: &ScreenContext<'_>) -> Vec<Effect> {
        self.request_curve(context.company)
    }

    fn take_answers(&mut self, _: &ScreenContext<'_>) -> Vec<Effect> {
        self.curve.take_answer();
        Vec::new()
    }

    fn selected_group(&self, context: &ScreenContext<'_>) -> Option<Group> {
        self.group(context.company)
    }

    fn open_item_title(&self, context: &ScreenContext<'_>) -> Option<String> {
        self.open_group.and_then(|_| self.group(context.company)).map(|group| group.to_string())
    }

    fn covers_list(&self) -> bool {
        self.open_group.is_some()
    }

    fn screen_escape_depth(&self) -> usize {
        usize::from(self.open_group.is_some())
    }

    fn open_object(&self, context: &ScreenContext<'_>) -> Option<(&'static str, String)> {
        let group = context.company.observation.known_groups.get(self.open_group?)?;
        Some(("group", group.id().to_owned()))
    }
}

impl PaneScreen for Customers {
    type PaneId = CustomersPane;

    fn panes(&self) -> &'static [CustomersPane] {
        if self.open_group.is_some() { &GROUP_PANES } else { &LIST_PANES }
    }

    fn pane(name: CustomersPane) -> &'static dyn Pane<Customers> {
        match name {
            CustomersPane::Groups => &groups::CustomerGroupsPane,
            CustomersPane::Channels => &channel_map::ChannelMapPane,
            CustomersPane::Costs => &costs::CostsPane,
            CustomersPane::Fit => &fit::FitPane,
            CustomersPane::Quality => &quality::QualityByWeekPane,
            CustomersPane::Actions => &group_actions::GroupActionsPane,
            CustomersPane::Facts => &facts::FactsPane,
            CustomersPane::Weeks => &weeks::WeeksPane,
            CustomersPane::Cohorts => &cohorts::CohortsPane,
            CustomersPane::Study => &study::StudyPane,
        }
    }

    fn focused_pane(&self) -> CustomersPane {
        if self.open_group.is_some() { self.group_state.focus } else { self.focus }
    }

    fn set_focused_pane(&mut self, name: CustomersPane) {
        match self.open_group {
            Some(_) => self.group_state.focus = name,
            None => self.focus = name,
        }
    }

    fn handle_screen_action(&mut self, action: Action, _: &ScreenContext<'_>) -> Option<Vec<Effect>> {
        (action == Action::Close && self.open_group.take().is_some()).then(Vec::new)
    }

    fn draw_panes(&self, canvas: &mut Canvas<'_>, area: Rect, context: &ScreenContext<'_>) {
        if self.open_group.is_some() {
            return open_group::draw_open_group(self, canvas, area, context);
        }
        let map = (channel_map::MAP_HEIGHT + 2).min(area.height / 2);
        let list = (context.company.observation.known_groups.len() as u16 + 3).min(area.height - map);
        let rest = area.height - map - list;
        // A preview of the selected group uses the remaining rows if there are enough.
        let (list, rest) = if rest >= 14 { (list, rest) } else { (list + rest, 0) };
        let [table, channels, preview] =
            Layout::vertical([Constraint::Length(list), Constraint::Length(map), Constraint::Length(rest)])
                .areas(area);
        draw_pane(self, CustomersPane::Groups, canvas, table, context);
        if channels.width >= 150 {
            let halves = [Constraint::Percentage(50), Constraint::Min(0)];
            let [left, right] = Layout::horizontal(halves).areas(channels);
            draw_pane(self, CustomersPane::Channels, canvas, left, context);
            draw_pane(self, CustomersPane::Costs, canvas, right, context);
        } else {
            draw_stack(self, &[CustomersPane::Channels, CustomersPane::Costs], canvas, channels, context);
        }
        if rest > 0 && self.table.selected().is_some() {
            open_group::draw_preview(self, canvas, preview, context);
        }
    }
}
