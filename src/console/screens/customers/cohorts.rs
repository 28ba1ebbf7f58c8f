//! Retention by signup week: a triangular table of cohorts and weeks since signup.

use std::collections::BTreeMap;

use ratatui::layout::Rect;

use super::Customers;
use super::selection::show_rows_effect;
use crate::action::Action;
use crate::context::{Figure, ScreenContext};
use crate::effect::Effect;
use crate::screens::panes::{PaneBorder, Pane, PanePlacement};
use novamind_base::formatting::{compact_number, percent};
use novamind_database::{QueryResult, number_at, text_at};
use novamind_session::identifiers::Group;
use novamind_tui::canvas::{Align, Canvas, Click, first_visible_row};
use novamind_tui::theme::Role;
use novamind_tui::widgets::chart::note_width;

const NAME_WIDTH: u16 = 14;
const CELL_WIDTH: u16 = 5;

pub struct CohortsPane;

impl Pane<Customers> for CohortsPane {
    fn hints(&self, _: &Customers) -> Vec<Action> {
        vec![Action::Open, Action::FocusNext, Action::Close]
    }

    fn figure(&self, customers: &Customers, context: &ScreenContext<'_>) -> Option<Figure> {
        customers.group_state.cohort.figure(&customers.cohorts, customers.group(context.company)?)
    }

    fn handle_action(&self, customers: &mut Customers, action: Action, context: &ScreenContext<'_>) -> Vec<Effect> {
        let Some(group) = customers.group(context.company) else { return Vec::new() };
        if action == Action::Open {
            return show_rows_effect(self.figure(customers, context));
        }
        customers.group_state.cohort.handle_action(action, &customers.cohorts, group, context.company.observation.week);
        Vec::new()
    }

    fn handle_click(&self, customers: &mut Customers, row: usize, _: &ScreenContext<'_>) -> Vec<Effect> {
        customers.group_state.cohort = CohortCell { cohort: row / 1000, weeks_since: row % 1000 };
        Vec::new()
    }

    fn border(&self, customers: &Customers, area: Rect, context: &ScreenContext<'_>) -> PaneBorder {
        let title = "Retention, %";
        let week = context.company.observation.week;
        let note = customers
            .group(context.company)
            .map_or(String::new(), |group| customers.cohorts.summary(group, week, note_width(area, title)));
        PaneBorder { title: title.to_owned(), note, ..PaneBorder::default() }
    }

    fn draw(&self, customers: &Customers, canvas: &mut Canvas<'_>, placement: PanePlacement, context: &ScreenContext<'_>) {
        let Some(group) = customers.group(context.company) else { return };
        let place = placement.focused.then_some(customers.group_state.cohort);
        draw(canvas, placement.area, &customers.cohorts, (group, context.company.observation.week), place, placement.index);
    }
}

/// Subscribers who signed up in the same week.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Cohort {
    pub size: f64,
    cancelled_by_week: BTreeMap<u32, f64>,
}

impl Cohort {
    /// Returns the share of the cohort that is still subscribed at the end of a week.
    pub fn retention(&self, week: u32) -> f64 {
        let gone: f64 = self.cancelled_by_week.range(..=week).map(|(_, left)| left).sum();
        if self.size > 0.0 { 1.0 - gone / self.size } else { 0.0 }
    }
}

/// Cohorts by group and signup week.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Cohorts(BTreeMap<Group, BTreeMap<u32, Cohort>>);

impl Cohorts {
    pub fn from_rows(rows: &QueryResult) -> Cohorts {
        let mut all = Cohorts::default();
        for row in &rows.rows {
            let Some(group) = Group::parse(text_at(row, 0)) else { continue };
            let (week, left, count) = (number_at(row, 1) as u32, number_at(row, 2) as u32, number_at(row, 3));
            let cohort = all.0.entry(group).or_default().entry(week).or_default();
            cohort.size += count;
            if left > 0 {
                // The week of a cancellation is at least the week of the signup.
                *cohort.cancelled_by_week.entry(left.max(week)).or_default() += count;
            }
        }
        all
    }

    /// Returns the signup weeks of a group with their cohorts, the newest first.
    fn weeks(&self, group: Group) -> Vec<(u32, &Cohort)> {
        let cohorts = self.0.get(&group).into_iter().flatten();
        let mut weeks: Vec<(u32, &Cohort)> = cohorts.map(|(week, cohort)| (*week, cohort)).collect();
        weeks.reverse();
        weeks
    }

    /// Returns the mean retention after `since` weeks, over all cohorts that are at least `since` weeks old.
    fn mean_retention(&self, group: Group, since: u32, now: u32) -> Option<f64> {
        let old = self.weeks(group).into_iter().filter(|(week, _)| week + since <= now);
        let (kept, size) = old.fold((0.0, 0.0), |(kept, size), (week, cohort)| {
            (kept + cohort.retention(week + since) * cohort.size, size + cohort.size)
        });
        (size > 0.0).then(|| kept / size)
    }

