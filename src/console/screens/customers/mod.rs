//! The customer groups: a table, what advertising brings, and each group opened.

mod cohorts;
mod columns;
mod facts;
mod group;
mod heat;
mod model;
#[cfg(test)]
mod tests;

use crossterm::event::KeyEvent;
use ratatui::layout::{Constraint, Layout, Rect};

use self::cohorts::Cohorts;
use self::columns::{columns, row_of};
use self::group::{Known, Opened};
use self::model::Market;
use super::{Figure, Look, Screen};
use crate::console::action::{Action, Scope};
use crate::console::canvas::{Canvas, Click};
use crate::console::company::Company;
use crate::console::effect::Effect;
use crate::console::readings::Reading;
use crate::console::text::count;
use crate::console::widgets::Table;
use crate::session::Rows;
use crate::tools::ToolId;
use crate::world::identifiers::Group;

/// Panes.
const GROUPS: usize = 0;
const CHANNELS: usize = 1;

/// The screen.
#[derive(Default)]
pub struct Customers {
    focus: usize,
    market: Market,
    table: Table,
    place: heat::Place,
    cohorts: Cohorts,
    /// The group that is open, by its number among the known ones.
    open: Option<usize>,
    opened: Opened,
}

impl Customers {
    /// Opens a group, if it is known.
    pub fn show(&mut self, group: Group, company: &Company) {
        self.focus = GROUPS;
        self.open = company.seen.known_groups.iter().position(|own| *own == group);
        self.opened = Opened::default();
        if let Some(open) = self.open {
            self.table.select(open);
        }
    }

    fn refresh(&mut self, company: &Company) {
        let groups = &company.seen.known_groups;
        let row = |group: &Group| row_of(*group, &self.market.of(*group), company, &self.market);
        let rows: Vec<_> = groups.iter().map(row).collect();
        if self.table.rows().is_empty() {
            self.table = Table::new(Vec::new()).by_cell();
        }
        self.table.set(columns(), rows);
        let last = groups.len().saturating_sub(1);
        self.open = self.open.map(|open| open.min(last)).filter(|_| !groups.is_empty());
        self.place.group = self.place.group.min(last);
    }

    fn known<'a>(&'a self, company: &'a Company) -> Known<'a> {
        Known { company, market: &self.market, cohorts: &self.cohorts }
    }

    fn act_open(&mut self, open: usize, action: Action, look: &Look<'_>) -> Vec<Effect> {
        let groups = &look.company.seen.known_groups;
        let Some(group) = groups.get(open).copied() else { return Vec::new() };
        let last = groups.len().saturating_sub(1);
        match (self.opened.focus, action) {
            (_, Action::Close) => self.open = None,
            (group::WAYS, Action::Left) => self.open = Some(open.saturating_sub(1)),
            (group::WAYS, Action::Right) => self.open = Some((open + 1).min(last)),
            (group::WAYS, Action::Open) => return vec![group::choose(self.opened.choice, group)],
            (_, Action::Open) => {
                let figure = self.opened.figure(self.known(look.company), group);
                return figure.and_then(|figure| figure.sql).map(Effect::EditSql).into_iter().collect();
            }
            _ => {
                let known = Known { company: look.company, market: &self.market, cohorts: &self.cohorts };
                self.opened.act(action, known, group);
            }
        }
        if let Some(open) = self.open {
            self.table.select(open);
        }
        Vec::new()
    }
}

impl Screen for Customers {
    fn scopes(&self) -> Vec<Scope> {
        match self.open.is_none() && self.focus == GROUPS && self.table.is_typing() {
            true => vec![Scope::Field, Scope::List],
            false => vec![Scope::List],
        }
    }

    fn hints(&self) -> Vec<Action> {
        match (self.open, self.focus) {
            (Some(_), _) => vec![Action::Open, Action::FocusNext, Action::Close],
            (None, GROUPS) => vec![Action::Open, Action::Sort, Action::Filter],
            (None, _) => vec![Action::Open],
        }
    }

    fn panes(&self) -> usize {
        if self.open.is_some() { group::PANES } else { 2 }
    }

    fn focus(&self) -> usize {
        if self.open.is_some() { self.opened.focus } else { self.focus }
    }

    fn set_focus(&mut self, pane: usize) {
        match self.open {
            Some(_) => self.opened.focus = pane.min(group::PANES - 1),
            None => self.focus = pane.min(CHANNELS),
        }
    }

