//! The customer groups: a table, what advertising brings, and each group opened.

mod group;
mod heat;
mod model;
#[cfg(test)]
mod tests;

use crossterm::event::KeyEvent;
use ratatui::layout::{Constraint, Layout, Rect};

use self::model::{Facts, Market, ad_budgets, development_budget};
use super::{Look, Screen};
use crate::console::action::{Action, Scope};
use crate::console::canvas::{Canvas, Click};
use crate::console::company::Company;
use crate::console::effect::Effect;
use crate::console::readings::Reading;
use crate::console::theme::Role;
use crate::console::widgets::{Cell, Column, Table, spark};
use crate::notation::{cents, compact, dollars, grouped, percent};
use crate::session::Rows;
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
    /// The group that is open, by its number among the known ones.
    open: Option<usize>,
    choice: usize,
}

/// Columns of the table, in the order of what is looked at first.
fn columns() -> Vec<Column> {
    let mut columns = vec![Column::words("group"), Column::words("kind")];
    columns.extend(
        [
            "subs",
            "seats",
            "leads",
            "new",
            "conv.",
            "left",
            "churn 30d",
            "MRR",
            "per seat",
            "use/day",
            "ads/day",
            "ad $/new",
            "dev/day",
        ]
        .map(Column::numbers),
    );
    columns.push(Column::words("new by week"));
    columns
}

fn row_of(group: Group, facts: &Facts, company: &Company, market: &Market) -> Vec<Cell> {
    let week = company.seen.week;
    let flow = facts.week(week);
    let before = facts.week(week.saturating_sub(1));
    let count = |value: f64| match value {
        0.0 => Cell::number(0.0, "–").role(Role::Dim),
        value => Cell::number(value, grouped(value, 0)),
    };
    let optional = |value: Option<f64>, write: &dyn Fn(f64) -> String| match value {
        Some(value) => Cell::number(value, write(value)),
        None => Cell::words("–").role(Role::Dim),
    };
    let budget = |value: f64| optional((value > 0.0).then_some(value), &dollars);
    let converted = (flow.leads > 0.0).then(|| flow.signed / flow.leads);
    // Companies sign weeks after they came: a share of this week's leads would mean nothing.
    let converted = converted.filter(|_| !group.is_enterprise());
    let (spend, signed) = (market.ad_spend(group), facts.last(week, 4, |flow| flow.signed));
    let seats = if group.is_enterprise() { Some(facts.sum(|held| held.seats)) } else { None };
    let trend: Vec<f64> = facts.trend(week, |flow| flow.signed).into_iter().map(|(_, new)| new).collect();
    let new_role = match flow.signed - before.signed {
        change if change > 0.0 => Role::Good,
        change if change < 0.0 => Role::Bad,
        _ => Role::Text,
    };
    let moved = match flow.signed - before.signed {
        change if change > 0.0 => "▲",
        change if change < 0.0 => "▼",
        _ => "",
    };
    vec![
        Cell::words(group.id()).role(Role::Strong),
        Cell::words(if group.is_enterprise() { "comp." } else { "indiv." }).role(Role::Dim),
        count(facts.sum(|held| held.customers)),
        optional(seats, &|seats| grouped(seats, 0)),
        count(flow.leads),
        Cell::number(flow.signed, format!("{moved} {}", grouped(flow.signed, 0))).role(new_role),
        optional(converted, &|share| percent(share, 1)),
        count(flow.cancelled),
        optional(facts.churn(), &|share| percent(share, 1)),
        Cell::number(facts.sum(|held| held.monthly), dollars(facts.sum(|held| held.monthly))),
        optional(facts.revenue_per_seat(), &cents),
        optional(facts.usage(), &compact),
        budget(ad_budgets(company, group)),
        optional((spend > 0.0 && signed > 0.0).then(|| spend / signed), &cents),
        budget(development_budget(company, group)),
        Cell::words(if trend.iter().any(|new| *new > 0.0) { spark(&trend, 12) } else { String::new() })
            .role(Role::Series(0)),
    ]
}

impl Customers {
    /// Opens a group, if it is known.
    pub fn show(&mut self, group: Group, company: &Company) {
        self.focus = GROUPS;
        self.open = company.seen.known_groups.iter().position(|own| *own == group);
        self.choice = 0;
        if let Some(open) = self.open {
            self.table.select(open);
        }
    }

    fn refresh(&mut self, company: &Company) {
        let groups = &company.seen.known_groups;
        let row = |group: &Group| row_of(*group, &self.market.of(*group), company, &self.market);
        let rows = groups.iter().map(row).collect();
        self.table.set(columns(), rows);
        let last = groups.len().saturating_sub(1);
        self.open = self.open.map(|open| open.min(last)).filter(|_| !groups.is_empty());
        self.place.group = self.place.group.min(last);
    }

    fn act_open(&mut self, open: usize, action: Action, look: &Look<'_>) -> Vec<Effect> {
        let groups = &look.company.seen.known_groups;
        match action {
            Action::Up => self.choice = self.choice.saturating_sub(1),
            Action::Down => self.choice = (self.choice + 1).min(group::CHOICES - 1),
            Action::First => self.choice = 0,
            Action::Last => self.choice = group::CHOICES - 1,
            Action::Left => self.open = Some(open.saturating_sub(1)),
            Action::Right => self.open = Some((open + 1).min(groups.len().saturating_sub(1))),
            Action::Close => self.open = None,
            Action::Open => {
                let chosen = groups.get(open).map(|group| group::choose(self.choice, *group));
                return chosen.into_iter().collect();
            }
            _ => {}
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
            (Some(_), _) => vec![Action::Open, Action::Left, Action::Right, Action::Close],
            (None, GROUPS) => vec![Action::Open, Action::Sort, Action::Filter],
            (None, _) => vec![Action::Open],
        }
    }

    fn panes(&self) -> usize {
        if self.open.is_some() { 1 } else { 2 }
    }

    fn focus(&self) -> usize {
        if self.open.is_some() { 0 } else { self.focus }
    }

    fn set_focus(&mut self, pane: usize) {
        if self.open.is_none() {
            self.focus = pane.min(CHANNELS);
        }
    }

    fn readings(&self) -> &'static [Reading] {
        &[
            Reading::Subscribers,
            Reading::Arrivals,
            Reading::Departures,
            Reading::LeadsByChannel,
            Reading::Usage,
        ]
    }

    fn take(&mut self, reading: Reading, rows: &Rows, look: &Look<'_>) {
        self.market.take(reading, rows);
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
            (GROUPS, Action::Open) => self.open = self.table.selected(),
            (CHANNELS, Action::Open) => return vec![Effect::ShowTool("set_targeted_ad_spend")],
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
            let again = self.choice == row;
            self.choice = row.min(group::CHOICES - 1);
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
        if let Some(group) = self.open.and_then(|open| groups.get(open)) {
            group::draw(canvas, area, look, &self.market, *group, Some(self.choice));
            return;
        }
        let map = (heat::HEIGHT + 2).min(area.height / 2);
        let list = (groups.len() as u16 + 4).min(area.height - map);
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
            group::draw(canvas, preview, look, &self.market, *group, None);
        }
    }
}

impl Customers {
    fn draw_table(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        let seen = &look.company.seen;
        let note = match self.table.note() {
            note if note.is_empty() => format!(
                "{} subscribers · {} seats · week {}",
                grouped(f64::from(seen.subscribers), 0),
                grouped(f64::from(seen.seats), 0),
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