    /// Formats the mean retention after 4, 8 and 12 weeks in at most `room` columns.
    pub fn summary(&self, group: Group, now: u32, room: usize) -> String {
        let mean = |since| self.mean_retention(group, since, now).map(|kept| (since, kept));
        let texts: Vec<String> = [4, 8, 12]
            .into_iter()
            .filter_map(mean)
            .map(|(since, kept)| format!("{} after {since} weeks", percent(kept, 0)))
            .collect();
        let fitting = |count: usize| {
            let words = texts[..count].join(", ");
            (words.len() <= room).then_some(words)
        };
        (1..=texts.len()).rev().find_map(fitting).unwrap_or_default()
    }
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct CohortCell {
    /// Index of the cohort, newest first.
    pub cohort: usize,
    pub weeks_since: usize,
}

impl CohortCell {
    pub fn handle_action(&mut self, action: Action, cohorts: &Cohorts, group: Group, now: u32) {
        let weeks = cohorts.weeks(group);
        match action {
            Action::Up => self.cohort = self.cohort.saturating_sub(1),
            Action::Down => self.cohort += 1,
            Action::Left => self.weeks_since = self.weeks_since.saturating_sub(1),
            Action::Right => self.select_next_week(&weeks, now),
            Action::First => (self.cohort, self.weeks_since) = (0, 0),
            Action::Last => self.cohort = usize::MAX,
            _ => {}
        }
        self.cohort = self.cohort.min(weeks.len().saturating_sub(1));
        let most = weeks.get(self.cohort).map_or(0, |(week, _)| now.saturating_sub(*week));
        self.weeks_since = self.weeks_since.min(most as usize);
    }

    /// Selects the next week since the signup. If the cohort is too young, selects the next older cohort with that week.
    fn select_next_week(&mut self, weeks: &[(u32, &Cohort)], now: u32) {
        let is_old_enough = |(week, _): &(u32, &Cohort)| *week as usize + self.weeks_since < now as usize;
        let older = weeks.iter().skip(self.cohort).position(is_old_enough);
        if let Some(steps) = older {
            (self.cohort, self.weeks_since) = (self.cohort + steps, self.weeks_since + 1);
        }
    }

    /// Returns the retention in the cell as a figure, with a query for the customers who were still subscribed at the
    /// end of the week.
    pub fn figure(self, cohorts: &Cohorts, group: Group) -> Option<Figure> {
        let (week, cohort) = *cohorts.weeks(group).get(self.cohort)?;
        let until = week + self.weeks_since as u32;
        let kept = percent(cohort.retention(until), 1);
        let (first, last) = ((7 * week).saturating_sub(6), 7 * week);
        let sql = format!(
            "-- {group}: signed up in week {week}, subscribed at the end of week {until}\n\
             SELECT s.customer_id, s.plan, s.effective_price, s.start_day, s.end_day, s.status\nFROM subscriptions s\n\
             JOIN customers c ON c.customer_id = s.customer_id\nWHERE c.group_id = '{group}'\n    \
             AND s.start_day BETWEEN {first} AND {last}\n    AND s.status IN ('subscribed', 'cancelled')\n    \
             AND (s.status = 'subscribed' OR min(s.end_day, (SELECT max(day) FROM service_day)) > {})",
            7 * until
        );
        let title = format!(
            "{kept} of the {group} customers of week {week} were subscribed at the end of week {until}"
        );
        Some(Figure { title, term: "cohort", sql: Some(sql), week_quantity: None })
    }
}

/// Returns the glyph of a retention share. Darker glyphs mean higher retention.
fn shade_symbol(share: f64) -> &'static str {
    match share {
        share if share >= 0.9 => "█",
        share if share >= 0.7 => "▓",
        share if share >= 0.4 => "▒",
        share if share > 0.0 => "░",
        _ => " ",
    }
}