    fn figure(&self, look: &Look<'_>) -> Option<Figure> {
        let company = look.company;
        let groups = &company.seen.known_groups;
        if let Some(group) = self.open.and_then(|open| groups.get(open)) {
            return self.opened.figure(self.known(company), *group);
        }
        match self.focus {
            GROUPS => {
                let group = groups.get(self.table.selected()?)?;
                columns::figure(*group, self.table.selected_column(), company)
            }
            _ => heat::figure(company, self.place),
        }
    }

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

    fn act(&mut self, action: Action, look: &Look<'_>) -> Vec<Effect> {
        if let Some(open) = self.open {
            return self.act_open(open, action, look);
        }
        match (self.focus, action) {
            (GROUPS, Action::Open) => {
                self.open = self.table.selected();
                self.opened = Opened::default();
            }
            (CHANNELS, Action::Open) => return vec![Effect::ShowTool(ToolId::SetTargetedAdSpend)],
            (CHANNELS, action) => {
                self.place.act(action, look.company.seen.known_groups.len());
            }
            (_, action) => {
                self.table.act(action, look.page);
            }
        }
        Vec::new()
    }

    fn key(&mut self, key: &KeyEvent, _: &Look<'_>) -> Vec<Effect> {
        self.table.edit_filter(|field| {
            field.key(key);
        });
        Vec::new()
    }

    fn paste(&mut self, text: &str, _: &Look<'_>) -> Vec<Effect> {
        self.table.edit_filter(|field| field.insert(text));
        Vec::new()
    }

    fn click(&mut self, pane: usize, row: usize, look: &Look<'_>) -> Vec<Effect> {
        if self.open.is_some() {
            let before = self.opened.choice;
            self.set_focus(pane);
            self.opened.click(row);
            let again = pane == group::WAYS && before == self.opened.choice;
            return if again { self.act(Action::Open, look) } else { Vec::new() };
        }
        if pane == CHANNELS {
            let groups = look.company.seen.known_groups.len().max(1);
            self.place = heat::Place { channel: row / groups, group: row % groups };
            return Vec::new();
        }
        let before = self.table.selected();
        self.table.select_place(row);
        if before == self.table.selected() { self.act(Action::Open, look) } else { Vec::new() }
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        let groups = &look.company.seen.known_groups;
        let known = self.known(look.company);
        if let Some(group) = self.open.and_then(|open| groups.get(open)) {
            return match canvas.zoomed {
                true => self.opened.draw_pane(canvas, area, look, known, *group, self.opened.focus),
                false => self.opened.draw(canvas, area, look, known, *group),
            };
        }
        if canvas.zoomed {
            return match self.focus {
                GROUPS => self.draw_table(canvas, area, look),
                _ => self.draw_channels(canvas, area, look),
            };
        }
        let map = (heat::HEIGHT + 2).min(area.height / 2);
        let list = (groups.len() as u16 + 3).min(area.height - map);
        let rest = area.height - map - list;
        // What room is left shows the selected group; without it the list takes it all.
        let (list, rest) = if rest >= 14 { (list, rest) } else { (list + rest, 0) };
        let [table, channels, preview] =
            Layout::vertical([Constraint::Length(list), Constraint::Length(map), Constraint::Length(rest)])
                .areas(area);
        self.draw_table(canvas, table, look);
        self.draw_channels(canvas, channels, look);
        let selected = self.table.selected().and_then(|row| groups.get(row));
        if let Some(group) = selected.filter(|_| rest > 0) {
            group::draw_preview(canvas, preview, known, *group);
        }
    }
}

impl Customers {
    fn draw_table(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        let seen = &look.company.seen;
        let note = match self.table.note() {
            note if note.is_empty() => format!(
                "{} · {} · week {}",
                count(f64::from(seen.subscribers), "subscriber"),
                count(f64::from(seen.seats), "seat"),
                seen.week
            ),
            note => note,
        };
        canvas.click(area, Click::Pane(GROUPS));
        let focused = self.focus == GROUPS;
        let inside = canvas.pane(area, "Groups", &note, focused);
        self.table.draw(canvas, inside, focused, GROUPS);
        if focused {
            canvas.pane_keys(area, &look.hints(&[Action::Open, Action::Sort, Action::Filter]));
        }
    }

    fn draw_channels(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        canvas.click(area, Click::Pane(CHANNELS));
        let focused = self.focus == CHANNELS;
        let inside =
            canvas.pane(area, "Leads per $1,000", "measured over 28 days · █ best of the group", focused);
        heat::draw(canvas, inside, look.company, &self.market, self.place, focused, CHANNELS);
        if focused {
            let open = look.keys.label(Action::Open).unwrap_or_default();
            canvas.pane_keys(area, &format!("{open} set_targeted_ad_spend"));
        }
    }
}