/// Draws the triangular table. The row index of a click is 1,000 times the cohort index plus the week.
fn draw(
    canvas: &mut Canvas<'_>,
    area: Rect,
    cohorts: &Cohorts,
    (group, now): (Group, u32),
    place: Option<CohortCell>,
    pane: usize,
) {
    let weeks = cohorts.weeks(group);
    if weeks.is_empty() {
        canvas.draw_text(area, "No signups in the last 16 weeks", Role::Dim);
        return;
    }
    if area.width < NAME_WIDTH + CELL_WIDTH || area.height < 3 {
        return;
    }
    let columns = ((area.width - NAME_WIDTH) / CELL_WIDTH) as usize;
    let oldest = weeks.last().map_or(now, |(week, _)| *week);
    let all = (now.saturating_sub(oldest) + 1) as usize;
    let left = first_visible_row(place.map_or(0, |place| place.weeks_since), columns, all);
    let head = Rect { height: 1, ..area };
    canvas.draw_text(Rect { width: NAME_WIDTH, ..head }, "week   signed", Role::Header);
    let cell_at =
        |row: Rect, at: usize| Rect { x: row.x + NAME_WIDTH + (at - left) as u16 * CELL_WIDTH, width: CELL_WIDTH, ..row };
    for since in left..all.min(left + columns) {
        let cell = cell_at(head, since);
        canvas.draw_aligned(Rect { width: CELL_WIDTH - 1, ..cell }, &format!("+{since}"), Role::Header, Align::Right);
    }
    // The last row shows the mean of all cohorts.
    let room = (area.height - 2) as usize;
    canvas.draw_column_marks(head, NAME_WIDTH, left > 0, all > left + columns);
    let list = Rect { y: area.y + 1, height: room as u16, ..area };
    let from = canvas.scroll_to_row(list, place.map_or(0, |place| place.cohort), weeks.len());
    let shown = weeks.iter().enumerate().skip(from).take(room);
    let mut y = area.y + 1;
    for (at, (week, cohort)) in shown {
        let row = Rect { y, height: 1, ..area };
        canvas.draw_text(Rect { width: 5, ..row }, &format!("{week:>4}"), Role::Strong);
        let size = Rect { x: row.x + 5, width: NAME_WIDTH - 6, ..row };
        canvas.draw_aligned(size, &compact_number(cohort.size), Role::Dim, Align::Right);
        let most = now.saturating_sub(*week) as usize;
        for since in left..(most + 1).min(left + columns) {
            let share = cohort.retention(week + since as u32);
            let here = place == Some(CohortCell { cohort: at, weeks_since: since });
            let cell = cell_at(row, since);
            draw_cell(canvas, cell, share, here);
            canvas.register_click(cell, Click::Row(pane, at * 1000 + since));
        }
        y += 1;
    }
    let row = Rect { y, height: 1, ..area };
    canvas.draw_text(Rect { width: NAME_WIDTH, ..row }, "all", Role::Header);
    for since in left..all.min(left + columns) {
        if let Some(share) = cohorts.mean_retention(group, since as u32, now) {
            let cell = Rect { width: CELL_WIDTH - 1, ..cell_at(row, since) };
            canvas.draw_aligned(cell, &format!("{:.0}", share * 100.0), Role::Strong, Align::Right);
        }
    }
}

fn draw_cell(canvas: &mut Canvas<'_>, cell: Rect, share: f64, here: bool) {
    let role = match share {
        share if share >= 0.7 => Role::Good,
        share if share >= 0.4 => Role::Text,
        _ => Role::Bad,
    };
    let figures = Rect { width: CELL_WIDTH - 1, ..cell };
    let shown = if here { Role::Selection } else { role };
    canvas.draw_aligned(figures, &format!("{:.0}", share * 100.0), shown, Align::Right);
    canvas.draw_text(Rect { x: cell.x + CELL_WIDTH - 1, width: 1, ..cell }, shade_symbol(share), role);
}

#[cfg(test)]
mod tests {
    use super::*;
    use novamind_database::Cell;

    #[test]
    fn retention_never_increases() {
        let row = |week: i64, left: i64, count: i64| {
            vec![Cell::Text("S1".into()), Cell::Integer(week), Cell::Integer(left), Cell::Integer(count)]
        };
        let rows = QueryResult {
            rows: vec![row(3, 0, 50), row(3, 5, 30), row(3, 7, 20), row(4, 0, 100)],
            ..QueryResult::default()
        };
        let cohorts = Cohorts::from_rows(&rows);
        let group = Group::parse("S1").expect("a group");
        let weeks = cohorts.weeks(group);
        assert_eq!(weeks.iter().map(|(week, _)| *week).collect::<Vec<_>>(), [4, 3]);
        let old = weeks[1].1;
        assert_eq!([3, 4, 5, 6, 7, 90].map(|week| old.retention(week)), [1.0, 1.0, 0.7, 0.7, 0.5, 0.5]);
        assert_eq!(cohorts.mean_retention(group, 4, 7), Some(0.5), "only cohorts that are old enough count");
        assert_eq!(cohorts.mean_retention(group, 2, 7), Some(0.85));
        assert_eq!(cohorts.mean_retention(group, 9, 7), None);
        let mut place = CohortCell::default();
        for _ in 0..9 {
            place.handle_action(Action::Right, &cohorts, group, 7);
        }
        assert_eq!(place, CohortCell { cohort: 1, weeks_since: 4 }, "the newer cohort has no week 4");
        place.handle_action(Action::Last, &cohorts, group, 7);
        assert_eq!(place.cohort, 1);
    }
}
